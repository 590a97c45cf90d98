"""Beyond the paper: two bodies that meet at a point, and the rod that would do the same.

The contact point is the origin, z points from the second body to the first; the impulse P acts on
the first, its opposite on the second. The contact velocity of the first relative to the second
answers to P with mobilities A, B, C, as that of a rod on a plate does. Nothing else of the bodies
enters an impact, so the branch rule and the three laws are those of the rod.
"""

from collections.abc import Mapping
from functools import cache
from itertools import combinations

import sympy as sp

from . import laws
from .laws import A, B, C
from .newton import approach, contact_change
from .proof import Equation
from .symbols import P_x, P_z, V_z, X, Z, c_x, c_z, k, m, mu, omega, u_0, u_f, v_0, v_f
from .trace import derived

Letters = Mapping[sp.Symbol, sp.Expr]  # those of a rod, and what stands for them in a body


def _letters(i: int) -> Letters:
    positive = sp.symbols(f"m_{i} k_{i}", positive=True)
    real = sp.symbols(f"X_{i} Z_{i} c_x{i} c_z{i} omega_{i}", real=True)
    return dict(zip((m, k, X, Z, c_x, c_z, omega), (*positive, *real), strict=True))


FIRST, SECOND = map(_letters, (1, 2))
BODIES = ((FIRST, 1), (SECOND, -1))  # with the sign of the impulse
_light = sp.Symbol("lambda", positive=True)  # 1/m of the equivalent rod


def _difference(first: tuple[sp.Expr, ...], second: tuple[sp.Expr, ...]) -> sp.Matrix:
    """What a form of the first body is more than one of the second."""
    one, other = (
        sp.Matrix(forms).subs(letters, simultaneous=True)
        for forms, (letters, _) in zip((first, second), BODIES, strict=True)
    )
    return (one - other).expand()


@derived
def contact() -> sp.Matrix:
    """Contact velocity (u_0, v_0) of the first body relative to the second."""
    end = tuple(approach().values())
    return _difference(end, end).subs(V_z, 0)


@derived
def response() -> sp.Matrix:
    """Change (du, dv) of the relative contact velocity under the impulse P."""
    return _difference(contact_change(P_x, P_z), contact_change(-P_x, -P_z))


@derived
def mobility() -> dict[sp.Symbol, sp.Expr]:
    """A, B, C of two bodies, read off du = C P_x - B P_z, dv = A P_z - B P_x."""
    du, dv = response()
    return {A: dv.coeff(P_z), B: -dv.coeff(P_x), C: du.coeff(P_x)}


@derived
def determinant() -> sp.Expr:
    """A C - B^2 of two bodies."""
    return sp.expand((A * C - B**2).subs(mobility()))


@derived
def equivalent_rod() -> sp.Matrix:
    """m, X/k and Z/k of the rod that has the mobilities A, B, C on a plate."""
    rod = {letter: sp.Eq(_light * form, letter) for letter, form in laws.mobility().items()}
    x = max(sp.solve(rod[A], X), key=lambda root: root.subs({A: 2, _light: 1, k: 1}))
    (z,) = sp.solve(rod[B].subs(X, x), Z)
    rest = sp.together((rod[C].lhs - C).subs(Z, z))
    roots = sp.solve(sp.numer(sp.cancel(rest)), _light)
    light = min(roots, key=lambda root: root.subs({A: 3, B: 1, C: 2}).evalf())
    return sp.Matrix([1 / light, (x / k).subs(_light, light), (z / k).subs(_light, light)])


@derived
def impulse(regime: str) -> sp.Matrix:
    """Impulse P of an impact in which the slip stops, and which ends with v_f under any law."""
    parts = laws.impulse_at(regime, v_f, u_0 / (mu * C + B))
    return sp.Matrix([sp.factor(part) for part in parts])


# ---- second routes ----------------------------------------------------------------------------


@cache
def _kinetic_energy() -> sp.Expr:
    """Of both bodies after P; the spin of each about the contact point stays what it was."""
    energy = sp.S.Zero
    for letters, sign in BODIES:
        M, K, x, z, v_x, v_z, spin = letters.values()
        about_contact = K**2 * spin + z * v_x - x * v_z
        after_x, after_z = v_x + sign * P_x / M, v_z + sign * P_z / M
        turning = (about_contact - z * after_x + x * after_z) / K  # k omega
        energy += M * (after_x**2 + after_z**2 + turning**2) / 2
    return energy


def _ends(p_x: sp.Expr, p_z: sp.Expr) -> list[sp.Expr]:
    """Relative contact velocity after an impulse: the work that a little more of it would do."""
    return [_kinetic_energy().diff(p).subs({P_x: p_x, P_z: p_z}) for p in (P_x, P_z)]


START = _ends(sp.S.Zero, sp.S.Zero)


def _by_work(form: sp.Matrix) -> list[sp.Expr]:
    """The gradient of the kinetic energy in P, here and without the impulse."""
    return [u - start - part for u, start, part in zip(_ends(P_x, P_z), START, form, strict=True)]


def _kinetic_energies(form: sp.Expr) -> list[sp.Expr]:
    """Kinetic energy of both bodies after minus before."""
    ends = dict(zip((u_0, v_0, u_f, v_f), (*START, *_ends(P_x, P_z)), strict=True))
    change = _kinetic_energy() - _kinetic_energy().subs({P_x: 0, P_z: 0})
    return [change - form.subs(ends, simultaneous=True)]


def _minors(form: sp.Expr) -> list[sp.Expr]:
    """Cauchy and Binet: all squares of minors of what the six motions do at the contact point."""
    motions = []
    for M, K, x, z, *_ in (letters.values() for letters, _ in BODIES):
        motions += [(1 / M, 1, 0), (1 / M, 0, 1), (1 / (M * K**2), -z, x)]
    pairs = combinations(motions, 2)
    return [form - sum(a * b * (u * w - v * q) ** 2 for (a, u, v), (b, q, w) in pairs)]


def _along_and_across(form: sp.Matrix) -> list[sp.Expr]:
    """An impulse through a rod's centre turns nothing; the trace is what any two across sum to."""
    mass, x, z = form
    return [C * x - B * z - x / mass, A * z - B * x - z / mass, A + C - (2 + x**2 + z**2) / mass]


def _by_conservation(form: sp.Matrix) -> list[sp.Expr]:
    """Phase by phase: where the slip stops, what holds it or turns it, how it ends."""
    slope = {p: [end.diff(p) for end in _ends(P_x, P_z)] for p in (P_x, P_z)}
    given = {A: slope[P_z][1], B: -slope[P_x][1], C: slope[P_x][0], u_0: START[0], v_0: START[1]}
    stick, back = form[:2], form[2:]
    stopped = u_0 / (mu * C + B)
    residuals = [
        _ends(-mu * P_z, P_z)[0].subs(P_z, stopped),
        _ends(*stick)[0],
        _ends(*stick)[1] - v_f,
        back[0] + mu * stopped - mu * (back[1] - stopped),
        _ends(*back)[1] - v_f,
    ]
    return [residual.subs(given) for residual in residuals]


_s = 1 / FIRST[m] + 1 / SECOND[m]
_a = [1 / (letters[m] * letters[k] ** 2) for letters, _ in BODIES]
_root = sp.sqrt((A - C) ** 2 + 4 * B**2)
_smaller = (A + C - _root) / 2  # eigenvalue
_x = sp.sqrt(A - _smaller) / sp.sqrt(_smaller)


def _sum(form: sp.Expr) -> sp.Expr:
    """Over both bodies, of a form of one divided by m k^2."""
    return sum(a * form.subs(letters) for a, (letters, _) in zip(_a, BODIES, strict=True))


EQUATIONS = (
    Equation(
        tag="pairs: contact velocity",
        what="contact velocity of the first of two bodies relative to the second",
        symbol="(u_0, v_0)",
        derive=contact,
        check=lambda form: [start - part for start, part in zip(START, form, strict=True)],
        verdict="new",
        note="the work that a small impulse does is its product with this",
    ),
    Equation(
        tag="pairs: response",
        what="its change under the impulse $P$ on the first body and $-P$ on the second",
        symbol="(\\Delta u, \\Delta v)",
        derive=response,
        shown=sp.Matrix(
            [
                (_s + _sum(Z**2)) * P_x - _sum(X * Z) * P_z,
                (_s + _sum(X**2)) * P_z - _sum(X * Z) * P_x,
            ]
        ),
        check=_by_work,
        verdict="new",
        note="with mobilities $A$, $B$, $C$ as for a rod: $C P_x - B P_z$ and $A P_z - B P_x$",
    ),
    Equation(
        tag="pairs: determinant",
        what="$A C - B^2$ of two bodies as a sum of positive terms",
        symbol="A C - B^2",
        derive=determinant,
        shown=_s**2
        + _s * _sum(X**2 + Z**2)
        + _a[0] * _a[1] * (FIRST[X] * SECOND[Z] - SECOND[X] * FIRST[Z]) ** 2,
        check=_minors,
        verdict="new",
        note="nothing cancels, whatever the masses and sizes",
    ),
    Equation(
        tag="pairs: equivalent rod",
        what="the rod that two bodies of mobilities $A$, $B$, $C$ are at the contact point",
        symbol="(m, X/k, Z/k)",
        derive=equivalent_rod,
        shown=sp.Matrix([1 / _smaller, _x, B / (_smaller * _x)]),
        check=_along_and_across,
        verdict="new",
        note="there is one for every pair, with $k$ of choice; its $1/m$ is the smaller eigenvalue",
    ),
    Equation(
        tag="pairs: impulse",
        what="$(P_x, P_z)$ of two bodies if the slip stops: sticking, then slipping back; $v_f$ by "
        "any law",
        symbol="(P_x, P_z, P_x, P_z)",
        derive=lambda: sp.Matrix([*impulse("stick"), *impulse("back")]),
        check=_by_conservation,
        verdict="new",
        note="the impulse of the equivalent rod",
    ),
    Equation(
        tag="pairs: energy",
        what="change of the kinetic energy of both bodies",
        symbol="\\Delta E",
        derive=laws.energy_of_impulse,
        check=_kinetic_energies,
        verdict="new",
        note="as for a rod, so that the work in Stronge's law is that on both bodies",
    ),
)
