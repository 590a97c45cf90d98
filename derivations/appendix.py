"""Dimensions of the material constants in Appendix A's force law.

Dimensions are monomials in mass, length and time; a constant's dimension is solved from the term
of the printed force law in which it stands.
"""

import sympy as sp

from . import paper
from .proof import Equation
from .trace import solve
from .words import formula

MASS, LENGTH, TIME = sp.symbols("mass length time", positive=True)
FORCE, SPEED = MASS * LENGTH / TIME**2, LENGTH / TIME
_NORMAL, _TANGENTIAL = "A: normal force", "A: tangential force"
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
_LENGTHS = {MASS: sp.Integer(1), LENGTH: sp.Integer(4), TIME: sp.Integer(1)}


def _with(law: sp.Expr, name: str) -> sp.Expr:
    """Dimension of what stands beside a constant in a force law."""
    term = law.coeff(paper.LETTERS[name])
    return term.subs(_DIMENSIONS, simultaneous=True).as_coeff_Mul()[1]


def _needed(name: str, tag: str, without: sp.Expr = sp.S.One) -> sp.Expr:
    """Dimension of a constant, so that its term, without a factor, is a force."""
    letter = paper.LETTERS[name]
    term = letter * _with(paper.printed(tag), name) / without
    sentence = f"Its term is a force; solved for ${sp.latex(letter)}$"
    (value,) = solve((term, FORCE), letter, sentence)
    return sp.simplify(value)


def _of_d_g_m(constant: str, tag: str) -> str:
    """The unit that a constant needs, in d, g and m."""
    powers = _needed(constant, tag).as_powers_dict()
    gravity = -powers[TIME] / 2
    size = powers[LENGTH] - gravity
    letters = [paper.LETTERS[name] for name in ("m", "g", "d")]
    return formula(
        sp.Mul(*(x**n for x, n in zip(letters, (powers[MASS], gravity, size), strict=True)))
    )


def _ratio(without: sp.Expr = sp.S.One) -> sp.Expr:
    return sp.simplify(_needed("k_t", _TANGENTIAL, without) / _needed("k_n", _NORMAL))


def _damping(without: sp.Expr = sp.S.One) -> tuple[sp.Expr, sp.Expr]:
    laws = (("n", _NORMAL), ("t", _TANGENTIAL))
    return tuple(_needed(rf"\gamma_{x}", tag, without) for x, tag in laws)


def _duration() -> sp.Expr:
    """Dimension of a time, which a speed makes a length."""
    duration = sp.Symbol("Delta_t", positive=True)
    (value,) = solve((SPEED * duration, LENGTH), duration, "A speed times it is a length")
    return value


def _unit(tag: str) -> sp.Expr:
    """Dimension of a printed constant."""
    return paper.printed(tag).subs(_DIMENSIONS, simultaneous=True).as_coeff_Mul()[1]


EQUATIONS = (
    Equation(
        "A: unit of k_n",
        "dimension of $k_n$",
        "[k_n]",
        where=lambda: {"k_n": _needed("k_n", _NORMAL)},
        verdict="erratum",
        said=lambda: _unit("A: unit of k_n"),
        derive=lambda: _needed("k_n", _NORMAL),
        mistaken=lambda: _needed("k_n", _NORMAL, sp.sqrt(LENGTH)),
        mistake="the spring is taken for a linear one",
        contradicted_by=(_NORMAL,),
        contradiction=lambda law: FORCE / _with(law, "k_n"),
        note=lambda: (
            f"{_of_d_g_m('k_n', _NORMAL)}; the printed unit is that of a linear spring (and $D$ "
            "stands "
            "for $d$). In reduced units, $d = m = g = 1$, the number is the same"
        ),
        at=_LENGTHS,
    ),
    Equation(
        "A: k_t = 95 k_n",
        "dimension of $k_t$ over that of $k_n$",
        "[k_t/k_n]",
        where=lambda: {"k_t": _needed("k_t", _TANGENTIAL), "k_n": _needed("k_n", _NORMAL)},
        verdict="erratum",
        said=sp.S.One,
        derive=_ratio,
        mistaken=lambda: _ratio(sp.sqrt(LENGTH)),
        mistake=r"as if the tangential force were $-k_t \delta^{1/2} s$",
        contradicted_by=(_TANGENTIAL, _NORMAL),
        contradiction=lambda law, other: _with(other, "k_n") / _with(law, "k_t"),
        note=lambda: (
            rf"$k_t \delta s$ is a force if $k_t$ is in {_of_d_g_m('k_t', _TANGENTIAL)}; the "
            "number is "
            f"$k_t/k_n$ times {formula(1 / _ratio())} only"
        ),
        at=_LENGTHS,
    ),
    Equation(
        "A: unit of gamma",
        r"dimension of $\gamma_n$ and of $\gamma_t$",
        r"([\gamma_n], [\gamma_t])",
        where=lambda: dict(zip((r"\gamma_n", r"\gamma_t"), _damping(), strict=True)),
        verdict="erratum",
        said=lambda: sp.Matrix([_unit("A: unit of gamma")] * 2),
        derive=_damping,
        mistaken=lambda: sp.Matrix(_damping(LENGTH)),
        mistake="as if the damping force had no factor of overlap",
        contradicted_by=(_NORMAL, _TANGENTIAL),
        contradiction=lambda *laws: sp.Matrix(
            [FORCE / _with(law, rf"\gamma_{x}") for x, law in zip("nt", laws, strict=True)]
        ),
        note=lambda: (
            rf"{_of_d_g_m(chr(92) + 'gamma_n', _NORMAL)}: the overlap in the damping term asks for "
            "another length than the printed unit has"
        ),
        at=_LENGTHS,
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
