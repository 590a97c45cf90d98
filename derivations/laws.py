"""Beyond the paper: the same impact under three laws of restitution, and its energy balance.

Newton (kinematic)  v_f = -epsilon v_0: the paper's law
Poisson (kinetic)   the impulse after the end of compression is epsilon times the one before
Stronge (energetic) the work given back by the normal impulse is epsilon^2 times the work taken

The normal contact velocity is piecewise linear in the normal impulse: slope a_1 while the contact
slips forward, up to the impulse P_1 where it stops, slope a_2 afterwards (sticking or slipping
back). "Early": the slip stops before compression ends (v_1 < 0); "late": after it. A slide is one
straight line, and there the three laws say the same.
"""

import sympy as sp

from . import second_routes
from .axioms import RESTITUTION
from .bodies import THIN
from .lecture import PAPER, compared, degrees, number, sign
from .newton import contact_change
from .proof import Equation
from .slip_reversal import reversed_change
from .slip_stick import sticking_velocity
from .symbols import (
    P_1,
    P_x,
    P_z,
    V_z,
    X,
    Z,
    c_x,
    c_z,
    epsilon,
    k,
    m,
    mu,
    omega,
    phi,
    u_0,
    u_f,
    v_0,
    v_f,
)
from .trace import derived, solve

a_1, a_2 = sp.symbols("a_1 a_2", positive=True)
# Inverse inertia of the contact point, per unit mass: du = C P_x - B P_z, dv = A P_z - B P_x.
A, B, C = sp.symbols("A B C", positive=True)
slope = sp.Symbol("a", positive=True)  # -a_1 in the Painleve region
P_c = sp.Symbol("P_c", positive=True)  # normal impulse at the end of compression
kappa = sp.Symbol("kappa", nonnegative=True)  # (1 - epsilon)/(1 + epsilon)

V_1 = v_0 + a_1 * P_1  # normal velocity when the slip stops


@derived()
def mobility() -> dict[sp.Symbol, sp.Expr]:
    """A, B, C in terms of X, Z, k, read off the contact velocity's response, (5) and (6)."""
    du, dv = (sp.expand(m * part) for part in contact_change(P_x, P_z))
    return {A: dv.coeff(P_z), B: -dv.coeff(P_x), C: du.coeff(P_x)}


@derived("a_{%s}")
def slopes() -> dict[str, sp.Expr]:
    """Slope m dv/dP_z while slipping forward, sticking and slipping back."""
    p = sp.Symbol("p", positive=True)
    rates = {
        "slip": contact_change(-mu * p, p)[1],
        "stick": sticking_velocity(p),
        "back": reversed_change(p)[1],
    }
    return {name: sp.factor(m * rate / p) for name, rate in rates.items()}


def _velocity(p: sp.Expr) -> sp.Expr:
    """Normal velocity after the slip has stopped."""
    return V_1 + a_2 * (p - P_1)


@derived("P_c")
def compression(order: str) -> sp.Expr:
    """Normal impulse at the end of compression."""
    line = _velocity(P_z) if order == "early" else v_0 + a_1 * P_z
    (p_c,) = solve(line, P_z)
    return p_c


@derived("W_c", "W_r")
def work(order: str, p_f: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Work of the normal impulse during compression and restitution, ended at p_f > P_1."""
    p, p_c = sp.Symbol("p"), compression(order)
    slip, after = v_0 + a_1 * p, _velocity(p)
    if order == "early":
        taken = sp.integrate(slip, (p, 0, P_1)) + sp.integrate(after, (p, P_1, p_c))
        given = sp.integrate(after, (p, p_c, p_f))
    else:
        taken = sp.integrate(slip, (p, 0, p_c))
        given = sp.integrate(slip, (p, p_c, P_1)) + sp.integrate(after, (p, P_1, p_f))
    return sp.expand(taken), sp.expand(given)


@derived("v_{f, %(order)s}")
def final_velocity(law: str, order: str) -> sp.Expr:
    """v_f of an impact in which the slip stops; a function of v_0, a_1, a_2 and P_1."""
    if law == "newton":
        return RESTITUTION({})
    if law == "poisson":
        return sp.factor(_velocity((1 + epsilon) * compression(order)))
    square = sp.Symbol("v_f^2", positive=True)
    p_f = P_1 + (sp.sqrt(square) - V_1) / a_2
    taken, given = work(order, p_f)
    (value,) = solve(sp.expand(given + epsilon**2 * taken), square)
    return sp.sqrt(sp.factor(value))


@derived("P_x", "P_z")
def impulse_at(regime: str, v_f: sp.Expr, p_1: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Impulse (P_x, P_z) per unit mass, in A, B, C, of an impact that stops at p_1."""
    back = mu if regime == "back" else B / C
    a2 = A - B * back
    extra = (v_f - (v_0 + (A + mu * B) * p_1)) / a2
    return -mu * p_1 + back * extra, p_1 + extra


@derived(r"\Delta E")
def energy_of_impulse() -> sp.Expr:
    """Energy change of any impact: the impulse times the mean contact velocity."""
    return P_x * (u_0 + u_f) / 2 + P_z * (v_0 + v_f) / 2


@derived(r"\Delta E_{%(regime)s}")
def energy_change(regime: str) -> sp.Expr:
    """Kinetic energy after minus before under Newton's law, per unit mass, in A, B, C."""
    p_x, p_z = impulse_at(regime, RESTITUTION({}), u_0 / (mu * C + B))
    end = {u_f: u_0 + C * p_x - B * p_z, v_f: v_0 + A * p_z - B * p_x, P_x: p_x, P_z: p_z}
    return sp.factor(energy_of_impulse().subs(end, simultaneous=True))


@derived(r"\kappa_c")
def energy_threshold(regime: str) -> sp.Expr:
    """kappa_c: Newton's law can create energy exactly where (1-eps)/(1+eps) < kappa_c.

    The energy change is a quadratic form in (u_0, v_0) that is negative at both ends of the
    regime; it reaches positive values where its discriminant is positive.
    """
    quadratic = sp.Poly(sp.numer(energy_change(regime)).subs(v_0, -1), u_0)
    gain = quadratic.discriminant().subs(epsilon, (1 - kappa) / (1 + kappa))
    roots = solve(sp.numer(sp.together(gain)), kappa, r"$\kappa = (1 - \epsilon)/(1 + \epsilon)$")
    point = {A: 3, B: sp.Rational(3, 2), C: 2, mu: sp.Rational(1, 5)}
    inside = [r for r in roots if 0 < r.subs(point).evalf() < 1]
    return sp.simplify(inside[0])


@derived(r"\epsilon_c")
def sticking_threshold() -> sp.Expr:
    """epsilon_c of slip-stick: the same threshold, solved for epsilon."""
    quadratic = sp.Poly(sp.numer(energy_change("stick")).subs(v_0, -1), u_0)
    roots = solve(quadratic.discriminant(), epsilon)
    return max(roots, key=lambda root: root.subs({A: 3, B: 1, C: 2}).evalf())


@derived(r"\epsilon_c")
def thin_threshold() -> sp.Expr:
    """epsilon_c of a sticking thin rod."""
    return sticking_threshold().subs(mobility()).subs(THIN)


@derived("v_{f, Newton}", "v_{f, Poisson}", "v_{f, Stronge}")
def limits() -> tuple[sp.Expr, ...]:
    """v_f of the three laws as v_0 -> 0- inside the Painleve region (a_1 < 0)."""
    return tuple(
        sp.simplify(final_velocity(law, "early").subs(a_1, -slope).subs(v_0, 0))
        for law in ("newton", "poisson", "stronge")
    )


@derived("W_{%(regime)s}")
def friction_work(regime: str) -> sp.Expr:
    """Work of friction in an impact whose slip stops at P_1, per unit mass."""
    p = sp.Symbol("p")
    slipping = -(mu * C + B) * (p - P_1)  # u, under du = C dP_x - B dP_z with dP_x = -mu dP_z
    work = sp.integrate(-mu * slipping, (p, 0, P_1))
    if regime == "back":
        work += sp.integrate(mu * (mu * C - B) * (p - P_1), (p, P_1, P_z))
    return sp.factor(work)


@derived(r"\Delta E_{%(regime)s, %(order)s}")
def energy_by_poisson(regime: str, order: str) -> sp.Expr:
    """Energy change under Poisson's law, per unit mass, by P_1 and the end of compression P_c."""
    slope_2 = A - B * (mu if regime == "back" else B / C)
    first = P_1 if order == "early" else P_c
    known = {a_1: A + mu * B, a_2: slope_2}
    v_start = -known[a_1] * first - slope_2 * (P_c - first)
    v_end = final_velocity("poisson", order).subs({**known, v_0: v_start}, simultaneous=True)
    u_start = (mu * C + B) * P_1
    p_x, p_z = impulse_at(regime, v_end, P_1)
    p_x, p_z = (part.subs(v_0, v_start) for part in (p_x, p_z))
    ends = {u_0: u_start, v_0: v_start, u_f: u_start + C * p_x - B * p_z, v_f: v_end}
    return sp.factor(energy_of_impulse().subs({**ends, P_x: p_x, P_z: p_z}, simultaneous=True))


# ---- second routes ----------------------------------------------------------------------------

_MOBILITIES = {A: 1 + X**2 / k**2, B: X * Z / k**2, C: 1 + Z**2 / k**2}
_THIN_LENGTHS = {X: sp.sin(phi), Z: sp.cos(phi), k: 1 / sp.sqrt(3)}


def _kinetic_energy(form: sp.Expr) -> list[sp.Expr]:
    """Kinetic energy after minus before, by its definition, under any impulse per unit mass."""
    turn = (X * P_z - Z * P_x) / k**2
    before = (c_x**2 + (c_z - V_z) ** 2 + k**2 * omega**2) / 2
    after = ((c_x + P_x) ** 2 + (c_z + P_z - V_z) ** 2 + k**2 * (omega + turn) ** 2) / 2
    u, v = c_x - Z * omega, c_z - V_z + X * omega
    contact = {u_0: u, v_0: v, u_f: u + P_x - Z * turn, v_f: v + P_z + X * turn}
    return [after - before - form.subs(contact, simultaneous=True)]


def _kinetic_energies(form: sp.Matrix) -> list[sp.Expr]:
    """Kinetic energies of whole impacts, without spin before, on a plate at rest."""
    start = {**_MOBILITIES, u_0: c_x, v_0: c_z}
    changes = [second_routes.energy_change(regime) for regime in ("stick", "back")]
    return [part.subs(start) - change for part, change in zip(form, changes, strict=True)]


def _triangles(form: sp.Matrix) -> list[sp.Expr]:
    """Work as areas under the broken line of v over P_z: given back, epsilon^2 of what was taken.

    Early: a trapezium up to the corner and a triangle after it are taken.
    """
    early, late = form
    taken_early = -(v_0 + V_1) / 2 * P_1 + V_1**2 / (2 * a_2)
    left_late = epsilon**2 * v_0**2 / (2 * a_1) - V_1**2 / (2 * a_1)  # to be given after P_1
    return [
        early - epsilon * sp.sqrt(2 * a_2 * taken_early),
        late - sp.sqrt(V_1**2 + 2 * a_2 * left_late),
    ]


def _impulses_in_proportion(form: sp.Matrix) -> list[sp.Expr]:
    """Poisson: the whole impulse is 1 + epsilon times that up to v = 0."""
    compressed = P_1 - V_1 / a_2, -v_0 / a_1
    whole = [P_1 + (v - V_1) / a_2 for v in form]
    return [p - (1 + epsilon) * p_c for p, p_c in zip(whole, compressed, strict=True)]


def _balance(p_x: sp.Expr, p_z: sp.Expr, u: sp.Expr, v: sp.Expr) -> sp.Expr:
    """Energy that an impulse gives a contact point of velocity (u, v), by its mobilities."""
    return u * p_x + v * p_z + (C * p_x**2 - 2 * B * p_x * p_z + A * p_z**2) / 2


def _all_but_normal_work(form: sp.Matrix) -> list[sp.Expr]:
    """The whole energy less the areas under the broken line of v over P_z."""
    checks = []
    for held, work in zip((B / C, mu), form, strict=True):
        more = P_z - P_1
        corner = v_0 + (A + mu * B) * P_1
        areas = (v_0 + corner) / 2 * P_1 + corner * more + (A - B * held) * more**2 / 2
        whole = _balance(-mu * P_1 + held * more, P_z, (mu * C + B) * P_1, v_0)
        checks.append(whole - areas - work)
    return checks


def _poisson_from_impulses(form: sp.Matrix) -> list[sp.Expr]:
    """The impulse is 1 + epsilon times P_c; and no term of the energy is positive.

    What is not negative: C, what the stop needs, mu C + B, what holds or turns the contact, the
    impulse after the corner, P_2, and where the slip stops late, P_1 - P_2.
    """
    whole, (b, s, after, rest) = (1 + epsilon) * P_c, sp.symbols("b s P_2 r", nonnegative=True)
    checks = []
    for part, (held, early) in zip(
        form, ((B / C, True), (mu, True), (B / C, False), (mu, False)), strict=True
    ):
        slope_1, slope_2 = A + mu * B, A - B * held
        start = -slope_1 * (P_1 if early else P_c) - (slope_2 * (P_c - P_1) if early else 0)
        p_x = -mu * P_1 + held * (whole - P_1)
        checks.append(_balance(p_x, whole, (mu * C + B) * P_1, start) - part)
        lost = (1 - epsilon**2) * P_c**2 / 2 * (slope_2 if early else slope_1)
        left = (part + lost).subs(epsilon, (P_1 + after) / P_c - 1)
        cases = [{B: mu * C + s}] if held == mu else [{B: b, mu: (b + s) / C}]
        cases += [{B: -b, mu: (b + s) / C}] if held != mu else []
        for case in cases:
            signs = left.subs(case, simultaneous=True)
            signs = sp.expand(sp.cancel(signs if early else signs.subs(P_1, after + rest)))
            checks += [sp.S.One for term in sp.Add.make_args(signs) if not term.is_nonpositive]
    return checks


def _one_line(form: sp.Expr) -> list[sp.Expr]:
    """With a_2 = a_1 there is no corner, and all laws and orders give the same."""
    return [
        (final_velocity(law, order) ** 2).subs(a_2, a_1) - form
        for law in ("newton", "poisson", "stronge")
        for order in ("early", "late")
    ]


def _thrown_up(form: sp.Matrix) -> list[sp.Expr]:
    """From v_0 = 0 down to -a P_1 and up again to zero at p_c: impulses and triangles there."""
    newton, poisson, stronge = form
    p_c = P_1 * (1 + slope / a_2)
    return [
        newton,
        poisson - a_2 * epsilon * p_c,
        stronge - epsilon * sp.sqrt(a_2 * slope * P_1 * p_c),
    ]


def _created(regime: str, ratio: sp.Expr) -> sp.Expr:
    """Discriminant of the energy change at kappa = ratio, from whole impacts: zero if right."""
    restitution = ((1 - ratio) / (1 + ratio)).subs(_MOBILITIES)
    return second_routes.energy_created(regime).subs(epsilon, restitution)


def _slopes_by_spin(form: sp.Matrix) -> list[sp.Expr]:
    """From rest, by the spin about the contact point, which an impulse through it keeps."""
    p_x = {"slip": -mu, "back": mu, "stick": sp.Symbol("p_x")}
    checks = []
    for (name, x), slope_of in zip(p_x.items(), (form[0], form[2], form[1]), strict=True):
        turn = (X - Z * x) / k**2  # k^2 turn + Z p_x - X p_z = 0, p_z = 1
        u, v = x - Z * turn, 1 + X * turn
        if name == "stick":
            v = v.subs(x, sp.solve(u, x)[0])
        checks.append(v - slope_of)
    return checks


_back, _stop = A - mu * B, B + mu * C
_all_loss = (1 + epsilon) * (A - 2 * mu * B + mu**2 * C)
_mixed = (1 + epsilon) * (A + mu * B) * (B - mu * C) + 2 * B * _back

_kept = (1 - epsilon**2) * P_c**2
_more = (1 + epsilon) * P_c - P_1


def _lossless_gains(regime: str) -> bool:
    """Whether impacts of restitution 1 can gain energy: those on that side of the threshold."""
    lossless = second_routes.energy_created(regime).subs(epsilon, 1)
    return bool(lossless.subs({X: 1, Z: 1, k: 1, mu: sp.Rational(1, 5)}) > 0)


def _threshold_told(regime: str) -> str:
    side = "below" if _lossless_gains(regime) else "above"
    return rf"Newton's law can create energy where $(1 - \epsilon)/(1 + \epsilon)$ is {side} this"


def _work_told() -> str:
    """The sign of friction's work, with what a stop and a reversal need."""
    turned = {B: mu * C + sp.Symbol("s", positive=True)}  # B > mu C
    held = {B: sp.Symbol("s", positive=True) - mu * C}  # mu C + B > 0
    more = {P_z: P_1 + sp.Symbol("P_2", positive=True)}
    signs = {sign(friction_work("stick"), held), sign(friction_work("back").subs(more), turned)}
    never = {"negative": "positive", "positive": "negative"}[signs.pop()]
    return (
        rf"never {never}, as $\mu C + B > 0$ where a slip stops and $B > \mu C$ where it turns "
        "back. "
        r"Under Stronge's law the normal work is $-(1 - \epsilon^2)$ times that of compression, so "
        "that no impact gains energy"
    )


def _poisson_told() -> str:
    """The sign of every term of the four energies, for B > 0."""
    rest = sp.Symbol("s", positive=True)
    more = {P_c: (P_1 + sp.Symbol("P_2", positive=True)) / (1 + epsilon)}
    held, turned = {A: (B**2 + rest) / C}, {A: mu * B + rest}
    signs = set()
    for regime, margin in (("stick", held), ("back", {**turned, B: mu * C + rest})):
        for order in ("early", "late"):
            signs.add(sign(energy_by_poisson(regime, order), {**margin, **more}))
    (every,) = signs
    never = {"negative": "positive", "positive": "negative"}[every]
    return (
        f"never {never}: every term is {every} but the last one of slip-stick, late, for $B < 0$, "
        r"and that is smaller than the one before it, as $\mu C \ge -B$ holds the contact and the "
        "impulse after the corner is at most $P_1$"
    )


def _thin_told() -> str:
    """The least threshold, where, and on which side of it the paper's two values lie."""
    threshold = thin_threshold()
    least = threshold.subs(phi, sp.pi / 4)
    neighbours = [threshold.subs(phi, sp.pi / 4 + x) - least for x in (-sp.pi / 90, sp.pi / 90)]
    (bound,) = {compared(x, 0, ("below", "above")) for x in neighbours}
    paper = compared(least, PAPER[epsilon], ("no energy", "energy"))
    edge = "exactly the edge" if sp.simplify(least - sp.Rational(4, 5)) == 0 else "off the edge"
    return (
        f"never {bound} {sp.nsimplify(least)}, reached at {degrees(sp.pi / 4)}: with the paper's "
        f"{number(PAPER[epsilon])} {paper} is created, and its 0.8 of Fig. 10 is {edge}"
    )


EQUATIONS = (
    Equation(
        "laws: slopes",
        r"$m\,dv/dP_z$ while slipping forward, sticking and slipping back",
        "(a_{slip}, a_{stick}, a_{back})",
        derive=lambda: tuple(slopes()[name] for name in ("slip", "stick", "back")),
        check=_slopes_by_spin,
    ),
    Equation(
        "laws: energy",
        "energy change of any impact from the impulse and the contact velocities",
        r"\Delta E",
        derive=energy_of_impulse,
        check=_kinetic_energy,
        note=("the mean contact velocity times the impulse; equal to the change of kinetic energy"),
    ),
    Equation(
        "laws: energy of a stopped slip",
        "energy change under Newton's law, per unit mass: slip-stick, slip reversal",
        r"(\Delta E_{stick}, \Delta E_{back})",
        derive=lambda: (energy_change("stick"), energy_change("back")),
        shown=(
            -(A * u_0**2 + 2 * B * u_0 * v_0 + (1 - epsilon**2) * C * v_0**2)
            / (2 * (A * C - B**2)),
            (1 + epsilon) * (_all_loss - 2 * _back) * v_0**2 / (2 * _back**2)
            - mu * _mixed * u_0 * v_0 / (_back**2 * _stop)
            - 2 * mu * A * B * (A - mu**2 * C) * u_0**2 / (_back**2 * _stop**2),
        ),
        check=_kinetic_energies,
    ),
    Equation(
        "laws: Poisson",
        "$v_f$ under Poisson's restitution: slip stops early, late",
        "(v_{f, early}, v_{f, late})",
        derive=lambda: tuple(final_velocity("poisson", o) for o in ("early", "late")),
        shown=(epsilon * (a_2 * P_1 - V_1), V_1 - a_2 / a_1 * (V_1 + epsilon * v_0)),
        check=_impulses_in_proportion,
    ),
    Equation(
        "laws: Stronge",
        "$v_f$ under Stronge's restitution: slip stops early, late",
        "(v_{f, early}, v_{f, late})",
        derive=lambda: tuple(final_velocity("stronge", o) for o in ("early", "late")),
        shown=(
            epsilon * sp.sqrt(V_1**2 - a_2 * P_1 * (v_0 + V_1)),
            sp.sqrt(V_1**2 + a_2 / a_1 * (epsilon**2 * v_0**2 - V_1**2)),
        ),
        check=_triangles,
    ),
    Equation(
        "laws: slide",
        "without a corner the three laws say the same",
        "v_f^2",
        derive=lambda: final_velocity("stronge", "late").subs(a_2, a_1) ** 2,
        where=lambda: {"v_f": RESTITUTION({})},
        shown=epsilon**2 * v_0**2,
        check=_one_line,
        note="so the condition of continuous slide (14) holds for all three",
    ),
    Equation(
        "laws: impact without collision",
        (r"$v_f$ as $v_0 \to 0-$ in the Painlevé region, $a = -a_1$: Newton, Poisson, Stronge"),
        "(v_{f, Newton}, v_{f, Poisson}, v_{f, Stronge})",
        derive=limits,
        check=_thrown_up,
        note=("the rod is thrown up by friction alone; the impulse stays finite under every law"),
    ),
    Equation(
        "laws: work of friction",
        ("work of friction if the slip stops at $P_1$, per unit mass: slip-stick, slip reversal"),
        "(W_{stick}, W_{back})",
        derive=lambda: (friction_work("stick"), friction_work("back")),
        shown=(
            -mu * (mu * C + B) * P_1**2 / 2,
            -mu * (mu * C + B) * P_1**2 / 2 - mu * (B - mu * C) * (P_z - P_1) ** 2 / 2,
        ),
        check=_all_but_normal_work,
        note=_work_told,
    ),
    Equation(
        "laws: energy, Poisson",
        (
            "energy change under Poisson's law, per unit mass: slip stops early "
            "(slip-stick, slip reversal), late (the same)"
        ),
        (
            r"(\Delta E_{stick, early}, \Delta E_{back, early}, \Delta E_{stick, late}, "
            r"\Delta E_{back, late})"
        ),
        derive=lambda: tuple(
            energy_by_poisson(regime, order)
            for order in ("early", "late")
            for regime in ("stick", "back")
        ),
        shown=(
            -_kept * (A - B**2 / C) / 2 - (mu * C + B) ** 2 * P_1**2 / (2 * C),
            -_kept * (A - mu * B) / 2
            - mu * (mu * C + 3 * B) * P_1**2 / 2
            - mu * (B - mu * C) * _more**2 / 2,
            -_kept * (A + mu * B) / 2
            - mu * (mu * C + B) * P_1**2 / 2
            - B * (mu * C + B) * _more**2 / (2 * C),
            -_kept * (A + mu * B) / 2
            - mu * (mu * C + B) * P_1**2 / 2
            - mu * (3 * B - mu * C) * _more**2 / 2,
        ),
        check=_poisson_from_impulses,
        note=_poisson_told,
    ),
    Equation(
        "laws: energy, slip-stick",
        lambda: _threshold_told("stick"),
        r"\kappa_c",
        derive=lambda: energy_threshold("stick"),
        shown=(sp.sqrt(A * C) - sp.sqrt(A * C - B**2)) ** 2 / B**2,
        check=lambda form: (
            _created("stick", form),
            _created("stick", (1 - sticking_threshold()) / (1 + sticking_threshold())),
        ),
    ),
    Equation(
        "laws: energy, slip reversal",
        lambda: _threshold_told("back"),
        r"\kappa_c",
        derive=lambda: energy_threshold("back"),
        shown=(sp.sqrt(A) - sp.sqrt(A - mu**2 * C)) ** 2 / (mu * B),
        check=lambda form: (_created("back", form),),
    ),
    Equation(
        "laws: energy, thin rod",
        lambda: (
            f"restitution {'above' if _lossless_gains('stick') else 'below'} which Newton's law "
            "can create energy in slip-stick, thin rod"
        ),
        r"\epsilon_c",
        derive=thin_threshold,
        shown=4 / sp.sqrt(16 + 9 * sp.sin(2 * phi) ** 2),
        check=lambda form: (_created("stick", (1 - form) / (1 + form)).subs(_THIN_LENGTHS),),
        note=_thin_told,
    ),
)
