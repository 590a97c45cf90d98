"""Beyond the paper: one impact under three laws of restitution, and its energy balance.

Newton (kinematic)  v_f = -epsilon v_0: the paper's law
Poisson (kinetic)   the impulse after the end of compression is epsilon times the one before
Stronge (energetic) the work given back by the normal impulse is epsilon^2 times the work taken

The normal contact velocity is piecewise linear in the normal impulse: slope a_1 while the contact
slips forward, up to the impulse P_1 where it stops, slope a_2 afterwards (sticking or slipping
back). "Early": the slip stops before compression ends (v_1 < 0); "late": after it. In a slide the
velocity is one straight line, and the three laws agree.
"""

from collections.abc import Callable

import sympy as sp

from . import second_routes
from .axioms import RESTITUTION
from .bodies import THIN
from .equality import Forms, NamedForms, Pair, Residuals
from .lecture import degrees, meaning, so
from .newton import contact_change
from .proof import Equation
from .slip_reversal import reversed_change
from .slip_stick import P_2, sticking_velocity
from .symbols import (
    P_1,
    P_x,
    P_z,
    X,
    Z,
    epsilon,
    k,
    length,
    m,
    mu,
    phi,
    u_0,
    u_f,
    v_0,
    v_f,
)
from .trace import derived, only_root, remembered, say, solve

LAWS = "newton", "poisson", "stronge"
ORDERS = "early", "late"
a_1, a_2 = sp.symbols("a_1 a_2", positive=True)
# Inverse inertia of the contact point: du = C P_x - B P_z, dv = A P_z - B P_x.
A, B, C = sp.symbols("A B C", positive=True)
W_c, W_r = sp.symbols("W_c W_r")  # work of the normal impulse in compression, in restitution
kappa = sp.Symbol("kappa", nonnegative=True)  # (1 - epsilon)/(1 + epsilon)

HELD = {"stick": B / C, "back": mu}  # tangential per normal impulse after the slip has stopped
_DOUBLE = (
    r"The energy change under Newton's law, quadratic in $u_0/v_0$, has a double root; "
    r"$\kappa = (1 - \epsilon)/(1 + \epsilon)$"
)
V_1 = v_0 + a_1 * P_1  # normal velocity when the slip stops


def read_off(du: sp.Expr, dv: sp.Expr) -> Forms:
    """Mobilities A, B, C of a contact, read off its velocity change (du, dv) under (P_x, P_z)."""
    return {A: dv.coeff(P_z), B: -dv.coeff(P_x), C: du.coeff(P_x)}


@derived()
def mobility() -> Forms:
    """Mobilities by the lengths, read off the contact velocity's response, (5) and (6)."""
    return read_off(*map(sp.expand, contact_change(P_x, P_z)))


@derived("a_{%s}")
def slopes() -> NamedForms:
    """Slope $dv/dP_z$ while slipping forward, sticking and slipping back."""
    p = sp.Symbol("p", positive=True)
    rates = {
        "slip": contact_change(-mu * p, p)[1],
        "stick": sticking_velocity(p),
        "back": reversed_change(p)[1],
    }
    return {name: sp.factor(rate / p) for name, rate in rates.items()}


@remembered
def _restitution() -> sp.Expr:
    """Restitution epsilon as a form in kappa."""
    (restitution,) = sp.solve(meaning(kappa) - kappa, epsilon)
    return restitution


def _velocity(p: sp.Expr) -> sp.Expr:
    """Normal velocity at a normal impulse, after the slip has stopped."""
    return V_1 + a_2 * (p - P_1)


@derived("P_c")
def compression(order: str) -> sp.Expr:
    """Normal impulse at the end of compression."""
    line = _velocity(P_z) if order == "early" else v_0 + a_1 * P_z
    return only_root(line, P_z)


@derived()
def work(order: str, p_f: sp.Expr) -> Forms:
    """Work of the normal impulse during compression and restitution, ended after $P_1$."""
    p, p_c = sp.Symbol("p"), compression(order)
    slip, after = v_0 + a_1 * p, _velocity(p)
    if order == "early":
        taken = sp.integrate(slip, (p, 0, P_1)) + sp.integrate(after, (p, P_1, p_c))
        given = sp.integrate(after, (p, p_c, p_f))
    else:
        taken = sp.integrate(slip, (p, 0, p_c))
        given = sp.integrate(slip, (p, p_c, P_1)) + sp.integrate(after, (p, P_1, p_f))
    return {W_c: sp.expand(taken), W_r: sp.expand(given)}


@derived("v_{f, %(order)s}")
def final_velocity(law: str, order: str) -> sp.Expr:
    """At the end of an impact in which the slip stops, by $v_0$, $a_1$, $a_2$ and $P_1$."""
    if law == "newton":
        return RESTITUTION({})
    if law == "poisson":
        return sp.factor(_velocity((1 + epsilon) * compression(order)))
    square = sp.Symbol("v_f^2", positive=True)
    p_f = P_1 + (sp.sqrt(square) - V_1) / a_2
    done = work(order, p_f)
    return sp.sqrt(only_root(sp.expand(done[W_r] + epsilon**2 * done[W_c]), square))


@derived("P_x", "P_z")
def impulse_at(regime: str, v_f: sp.Expr, p_1: sp.Expr) -> Pair:
    """Impulse, by $A$, $B$, $C$, of an impact whose slip stops."""
    extra = (v_f - (v_0 + (A + mu * B) * p_1)) / (A - B * HELD[regime])
    return -mu * p_1 + HELD[regime] * extra, p_1 + extra


@derived(r"\Delta E")
def energy_of_impulse() -> sp.Expr:
    """Energy change of any impact: the impulse times the mean contact velocity."""
    return P_x * (u_0 + u_f) / 2 + P_z * (v_0 + v_f) / 2


def _energy(p_x: sp.Expr, p_z: sp.Expr) -> sp.Expr:
    """Energy change under an impulse, by the mobilities A, B, C."""
    ends = u_0 + C * p_x - B * p_z, v_0 + A * p_z - B * p_x
    say("The contact velocity after it", "u_0 + C P_x - B P_z", "v_0 + A P_z - B P_x", ends)
    put = dict(zip((P_x, P_z, u_f, v_f), (p_x, p_z, *ends), strict=True))
    return energy_of_impulse().subs(put, simultaneous=True)


@remembered
def energy_change(regime: str) -> sp.Expr:
    """Kinetic energy after minus before an impact of a regime, under Newton's law, in A, B, C."""
    return sp.factor(_energy(*impulse_at(regime, RESTITUTION({}), u_0 / (mu * C + B))))


@derived(r"\kappa_c")
def energy_threshold(regime: str) -> sp.Expr:
    """Where Newton's law begins to create energy.

    The energy change is a quadratic form in (u_0, v_0) that is negative at both ends of the
    regime; it reaches positive values where its discriminant is positive.
    """
    a, b, c = sp.Poly(sp.numer(energy_change(regime)).subs(v_0, -1), u_0).all_coeffs()
    gain = (b**2 - 4 * a * c).subs(epsilon, _restitution())
    roots = solve(sp.numer(sp.factor(gain)), kappa, _DOUBLE)
    point = {A: 3, B: sp.Rational(3, 2), C: 2, mu: sp.Rational(1, 5)}
    (inside,) = (root for root in roots if 0 < root.subs(point).evalf() < 1)
    return inside


@derived(r"\epsilon_c")
def sticking_threshold() -> sp.Expr:
    r"""That of slip-stick, solved for $\epsilon$."""
    ratio = energy_threshold("stick")
    return sp.factor(sp.radsimp((1 - ratio) / (1 + ratio)))


@derived(r"\epsilon_c")
def thin_threshold() -> sp.Expr:
    """That of a sticking thin rod."""
    return sticking_threshold().subs(mobility()).subs(THIN)


@derived(r"\Delta E_{%(order)s, %(regime)s}")
def energy_by_poisson(regime: str, order: str) -> sp.Expr:
    """Energy change under Poisson's law by the impulses, with $P_2 = P_z - P_1$."""
    held, whole = HELD[regime], P_1 + P_2
    known = {a_1: A + mu * B, a_2: A - B * held}
    compressed = sp.factor(whole / (1 + _restitution()))
    v_start = only_root(compression(order) - compressed, v_0)
    change = _energy(-mu * P_1 + held * P_2, whole)
    change = change.subs({u_0: (mu * C + B) * P_1, v_0: v_start}).subs(known)
    lost = change.diff(kappa) * kappa  # it is linear in kappa
    return sp.factor(lost) + sp.factor(change - lost)


# ---- second routes ----------------------------------------------------------------------------


def _triangles(form: sp.Matrix) -> Residuals:
    """Residuals of Stronge's law, with works as areas under the broken line of v over P_z.

    The area given back is epsilon^2 times the area taken. If the slip stops early, a trapezium up
    to the corner and a triangle after it are taken.
    """
    early, late = form
    corner = v_0 + a_1 * P_1
    taken_early = -(v_0 + corner) / 2 * P_1 + corner**2 / (2 * a_2)
    left_late = epsilon**2 * v_0**2 / (2 * a_1) - corner**2 / (2 * a_1)  # to be given after P_1
    return [
        early - epsilon * sp.sqrt(2 * a_2 * taken_early),
        late - sp.sqrt(corner**2 + 2 * a_2 * left_late),
    ]


def _impulses_in_proportion(form: sp.Matrix) -> Residuals:
    """Residuals of Poisson's law: the whole impulse is 1 + epsilon times the one up to v = 0."""
    corner = v_0 + a_1 * P_1
    compressed = P_1 - corner / a_2, -v_0 / a_1
    whole = [P_1 + (v - corner) / a_2 for v in form]
    return [p - (1 + epsilon) * p_c for p, p_c in zip(whole, compressed, strict=True)]


def _areas(form: sp.Matrix) -> Residuals:
    """Residuals of the energy changes under Poisson's law: work of both forces, as areas.

    The areas are those under the broken lines of v, and of u times -+mu, over P_z.
    """
    for change, (regime, order) in zip(form, _ENDS, strict=True):
        compressed = (P_1 + P_2) * (1 + kappa) / 2
        rise, rise_later = A + mu * B, A - (mu * B if regime == "back" else B**2 / C)
        start = -rise * compressed
        if order == "early":
            start = -rise * P_1 - rise_later * (compressed - P_1)
        corner = start + rise * P_1
        normal = (start + corner) / 2 * P_1 + corner * P_2 + rise_later * P_2**2 / 2
        friction = -mu * (mu * C + B) * P_1**2 / 2
        if regime == "back":
            friction -= mu * (B - mu * C) * P_2**2 / 2
        yield normal + friction - change


def _created(regime: str, ratio: sp.Expr) -> sp.Expr:
    """Discriminant of the energy change, from whole impacts: zero at the threshold."""
    restitution = ((1 - ratio) / (1 + ratio)).subs(mobility())
    return second_routes.energy_created(regime).subs(epsilon, restitution)


_LEAST = sp.pi / 4  # tilt of the least threshold of a thin rod
_ENDS = [(regime, order) for order in ORDERS for regime in HELD]


def _threshold_told(regime: str) -> str:
    at = {X: 1, Z: 1, k: 1, m: 1, mu: sp.Rational(1, 5)}
    return so(
        r"Newton's law can create energy where $(1 - \epsilon)/(1 + \epsilon)$ is below this",
        _created(regime, kappa).subs(at),
        kappa,
        energy_threshold(regime).subs(mobility()).subs(at),
    )


def _poisson_told() -> str:
    """Note that under Poisson's law no term of the energy change is positive, for either sign of B.

    At kappa = 0 nothing is lost in restitution. Not negative are C, mu C + B where the slip stops,
    what holds or turns the contact, P_2, and P_1 - P_2 where the slip stops late.
    """
    b, s, rest = sp.symbols("b s r", nonnegative=True)
    after = sp.Symbol("P_2", nonnegative=True)
    holds = [{B: b, mu: (b + s) / C}, {B: -b, mu: (b + s) / C}]
    terms = []
    for regime, order in _ENDS:
        change = energy_by_poisson(regime, order).subs({kappa: 0, P_2: after})
        change = change.subs(P_1, after + rest) if order == "late" else change
        for case in holds if regime == "stick" else [{B: mu * C + s}]:
            whole = sp.expand(change.subs(case, simultaneous=True))
            terms += sp.Add.make_args(whole)
    return so("never positive", terms)


def _under(name: str, shown: Pair, check: Callable[[sp.Matrix], Residuals]) -> Equation:
    """Entry of the final velocity under a named law, for an early and a late stop."""
    return Equation(
        f"laws: {name}",
        f"$v_f$ under {name}'s restitution: slip stops before the end of compression (early), late",
        "(v_{f, early}, v_{f, late})",
        derive=lambda: tuple(final_velocity(name.lower(), order) for order in ORDERS),
        shown=shown,
        check=check,
    )


def _creates(name: str, regime: str, shown: sp.Expr) -> Equation:
    """Entry of the threshold at which Newton's law begins to create energy in a regime."""
    return Equation(
        f"laws: energy, {name}",
        lambda: _threshold_told(regime),
        r"\kappa_c",
        derive=lambda: energy_threshold(regime),
        shown=shown,
        check=lambda form: (_created(regime, form),),
    )


EQUATIONS = (
    _under(
        "Poisson",
        (epsilon * (a_2 * P_1 - V_1), V_1 - a_2 / a_1 * (V_1 + epsilon * v_0)),
        _impulses_in_proportion,
    ),
    _under(
        "Stronge",
        (
            epsilon * sp.sqrt(V_1**2 - a_2 * P_1 * (v_0 + V_1)),
            sp.sqrt(V_1**2 + a_2 / a_1 * (epsilon**2 * v_0**2 - V_1**2)),
        ),
        _triangles,
    ),
    Equation(
        "laws: slide",
        "where the slip does not stop the three laws say the same",
        "v_f^2",
        derive=lambda: tuple(
            final_velocity(law, order).subs(a_2, a_1) ** 2 for law in LAWS for order in ORDERS
        ),
        where=lambda: {"v_f": RESTITUTION({})},
        # the same share of the work on one line of v over P_z
        check=lambda form: [square / 2 - epsilon**2 * v_0**2 / 2 for square in form],
    ),
    Equation(
        "laws: energy, Poisson",
        "energy change under Poisson's law: slip stops early (slip-stick, slip "
        "reversal), late (the same)",
        r"(\Delta E_{early, stick}, \Delta E_{early, back}, \Delta E_{late, stick}, "
        r"\Delta E_{late, back})",
        derive=lambda: tuple(energy_by_poisson(*end) for end in _ENDS),
        check=_areas,
        note=_poisson_told,
    ),
    _creates("slip-stick", "stick", (sp.sqrt(A * C) - sp.sqrt(A * C - B**2)) ** 2 / B**2),
    _creates("slip reversal", "back", (sp.sqrt(A) - sp.sqrt(A - mu**2 * C)) ** 2 / (mu * B)),
    Equation(
        "laws: energy, thin rod",
        lambda: so(
            "restitution above which Newton's law can create energy in slip-stick, thin rod",
            second_routes.energy_created("stick").subs(THIN).subs({length: 1, phi: _LEAST}),
            epsilon,
            thin_threshold().subs(phi, _LEAST),
        ),
        r"\epsilon_c",
        derive=thin_threshold,
        shown=4 / sp.sqrt(16 + 9 * sp.sin(2 * phi) ** 2),
        check=lambda form: (second_routes.energy_created("stick").subs(epsilon, form).subs(THIN),),
        note=lambda: so(
            f"least at {degrees(_LEAST)}, {thin_threshold().subs(phi, _LEAST)}",
            thin_threshold(),
            phi,
            _LEAST,
        ),
    ),
)
