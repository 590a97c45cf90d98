"""Sentences of the text that state a number, a sign or an order, computed."""

import mpmath
import sympy as sp

from . import paper, second_routes
from .bodies import THIN
from .drift import relaxation, stationary
from .proof import DIGITS, Equation
from .symbols import X, Z, c_x, h_0, k, mu, omega, phi
from .trace import derived, solve
from .words import degrees, formula, number

stiffness, damping, speed, mass = sp.symbols("k_n gamma_n v m_r", positive=True)

_30_DEGREES = {phi: sp.pi / 6}
_FIG_10C = sp.Integer(10)  # -c_z/c_x there


def _sign(value: sp.Expr) -> sp.Expr:
    if value.free_symbols:
        raise ValueError(f"{value} is no number")
    return sp.sign(sp.nsimplify(sp.N(value, DIGITS)))


def _stationary_thin() -> list[sp.Expr]:
    """c_x and -c_z before the stationary landing of a thin rod in slip-stick."""
    return [part.subs(THIN) for part in stationary("stick")]


def stationary_ratio() -> sp.Expr:
    """-c_z/c_x before the stationary landing of a thin rod in slip-stick."""
    along, up = _stationary_thin()
    return sp.simplify(up / along)


def _ratio_told() -> str:
    """The ratio, and the tilts below and above which it is larger than one."""
    ratio = stationary_ratio()
    low = sp.asin(sp.sin(2 * phi) * ratio) / 2  # ratio sin(2 phi) is a number
    ends = low, sp.pi / 2 - low
    if any(sp.simplify(ratio.subs(phi, end)) != 1 for end in ends):
        raise ValueError("the ratio is not one there")
    low, high = map(degrees, ends)
    at_30 = number(ratio.subs(_30_DEGREES))
    return f"it is {formula(ratio)} of a thin rod: {at_30} at 30 degrees, one at {low} and {high}"


@derived(r"\mu n")
def landings_to_relax() -> sp.Expr:
    """mu times the number of landings that leave 1/e of a deviation, as mu goes to 0."""
    rate = -sp.log(relaxation("back")).diff(mu).subs(mu, 0)
    return sp.factor(1 / rate)


@derived("1 - e")
def restitution_lost() -> sp.Expr:
    """1 - e of Appendix A's normal force at small damping, with the reduced mass as M_e.

    The damping force's work along the undamped path, over twice the energy.
    """
    power = sp.Symbol("y", positive=True)  # overlap to the power 5/2
    energy = sp.Rational(2, 5) * stiffness * power
    (deepest,) = (
        y ** sp.Rational(2, 5)
        for y in solve(energy - mass * speed**2 / 2, power, r"$y = \delta^{5/2}$")
    )
    # x sqrt(1 - x^(5/2)) from 0 to 1, x the overlap over the deepest, is a beta function
    shape = sp.Rational(2, 5) * sp.beta(sp.Rational(4, 5), sp.Rational(3, 2))
    work = 2 * damping * mass * speed * deepest**2 * shape
    return sp.powsimp(sp.simplify(work / (mass * speed**2)))


def _relaxed(form: sp.Expr) -> list[sp.Expr]:
    """Two landings whose c_x differ by one: how fast friction brings them together."""
    after = second_routes.impact("back")[0].subs(omega, 0)
    left = sp.cancel(after.subs(c_x, 1) - after.subs(c_x, 0))
    return [form * left.diff(mu).subs(mu, 0) + 1]


def _lost_by_quadrature(form: sp.Expr) -> list[sp.Expr]:
    """The work integral by numbers where the deepest overlap is 1, and its powers by dimensions."""
    with mpmath.workdps(DIGITS + 30):
        integral = mpmath.quad(lambda x: x * mpmath.sqrt(1 - x ** mpmath.mpf("2.5")), [0, 1])
        number = sp.Float(str(2 * integral), DIGITS + 25)
    unit = {stiffness: sp.Rational(5, 4), mass: 1, speed: 1, damping: 1}
    powers = [sp.simplify(letter * form.diff(letter) / form) for letter in unit]
    wanted = [-sp.Rational(4, 5), sp.Rational(4, 5), sp.Rational(3, 5), sp.S.One]
    return [form.subs(unit) - number, *(a - b for a, b in zip(powers, wanted, strict=True))]


_APPENDIX_A = {  # in d, g and virtual spheres
    stiffness: paper.printed("A: unit of k_n").as_coeff_Mul()[0],
    damping: paper.printed("A: unit of gamma").as_coeff_Mul()[0],
    speed: 1,
}
_MASSES = {"two virtual spheres": sp.Rational(1, 2), "one": sp.S.One}
_MASSES["a rod of note [12] with $l = 9.5 d$"] = paper.printed("[12]: mass").subs(
    h_0, 17 / sp.Integer(2)
)


def _restitution(drag: float) -> float:
    """e of y'' = -y^(3/2) - drag y y' from y = 0, y' = 1, in 800 steps of Runge and Kutta."""
    step, y, v = 0.004, 0.0, 1.0

    def rate(y: float, v: float) -> tuple[float, float]:
        deep = max(y, 0.0)
        return v, -(deep**1.5) - drag * deep * v

    while y >= 0:
        one = rate(y, v)
        two = rate(y + step / 2 * one[0], v + step / 2 * one[1])
        three = rate(y + step / 2 * two[0], v + step / 2 * two[1])
        four = rate(y + step * three[0], v + step * three[1])
        y += step / 6 * (one[0] + 2 * two[0] + 2 * three[0] + four[0])
        v += step / 6 * (one[1] + 2 * two[1] + 2 * three[1] + four[1])
    return -v


def damping_needed(restitution: float, reduced_mass: sp.Expr) -> float:
    """Times Appendix A's damping constant that gives a restitution to rods that meet head on."""
    low, high = 0.0, 5.0
    while high - low > 1e-6:
        middle = (low + high) / 2
        low, high = (middle, high) if _restitution(middle) > restitution else (low, middle)
    constants = _APPENDIX_A
    overlap = (float(reduced_mass) * constants[speed] ** 2 / constants[stiffness]) ** 0.4
    return low / (constants[damping] * overlap**2 / constants[speed])


def _damping_told() -> str:
    lightest = _MASSES["two virtual spheres"]
    small = (1 - 0.999) / float(restitution_lost().subs(_APPENDIX_A).subs(mass, lightest))
    if abs(damping_needed(0.999, lightest) / small - 1) > 2e-3:
        raise ValueError("the motion loses something else at small damping")
    loss = restitution_lost().subs(_APPENDIX_A).subs(mass, _MASSES["two virtual spheres"])
    times = [damping_needed(0.65, of) for of in _MASSES.values()]
    needed = ", ".join(
        f"{number(x, 3)} times for {of}" for x, of in zip(times, _MASSES, strict=True)
    )
    return (
        rf"it grows as $v^{{3/5}}$ and in proportion to $\gamma_n$. Appendix A's constants give "
        rf"{number(loss)} at $(d g)^{{1/2}}$ for two virtual spheres; a restitution of 0.65 needs "
        rf"more $\gamma_n$, by what $m_r$ is that of: {needed} (the equation of motion solved, as "
        "the damping is not small then)"
    )


EQUATIONS = (
    Equation(
        "IV: large ratio",
        "sign of $-c_z/c_x - 1$ at 30 degrees, in stationary translation",
        r"[\mathrm{sgn}(-c_z/c_x - 1)]_{\phi = \pi/6}",
        where=lambda: dict(zip(("c_x", "-c_z"), _stationary_thin(), strict=True)),
        verdict="erratum",
        said=sp.S.One,
        derive=lambda: _sign(stationary_ratio().subs(_30_DEGREES) - 1),
        contradicted_by=("24", "25"),
        contradiction=lambda drift, up: _sign((up / drift).subs(THIN).subs(_30_DEGREES) - 1),
        mistaken=lambda: _sign(_FIG_10C - 1),
        mistake=f"the {_FIG_10C} of Fig. 10(c) is taken for typical",
        note=_ratio_told,
    ),
    Equation(
        "V: landings to relax",
        r"$\mu$ times the number of landings after which 1/e of a deviation is left, as "
        r"$\mu \to 0$",
        r"\mu n",
        verdict="new",
        derive=landings_to_relax,
        shown=X * Z / (2 * k**2),
        check=_relaxed,
        note="the abstract calls friction crucial: with less of it the drift does not go to "
        "zero, but takes ever longer to come; without any, $c_x$ stays what it was",
    ),
    Equation(
        "A: restitution",
        "$1 - e$ of Appendix A's normal force at small damping, $M_e$ the reduced mass $m_r$",
        "1 - e",
        verdict="new",
        derive=restitution_lost,
        shown=sp.Mul(
            damping,
            sp.beta(sp.Rational(4, 5), sp.Rational(3, 2)),
            sp.Pow(4 * mass**4 * speed**3 / (5 * stiffness**4), sp.Rational(1, 5), evaluate=False),
            evaluate=False,
        ),
        check=_lost_by_quadrature,
        note=_damping_told,
    ),
)
