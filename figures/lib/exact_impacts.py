"""Random impacts, the same in many digits, and the paper's formulas as they are printed.

`exact` runs the text of the impact map on mpmath numbers, one impact at a time. `literal` evaluates
the formulas of the paper's Sec. IV in the structure in which they are printed, with their mistakes
corrected but nothing rewritten.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import mpmath
import numpy as np

from impact import Regime, collide, spherocylinder
from impact._impacts import Impacts

from .style import REGIME_WORDS, RESTITUTION_LAWS

DIGITS = 50  # of what errors are measured against
FIELDS = ("c_x", "c_z", "P_x", "P_z", "omega")


def random_impacts(n: int, seed: int = 1) -> Impacts:
    """Arrays of n impacts: velocities and friction log-uniform over six decades, all tilts."""
    rng = np.random.default_rng(seed)
    tilt, length = rng.uniform(-np.pi / 2, np.pi / 2, n), 1 + 10 ** rng.uniform(-2, 1.5, n)
    rod = spherocylinder(tilt, length)
    sizes = 10 ** rng.uniform(-3, 3, (5, n))
    c_x, c_z, spin, V_z = sizes[:4] * rng.choice([-1, 1], (4, n))
    omega = spin / rod.k
    towards = np.where(c_z - V_z + omega * rod.X < 0, 1.0, -1.0)  # every pair approaches
    velocities = towards * np.array([c_x, c_z, omega, V_z])
    return Impacts(*velocities, *rod, sizes[4], rng.uniform(0, 1, n))


@cache
def _map() -> dict[str, Any]:
    """Functions of `impact._kernel` for numbers of many digits, whose sums need no second part."""
    from derivations.kernel import KERNEL, choices, loaded, whole_sums

    return loaded(KERNEL.read_text("utf-8"), choices(bool) | whole_sums(mpmath.sqrt, 0))


def exact(row: Any, law: str) -> tuple[Regime, tuple]:
    """Regime and the `FIELDS` of one impact that approaches, in the digits of `row`'s numbers."""
    space = _map()
    c_x, c_z, omega, regime, P_x, P_z, *_ = space["impact"](space[law], row)
    return Regime(regime), (c_x, c_z, P_x, P_z, omega)


class Reference(NamedTuple):
    """Exact results as sums of two floats (high + low), and the size to which errors relate."""

    regime: np.ndarray
    high: np.ndarray  # (fields, impacts)
    low: np.ndarray
    scale: np.ndarray

    def ulp(self, got: Any, fields: tuple[str, ...] = FIELDS) -> np.ndarray:
        """Largest error of the named fields of `got`, in units in the last place of the scale."""
        return self.error(got, fields, np.spacing(self.scale))

    def error(self, got: Any, fields: tuple[str, ...], unit: np.ndarray) -> np.ndarray:
        """Largest error of the named fields of `got`, each in a unit of its own, as the scale.

        `got` may hold more impacts after those of the reference.
        """
        rows, n = [FIELDS.index(field) for field in fields], len(self.regime)
        values = np.stack([np.asarray(getattr(got, field)[:n], float) for field in fields])
        error = np.abs((values - self.high[rows]) - self.low[rows]) / unit[rows]
        return np.where(np.isnan(error), np.inf, error).max(0)


def reference(impacts: Impacts, law: str = "newton") -> Reference:
    """Exact results of many impacts.

    Errors of velocities and impulses relate to the largest of |c_x|, |c_z - V_z|, |omega X|,
    |omega Z|, |P_x|, |P_z| and the result itself; errors of omega to the largest of |omega| and
    (|X P_z| + |Z P_x|)/k^2.
    """
    n = impacts.c_x.size
    regime, (high, low) = np.empty(n, np.int8), np.empty((2, 5, n))
    with mpmath.workdps(DIGITS):
        for i, row in enumerate(np.transpose(impacts).tolist()):
            regime[i], values = exact([mpmath.mpf(value) for value in row], law)
            high[:, i] = values
            low[:, i] = [value - float(value) for value in values]
    c_x, c_z, omega, V_z, X, Z, k = impacts[:7]
    P_x, P_z = np.abs(high[2:4])
    size = np.max(np.abs([c_x, c_z - V_z, omega * X, omega * Z, P_x, P_z]), axis=0)
    turn = np.maximum(np.abs(omega), (np.abs(X) * P_z + np.abs(Z) * P_x) / (k * k))
    scale = np.concatenate([np.maximum(size, np.abs(high[:4])), [turn]])
    return Reference(regime, high, low, scale)


def largest_errors(n: int) -> np.ndarray:
    """Largest error of `impact.collide` over n random impacts, in ulp, (laws, regimes)."""
    impacts, found = random_impacts(n, seed=3), []
    for law in RESTITUTION_LAWS:
        true = reference(impacts, law)
        error = true.ulp(impacts.collide(collide, law))
        found.append([error[true.regime == one].max() for one in REGIME_WORDS])
    return np.array(found)


class Literal(NamedTuple):
    """Velocities by the paper's formulas, which print none for the rest."""

    c_x: Any
    c_z: Any


@cache
def _printed() -> dict[str, Callable]:
    """Equations (12)-(14), (16), (18), (19), (21), (22) as functions on floats.

    With the repairs that the registry names of (12), (13) and (21); nothing else is touched.
    """
    import sympy as sp

    from derivations import slide, slip_reversal, slip_stick
    from derivations import symbols as s
    from derivations.newton import approach

    equations = (*slide.EQUATIONS, *slip_stick.EQUATIONS, *slip_reversal.EQUATIONS)
    arguments = (s.c_x, s.c_z, s.omega, s.V_z, s.X, s.Z, s.k, s.mu, s.epsilon)
    return {
        equation.tag: sp.lambdify(arguments, equation.repaired.subs(approach()), modules="numpy")
        for equation in equations
        if equation.tag in ("12", "13", "14", "16", "18", "19", "21", "22")
    }


def literal(impacts: Impacts) -> Literal:
    """c_x', c_z' from the printed formulas in float64, mirrored to the paper's u_0 > 0."""
    formula = _printed()
    c_x, c_z, omega, V_z, X, *rest = impacts
    side = np.where(c_x - omega * rest[0] < 0, -1.0, 1.0)
    row = (side * c_x, c_z, side * omega, V_z, side * X, *rest)
    with np.errstate(all="ignore"):
        conditions = [formula["14"](*row) > 0, formula["16"](*row)]
        x, z = (
            np.select(conditions, [formula[tag](*row) for tag in tags[:2]], formula[tags[2]](*row))
            for tags in (("12", "18", "21"), ("13", "19", "22"))
        )
    return Literal(side * x, z)
