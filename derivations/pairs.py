"""Beyond the paper: two bodies that meet at a point, and the rod that would do the same.

The contact point is the origin, z points from the second body to the first; the impulse P acts on
the first, its opposite on the second. The contact velocity of the first relative to the second
answers to P with mobilities A, B, C, as that of a rod on a plate does. Nothing else of the bodies
enters an impact, so the branch rule and the three laws are those of the rod.
"""

from functools import cache
from itertools import combinations

import sympy as sp

from . import laws
from .laws import A, B, C
from .lecture import compared
from .newton import contact_change
from .proof import Equation
from .symbols import P_x, P_z, X, Z, c_x, c_z, k, m, omega, u_0, u_f, v_0, v_f
from .trace import derived, solve

# The letters of a rod, and what stands for them in each body.
FIRST, SECOND = (
    {
        x: sp.Symbol(f"{x}_{i}", real=True, positive=x.is_positive)
        for x in (m, k, X, Z, c_x, c_z, omega)
    }
    for i in (1, 2)
)
_light = sp.Symbol("lambda", positive=True)  # 1/m of the equivalent rod


@derived(r"\Delta u", r"\Delta v")
def response() -> sp.Matrix:
    """Change (du, dv) of the relative contact velocity under the impulse P."""
    first = sp.Matrix(contact_change(P_x, P_z)).subs(FIRST)
    return (first - sp.Matrix(contact_change(-P_x, -P_z)).subs(SECOND)).expand()


@derived()
def mobility() -> dict[sp.Symbol, sp.Expr]:
    """A, B, C of two bodies, read off du = C P_x - B P_z, dv = A P_z - B P_x."""
    du, dv = response()
    return {A: dv.coeff(P_z), B: -dv.coeff(P_x), C: du.coeff(P_x)}


@derived("A C - B^2")
def determinant() -> sp.Expr:
    """A C - B^2 of two bodies."""
    return sp.expand((A * C - B**2).subs(mobility()))


@derived("m", "X/k", "Z/k")
def equivalent_rod() -> sp.Matrix:
    """m, X/k and Z/k of the rod that has the mobilities A, B, C on a plate."""
    rod = {letter: _light * form for letter, form in laws.mobility().items()}
    x = max(solve(rod[A] - A, X), key=lambda root: root.subs({A: 2, _light: 1, k: 1}))
    z = max(solve(rod[C] - C, Z), key=lambda root: root.subs({C: 2, _light: 1, k: 1}))
    coupled = sp.expand((rod[B] ** 2 - B**2).subs({X: x, Z: z}))
    roots = solve(coupled, _light, r"$\lambda = 1/m$")
    light = min(roots, key=lambda root: root.subs({A: 3, B: 1, C: 2}).evalf())
    return sp.Matrix([1 / light, *((length / k).subs(_light, light) for length in (x, z))])


# ---- second routes ----------------------------------------------------------------------------


@cache
def _kinetic_energy() -> sp.Expr:
    """Of both bodies after P; the spin of each about the contact point stays what it was."""
    energy = sp.S.Zero
    for letters, sign in ((FIRST, 1), (SECOND, -1)):
        M, K, x, z, v_x, v_z, spin = letters.values()
        after_x, after_z = v_x + sign * P_x / M, v_z + sign * P_z / M
        turning = K * spin + (z * (v_x - after_x) - x * (v_z - after_z)) / K  # k omega
        energy += M * (after_x**2 + after_z**2 + turning**2) / 2
    return energy


def _ends(p_x: sp.Expr = P_x, p_z: sp.Expr = P_z) -> list[sp.Expr]:
    """Relative contact velocity after an impulse: the work that a little more of it would do."""
    return [_kinetic_energy().diff(p).subs({P_x: p_x, P_z: p_z}) for p in (P_x, P_z)]


START = _ends(sp.S.Zero, sp.S.Zero)


def _kinetic_energies(form: sp.Expr) -> list[sp.Expr]:
    """Kinetic energy of both bodies after minus before."""
    ends = dict(zip((u_0, v_0, u_f, v_f), (*START, *_ends()), strict=True))
    change = _kinetic_energy() - _kinetic_energy().subs({P_x: 0, P_z: 0})
    return [change - form.subs(ends, simultaneous=True)]


def _minors(form: sp.Expr) -> list[sp.Expr]:
    """Cauchy and Binet: all squares of minors of what the six motions do at the contact point."""
    motions = []
    for M, K, x, z, *_ in (FIRST.values(), SECOND.values()):
        motions += [(1 / M, 1, 0), (1 / M, 0, 1), (1 / (M * K**2), -z, x)]
    pairs = combinations(motions, 2)
    return [form - sum(a * b * (u * w - v * q) ** 2 for (a, u, v), (b, q, w) in pairs)]


def _by_mobilities() -> list[sp.Expr]:
    """What the mobilities make of an impulse, less how the contact velocity answers to it."""
    a, b, c = (mobility()[letter] for letter in (A, B, C))
    found = sp.Matrix([c * P_x - b * P_z, a * P_z - b * P_x])
    return list(found - (sp.Matrix(_ends()) - sp.Matrix(START)))


def _along_and_across(form: sp.Matrix) -> list[sp.Expr]:
    """An impulse through a rod's centre turns nothing; the trace is what any two across sum to."""
    mass, x, z = form
    return [C * x - B * z - x / mass, A * z - B * x - z / mass, A + C - (2 + x**2 + z**2) / mass]


_s = 1 / FIRST[m] + 1 / SECOND[m]
_a = [1 / (letters[m] * letters[k] ** 2) for letters in (FIRST, SECOND)]
_root = sp.sqrt((A - C) ** 2 + 4 * B**2)  # the eigenvalues' distance


def _sum(form: sp.Expr) -> sp.Expr:
    """Over both bodies, of a form of one divided by m k^2."""
    return _a[0] * form.subs(FIRST) + _a[1] * form.subs(SECOND)


def _terms_told() -> str:
    """The one sign of all terms, for bodies in any place."""
    squares = {x: sp.Symbol(str(x), real=True) for body in (FIRST, SECOND) for x in body.values()}
    squares |= {
        body[x]: sp.Symbol(str(body[x]), positive=True) for body in (FIRST, SECOND) for x in (m, k)
    }
    terms = sp.Add.make_args(_shown_determinant().subs(squares))
    (word,) = {"positive" if term.is_nonnegative else "negative" for term in terms}
    return word


def _eigenvalue_told() -> str:
    one = 1 / equivalent_rod()[0]
    at = {A: 3, B: 1, C: 2}
    return compared(one.subs(at), (A + C - one).subs(at), ("larger", "smaller"))


def _lean_told() -> str:
    """What -Z makes of the B of the rod alone."""
    coupled = laws.mobility()[B]
    turned = sp.cancel(coupled.subs(Z, -Z) / coupled)
    return compared(turned, sp.S.Zero, ("the same way", "the other way, $-Z$"))


def _shown_determinant() -> sp.Expr:
    return _s**2 + _s * _sum(X**2 + Z**2) + _a[0] * _a[1] * _cross**2


_cross = FIRST[X] * SECOND[Z] - SECOND[X] * FIRST[Z]
EQUATIONS = (
    Equation(
        "pairs: response",
        ("change of the contact velocity of the first of two bodies relative to the second"),
        r"(\Delta u, \Delta v)",
        derive=response,
        shown=(
            (_s + _sum(Z**2)) * P_x - _sum(X * Z) * P_z,
            (_s + _sum(X**2)) * P_z - _sum(X * Z) * P_x,
        ),
        check=lambda form: sp.Matrix(_ends()) - sp.Matrix(START) - form,
    ),
    Equation(
        "pairs: determinant",
        lambda: f"$A C - B^2$ of two bodies as a sum of {_terms_told()} terms",
        "A C - B^2",
        derive=determinant,
        shown=_shown_determinant(),
        check=lambda form: [*_minors(form), *_by_mobilities()],
    ),
    Equation(
        "pairs: equivalent rod",
        "the rod that two bodies of mobilities $A$, $B$, $C$ are at the contact point",
        "(m, X/k, Z/k)",
        derive=equivalent_rod,
        shown=(
            2 / (A + C - _root),
            sp.sqrt(A - C + _root) / sp.sqrt(A + C - _root),
            sp.sqrt(C - A + _root) / sp.sqrt(A + C - _root),
        ),
        check=_along_and_across,
        note=lambda: (
            f"its $1/m$ is the {_eigenvalue_told()} eigenvalue; for $B < 0$ it leans {_lean_told()}"
        ),
    ),
    Equation(
        "pairs: energy",
        "change of the kinetic energy of both bodies",
        r"\Delta E",
        derive=laws.energy_of_impulse,
        check=_kinetic_energies,
    ),
)
