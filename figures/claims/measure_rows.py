"""Numbers of the claims on one impact and on plane rows, and of E3, from the figures' own data.

A function that `measures` a claim takes a figure's data, `d`, or all evidence, `data`, and returns
`Numbers` by the keys that claims.toml gives them. What the paper's row over tilt tells is in
`over_tilt`.
"""

import numpy as np
from scipy.optimize import minimize_scalar

import impact
import md
from impact import drift, flat_ended_rod, spherocylinder

from ..checks import appendix_a, closure, phase_friction
from ..lib import runs as rows
from ..lib import soft_impacts as soft
from ..lib.style import Data
from ..paper import fig02, fig12, fig13
from . import gear, over_tilt
from .evidence import Evidence, Whole
from .measure_annulus import begins, reverse_drift
from .over_tilt import CLEAR
from .uncertainty import (
    Number,
    bend,
    count,
    crossing,
    entry,
    exponents,
    measures,
    off_line,
    onset,
    peak,
    resampled,
    rms,
    standard,
)

LEFT = "printed", "V_z", "turned", "restitution"  # of `closure.STEPS`
LEFT_OF_LANDINGS = "V_z", "turned", "spin"  # of these as well


@measures("S1", "appendix_a")
def restitution(d):
    e = d["restitution"][0, 0, 0]
    found = {
        "mean": e.mean(),
        "spread": np.ptp(e),
        "head_on": e[0],
        "nearest": appendix_a.miss(d["restitution"]).min(),
    }
    return {key: Number(value, d["step_error"], "halved step") for key, value in found.items()}


@measures("S3")
def forward(data):
    grid = data.figure("fig02")
    return {
        "forward": count(over_tilt.NUMBERS["S3.forward"](data.over_tilt)),  # not resampled
        "driven": count(np.mean(grid["kind"][grid["gamma"] >= fig02.ONSET] == 1)),
    }


def _cut(data: Evidence) -> Data:
    """Drift [cm/s] of the row over friction, at the restitution of the figures' law."""
    d = data.figure("phase_friction")
    at = rows.nearest(d["restitution"], phase_friction.OF_LAW)
    return {"friction": d["friction"], **{name: d[name][:, at] for name in ("c_x", "c_x_error")}}


@measures("S7")
def friction(data):
    d, annulus = _cut(data), data.figure("fig04")
    return {
        "ring_change": resampled(annulus, lambda d: exponents(d["plate"], d["plate_c_x"])[-1]),
        "ring_without": resampled(annulus, lambda d: d["plate_c_x"][0] / d["plate_c_x"].max()),
        "change": resampled(d, lambda d: exponents(d["friction"], d["c_x"])[-1]),
        "without": resampled(_slippery(data), _part_of_largest),
        "friction": count(d["friction"][d["c_x"].argmax()]),
    }


@measures("S9", "fig13")
def over_gamma(d):
    f, far = fig13.fits(d), d["gamma"] >= 2
    return {
        "power": standard(f["power"], f["power_error"]),
        **begins(d, "gamma_c_x"),
        "bend": lambda d: bend(d["gamma"][far], d["gamma_c_x"][far]),
        "slope": standard(f["line_slope"], f["line_slope_error"]),
        "zero": lambda d: fig13.fits(d)["line_from"],
    }


@measures("S11")
def turned_round(data):
    sweep = fig13.sweeps(data.quick)["gamma"]
    names = {"before": "landings.c_z_before.mean", "after": "landings.c_z_after.mean"}
    far = sweep.values("plate.acceleration") >= 2  # near 1 no rod lands
    d = Whole({name: values[far] for name, values in rows.means(sweep, names).items()})
    return {"driven": resampled(d, lambda d: np.abs(1 + d["before"] / d["after"]).max())}


@measures("S15", "fig12")
def soft_impact(d):
    some = np.isclose(d["tilt"], soft.TABLE_TILTS[:, None]).any(axis=0)
    theory = soft.rigid(d["tilt"][some], fig12.EPSILON).regime
    found, laws = {}, list(soft.LAW_WORDS)
    for name, law in (("printed", "appendix_a"), ("coulomb", "coulomb")):
        i = laws.index(law)
        found[name] = Number(d["rms_constant"][i], d["step_error"][i], "halved step")
        found[f"{name}_regimes"] = count((d["regime"][i, some] == theory).sum())
    return {**found, "seen": count(len(set(d["regime"][laws.index("coulomb"), some])))}


@measures("S16")
def theory(data):
    d, of, size = (data.figure(name) for name in ("fig13", "closure", "row_size"))
    steps, usual = list(closure.STEPS), rows.nearest(size["count"], rows.COUNT)
    return {
        **{f"left_{name}": entry(of, "left", steps.index(name)) for name in LEFT},
        **{
            f"landing_{name}": entry(of, "left_landing", steps.index(name))
            for name in LEFT_OF_LANDINGS
        },
        "size": resampled(size, lambda d: (d["c_x"][usual] / d["c_x"][-1]).mean()),
        "peak_tilt": peak(d, "tilt_tilt", "tilt_c_x"),
        "peak_theory": Number(np.degrees(d["fine"])[d["thin"].argmax()]),
    }


@measures("S17", "fig13")
def over_length(d):
    length = d["length"]
    grows, long = length <= 2, length >= 3

    def zero(d):
        slope, at = np.polyfit(length[grows], d["length_c_x"][grows], 1)
        return -at / slope

    return {
        "zero": zero,
        "bend": lambda d: (
            off_line(length[grows], d["length_c_x"][grows]) / d["length_c_x"][grows][-1]
        ),
        "saturation": lambda d: crossing(
            length, -d["length_c_x"], -0.9 * d["length_c_x"][long].mean()
        ),
        "spread": lambda d: np.ptp(d["length_c_x"][long]) / d["length_c_x"][long].mean(),
        "peak": peak(d, "length", "length_c_x"),
    }


@measures("S19")
def integrators(_):
    laws = {"coulomb": md.coulomb(), "printed": md.appendix_a()}
    return {name: Number(gear.difference(law)) for name, law in laws.items()}


@measures("S21")
def slides(data):
    return {"weighted": data.census["slide"]}


@measures("S22")
def isolated(data):
    return {
        "map": data.census["residual"],
        "map_isolated": data.census["isolated_residual"],
        "disturbed": data.census["disturbed"],
    }


@measures("S23")
def near_onset(data):
    d, grid, lone = (data.figure(name) for name in ("fig13", "fig02", "alpha"))
    gamma, near = d["gamma"], d["gamma"] <= 1.4

    def off(d):
        x, y = gamma[near] - 1, (gamma * d["gamma_V_z"])[near]  # V_0 grows with Gamma
        return rms(y - (x @ y) / (x @ x) * x) / rms(y)

    falling = np.where(lone["gamma_alpha_impulse"] < 0, 1, np.nan)

    def least(name):
        """The least where the plate falls at landings, in the mean."""
        at = np.unravel_index(np.nanargmin(falling * lone[name]), falling.shape)
        return entry(lone, name, at)

    reverse, sign, back = reverse_drift(grid), np.sign(grid["V_z"]), grid["kind"] < 0
    return {
        "zero": onset(gamma, d["gamma_V_z"] > 0),
        "bend": resampled(d, off),
        "lowest": resampled(d, lambda d: d["gamma_V_z"][near].min()),
        "agree": reverse["follows"],
        "backwards": reverse["back"],
        "explained": count(np.mean(sign[back] < 0) if back.any() else np.nan),
        "negative": count((sign < 0).sum()),
        "lone_lowest": least("gamma_alpha_impulse"),
        "lone_drift": least("gamma_drift"),
    }


@measures("S24", "fig13")
def tilt_over_gamma(d):
    return {
        "spread": lambda d: np.ptp(d["gamma_tilt"]),
        "low": entry(d, "gamma_tilt", 0),
        "high": entry(d, "gamma_tilt", -1),
    }


FREQUENCIES_HZ, FREQUENCY_TILTS_DEG = [50, 60, 75, 100], (10, 21, 40)
SLIPPERY = [2e-3, 4e-3]  # frictions of the plate


def sweeps(quick: bool = False) -> rows.Sweeps:
    """Sweeps that no figure shows: over frequency and tilt; long runs on a slippery plate."""
    axes = [
        {"plate.frequency_hz": [50, 100] if quick else FREQUENCIES_HZ},
        {"box.length": rows.boxes(FREQUENCY_TILTS_DEG)},
        rows.starts(2 if quick else 3),
    ]
    slippery = [{"contacts.plate.friction": SLIPPERY}, rows.starts(2 if quick else 4)]
    long = {"box.length": rows.BOX, "rods.inertia": "solid"}
    return {
        "frequency": rows.planned(axes, 50 if quick else 150),
        "slippery": rows.planned(slippery, 200 if quick else 3000, long, measure=slow_start),
    }


def relaxation(series: np.ndarray) -> tuple[float, float]:
    """Stationary value c and time T of c [1 - exp(-t/T)], fitted to a series that begins at 0.

    T is at most three times as long as the series: beyond, only c/T is known.
    """
    time = np.arange(len(series)) + 0.5

    def fitted(log_time: float) -> tuple[float, float]:
        shape = -np.expm1(-time / np.exp(log_time))
        value = (shape @ series) / (shape @ shape)
        return ((series - value * shape) ** 2).sum(), value

    best = minimize_scalar(lambda x: fitted(x)[0], bounds=(0.0, np.log(3 * len(series)))).x
    return fitted(best)[1], np.exp(best)


def slow_start(scene: md.Scene, periods: int) -> Data:
    """How the drift of a row begins: stationary value [cm/s], periods to it, what lands how often.

    Starts carry no momentum along the plate, so that it begins at 0.
    """
    run = md.run(scene, periods=periods, ledger=False)
    if not run.finished:
        raise KeyboardInterrupt
    stationary, time = relaxation(run.c_x_series)
    return {
        "stationary": stationary * scene.cm_per_s,
        "relaxation": time,
        "V_z": run.touches["plate_velocity_by_speed"]["mean"],
        "often": run.landings["per_rod_and_period"]["mean"],
    }


def _slippery(data: Evidence) -> Data:
    """Rows on a slippery plate, over friction; the largest drift over all frictions [cm/s]."""
    names = "stationary", "relaxation", "V_z", "often"
    found = rows.means(sweeps(data.quick)["slippery"], {name: name for name in names})
    cut = _cut(data)
    at = cut["c_x"].argmax()
    return Whole(found | {"largest": cut["c_x"][at], "largest_error": cut["c_x_error"][at]})


def _part_of_largest(d: Data) -> float:
    return d["stationary"][0] / d["largest"]


@measures("S25")
def frequency(data):
    sweep = sweeps(data.quick)["frequency"]
    regimes = {name: f"touches.{name}.mean" for name in ("slide", "slip_stick", "slip_reversal")}
    d = Whole(rows.means(sweep, {"c_x": "c_x", **regimes}))
    speed = np.reshape([point.scene.plate_speed for point in sweep.points], sweep.shape)[..., 0]

    def factor(d):
        scaled = d["c_x"] / speed
        return (scaled.max(axis=0) / scaled.min(axis=0)).max()

    return {
        "forward": count(np.mean(d["c_x"] > CLEAR * d["c_x_error"])),
        "factor": resampled(d, factor),
        "regimes": resampled(d, lambda d: max(np.ptp(d[name], axis=0).max() for name in regimes)),
        "trend": resampled(d, lambda d: (d["c_x"][-1] / d["c_x"][0] * speed[0] / speed[-1]).mean()),
    }


@measures("S26")
def without_friction(data):
    d, least = _slippery(data), SLIPPERY[0]
    rod = spherocylinder(rows.BOX_TILT, rows.LENGTH)
    low, middle, high = drift(
        rod, friction=np.array([1e-9, least, np.inf]), restitution=rows.RESTITUTION
    ).c_x
    speed, needed = rows.plate_speed_cm_s(), rod.X * rod.Z / (2 * least * rod.k**2)
    landings = impact.relaxation(rod, friction=least, restitution=rows.RESTITUTION)
    return {
        "stationary": resampled(d, _part_of_largest),
        "theory": resampled(d, lambda d: d["stationary"][0] / (d["V_z"][0] * speed * middle)),
        "twice": resampled(d, lambda d: d["stationary"][1] / d["stationary"][0]),
        "relaxation": resampled(d, lambda d: d["relaxation"][0] * d["often"][0] / needed),
        "faster": resampled(d, lambda d: d["relaxation"][0] / d["relaxation"][1]),
        "rate": Number(landings / needed),
        "limit": Number(low / high),
    }


@measures("E3", "tip_shape")
def flat_end(d):
    tilt = d["tilt"]
    at, shapes = np.radians(28), (flat_ended_rod, spherocylinder)
    flat, whole = (drift(shape(at, d["length"]), **rows.SETTING).c_x for shape in shapes)
    beyond, ahead = tilt > d["flat_threshold"], tilt > 0
    at_28 = rows.nearest(d["bounced_tilt"], at)
    bounced = np.degrees(d["bounced_tilt"])
    return {
        "threshold": Number(crossing(np.degrees(tilt[ahead]), -d["flat"][ahead], 0)),
        "bounced_threshold": lambda d: crossing(bounced, -d["flat_bounced"], 0),
        "slower": Number(flat / whole),
        "always": Number((d["flat"][beyond] / d["round"][beyond]).max()),
        "below": Number(d["flat"][ahead & (tilt < d["flat_threshold"])].min()),
        "bounced": lambda d: d["flat_bounced"][at_28] / d["round_bounced"][at_28],
        "reverse": lambda d: d["flat_bounced"].min(),
    }
