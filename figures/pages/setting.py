"""What is so at one setting of rod, plate and approach: numbers over tilt, and words."""

from dataclasses import astuple, dataclass

import numpy as np

import impact
from impact import Regime

from ..lib.style import RESTITUTION_LAWS, SHAPES

TILT = np.linspace(0, np.pi / 2, 1801)  # of the curves; colours take every tenth
FRICTION = np.linspace(0, 1, 101)
_RODS = {"thin": impact.thin_rod, "round": impact.spherocylinder, "flat": impact.flat_ended_rod}
WORDS = {
    Regime.SLIDE: "Slide: the contact point slips until it leaves the plate.",
    Regime.SLIP_STICK: "Slip-stick: the contact point slips, stops, and friction holds it.",
    Regime.SLIP_REVERSAL: "Slip reversal: the contact point slips, stops, and slips back.",
}
RANGES = {  # ends of a slider, its name, its digits
    "tilt_deg": (0, 90, r"tilt $\phi$ (deg)", "%.2f"),
    "friction": (0, 1, r"friction $\mu$", "%.3f"),
    "restitution": (0, 1, r"restitution $\epsilon$", "%.3f"),
    "ratio": (0.1, 10, r"approach $-c_z/c_x$", "%.2f"),
    "length": (1, 20, "length $l/d$", "%.2f"),
}
CHOICES = {"shape": SHAPES, "law": {law: law.title() for law in RESTITUTION_LAWS}}


@dataclass(frozen=True, slots=True)
class Setting:
    """Where the controls stand; the length of a thin rod changes nothing that is drawn."""

    tilt_deg: float = 30.0
    friction: float = 0.3
    restitution: float = 0.65
    ratio: float = 2.0
    length: float = 8.0
    shape: str = "round"
    law: str = "newton"

    def __post_init__(self):
        for name, (low, high, *_) in RANGES.items():
            if not low <= (value := getattr(self, name)) <= high:
                raise ValueError(f"{name} must be between {low:g} and {high:g}, got {value!r}")
        for name, choices in CHOICES.items():
            if (value := getattr(self, name)) not in choices:
                raise ValueError(f"{name} must be one of {', '.join(choices)}, got {value!r}")


def _crossings(x: np.ndarray, y: np.ndarray, level: float) -> np.ndarray:
    """Where a curve of short straight pieces crosses a level."""
    i = np.flatnonzero(np.diff(y > level))
    return x[i] + (level - y[i]) / (y[i + 1] - y[i]) * (x[i + 1] - x[i])


def data(setting: Setting) -> dict[str, np.ndarray]:
    """What the panels show; the last element of all that goes over tilt [rad] is the setting's."""
    tilt_deg, friction, restitution, ratio, length, shape, law = astuple(setting)
    tilt = np.append(TILT, np.radians(tilt_deg))
    rod, columns = (_RODS[shape](some, length) for some in (tilt, TILT[::10]))
    before = np.array([1, -ratio]) / np.hypot(1, ratio)
    plate = {"friction": friction, "restitution": restitution}
    hit, moves = impact.collide(*before, geometry=rod, law=law, **plate), impact.drift(rod, **plate)
    regimes = impact.classify(
        *before, geometry=columns, friction=FRICTION[:, None], restitution=restitution
    )
    holds = impact.critical_friction(rod)
    return {
        "tilt": tilt,
        "c_x_before": np.full(tilt.shape, before[0]),
        "c_x": hit.c_x,
        "c_z": hit.c_z,
        "spin": hit.omega * rod.k,
        "energy_change": hit.energy_change,
        "regime": hit.regime,
        "regimes": regimes,
        "drift": moves.c_x,
        "drift_regime": np.ma.masked_equal(moves.regime, Regime.INVALID),  # without friction
        "sticking": impact.drift(rod, friction=np.inf, restitution=restitution).c_x,
        "critical_friction": holds,
        "slide_friction": impact.slide_friction(rod, approach_ratio=ratio, restitution=restitution),
        "critical_tilts": _crossings(TILT, holds[:-1], friction),
    }


def words(d: dict[str, np.ndarray]) -> str:
    """What happens at the setting, in plain words."""
    here = {name: values[-1] for name, values in d.items() if values.shape == d["tilt"].shape}
    lost, slides, c_x = -200 * here["energy_change"], here["slide_friction"], here["drift"]
    through = f"below friction {slides:.3f}" if np.isfinite(slides) else "at every friction"
    way = "the way the rod leans" if c_x > 0 else "against the way the rod leans"
    tilts = ", ".join(f"{tilt:.2f}°" for tilt in np.degrees(d["critical_tilts"])) or "none"
    size = "without bound" if np.isinf(c_x) else f"{abs(c_x):.4g} of the plate's velocity"
    drifts = f"{size}, {way}" if abs(c_x) >= 5e-4 else "none"
    rise = f"{abs(here['c_z']):.3f} {'up' if here['c_z'] >= 0 else 'down'}"
    never = "at no value of the friction"
    return (
        f"{WORDS[here['regime']]}\n"
        f"After it the centre moves at {here['c_x']:+.3f} along the plate and {rise}, spin times k "
        f"is {here['spin']:+.3f}, in units of the speed before; "
        f"{abs(lost):.1f} % of the energy {'lost' if lost > -0.05 else 'GAINED'}.\n"
        f"At this tilt the contact slides through {through if slides else never}, and "
        f"slips back, once stopped, below {here['critical_friction']:.3f}. "
        f"Critical tilts at this friction: {tilts}.\n"
        f"Drift: {'not determined without friction' if np.isnan(c_x) else drifts}."
    )
