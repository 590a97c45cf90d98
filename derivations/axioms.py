"""The assumptions: all else in this package is computed from the forms below.

An axiom is called with values for its letters, and notes that it was used (module `trace`).
`assuming` changes an axiom for a trial.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import sympy as sp

from . import trace
from .proof import Equation, Form
from .symbols import F_z, P_x, P_z, c_x, c_z, epsilon, m, moment, mu, omega, theta, v_0

tau = sp.Symbol("tau", positive=True)  # duration of the impact
after_x, after_z = sp.symbols("cprime_x cprime_z", real=True)  # velocity of the centre after it
sigma = sp.Symbol("sigma", real=True)  # direction of the slip, 1 or -1
lever_x, lever_z = sp.symbols("x z", real=True)  # from the centre of mass to the contact point
xi, zeta, turn = sp.symbols("xi zeta vartheta", real=True)  # a point of the body; its turn
q = sp.Symbol("q", nonnegative=True)  # |F_x|/F_z
P, F = sp.symbols("P F", real=True)


@dataclass(slots=True)
class Axiom:
    """An assumption as a form in letters; calling it with values for them notes its use."""

    tag: str
    form: Form
    compared: str = ""  # with zero: "sign" if its sign counts alone, "zero" if it vanishes

    def __call__(self, values: Mapping[sp.Symbol, sp.Expr]) -> Form:
        """Return the form with `values` for its letters."""
        value = self.form.subs(values, simultaneous=True)
        trace.note(trace.Step("axiom", self.tag, value=value))
        return value


NEWTON = Axiom("1", P / m)
EULER = Axiom("IV: Euler", (lever_z * P_x - lever_x * P_z) / moment)
RIGID = Axiom(
    "IV: rigid body",
    sp.Matrix([xi * sp.cos(turn) + zeta * sp.sin(turn), zeta * sp.cos(turn) - xi * sp.sin(turn)]),
)
IMPULSIVE = Axiom("IV: impulsive limit", P / tau)
SLIP = Axiom("IV: Coulomb, slip", -mu * sigma * F_z)
STICK = Axiom("IV: Coulomb, stick", mu - q, "sign")
RESTITUTION = Axiom("IV: restitution", -epsilon * v_0)
CLOSURE = Axiom("V: closure", sp.Matrix([omega, after_x - c_x, after_z + c_z]), "zero")
LANDING_PHASES = Axiom("V: H(theta)", (1 + sp.cos(theta)) / (2 * sp.pi))

AXIOMS = (NEWTON, EULER, RIGID, IMPULSIVE, SLIP, STICK, RESTITUTION, CLOSURE, LANDING_PHASES)


@contextmanager
def assuming(axiom: Axiom, form: Form) -> Iterator[None]:
    """Put another form in an axiom's place, for a trial; what rests on it is derived again."""
    with trace.derived_again("axiom", axiom.tag):
        usual, axiom.form = axiom.form, form
        try:
            yield
        finally:
            axiom.form = usual


def _euler_checks(form: sp.Expr) -> list[sp.Expr]:
    """From point masses: two equal ones on a light rod, struck at one, which then moves alone."""
    a, b = sp.symbols("a b", real=True)  # half the vector from one to the other
    struck = {lever_x: a, lever_z: b, moment: m * (a**2 + b**2)}  # total mass m
    across = {P_x: b, P_z: -a}  # an impulse across the rod leaves the other mass at rest
    spin = form.subs(struck).subs(across)
    other = sp.Matrix([b, -a]) / m + spin * sp.Matrix([-b, a])
    along = form.subs(struck).subs({P_x: a, P_z: b})  # nothing turns
    scale = form.subs(moment, 2 * moment) * 2 - form
    return [*other, along, scale]


def _rigid_checks(form: sp.Matrix) -> list[sp.Expr]:
    """Distances stay, the body starts in its place, and a positive turn takes +z towards +x."""
    return [
        form.dot(form) - xi**2 - zeta**2,
        *(form.subs(turn, 0) - sp.Matrix([xi, zeta])),
        *(form.diff(turn).subs(turn, 0) - sp.Matrix([zeta, -xi])),
    ]


EQUATIONS = (
    Equation.read(NEWTON.tag, printed=P, derive=lambda: m * NEWTON({})),
    Equation.read(EULER.tag, derive=lambda: EULER({}), check=_euler_checks),
    Equation.read(RIGID.tag, derive=lambda: RIGID({}), check=_rigid_checks),
    Equation.read(IMPULSIVE.tag, printed=P / tau, derive=lambda: IMPULSIVE({})),
    Equation.read(SLIP.tag, printed=-mu * sigma * F_z, derive=lambda: SLIP({})),
    Equation.read(
        STICK.tag, derive=lambda: STICK({}), check=lambda form: (form.subs(q, mu), form.diff(q) + 1)
    ),
    Equation.read(RESTITUTION.tag, printed=-epsilon * v_0, derive=lambda: RESTITUTION({})),
    Equation.read(
        CLOSURE.tag, printed=(omega, after_x - c_x, after_z + c_z), derive=lambda: CLOSURE({})
    ),
    Equation.read(
        LANDING_PHASES.tag,
        printed=(1 + sp.cos(theta)) / (2 * sp.pi),
        derive=lambda: LANDING_PHASES({}),
    ),
)
