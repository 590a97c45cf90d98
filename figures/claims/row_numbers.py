"""The measured numbers that `claims.toml` names, with their errors, from the figures' own data."""

import numpy as np

from impact import collide, drift, flat_ended_rod, landing_density, spherocylinder
from md.scene import from_tables
from md.sweep import Sweep

from ..checks import appendix_a, landing_census, phase_friction
from ..cost.accuracy_cost_impact import gear_from_leapfrog
from ..lib import runs as rows
from ..lib import soft_impacts as soft
from ..paper import fig12, fig13
from . import annulus_numbers as measured_ring
from . import law_numbers as law_claims
from .law_numbers import rms
from .number import Number, count, off_line, onset, resampled, standard
from .register import CLEAR, MEASURES, measures, over, table

__all__ = ["MEASURES", "measured_ring", "sweeps", "table"]  # the annulus registers itself


@measures("S1", "mean", "spread", "head_on", "nearest")
def _restitution(quick):
    d = table("appendix_a", quick)
    one = int(np.argmin(abs(d["speed"] - 1)))
    e, step = d["restitution"][0, 0, 0, one], float(d["step_error"])
    nearest = appendix_a.miss(d["restitution"][..., one, :], -1).min()
    for value in (e.mean(), np.ptp(e), e[0], nearest):
        yield Number(value, step, "halved step")


@measures("S2", "rms", "largest")
def _tilt(quick):
    d = table("fig06", quick)
    for measure in (rms, lambda off: np.abs(off).max()):
        yield resampled(d, lambda d, m=measure: m(d["tilt_deg"] - d["nominal_deg"]), "tilt_deg")


@measures("S3", "forward", "driven")
def _forward(quick):
    d, grid = table("fig13", quick), table("fig02", quick)
    yield count(np.mean(d["a_c_x"] > CLEAR * d["a_c_x_error"]))
    yield count(np.mean(grid["kind"][grid["gamma"] >= 1.6] == 1))


def _cut(quick: bool) -> dict[str, np.ndarray]:
    """Drift over friction at the restitution of the other figures."""
    d = table("phase_friction", quick)
    at = int(np.abs(d["restitution"] - rows.RESTITUTION).argmin())
    cut = {name: d[name][:, at] for name in ("c_x", "c_x_error", "V_z", "theory")}
    return {**cut, "friction": d["friction"], "place": at}


@measures("S7", "change", "without", "friction")
def _friction(quick):
    d = _cut(quick)
    yield resampled(d, lambda d: d["c_x"][-1] / d["c_x"][-2] - 1, "c_x")
    yield resampled(d, lambda d: d["c_x"][0] / d["c_x"].max(), "c_x")
    yield count(d["friction"][d["c_x"].argmax()])


@measures("S9", "power", "onset", "bend", "slope", "zero")
def _over_gamma(quick):
    d = table("fig13", quick)
    f, far = fig13.fits(d), d["gamma"] >= 2
    yield standard(f["power"], f["power_error"])
    yield onset(d["gamma"], d["b_c_x"] > CLEAR * d["b_c_x_error"])

    def bend(d):
        return off_line(d["gamma"][far], d["b_c_x"][far]) / d["b_c_x"][far].mean()

    yield resampled(d, bend, "b_c_x")
    yield standard(f["line_slope"], f["line_slope_error"])
    yield resampled(d, lambda d: fig13.fits(d)["line_from"], "b_c_x")


@measures("S10", "spin", "kept", "touches", "landings")
def _before_and_after(quick):
    d, rods = table("fig06", quick), from_tables(rows.ROW).rods
    per_spin = rods.length * rods.diameter_cm / 2 / d["speed"]
    yield resampled(d, lambda d: rms(d["omega_before"]) * per_spin, "omega_before")
    pair = "omega_before", "omega_after"
    yield resampled(d, lambda d: rms(d[pair[0]]) / rms(d[pair[1]]), *pair)
    for kind in ("", "merged_"):
        pair = f"{kind}c_x_before", f"{kind}c_x_after"
        yield resampled(d, lambda d, pair=pair: rms(1 - d[pair[0]] / d[pair[1]]), *pair)


@measures("S11", "touches", "landings", "driven", "smallest", "largest")
def _turned_round(quick):
    def ratio(kind):
        return lambda d: -d[f"{kind}c_z_before"] / d[f"{kind}c_z_after"]

    d, pair = table("fig06", quick), ("c_z_before", "c_z_after")
    touches, landings = ratio(""), ratio("merged_")
    yield resampled(d, lambda d: rms(1 - touches(d)), *pair)
    yield resampled(d, lambda d: rms(1 - landings(d)), *(f"merged_{name}" for name in pair))
    sweep = fig13.sweeps(quick)["gamma"]
    far = sweep.values("plate.acceleration") >= 2
    driven = over(sweep, **{name: f"merged.{name}.mean" for name in pair})
    yield resampled(driven, lambda d: np.abs(1 - touches(d))[far].max(), *pair)
    yield resampled(d, lambda d: touches(d).min(), *pair)
    yield resampled(d, lambda d: touches(d).max(), *pair)


@measures("S12", "mean", "spread", "by_speed")
def _plate_velocity(quick):
    d = table("fig06", quick)
    yield resampled(d, lambda d: d["plate"].mean(), "plate")
    yield resampled(d, lambda d: np.ptp(d["plate"]), "plate")
    yield resampled(d, lambda d: d["plate_by_speed"].mean(), "plate_by_speed")


def _ends(quick: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nominal tilts; which are small, and which are large."""
    nominal = rows.tilts(quick)
    return nominal, nominal < law_claims.SMALL_DEG, nominal > law_claims.LARGE_DEG


@measures("S13", "small", "large", "change", "sharp")
def _flights(quick):
    d, (nominal, small, large) = table("fig07", quick), _ends(quick)
    name = "merged_flight"
    yield resampled(d, lambda d: d[name][small].mean(), name)
    yield resampled(d, lambda d: rms(d[name][large] - 1), name)

    def change(d):
        found = law_claims.change_tilt({"flight": d[name], "nominal": nominal})
        return found if np.isfinite(d[name]).all() and np.isfinite(found) else np.inf

    def sharp(d):
        before, after = np.interp([25, 35], nominal, d[name])
        return (before - after) / (d[name].max() - 1)

    yield resampled(d, change, name)
    yield resampled(d, sharp, name)


@measures("S14", "distance", "small", "large", "less")
def _phases(quick):
    d, (_, small, large) = table("fig08", quick), _ends(quick)
    H, share = landing_density(d["phase"]), "merged_falling"
    yield resampled(d, lambda d: np.pi * np.abs(d["density"] - H).mean(), "density")
    yield resampled(d, lambda d: d[share][small].mean(), share)
    yield resampled(d, lambda d: d[share][large].mean(), share)
    yield resampled(d, lambda d: d[share][small].mean() - d[share][large].mean(), share)


@measures("S15", "printed", "printed_regimes", "coulomb", "coulomb_regimes", "seen")
def _soft_impact(quick):
    d = table("fig12", quick)
    some = np.isclose(d["tilt"], soft.TABLE_TILTS[:, None]).any(axis=0)
    theory = soft.rigid(d["tilt"][some], fig12.EPSILON).regime
    for law in ("appendix_a", "coulomb"):
        i = list(fig12.SOFT).index(law)
        yield Number(d["rms_constant"][i], d["step_error"][i], "halved step")
        yield count((d["regime"][i, some] == theory).sum())
    yield count(len(set(d["regime"][i, some])))


@measures("S16", "distance", "peak", "bump", "peak_tilt", "peak_theory")
def _over_tilt(quick):
    d = table("fig13", quick)
    fine_deg, line = np.degrees(d["fine"]), d["thin"] * d["speed"] / 2

    def distance(d):
        theory = np.interp(d["a_tilt"], fine_deg, line)
        return rms(d["a_c_x"] - theory) / rms(theory)

    yield resampled(d, distance, "a_c_x", "a_tilt")
    yield resampled(d, lambda d: d["a_c_x"].max() / line.max(), "a_c_x")
    f = fig13.fits(d)
    yield standard(f["bump"], f["bump_error"])
    yield resampled(d, lambda d: d["a_tilt"][d["a_c_x"].argmax()], "a_c_x")
    yield Number(fine_deg[line.argmax()])


@measures("S17", "zero", "bend", "saturation", "spread", "peak")
def _over_length(quick):
    d, name = table("fig13", quick), "c_c_x"
    length = d["length"]
    grows, long = length <= 2, length >= 3

    def zero(d):
        slope, at = np.polyfit(length[grows], d[name][grows], 1)
        return -at / slope

    def saturation(d):
        level = 0.9 * d[name][long].mean()
        j = int(np.argmax(d[name] >= level))
        before = max(j - 1, 0)
        return np.interp(level, d[name][[before, j]], length[[before, j]])

    def spread(d):
        return np.ptp(d[name][long]) / d[name][long].mean()

    yield resampled(d, zero, name)
    yield resampled(d, lambda d: off_line(length[grows], d[name][grows]) / d[name][grows][-1], name)
    yield resampled(d, saturation, name)
    yield resampled(d, spread, name)
    yield resampled(d, lambda d: length[d[name].argmax()], name)


@measures("S19", "coulomb", "printed")
def _gear(_):
    for _, largest in gear_from_leapfrog():
        yield Number(largest)


def _census(quick: bool, name: str) -> Number:
    """A measure of the touches of one row, with its standard error."""
    return standard(*rows.gathered(landing_census.one_row(quick), name)[0])


@measures("S21", "largest", "mean", "weighted")
def _slides(quick):
    d, (nominal, _, _) = over(rows.tilt_plan(quick), slide="landings.slide.mean"), _ends(quick)
    yield resampled(d, lambda d: d["slide"].max(), "slide")
    yield resampled(d, lambda d: d["slide"][nominal > 12].mean(), "slide")
    yield _census(quick, "slide")


@measures("S22", "contact", "pushed", "touches", "map", "map_isolated")
def _isolated(quick):
    names = {"contact": "landings.contact_periods.mean", "pushed": "landings.not_isolated.mean"}
    d = over(rows.tilt_plan(quick), touches="merged.touches.mean", **names)
    for name in ("contact", "pushed", "touches"):
        yield resampled(d, lambda d, name=name: d[name].mean(), name)
    yield _census(quick, "residual")
    yield _census(quick, "isolated_residual")


@measures(
    *("S23", "zero", "bend", "lowest", "agree", "backwards", "backwards_negative", "negative"),
    *("lone_lowest", "lone_drift"),
)
def _onset(quick):
    d, grid, lone = (table(name, quick) for name in ("fig13", "fig02", "alpha"))
    gamma, near = d["gamma"], d["gamma"] <= 1.4

    def bend(d):
        x, y = gamma[near] - 1, (gamma * d["b_V_z"])[near]  # V_0 grows with Gamma
        return rms(y - (x @ y) / (x @ x) * x) / rms(y)

    yield onset(gamma, d["b_V_z"] > 0)
    yield resampled(d, bend, "b_V_z")
    yield resampled(d, lambda d: d["b_V_z"][near].min(), "b_V_z")
    early = grid["gamma"] <= 1.6
    kind, sign = grid["kind"], np.sign(grid["V_z"])
    clear = kind[early] != 0
    yield count(np.mean((kind == sign)[early][clear]) if clear.any() else np.nan)
    for which in (kind < 0, (kind < 0) & (sign < 0), sign < 0):
        yield count(which.sum())
    alpha, c_x = lone["gamma_alpha_impulse"], lone["gamma_drift"]
    at = np.unravel_index(np.nanargmin(alpha), alpha.shape)
    yield standard(alpha[at], lone["gamma_alpha_impulse_error"][at])
    at = np.unravel_index(np.nanargmin(np.where(alpha < 0, c_x, np.nan)), c_x.shape)
    yield standard(c_x[at], lone["gamma_drift_error"][at])


@measures("S24", "spread", "low", "high")
def _tilt_over_gamma(quick):
    d = table("fig13", quick)
    yield resampled(d, lambda d: np.ptp(d["b_tilt"]), "b_tilt")
    for end in (0, -1):
        yield standard(d["b_tilt"][end], d["b_tilt_error"][end])


FREQUENCIES_HZ, FREQUENCY_TILTS_DEG = (50, 60, 75, 100), (10, 21, 40)
SLIPPERY = 2e-3  # friction of the plate


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """What no figure shows: over frequency and tilt; a slippery plate, for as long as it takes."""
    axes = [
        {"plate.frequency_hz": [50, 100] if quick else [*FREQUENCIES_HZ]},
        {"box.length": rows.boxes(np.array(FREQUENCY_TILTS_DEG))},
        {"start.seed": [1, 2] if quick else [1, 2, 3]},
    ]
    long = {"box.length": phase_friction.BOX, "rods.inertia": "solid"}
    long["contacts.plate.friction"] = SLIPPERY
    return {
        "frequency": rows.planned(axes, 50 if quick else 150),
        "slippery": rows.planned([{"start.seed": [1, 2]}], 200 if quick else 1500, long),
    }


@measures("S25", "forward", "factor", "regimes", "trend")
def _frequency(quick):
    sweep = sweeps(quick)["frequency"]
    regimes = {name: f"landings.{name}.mean" for name in ("slide", "slip_stick", "slip_reversal")}
    d, scenes = over(sweep, c_x="c_x", **regimes), [point.scene for point in sweep.points]
    speed = np.reshape([scene.plate_speed for scene in scenes], sweep.shape)[..., 0]
    yield count(np.mean(d["c_x"] > CLEAR * d["c_x_error"]))

    def factor(d):
        scaled = d["c_x"] / speed
        return (scaled.max(axis=0) / scaled.min(axis=0)).max()

    yield resampled(d, factor, "c_x")
    yield resampled(d, lambda d: max(np.ptp(d[name], axis=0).max() for name in regimes), *regimes)
    yield resampled(d, lambda d: (d["c_x"][-1] / d["c_x"][0] * speed[0] / speed[-1]).mean(), "c_x")


def _landings_of_closure(rod, friction: float, landings: int) -> float:
    """Landings in which the closure, impact by impact, comes e times as near its drift."""
    setting = {"friction": friction, "restitution": rows.RESTITUTION, "plate_velocity": 1.0}
    aim = drift(rod, **setting)
    c_x, c_z, left = aim.c_x / 2, aim.c_z, []
    for _ in range(landings):
        hit = collide(c_x, -c_z, geometry=rod, **setting)
        c_x, c_z = hit.c_x, hit.c_z
        left.append(aim.c_x - c_x)
    half = landings // 2
    return (landings - 1 - half) / np.log(left[half] / left[-1])


@measures("S26", "short", "long", "largest", "rate", "limit", "made")
def _without_friction(quick):
    d, sweep = _cut(quick), sweeps(quick)["slippery"]
    yield resampled(d, lambda d: d["c_x"][0] / d["c_x"].max(), "c_x")
    by_speed = "landings.plate_velocity_by_speed.mean"
    names = {"V_z": by_speed, "often": "merged.per_rod_and_period.mean"}
    long = over(sweep, c_x="c_x_cm_s", **names)
    rod = spherocylinder(np.arccos(rows.COUNT / phase_friction.BOX), rows.LENGTH)
    low, middle, high = (
        drift(rod, friction=mu, restitution=rows.RESTITUTION).c_x for mu in (1e-9, SLIPPERY, np.inf)
    )
    speed = rows.plate_speed_cm_s()
    yield resampled(long, lambda d: d["c_x"] / (d["V_z"] * speed * middle), "c_x", "V_z")
    yield resampled({**d, **long, "all": d["c_x"]}, lambda d: d["c_x"] / d["all"].max(), "c_x")
    needed = int(rod.X * rod.Z / (2 * SLIPPERY * rod.k**2))
    yield Number(_landings_of_closure(rod, SLIPPERY, needed) / needed)
    yield Number(low / high)
    yield count(long["often"] * sweep.points[0].periods / needed)


@measures("E3", "threshold", "slower", "always", "below")
def _flat_end(quick):
    d = table("tip_shape", quick)
    setting = {"friction": rows.FRICTION, "restitution": rows.RESTITUTION}
    tilt, edge = d["tilt"], float(d["flat_threshold"])
    length, at = float(d["length"]), np.radians(28)
    yield Number(np.degrees(edge))
    pair = (make(at, length) for make in (flat_ended_rod, spherocylinder))
    flat, whole = (drift(rod, **setting).c_x for rod in pair)
    yield Number(flat / whole)
    beyond, below = tilt > edge, (tilt > 0) & (tilt < edge)
    yield Number((d["flat"] / np.where(beyond, d["round"], np.inf)).max())
    yield Number(d["flat"][below].min())
