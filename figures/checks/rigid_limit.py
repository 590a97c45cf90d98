"""How the soft impact comes to the rigid one: error against stiffness, law by law.

RMS over 17 tilts (5 to 85 degrees) of (c_x', c_z')/|c_z| against the theory at the restitution
measured in each run; the scene of Fig. 12. (a) Friction as a constraint leaves one small number,
the overlap over the rod's size, that falls as k_n^(-2/5). A spring adds another, its own give, that
a stiffer plate does not remove: floors. Appendix A goes away from the theory as the plate grows
stiff, because k_t delta falls behind k_n sqrt(delta) as sqrt(delta). (b) The floors fall as one
over the root of the tangential stiffness ratio, without damping as well; damping makes them three
times lower. Crosses: every switch located (DOP853).
"""

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import md

from ..lib.soft_impacts import CONTACT_COLOURS, LAW_WORDS, from_theory, scene_words
from ..lib.style import Data, log_log, name_panels, note, style

TANGENTIAL_RATIOS = (3.0, 30.0, 300.0, 3000.0)  # tangential ratios of panel (a)
SPRING_SERIES = (  # k_n, tangential damping of panel (b); k_n in words
    (5e6, 1.0, r"5\times10^6"),
    (1e12, 1.0, "10^{12}"),
    (1e12, 0.0, "10^{12}"),
)
FITTED = 100.0  # from this ratio on


def _spring(k: float, ratio: float, damping: float = 1.0) -> md.Law:
    """`constant_restitution` with this stiffness and tangential spring."""
    return md.constant_restitution(stiffness=k, tangential_ratio=ratio, tangential_damping=damping)


BY_STIFFNESS = {
    LAW_WORDS["coulomb"]: lambda k: md.coulomb(stiffness=k),
    **{f"a spring, ratio {r:g}": partial(_spring, ratio=r) for r in TANGENTIAL_RATIOS},
    LAW_WORDS["appendix_a"]: md.appendix_a,
    "its dashpots without overlap": partial(md.appendix_a, overlap_factor=False),
}


def _errors(laws: list[list[md.Law]], **how) -> tuple[np.ndarray, np.ndarray]:
    """RMS distances of laws from the theory, and how many regimes of 17 agree; shape of `laws`."""
    found = np.array([[from_theory(law, **how) for law in row] for row in laws])
    return found[..., 0], found[..., 1].astype(int)


def _slope(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Slope in log-log and its standard error."""
    line, covariance = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    return np.array([line[0], np.sqrt(covariance[0, 0])])


def data(quick: bool = False) -> Data:
    """Errors and regimes right, shape (laws, k_n) and (series, ratios); slopes in log-log."""
    k_n = 10.0 ** np.linspace(5, 14, 4 if quick else 10)
    ratios = np.geomspace(3, 3000, 7 if quick else 13)
    laws = [[law(k) for k in k_n] for law in BY_STIFFNESS.values()]
    error, right = _errors(laws)
    half, _ = _errors([row[::3] for row in laws], refine=64)
    (located,), _ = _errors([laws[0][::3]], integrator="dop853")
    springs = [[_spring(k, ratio, damping) for ratio in ratios] for k, damping, _ in SPRING_SERIES]
    by_ratio, _ = _errors(springs)
    stiff = ratios >= FITTED
    return {
        "k_n": k_n,
        "error": error,
        "right": right,
        "located": located,
        "half_step": np.max(abs(half / error[:, ::3] - 1), axis=1),  # relative change of the error
        "slope": _slope(k_n, error[0]),
        "ratio": ratios,
        "error_by_ratio": by_ratio,
        "slope_by_ratio": np.array([_slope(ratios[stiff], row[stiff]) for row in by_ratio]),
    }


@style
def draw(d: Data) -> Figure:
    figure, (left, other) = plt.subplots(1, 2, figsize=(7.0, 4.0))
    k_n = d["k_n"]
    constraint, spring, printed = CONTACT_COLOURS.values()
    looks = [(constraint, "o-"), *((spring, f"s{dashes}") for dashes in (":", "-.", "--", "-"))]
    looks += [(printed, "D-"), (printed, "v:")]
    for name, error, (colour, form) in zip(BY_STIFFNESS, d["error"], looks, strict=True):
        left.plot(k_n, error, form, color=colour, ms=3, label=name)
    left.plot(k_n[::3], d["located"], "x", color="0.5", ms=7, label="every switch located")
    left.plot(k_n, 0.4 * d["error"][0, 0] * (k_n / k_n[0]) ** -0.4, "-", color="0.6", lw=0.8)
    left.text(1e11, 9e-7, r"$k_n^{-2/5}$", ha="center", color="0.4")
    log_log(
        left,
        xlabel=r"stiffness $k_n$ ($mg/d^{3/2}$)",
        ylabel=r"RMS $|\Delta\mathbf{c}'|/|c_z|$",
        ylim=(1e-10, 1),
    )
    forms = "^--", "s-", "D-."
    series = zip(SPRING_SERIES, d["error_by_ratio"], d["slope_by_ratio"], forms, strict=True)
    for (_, damping, k), error, (slope, _), form in series:
        label = rf"$k_n={k}$, damping {damping:g}, slope {slope:.2f}"
        other.plot(d["ratio"], error, form, color=spring, ms=3, label=label)
    other.plot(d["ratio"], 2.2e-2 * np.sqrt(3 / d["ratio"]), "-", color="0.6", lw=0.8)
    other.text(60, 2.9e-3, r"ratio$^{-1/2}$", ha="right", color="0.4")
    log_log(other, ylim=(2e-4, 0.3), xlabel=r"tangential stiffness over $k_n\delta^{1/2}$")
    name_panels((left, other), (f"constraint: slope {d['slope'][0]:.3f}", "spring"))
    for ax in (left, other):
        ax.legend(loc="lower left")
    note(figure, f"{scene_words()}; theory at the measured restitution")
    return figure
