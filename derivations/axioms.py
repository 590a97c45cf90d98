"""The assumptions: all else in this package is computed from the forms below.

An axiom is called with values for its letters, and notes that it was used (module `trace`).
"""

from dataclasses import dataclass
from typing import Any

import sympy as sp

from . import trace
from .equality import Form, Forms, Residuals
from .proof import Equation
from .symbols import F_z, P_x, P_z, c_x, c_z, epsilon, m, moment, mu, omega, theta, v_0

tau = sp.Symbol("tau", positive=True)  # duration of the impact
after_x, after_z = sp.symbols("cprime_x cprime_z", real=True)  # velocity of the centre after it
sigma = sp.Symbol("sigma", real=True)  # direction of the slip, 1 or -1
lever_x, lever_z = sp.symbols("x z", real=True)  # from the centre of mass to the contact point
xi, zeta, turn = sp.symbols("xi zeta vartheta", real=True)  # a point of the body; its turn
held = sp.Symbol("f", nonnegative=True)  # |F_x|/F_z
P = sp.Symbol("P", real=True)


@dataclass(slots=True)
class Axiom:
    """An assumption as a form in letters; calling it with values for them notes its use.

    A call may have left sides of its own, `lefts`, if the values change what the form is: a force
    in the place of an impulse.
    """

    tag: str
    left: tuple[str, ...]  # left sides of the form's parts, LaTeX
    form: Form

    def __call__(self, values: Forms, *lefts: str) -> Form:
        """Return the form with `values` for its letters."""
        value = self.form.subs(values, simultaneous=True)
        trace.note(trace.Step("axiom", self.tag, lefts or self.left, value))
        return value


NEWTON = Axiom("1", ("dc",), P / m)
EULER = Axiom("IV: Euler", (r"d\omega",), (lever_z * P_x - lever_x * P_z) / moment)
RIGID = Axiom(
    "IV: rigid body",
    ("x", "z"),
    sp.Matrix([xi * sp.cos(turn) + zeta * sp.sin(turn), zeta * sp.cos(turn) - xi * sp.sin(turn)]),
)
IMPULSIVE = Axiom("IV: impulsive limit", ("F",), P / tau)
SLIP = Axiom("IV: Coulomb, slip", ("F_x",), -mu * sigma * F_z)
STICK = Axiom("IV: Coulomb, stick", (r"\mu - |F_x|/F_z",), mu - held)
RESTITUTION = Axiom("IV: restitution", ("v_f",), -epsilon * v_0)
CLOSURE = Axiom("V: closure", ("0", "0", "0"), sp.Matrix([omega, c_x - after_x, c_z + after_z]))
LANDING_PHASES = Axiom("V: H(theta)", (r"H(\theta)",), (1 + sp.cos(theta)) / (2 * sp.pi))

AXIOMS = (NEWTON, EULER, RIGID, IMPULSIVE, SLIP, STICK, RESTITUTION, CLOSURE, LANDING_PHASES)


BY_TAG = {axiom.tag: axiom for axiom in AXIOMS}


def _euler_checks(form: sp.Expr) -> Residuals:
    """Residuals of Euler's law for two equal point masses on a light rod, struck at one of them.

    Struck across the rod, that one moves alone; struck along it, nothing turns.
    """
    a, b = sp.symbols("a b", real=True)  # half the vector from one to the other
    struck = form.subs({lever_x: a, lever_z: b, moment: m * (a**2 + b**2)})  # total mass m
    spin = struck.subs({P_x: b, P_z: -a})  # an impulse across the rod
    other = sp.Matrix([b, -a]) / m + spin * sp.Matrix([-b, a])  # the other mass stays at rest
    along = struck.subs({P_x: a, P_z: b})  # nothing turns
    scale = form.subs(moment, 2 * moment) * 2 - form
    return [*other, along, scale]


def _assumed(axiom: Axiom, about: str, left: str = "", derive: Any = None, **more: Any) -> Equation:
    """Entry of an axiom, with the axiom's form unless `derive` gives another one."""
    derive = derive or (lambda: axiom({}))
    return Equation(axiom.tag, about, left, derive=derive, verdict="assumed", **more)


EQUATIONS = (
    _assumed(
        NEWTON,
        "Newton's law for the centre of mass, along $x$ and along $z$",
        r"m d\mathbf{c}",
        derive=lambda: (m * NEWTON({P: P_x}), m * NEWTON({P: P_z})),
    ),
    _assumed(
        EULER,
        "Euler's law: the moment of the impulse about the centre of mass turns the body; $x$, $z$ "
        "from the centre to the contact point",
        r"d\omega",
        check=_euler_checks,
    ),
    _assumed(
        RIGID,
        r"place, from the centre of mass, of the point $(\xi, \zeta)$ of a rigid body that has "
        r"turned by $\vartheta$",
        "(x, z)",
        # distances stay, a turn starts in place, a positive one takes +z to +x
        check=lambda form: [
            form.dot(form) - xi**2 - zeta**2,
            *(form.subs(turn, 0) - sp.Matrix([xi, zeta])),
            *(form.diff(turn).subs(turn, 0) - sp.Matrix([zeta, -xi])),
        ],
    ),
    _assumed(
        IMPULSIVE,
        r"the impact is short and its force large: $\tau \to 0$ with the impulse kept",
        "F",
        check=lambda form: (tau * form - P,),
        note="place and tilt of the rod and the plate's velocity do not change meanwhile, and "
        "gravity gives no impulse",
    ),
    _assumed(
        SLIP,
        "friction of a contact that slips forward, and of one that slips back",
        derive=lambda: (SLIP({sigma: 1}), SLIP({sigma: -1})),
        formulas=("IV: friction", "IV: friction, back"),
        note="static and dynamic friction are equal",
    ),
    _assumed(
        STICK,
        "margin of the friction that holds a contact at rest, $f = |F_x|/F_z$",
        r"\mu - |F_x|/F_z",
        check=lambda form: (form.subs(held, mu), form.diff(held) + 1),
    ),
    _assumed(RESTITUTION, "kinematic restitution"),
    _assumed(
        CLOSURE,
        "stationary translation: what holds in the mean landing",
        formulas=("V: closure, spin", "V: closure, c_x", "V: closure, c_z"),
    ),
    _assumed(
        LANDING_PHASES,
        "density of landing phases",
        note="the paper's approximation to its simulations",
    ),
)
