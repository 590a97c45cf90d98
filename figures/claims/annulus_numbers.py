"""Numbers of the claims about the annulus, and of the experiment's geometry and map of drift."""

import numpy as np

from md.placement import largest_tilt

from ..lib import runs
from ..paper import fig02, fig04
from .number import Number, count, off_line, onset, resampled, standard
from .register import CLEAR, measures, table

VISIBLE = 0.02  # of the drift at the largest Gamma: what can be seen to move in a figure
UPRIGHT_DEG, HALF_ORDER = 11.0, 0.5  # the small tilt of Fig. 5(a), generously; a broken zig-zag
REGION_DEG = 5.0  # contrast of tilts that makes a region


def _over_tilt(quick: bool, name: str = "still") -> dict[str, Number]:
    """What `fig04.shape` tells of the drift over tilt."""
    d, pair = table("fig04", quick), (f"{name}_tilt", f"{name}_c_x")
    keys = fig04.shape(*(d[key] for key in pair))
    return {
        key: resampled(d, lambda d, key=key: fig04.shape(d[pair[0]], d[pair[1]])[key], *pair)
        for key in keys
    }


@measures("S4", "bend", "slope", "early", "late", "dip", "end")
def _drift_over_tilt(quick):
    yield from (_over_tilt(quick)[key] for key in ("bend", "slope", "early", "late", "dip", "end"))


@measures("S5", "onset", "first", "last", "bend", "slope", "zero")
def _drift_over_gamma(quick):
    d = table("fig04", quick)
    gamma, c_x = d["gamma"], d["gamma_c_x"]
    seen = (c_x > CLEAR * d["gamma_c_x_error"]) & (c_x > VISIBLE * c_x[-1])
    begins = [onset(gamma, moves) for moves in seen.T]
    values = [number.value for number in begins]
    yield Number(np.mean(values), np.mean([n.error for n in begins]), "half interval")
    yield count(min(values))
    yield count(max(values))
    far = gamma >= 2

    def lines(d):
        return np.polyfit(gamma[far], d["gamma_c_x"][far], 1)

    def bend(d):
        curves = d["gamma_c_x"][far].T
        return max(off_line(gamma[far], y) / y.mean() for y in curves)

    yield resampled(d, bend, "gamma_c_x")
    yield resampled(d, lambda d: lines(d)[0].mean(), "gamma_c_x")
    yield resampled(d, lambda d: np.mean(-lines(d)[1] / lines(d)[0]), "gamma_c_x")


def _at(d: dict, name: str, friction: float) -> float:
    return float(np.interp(friction, d[name], d[f"{name}_c_x"]))


@measures("S6", "rise", "all", "paper")
def _walls(quick):
    d = table("fig04", quick)

    def rise(d):
        return np.diff(d["wall_c_x"]).max() / d["wall_c_x"].max()

    yield resampled(d, rise, "wall_c_x")
    yield resampled(d, lambda d: d["wall_c_x"][-1] / d["wall_c_x"][0], "wall_c_x")
    yield resampled(d, lambda d: _at(d, "wall", 0) / _at(d, "wall", 0.3), "wall_c_x")


@measures("S8", "order", "tilt", "broken", "appears", "leaning", "share", "contrast", "spread")
def _zigzag(quick):
    d = table("fig05", quick)
    low, order = d["mean"] <= UPRIGHT_DEG, d["zigzag"]
    best = int(np.argmax(np.where(low, order, -np.inf)))
    yield standard(order[best], d["zigzag_error"][best])
    yield standard(d["mean"][best], d["mean_error"][best])

    def first(d, values):
        """Tilt at which the values first become negative, between two numbers of rods."""
        rank = np.argsort(d["mean"])
        tilt, values = d["mean"][rank], values[rank]
        j = int(np.argmax(values < 0))
        if values[j] >= 0:
            return np.inf
        i = max(j - 1, 0)
        return float(np.interp(0, values[[j, i]], tilt[[j, i]]) if i < j else tilt[0])

    yield resampled(d, lambda d: first(d, d["zigzag"] - HALF_ORDER), "mean", "zigzag")
    yield resampled(d, lambda d: first(d, REGION_DEG - d["contrast"]), "mean", "contrast")
    at = int(np.argmin(np.abs(d["count"] - runs.ANNULUS_COUNT)))
    for name in ("mean", "share", "contrast", "spread"):
        yield standard(d[name][at], d[f"{name}_error"][at])


@measures("S18", "ratio", "smooth")
def _plane_to_annulus(quick):
    d = table("fig04", quick)
    names = ("still_c_x", "plane_c_x")
    low, high = d["plane_tilt"].min(), min(d["plane_tilt"].max(), 45)
    inside = (d["still_tilt"] >= max(low, 10)) & (d["still_tilt"] <= high)

    def plane(d, tilt):
        return np.interp(tilt, d["plane_tilt"], d["plane_c_x"])

    def ratio(d):
        return plane(d, d["still_tilt"][inside]).sum() / d["still_c_x"][inside].sum()

    yield resampled(d, ratio, *names)
    both = ("wall_c_x", "plane_c_x")
    yield resampled(d, lambda d: plane(d, d["wall_tilt"][0]) / d["wall_c_x"][0], *both)


@measures("S20", "kept", "dip", "still_dip", "faster")
def _rolling(quick):
    d = table("fig04", quick)
    pairs = ("still_tilt", "still_c_x", "rolling_tilt", "rolling_c_x")

    def dips(d):
        return [fig04.shape(d[f"{n}_tilt"], d[f"{n}_c_x"])["dip"] for n in ("still", "rolling")]

    def kept(d):
        still, rolling = dips(d)
        return rolling / still if still > 0 else np.nan

    without = _over_tilt(quick)["dip"].value > 0
    yield resampled(d, kept, *pairs) if without else count(np.inf)
    yield _over_tilt(quick, "rolling")["dip"]
    yield _over_tilt(quick)["dip"]
    between = (d["still_tilt"] > fig04.MAXIMA_DEG[0]) & (d["still_tilt"] < fig04.MAXIMA_DEG[1])

    def faster(d):
        return d["rolling_c_x"][between].mean() / d["still_c_x"][between].mean()

    yield resampled(d, faster, "still_c_x", "rolling_c_x")


@measures("E1", "flat", "round", "steepest", "most")
def _geometry(quick):
    gap, length = runs.ANNULUS_SCENE.annulus, runs.ANNULUS_SCENE.rods.length
    for flat in (True, False):
        yield Number(np.degrees(largest_tilt(gap, length, flat=flat)))
    d = table("fig04", quick)
    for at in (d["count"].argmin(), d["count"].argmax()):
        yield standard(d["still_tilt"][at], d["still_tilt_error"][at])


@measures(
    *("E2", "onset", "early", "points", "slower", "end", "follows"),
    *("ring_onset", "ring_back", "ring_slower", "ring_follows"),
)
def _map_of_drift(quick):
    d = table("fig02", quick)
    yield onset(d["gamma"], (d["kind"] == 1).all(axis=1))
    yield count(np.mean(d["kind"][d["gamma"] < 1.5] == 1))
    back, slower = _reverse(d["c_x"], d["c_x_error"], d["kind"])
    yield count(back.sum())
    yield slower
    yield onset(d["gamma"], ~back.any(axis=1)) if back.any() else count(np.inf)
    yield _follows(d, "kind", "V_z")
    yield onset(d["gamma"], (d["ring_kind"] == 1).all(axis=1))
    back, slower = _reverse(d["ring_c_x"], d["ring_c_x_error"], d["ring_kind"])
    yield count(back.sum())
    yield slower
    yield _follows(d, "ring_kind", "ring_V_z")


def _follows(d: dict, kind: str, plate: str) -> Number:
    """Share of the drifts up to Gamma = 1.6 that have the sign of the plate's mean velocity."""
    early = d["gamma"] <= fig02.ONSET
    kind, sign = d[kind][early], np.sign(d[plate][early])
    return count(np.mean((kind == sign)[kind != 0]))


def _reverse(c_x: np.ndarray, error: np.ndarray, kind: np.ndarray) -> tuple[np.ndarray, Number]:
    """Points of reverse drift; the fastest of them over the median drift at the largest Gamma."""
    back, forward = kind == -1, np.median(c_x[-1])
    if not back.any():
        return back, standard(0, np.nan)
    at = np.unravel_index(np.where(back, -c_x, -np.inf).argmax(), c_x.shape)
    return back, standard(-c_x[at] / forward, error[at] / forward)
