"""Numbers of the claims on the annulus, on the experiment's geometry (E1) and on Fig. 2 (E2).

A function that `measures` a claim takes a figure's data and returns `Numbers` by the keys that
claims.toml gives them.
"""

from math import cos, hypot, pi, sin

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import norm

from md import Annulus
from md.placement import largest_tilt

from ..lib import runs
from ..lib.arrangement import MORE_DEG
from ..paper import fig02, fig04
from .uncertainty import (
    Number,
    Numbers,
    among,
    bend,
    count,
    crossing,
    entry,
    exponents,
    measures,
    onset,
    resampled,
    standard,
)

VISIBLE = 0.02  # of the drift at the largest Gamma: what can be seen to move in a figure
UPRIGHT_DEG, HALF_ORDER = 11.0, 0.5  # the small tilt of Fig. 5(a), generously; a broken zig-zag
REGION_TILT_DEG = 25.0  # mean tilt at which the region of larger tilt holds half of the rods
REGION_DEG = 5.0  # contrast of tilts that makes a region


def sweeps(quick: bool = False) -> runs.Sweeps:
    """Sweeps of the claims that no figure shows: annuli and rows under the simple law."""
    return fig04.sweeps(quick, assumed=True)


def _part(d: dict, name: str, key: str) -> float:
    """A number that `fig04.shape` gives of the drift over tilt."""
    return fig04.shape(d[f"{name}_tilt"], d[f"{name}_c_x"])[key]


def _shape(d: dict, name: str, key: str) -> Number:
    """The same with its error."""
    found = resampled(d, lambda d: _part(d, name, key))
    return among(found, d[f"{name}_tilt"]) if key in ("early", "late") else found


@measures("S4", "fig04")
def drift_over_tilt(d):
    keys = "bend", "slope", "early", "late", "dip", "end"
    wanted = {key: ("still", key) for key in keys} | {
        "narrow": ("narrow", "end"),
        "rest_dip": ("rest", "dip"),
        "rest_late": ("rest", "late"),
    }
    return {key: _shape(d, *of) for key, of in wanted.items() if f"{of[0]}_c_x" in d}


def begins(d: dict, name: str) -> Numbers:
    """Smallest Gamma from which on rods drift: beyond errors, and so that one sees it in a figure.

    The mean over further axes.
    """
    c_x = d[name].reshape(len(d["gamma"]), -1)
    forward = fig02.classify(c_x, d[f"{name}_error"].reshape(c_x.shape)) == 1
    found = {}
    for key, moves in ("onset", forward), ("visible", forward & (c_x > VISIBLE * c_x[-1])):
        value, half, notion = zip(*(onset(d["gamma"], one) for one in moves.T), strict=True)
        found[key] = Number(np.mean(value), np.mean(half), notion[0])
    return found


@measures("S5", "fig04")
def drift_over_gamma(d):
    gamma = d["gamma"]
    far = gamma >= 2

    def lines(d):
        return np.polyfit(gamma[far], d["gamma_c_x"][far], 1)

    return {
        **begins(d, "gamma_c_x"),
        "rest": begins(d, "rest_gamma_c_x")["visible"] if "rest_gamma_c_x" in d else count(np.nan),
        "bend": lambda d: max(bend(gamma[far], y) for y in d["gamma_c_x"][far].T),
        "slope": lambda d: lines(d)[0].mean(),
        "zero": lambda d: np.mean(-lines(d)[1] / lines(d)[0]),
    }


@measures("S6", "fig04")
def walls(d):
    rough = d["wall"] > 0
    return {
        "rise": lambda d: exponents(d["wall"][rough], d["wall_c_x"][rough]).max(),
        "all": lambda d: d["wall_c_x"][-1] / d["wall_c_x"][0],
        "paper": lambda d: np.divide(*np.interp([0, 0.3], d["wall"], d["wall_c_x"])),
    }


@measures("S8", "fig05")
def zigzag(d):
    best = np.argmax(np.where(d["mean"] <= UPRIGHT_DEG, d["zigzag"], -np.inf))
    at = runs.nearest(d["mean"], REGION_TILT_DEG)

    def first(values):
        """Tilt at which the values first become negative, between two numbers of rods."""

        def tilt(d):
            rank = np.argsort(d["mean"])
            return crossing(d["mean"][rank], values(d)[rank], 0)

        return tilt

    return {
        "order": entry(d, "zigzag", best),
        "tilt": entry(d, "mean", best),
        "broken": first(lambda d: d["zigzag"] - HALF_ORDER),
        "appears": first(lambda d: REGION_DEG - d["contrast"]),
        "rods": count(d["count"][at]),
        "leaning": entry(d, "mean", at),
        **{name: entry(d, name, at) for name in ("share", "contrast", "spread")},
        "normal": lambda d: norm.sf(MORE_DEG / d["spread"][at]),
    }


@measures("S18", "fig04")
def plane_to_annulus(d):
    plane_tilt, tilt, smooth_tilt = d["plane_tilt"], d["still_tilt"], d["wall_tilt"][0]
    inside = (tilt >= max(plane_tilt.min(), 10)) & (tilt <= min(plane_tilt.max(), 45))

    def ratio(d):
        still = d["still_c_x"][inside].sum()
        return np.interp(tilt[inside], plane_tilt, d["plane_c_x"]).sum() / still

    def smooth(d):
        wall = d["wall_c_x"][0]
        return np.interp(smooth_tilt, plane_tilt, d["plane_c_x"]) / wall

    return {"ratio": ratio, "smooth": smooth}


@measures("S20", "fig04")
def rolling(d):
    alike = np.isin(d["count"], d["rolling"])
    tilt = d["still_tilt"][alike]
    first, second = fig04.MAXIMA_DEG
    between = (tilt > first) & (tilt < second)

    def kept(d):
        still = _part(d, "still", "dip")
        return _part(d, "rolling", "dip") / still if still > 0 else np.nan

    def faster(d):
        still = d["still_c_x"][alike]
        return d["rolling_c_x"][between].mean() / still[between].mean()

    still_dip = _shape(d, "still", "dip")
    return {
        "kept": kept if still_dip.value > 0 else count(np.inf),
        "dip": _shape(d, "rolling", "dip"),
        "still_dip": still_dip,
        "faster": faster,
    }


def largest_tilt_of_flat(gap: Annulus, length: float) -> float:
    """Largest tilt, rad, of a rod with one flat end, as those of the experiment, in the gap.

    One end is a disc across the axis, the other a cap; the middle touches the inner wall. Source:
    contact of the rim of the disc, or of the cap, with the outer cylinder.
    """
    off, turn = gap.inner + 0.5, np.linspace(0, 2 * pi, 721)

    def room(tilt: float) -> float:
        """What the outer wall leaves at the worse end, for the best place along the annulus."""
        rim_x, rim_y = 0.5 * np.cos(turn) * cos(tilt), off + 0.5 * np.sin(turn)

        def tightness(shift: float) -> float:
            disc = np.hypot(shift + length / 2 * sin(tilt) + rim_x, rim_y).max()
            cap = 0.5 + hypot(shift - (length / 2 - 0.5) * sin(tilt), off)
            return max(disc, cap)

        return gap.outer - minimize_scalar(tightness, (-0.1, 0.1), options={"xtol": 1e-12}).fun

    return pi / 2 if room(pi / 2) >= 0 else brentq(room, 0.0, pi / 2, xtol=1e-10)


@measures("E1", "fig04")
def geometry(d):
    scene = runs.ANNULUS_SCENE
    gap, length = scene.annulus, scene.rods.length
    return {
        "flat": Number(np.degrees(largest_tilt_of_flat(gap, length))),
        "round": Number(np.degrees(largest_tilt(gap, length))),
        "steepest": entry(d, "still_tilt", d["count"].argmin()),
        "most": entry(d, "still_tilt", d["count"].argmax()),
    }


@measures("E2", "fig02")
def map_of_drift(d):
    gamma, kind = d["gamma"], d["kind"]
    row = reverse_drift(d)
    back = (kind == -1).any(axis=1)
    return {
        "points": row.pop("back"),
        **row,
        "early": count(np.mean(kind[gamma < 1.5] == 1)),
        "end": onset(gamma, ~back) if back.any() else count(np.inf),
        **{f"ring_{key}": number for key, number in reverse_drift(d, "ring_").items()},
    }


def reverse_drift(d: dict, prefix: str = "") -> Numbers:
    """Onset of forward drift, points of reverse drift, and the fastest of them.

    slower : over the median drift at the largest Gamma
    follows : share of drifts up to Gamma = 1.6 with the sign of the plate's mean velocity
    """
    c_x, error, kind, V_z = (d[f"{prefix}{name}"] for name in ("c_x", "c_x_error", "kind", "V_z"))
    back, forward = kind == -1, np.median(c_x[-1])
    at = np.unravel_index(np.where(back, -c_x, -np.inf).argmax(), c_x.shape)
    early = (d["gamma"] <= fig02.ONSET)[:, None] & (kind != 0)
    same = (kind == np.sign(V_z))[early]
    return {
        "onset": onset(d["gamma"], (kind == 1).all(axis=1)),
        "back": count(back.sum()),
        "slower": standard(-c_x[at] / forward, error[at] / forward) if back.any() else count(0),
        "follows": count(np.mean(same) if same.size else np.nan),
    }
