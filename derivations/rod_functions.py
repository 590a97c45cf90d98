"""Generated functions of rods, regime boundaries and drift: outputs and rewriting rules."""

import sympy as sp

from . import bodies, drift, laws, optimum, thin_rod
from .rewrites import Body, Function, recast, single_fraction
from .symbols import V_z, X, Z, diameter, epsilon, k, length, mu, phi

_x, _z, _s, _g = sp.symbols("x z s g", positive=True)  # |X|/k, |Z|/k, d/l, (1 + epsilon) r
_grip, _sin, _cos, _root = sp.symbols("grip sin cos root", positive=True)
_tangent, _held = sp.symbols("tangent held", positive=True)
_root_a, _root_b, _root_c, _root_d = sp.symbols("root_a root_b root_c root_d", positive=True)


def _name(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


_h = _name("h")


def _thin(expr: sp.Expr) -> sp.Expr:
    """Per length k, for positive X and Z."""
    return sp.simplify(expr.subs({X: _x * k, Z: _z * k}))


def _of_tilt(expr: sp.Expr) -> sp.Expr:
    return expr.subs({sp.sin(phi): _sin, sp.cos(phi): _cos})


def _grip_of(case: str) -> sp.Expr:
    """c_x/(x c_z') - z."""
    along, up = drift.stationary(case)
    return sp.simplify(_thin(along / up) / _x - _z)


def _response() -> Body:
    """What a response's eigenvalues are made of; at the critical friction that of slip-stick."""
    a, b, c, d = optimum.jacobian("back")
    forms = (*optimum.stability_margins("back"), a - d, -4 * b * c)
    names = ("steady", "alternating", "shrinking", "apart", "coupling")
    friction = _held * thin_rod.critical_friction()
    return {_name(n): form.subs(mu, friction) for n, form in zip(names, forms, strict=True)}


FUNCTIONS: tuple[Function, ...] = (
    Function(
        name="critical_friction",
        summary="Friction below which a stopped contact slips back, Eqs. (16), (20).",
        detail=r"For $XZ \ge 0$; the sign of $XZ$ is the side to which it slips.",
        arguments=(X, Z, k),
        derived=lambda: {mu: thin_rod.critical_friction()},
        rules=(recast("positive denominator", "no sign to lose", mu=X * Z / (k**2 + Z**2)),),
    ),
    Function(
        name="painleve_friction",
        summary="Friction from which a slipping contact is pressed into the plate.",
        detail=r"For $XZ \ge 0$ and slip towards $-x$.",
        arguments=(X, Z, k),
        derived=lambda: {mu: optimum.painleve_friction()},
        rules=(),
    ),
    Function(
        name="critical_tangents",
        summary=r"Critical tilts of a thin rod: $\tan(lower) = a/b$ and $\tan(upper) = b/c$; Eq. "
        "(23).",
        detail=r"$root = \sqrt{(3 - 4 \mu)(3 + 4 \mu)}$, $\mu \le 3/4$.",
        arguments=(mu, _root),
        derived=lambda: {
            _name("lower"): thin_rod.critical_tangents()[0].subs(sp.sqrt(9 - 16 * mu**2), _root),
            _name("upper"): thin_rod.critical_tangents()[1].subs(sp.sqrt(9 - 16 * mu**2), _root),
        },
        rules=(
            recast(
                "conjugate root",
                r"$3 - root$ cancels for small $\mu$; the product of both roots is 4",
                a=8 * mu,
                b=3 + _root,
                c=2 * mu,
                lower=_name("a") / _name("b"),
                upper=_name("b") / _name("c"),
            ),
        ),
        returned=("a", "b", "c"),
        unused=("lower", "upper"),
        meaning={mu: sp.sqrt(9 - _root**2) / 4},
    ),
    Function(
        name="slide_friction",
        summary="Numerator and denominator of the friction at which $u_* = 0$, Eq. (14).",
        detail=r"$g = (1 + \epsilon)(-c_z/c_x)$, $\omega = 0$, $c_x > 0$.",
        arguments=(X, Z, k, _g),
        derived=lambda: {
            _name("quotient"): thin_rod.slide_friction().subs(thin_rod.ratio, _g / (1 + epsilon))
        },
        rules=(
            single_fraction(),
            recast(
                "two signs",
                "numerator and denominator decide between 0, a number and infinity",
                above=k**2 + X**2 - _g * X * Z,
                below=_g * (k**2 + Z**2) - X * Z,
                quotient=_name("above") / _name("below"),
            ),
        ),
        returned=("above", "below"),
        unused=("quotient",),
    ),
    Function(
        name="drift_grips",
        summary="What friction adds to $z$ in the drift: while sticking, and in slip reversal.",
        detail="Lengths in units of $k$: $x = |X|/k$, $z = |Z|/k$. The smaller one is the right "
        "one.",
        arguments=(_x, _z, mu),
        derived=lambda: {
            _name("stick"): _grip_of("stick"),
            _name("back"): _grip_of("back"),
        },
        rules=(
            recast(
                "no square",
                "$z^2$ cannot overflow",
                stick=_z,
                slant=_z / _x,
                back=mu / _x + mu * _name("slant") * _z,
            ),
        ),
    ),
    Function(
        name="drift",
        summary="Stationary $(c_x, c_z')/V_z$, Eqs. (24)-(30), with the grip of `drift_grips`.",
        detail="Lengths in units of $k$; signs of $XZ$ and $V_z$ are put on afterwards.",
        arguments=(_x, _z, epsilon, _grip),
        derived=lambda: {
            _name("along"): _thin(drift.stationary("back")[0] / V_z).subs(
                mu, _grip * _x / (1 + _z**2)
            ),
            _name("up"): _thin(drift.stationary("back")[1] / V_z),
        },
        rules=(
            recast(
                "divide by $x$",
                "$x^2$ cannot underflow; tilt 0 and full restitution give a signed infinity",
                lost=1 - epsilon,
                along=(1 + epsilon) * (_z + _grip) / (_name("lost") / _x + 2 * _x),
                up=(1 + epsilon) / (_name("lost") + 2 * _x**2),
            ),
        ),
    ),
    Function(
        name="optimum_stick",
        summary=r"Largest drift of a thin rod in slip-stick: $\tan\phi = a/b$ and $c_x/V_z$.",
        detail=r"$a = \sqrt{1 - \epsilon}$, $b = \sqrt{7 - \epsilon}$.",
        arguments=(epsilon, _root_a, _root_b),
        derived=lambda: {_name("along"): optimum.optimum("stick")[1]},
        rules=(
            recast(
                "name the roots",
                "infinite where nothing is lost",
                gained=1 + epsilon,
                along=3 * _name("gained") / (_root_a * _root_b),
            ),
        ),
        meaning={_root_a: sp.sqrt(1 - epsilon), _root_b: sp.sqrt(7 - epsilon)},
    ),
    Function(
        name="optimum_back",
        summary=r"Largest drift of a thin rod in slip reversal: $\tan\phi$ and $c_x/V_z$.",
        detail=r"$root = \sqrt{\mu^2 (9 - \epsilon)^2 + (1 - \epsilon)(7 - \epsilon)}$; $\mu > 0$.",
        arguments=(mu, epsilon, _root),
        derived=lambda: {
            _name("tangent"): optimum.optimum("back")[0],
            _name("along"): optimum.optimum("back")[1],
        },
        rules=(
            recast(
                "conjugate root",
                "a sum of positive terms in the denominator",
                sum=mu * (9 - epsilon) + _root,
                lost=1 - epsilon,
                tangent=_name("lost") / _name("sum"),
                least=7 - epsilon,
                along=(1 + epsilon)
                * (mu + 3 * _name("sum") / (2 * _name("lost")))
                / _name("least"),
            ),
        ),
        meaning={_root: sp.sqrt(mu**2 * (9 - epsilon) ** 2 + (1 - epsilon) * (7 - epsilon))},
    ),
    Function(
        name="thin_drift_stick",
        summary=r"Drift (26) of a thin rod over $V_z$, of $\tan\phi$.",
        detail="Infinite at tilt 0 where nothing is lost.",
        arguments=(epsilon, _tangent),
        derived=lambda: {
            _name("along"): optimum.drift_over_tangent("stick").subs(bodies.T, _tangent)
        },
        rules=(
            recast(
                "sum of positive terms",
                "one quotient",
                gained=1 + epsilon,
                lost=1 - epsilon,
                along=6
                * _name("gained")
                * _tangent
                / (_name("lost") + (7 - epsilon) * _tangent**2),
            ),
        ),
    ),
    Function(
        name="landing_response",
        summary="Response of a stationary landing to a deviation.",
        detail="$1 - tr + det$, $1 + tr + det$, $1 - det$; the difference of the diagonal entries; "
        "$-4$ times that of the others. $held$: friction over the critical one, at most 1.",
        arguments=(X, Z, k, epsilon, _held),
        derived=_response,
        rules=(
            recast(
                "sums of positive terms",
                "a slow return keeps its digits; $XZ$ drops out of all denominators",
                lost=1 - epsilon,
                less=k**2 + (1 - _held) * Z**2,
                more=k**2 + (1 + _held) * Z**2,
                D=(1 + _held) * ((k**2 + Z**2) * k**2 + X**2 * _name("less")),
                steady=2 * _held * k**2 * (_name("lost") * k**2 + 2 * X**2) / _name("D"),
                alternating=2 * (1 + epsilon) * k**2 * _name("more") / _name("D"),
                push=(1 + epsilon) * _held * k**4,
                rest=2 * X**2 * (k**2 + (1 - _held) * (1 + _held) * Z**2)
                + _name("lost") * k**2 * _name("more"),
                shrinking=(_name("rest") + _name("push")) / _name("D"),
                apart=(_name("rest") - _name("push")) / _name("D"),
                slant=_held * k**2 * X * Z / _name("D"),
                coupling=8 * (1 + epsilon) * (1 + _held) * _name("slant") ** 2,
            ),
        ),
    ),
    Function(
        name="energy_restitution_stick",
        summary="Restitution above which Newton's law can create energy, slip-stick.",
        detail=r"Mobilities $A$, $B$, $C$; $root_a = \sqrt{A}$, $root_c = \sqrt{C}$, "
        r"$root_d = \sqrt{A C - B^2}$.",
        arguments=(_root_a, _root_c, _root_d),
        derived=lambda: {_name("restitution"): laws.sticking_threshold()},
        rules=(
            recast(
                "name the roots",
                "one quotient; $A C$ cannot overflow",
                restitution=_root_d / (_root_a * _root_c),
            ),
        ),
        meaning={
            laws.A: _root_a**2,
            laws.C: _root_c**2,
            laws.B: sp.sqrt(_root_a**2 * _root_c**2 - _root_d**2),
        },
    ),
    Function(
        name="energy_threshold_back",
        summary=r"$(1-\epsilon)/(1+\epsilon)$ below which Newton's law can create energy, "
        "reversal.",
        detail=r"Mobilities $A$, $B$, $C$; $root_a = \sqrt{A}$, $root_b = \sqrt{A - \mu^2 C}$.",
        arguments=(laws.B, laws.C, mu, _root_a, _root_b),
        derived=lambda: {_name("kappa"): laws.energy_threshold("back")},
        rules=(
            recast(
                "difference of roots",
                r"$(a - b)^2 = (\mu^2 C/(a + b))^2$; no power that overflows",
                q=mu * laws.C / (_root_a + _root_b),
                kappa=mu * _name("q") ** 2 / laws.B,
            ),
        ),
        meaning={laws.A: _root_a**2, laws.C: (_root_a**2 - _root_b**2) / mu**2},
    ),
    Function(
        name="round_rod",
        summary="$(X, Z)$ and $k^2/l^2$ of a solid spherocylinder.",
        detail=r"$l$ overall length, $d$ diameter, $s = d/l \le 1$, of a tilt given by sin and "
        "cos.",
        arguments=(length, diameter, _s, _sin, _cos),
        derived=lambda: {
            X: _of_tilt(bodies.round_contact()[0]),
            Z: _of_tilt(bodies.round_contact()[1]),
            _name("gyration"): sp.factor(
                bodies.spherocylinder_gyration().subs(diameter, _s * length) / length**2
            ),
        },
        rules=(
            recast(
                "sums of positive terms",
                "$h = (l - d)/l$ instead of powers of $d$ with both signs",
                axis=length - diameter,
                X=_name("axis") / 2 * _sin,
                Z=_name("axis") / 2 * _cos + diameter / 2,
                h=1 - _s,
                gyration=(_s**3 / 10 + _h * (sp.Rational(9, 32) * _s**2 + _h * (_s / 4 + _h / 8)))
                / (_s + 3 * _h / 2),
            ),
        ),
    ),
    Function(
        name="flat_rod",
        summary="$(X, Z)$ and $k^2/l^2$ of a solid flat-ended cylinder on its lower edge.",
        detail=r"$l$ length, $d$ diameter, $s = d/l$, of a tilt $\ge 0$ given by sin and cos.",
        arguments=(length, diameter, _s, _sin, _cos),
        derived=lambda: {
            X: _of_tilt(bodies.flat_contact()[0]),
            Z: _of_tilt(bodies.flat_contact()[1]),
            _name("gyration"): sp.expand(
                bodies.cylinder_gyration().subs(diameter, _s * length) / length**2
            ),
        },
        rules=(
            recast(
                "half last",
                "halving is exact",
                X=(length * _sin - diameter * _cos) / 2,
                Z=(length * _cos + diameter * _sin) / 2,
                weight=4 + 3 * _s**2,
                gyration=_name("weight") / 48,
            ),
        ),
    ),
)
