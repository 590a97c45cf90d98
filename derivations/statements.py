"""Sentences of the text that state a number, a sign or an order; dimensions of Appendix A.

Dimensions are monomials in mass, length and time; a constant's dimension is solved from the term
of the printed force law in which it stands.
"""

from collections.abc import Callable, Mapping

import mpmath
import sympy as sp

from . import paper, second_routes
from .bodies import THIN
from .drift import landing, thin_stationary
from .equality import DIGITS, Residuals
from .lecture import PAPER, degrees, formula, number
from .proof import Equation
from .symbols import c_x, c_z, epsilon, h_0, length, mu, phi
from .trace import derived, only_root
from .typeset import latex

stiffness, damping, speed, mass = sp.symbols("k_n gamma_n v_n m_r", positive=True)

_TILT = {phi: sp.pi / 6}
_FIG_10C = paper.setting("Fig. 10(c)")[-c_z / c_x]


def _sign(value: sp.Expr) -> sp.Expr:
    if value.free_symbols:
        raise ValueError(f"{value} is no number")
    return sp.sign(sp.nsimplify(sp.N(value, DIGITS)))


def stationary_ratio() -> sp.Expr:
    """-c_z/c_x before the stationary landing of a thin rod in slip-stick."""
    along, up = thin_stationary("stick")
    return sp.simplify(up / along)


@derived(r"\mu n")
def landings_to_relax() -> sp.Expr:
    r"""$\mu$ times the number of landings that leave exp(-1) of a deviation, as $\mu \to 0$."""
    rate = -sp.log(landing("back")[0].diff(c_x)).diff(mu).subs(mu, 0)
    return 1 / rate


@derived("1 - e")
def restitution_lost() -> sp.Expr:
    """Appendix A's normal force at small damping, with the reduced mass as $M_e$.

    The damping force's work along the undamped path, over twice the energy.
    """
    power = sp.Symbol("y", positive=True)  # overlap to the power 5/2
    energy = sp.Rational(2, 5) * stiffness * power
    highest = only_root(energy - mass * speed**2 / 2, power, r"$y = \delta^{5/2}$")
    deepest = highest ** sp.Rational(2, 5)
    # x sqrt(1 - x^(5/2)) from 0 to 1, x the overlap over the deepest, is a beta function
    shape = sp.Rational(2, 5) * sp.beta(sp.Rational(4, 5), sp.Rational(3, 2))
    work = 2 * damping * mass * speed * deepest**2 * shape
    return sp.simplify(work / (mass * speed**2))


def _relaxed(form: sp.Expr) -> Residuals:
    """Residual of mu n: how fast friction brings together two landings whose c_x differ by one."""
    after = second_routes.landed("back")[0]
    left = after.subs(c_x, 1) - after.subs(c_x, 0)
    return [form * left.diff(mu).subs(mu, 0) + 1]


def _lost_by_quadrature(form: sp.Expr) -> Residuals:
    """Residual of 1 - e: work over the path in and out, by quadrature, over twice the energy."""
    at = {stiffness: 2, damping: 3, mass: 4, speed: 5}
    with mpmath.workdps(DIGITS + 30):
        k, gamma, m, v = map(mpmath.mpf, at.values())
        deepest = (5 * m * v**2 / (4 * k)) ** mpmath.mpf("0.4")

        def power(x: mpmath.mpf) -> mpmath.mpf:
            left = v**2 - 4 * k * x ** mpmath.mpf("2.5") / (5 * m)
            return gamma * m * x * mpmath.sqrt(max(left, 0))

        lost = 2 * mpmath.quad(power, [0, deepest]) / (m * v**2)
        return [form.subs(at) - lost]


_APPENDIX_A = {  # in d, g and virtual spheres
    stiffness: paper.printed("A: unit of k_n").as_coeff_Mul()[0],
    damping: paper.printed("A: unit of gamma").as_coeff_Mul()[0],
    speed: 1,
}
_MASSES = {  # reduced, by what touches; lengths in d, caps included
    "two virtual spheres": sp.S.Half,
    "one and the plate": sp.S.One,
    "a rod and the plate": paper.printed("[12]: mass").subs(
        h_0, paper.setting("Fig. 6")[length] - 1
    ),
}


def _damping_told() -> str:
    lost = restitution_lost().subs(_APPENDIX_A)
    found = ", ".join(f"{number(lost.subs(mass, x))} for {name}" for name, x in _MASSES.items())
    return (
        f"Appendix A's constants give {found}, at $v_n = {_APPENDIX_A[speed]} (d g)^{{1/2}}$; the "
        f"paper's restitution of {number(PAPER[epsilon])} asks for {number(1 - PAPER[epsilon])}"
    )


EQUATIONS = (
    Equation(
        "IV: large ratio",
        f"sign of $-c_z/c_x - 1$ at {degrees(_TILT[phi])}, stationary in slip-stick",
        rf"[\mathrm{{sgn}}(-c_z/c_x - 1)]_{{\phi = {latex(_TILT[phi])}}}",
        where=lambda: dict(zip(("c_x", "-c_z"), thin_stationary("stick"), strict=True)),
        said=sp.S.One,
        derive=lambda: _sign(stationary_ratio().subs(_TILT) - 1),
        contradicted_by=("24", "25"),
        contradiction=lambda drift, up: _sign((up / drift).subs(THIN).subs(_TILT) - 1),
        mistaken=lambda: _sign(_FIG_10C - 1),
        mistake=f"perhaps the {_FIG_10C} of Fig. 10(c) is taken for typical",
        note=lambda: (
            f"it is {formula(stationary_ratio())} of a thin rod in slip-stick: "
            f"{number(stationary_ratio().subs(_TILT))} at {degrees(_TILT[phi])}"
        ),
    ),
    Equation(
        "V: landings to relax",
        r"$\mu$ times the number of landings after which exp(-1) of a deviation of $c_x$ is left, "
        r"as $\mu \to 0$",
        r"\mu n",
        derive=landings_to_relax,
        check=_relaxed,
    ),
    Equation(
        "A: restitution",
        "$1 - e$ of Appendix A's normal force at small damping, $M_e$ the reduced mass $m_r$, "
        "$B(4/5, 3/2)$ Euler's beta function",
        "1 - e",
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


# ---- dimensions of the material constants in Appendix A's force law ------------------------------

MASS, LENGTH, TIME = sp.symbols("mass length time", positive=True)
FORCE, SPEED = MASS * LENGTH / TIME**2, LENGTH / TIME
_DIMENSIONS = {
    paper.LETTERS[name]: of
    for of, names in (
        (MASS, ("m", "M_e")),
        (LENGTH, ("d", "D", r"\delta", r"\mathbf{s}")),
        (SPEED, ("v_n", "v_t")),
        (LENGTH / TIME**2, ("g",)),
    )
    for name in names
}
_OVERLAP = paper.LETTERS[r"\delta"]
_LENGTHS = {MASS: 1, LENGTH: 4, TIME: 1}


def _law(name: str) -> str:
    """Tag of the printed force law in which a constant stands."""
    return "A: normal force" if name.endswith("n") else "A: tangential force"


def _with(law: sp.Expr, name: str) -> sp.Expr:
    """Dimension of what stands beside a constant in a force law."""
    term = law.coeff(paper.LETTERS[name])
    return term.subs(_DIMENSIONS, simultaneous=True).as_coeff_Mul()[1]


def _needed(name: str, without: sp.Expr = sp.S.One) -> sp.Expr:
    """Dimension that a constant needs so that its term, over the factor `without`, is a force."""
    letter = paper.LETTERS[name]
    term = letter * _with(paper.printed(_law(name)), name) / without.subs(_DIMENSIONS)
    sentence = f"Its term is a force; solved for ${sp.latex(letter)}$"
    return only_root((term, FORCE), letter, sentence)


def _of_d_g_m(constant: str) -> str:
    """The unit that a constant needs, in d, g and m."""
    powers = _needed(constant).as_powers_dict()
    gravity = -powers[TIME] / 2
    m, g, d = (paper.LETTERS[name] for name in "mgd")
    return formula(m ** powers[MASS] * g**gravity * d ** (powers[LENGTH] - gravity))


def _duration() -> sp.Expr:
    """Dimension of a time, solved from a speed times it being a length."""
    duration = sp.Symbol("Delta_t", positive=True)
    return only_root((SPEED * duration, LENGTH), duration, "A speed times it is a length")


def _unit(tag: str) -> sp.Expr:
    """Dimension of a constant as printed, without its number."""
    return paper.printed(tag).subs(_DIMENSIONS, simultaneous=True).as_coeff_Mul()[1]


def _wrong_unit(
    tag: str,
    about: str,
    left: str,
    form: Callable[[Callable[[str], sp.Expr]], sp.Expr],
    said: sp.Expr | Callable[[], sp.Expr],
    constants: Mapping[str, sp.Expr],
    note: Callable[[], str],
) -> Equation:
    """Entry of a printed dimension that a force law contradicts.

    Parameters
    ----------
    form : gives what is judged, from a function that gives the dimension of a constant
    constants : each with the factor of its force that the mistake leaves out
    """
    factor, *_ = constants.values()

    def by_printed_laws(*laws: sp.Expr) -> sp.Expr:
        law_of = dict(zip(constants, laws, strict=True))
        return form(lambda name: FORCE / _with(law_of[name], name))

    return Equation(
        tag,
        about,
        left,
        where=lambda: {name: _needed(name) for name in constants},
        said=said,
        derive=lambda: form(_needed),
        mistaken=lambda: form(lambda name: _needed(name, constants[name])),
        mistake=f"a factor {formula(factor)} of the force is left out",
        contradicted_by=tuple(map(_law, constants)),
        contradiction=by_printed_laws,
        note=note,
        at=_LENGTHS,
    )


DIMENSIONS = (
    _wrong_unit(
        "A: unit of k_n",
        "dimension of $k_n$",
        "[k_n]",
        form=lambda needed: needed("k_n"),
        said=lambda: _unit("A: unit of k_n"),
        constants={"k_n": sp.sqrt(_OVERLAP)},
        note=lambda: _of_d_g_m("k_n"),
    ),
    _wrong_unit(
        "A: k_t = 95 k_n",
        "dimension of $k_t$ over that of $k_n$",
        "[k_t/k_n]",
        form=lambda needed: needed("k_t") / needed("k_n"),
        said=sp.S.One,
        constants={"k_t": sp.sqrt(_OVERLAP), "k_n": sp.S.One},
        note=lambda: f"$k_t$ needs {_of_d_g_m('k_t')}",
    ),
    _wrong_unit(
        "A: unit of gamma",
        r"dimension of $\gamma_n$ and of $\gamma_t$",
        r"([\gamma_n], [\gamma_t])",
        form=lambda needed: sp.Matrix([needed(r"\gamma_n"), needed(r"\gamma_t")]),
        said=lambda: sp.Matrix([_unit("A: unit of gamma")] * 2),
        constants={r"\gamma_n": _OVERLAP, r"\gamma_t": _OVERLAP},
        note=lambda: _of_d_g_m(r"\gamma_n"),
    ),
    Equation(
        "A: time step",
        "dimension of the time step",
        r"[\Delta t]",
        where=lambda: {r"\Delta t": TIME},
        said=lambda: _unit("A: time step"),
        derive=_duration,
    ),
)
