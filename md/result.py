"""Result of a run: its numbers, and the text that the command prints of them."""

import json
from dataclasses import asdict, dataclass
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from .cache import digest
from .domains import as_dict, in_notebook
from .measures import FEWEST, TREND, UNLIKELY, steady, trend, wedged_periods
from .scene import Scene
from .units import in_cm, labelled

if TYPE_CHECKING:
    from xarray import Dataset

NOTHING = 1e-6  # of the plate's peak velocity: a slower drift counts as zero
UNBALANCED = 0.05  # of what is lost, if that is more than 1 m g d: energy that too long steps make
SETTLING = 400  # periods; rods in an annulus rearrange for two hundred (Fig. 5)


@dataclass(frozen=True)
class Accuracy:
    """Error of a drift, and what it cost; velocities are absolute, in sqrt(g d).

    tolerance : asked for, of |c_x| or of the floor, whichever is larger
    confidence : of the interval
    floor : drifts below it are judged as if they were this fast
    error : half of the interval that holds the true drift with this confidence
    statistical : statistical part of the error; it and `bias_error` add in squares
    bias : of the step, which is taken off the drift
    bias_error : half of the interval of the bias
    bias_measured : whether the bias was measured, by starts with steps twice as long; else it is a
        flat allowance
    per_contact : steps in the shortest contact
    starts, made : number of starts that were run, and their periods in all
    chance : that starts differ as they do if they are in one state
    fell : rods that fell over behind the transients, of all starts
    state : "not settled" if the drift of a start still trends, or the rate at which its rods fall
        over; else "reached" if error <= tolerance max(|c_x|, floor), else "not reached"
    seconds : of the run, without compiling
    needed_seconds, next_digit_seconds : estimated for this tolerance, nan where the pace is not
        known, and for a tenth of the tolerance
    """

    tolerance: float
    confidence: float
    floor: float
    error: float
    statistical: float
    bias: float
    bias_error: float
    bias_measured: bool
    per_contact: float
    starts: int
    made: int
    chance: float
    fell: int
    state: str
    seconds: float
    needed_seconds: float
    next_digit_seconds: float


@dataclass(frozen=True, repr=False, eq=False)
class Result:
    """Result of a run; velocities in sqrt(g d) unless the name says cm/s.

    As text, and in a notebook, it is what the command prints.

    scene : scene of the run
    c_x, tilt_deg : means over rods and over the periods behind the transient; in an annulus c_x is
        the velocity around it at its middle radius, and tilts have no sign; in a row tilts are
        means of axes, half the angle of the sum of unit vectors at twice the tilt
    c_x_stderr, tilt_stderr_deg : their standard errors, as `measures.standard_error`; nan where
        one run cannot tell: below 124 periods, and in an annulus, where starts differ; up to some
        two hundred periods they are too small by up to a fifth
    periods : number of periods that were made
    discarded : periods of the transient, a fifth of the run
    steps_per_period, dt : the step, in sqrt(d/g)
    run_seconds, compile_seconds : of the clock, s
    energy : work of the plate and of shaken walls, losses by kind, change and residual, in m g d;
        None if not asked for
    touches : mean and standard error over all touches of the plate, but the first of each rod,
        which no flight comes before, of each quantity of `measures.MEANS`, and touches per rod and
        period; `plate_velocity` is over the plate's peak velocity; None without a plate
    landings : the same for the quantities of `measures.OF_LANDINGS`, touches less than
        `measures.HOP` periods apart merged into one landing; of those that are not over the number
        alone is counted; None without a plate
    fell : times that a rod fell past the horizontal; None in an annulus
    wedged : share of the rods that are wedged between the walls at the end; None in a row
    phases : touches behind the transient in each of 64 equal parts of the plate's cycle, which
        begins where it rises through its mean height; empty without a plate
    c_x_series, tilt_series, fell_series : drift, tilt in degrees and number of rods that fell over,
        period by period, transient included
    rods : x, z, sin and cos of the tilt at the end; c_x, c_z, omega half a step before; in an
        annulus place and director, velocity and turn, as in `kernels`
    finished : False if the run was interrupted
    accuracy : of c_x; None without a tolerance
    """

    scene: Scene
    c_x: float
    c_x_stderr: float
    tilt_deg: float
    tilt_stderr_deg: float
    periods: int
    discarded: int
    steps_per_period: int
    dt: float
    run_seconds: float
    compile_seconds: float
    energy: dict[str, float] | None
    touches: dict[str, dict[str, float]] | None
    landings: dict[str, dict[str, float]] | None
    fell: int | None
    wedged: float | None
    phases: list[int]
    c_x_series: np.ndarray
    tilt_series: np.ndarray
    fell_series: np.ndarray
    rods: np.ndarray
    finished: bool
    accuracy: Accuracy | None = None

    def __repr__(self) -> str:
        drift = _with_error(self.c_x_cm_s, self.c_x_stderr_cm_s)
        tilt = f"{self.tilt_deg:.3g} degrees"
        return f"<Result: {drift} cm/s at {tilt}, {self.periods} {_unit(self)}>"

    def __str__(self) -> str:
        return f"{self.scene}\n{result_text(self)}"

    _repr_html_ = in_notebook

    @property
    def c_x_cm_s(self) -> float:
        """Drift in cm/s."""
        return self.c_x * self.scene.cm_per_s

    @property
    def c_x_stderr_cm_s(self) -> float:
        """Standard error of the drift in cm/s."""
        return self.c_x_stderr * self.scene.cm_per_s

    @property
    def settled(self) -> bool | None:
        """False if the drift or the rate of falls still trends; None if the run is too short."""
        if self.accuracy is not None:
            return self.accuracy.state != "not settled"
        found = trend(self.c_x_series[self.discarded :])
        if isnan(found):
            return None
        return found <= TREND and steady(self.fell_series[self.discarded :])

    @property
    def rod_steps(self) -> int:
        """Number of steps times number of rods."""
        return self.periods * self.steps_per_period * self.scene.rods.count

    def to_xarray(self) -> "Dataset":
        """Drift, tilt and falls period by period, transient included, as `xarray.Dataset`.

        With units; `.to_dataframe()` makes a table.
        """
        names = "c_x", "tilt", "fell"
        return labelled({name: ("period", getattr(self, f"{name}_series")) for name in names})

    def as_dict(self) -> dict[str, Any]:
        """Dictionary for JSON: all but the arrays, with scene, digest, seed, law and versions."""
        contact = self.scene.contacts.plate or self.scene.contacts.rods
        skip = ("scene", "phases", "c_x_series", "tilt_series", "fell_series", "rods", "accuracy")
        plain = {key: value for key, value in vars(self).items() if key not in skip}
        return finite(
            {
                **plain,
                "c_x_cm_s": self.c_x_cm_s,
                "c_x_stderr_cm_s": self.c_x_stderr_cm_s,
                "rod_steps": self.rod_steps,
                "settled": self.settled,
                "scene": as_dict(self.scene),
                "scene_digest": self.scene.digest(),
                "law": contact.law.name if contact else None,
                "seed": self.scene.start.seed,
                "versions": {"md": digest(), "numpy": np.__version__, "numba": numba.__version__},
                **({"accuracy": asdict(self.accuracy)} if self.accuracy else {}),
            }
        )


def finite(value: Any) -> Any:
    """`value` with None in place of nan and inf, which JSON lacks."""
    return json.loads(json.dumps(value), parse_constant=lambda _: None)


def result_text(result: Result) -> str:
    """Text of a result: what the run measured, and what it cost."""
    lines = [*_drift(result), *_touches(result)]
    if energy := result.energy:
        lost = energy["plate_work"] - energy["change"] - energy["residual"]
        lines.append(
            f"energy       plate {energy['plate_work']:.4g}, lost {lost:.4g}, "
            f"gained {energy['change']:.3g}, residual {energy['residual']:.1e} m g d"
        )
        if lost > 1.0 and -energy["residual"] > UNBALANCED * lost:
            lines.append("warning      energy does not balance: the steps are too long")
    return "\n".join([*lines, *_cost(result), *accuracy_lines(result)])


def _with_error(value: float, error: float) -> str:
    return f"{value:.4g}" if isnan(error) else f"{value:.4g} +- {error:.2g}"


def _unit(r: Result) -> str:
    """Unit of the time that a run is measured in."""
    return "periods" if r.scene.vibrates else "sqrt(d/g)"


def _drift(r: Result) -> list[str]:
    row = r.scene.annulus is None
    lines = [
        f"drift        c_x = {_with_error(r.c_x, r.c_x_stderr)} sqrt(g d) = "
        f"{_with_error(r.c_x_cm_s, r.c_x_stderr_cm_s)} cm/s"
    ]
    if isnan(r.c_x_stderr):
        why = "rods keep their arrangement: only other starts tell it (start.seed)"
        if row:
            why = f"from {FEWEST * 5 // 4 - 1} {_unit(r)} on one run can tell it"
        lines.append(f"             error unknown: {why}")
    fell = f", fell {r.fell} times" if r.fell else ""
    lines.append(f"tilt         {_with_error(r.tilt_deg, r.tilt_stderr_deg)} degrees{fell}")
    if row and r.tilt_deg * r.scene.tilt < 0 and 1 < abs(r.tilt_deg) < 85:
        lines.append("warning      turned over: the rods lean to the other side than at the start")
    return lines


def _touches(r: Result) -> list[str]:
    if not r.touches:
        return []
    mean = {name: pair["mean"] for name, pair in r.touches.items()}
    if not mean["per_rod_and_period"]:
        return ["touches      none has begun behind the transient"]
    return [
        f"touches      {mean['per_rod_and_period']:.3g} per rod and {_unit(r).removesuffix('s')}: "
        f"slide {mean['slide']:.0%}, slip-stick {mean['slip_stick']:.0%}, slip reversal "
        f"{mean['slip_reversal']:.0%}; pushed by others {mean['pushed_by_others']:.0%}",
        f"at touch     V_z/V_0 = {mean['plate_velocity']:.3g}, restitution "
        f"{mean['restitution']:.3g}, flight {mean['flight_periods']:.3g} and contact "
        f"{mean['contact_periods']:.2g} {_unit(r)}",
    ]


def _cost(r: Result) -> list[str]:
    scene, unit = r.scene, _unit(r)
    seconds = r.periods / scene.frequency * scene.rods.diameter_cm / scene.cm_per_s
    line = f"{unit:12} {r.periods} = {seconds:.4g} s; the first {r.discarded} are left out of the "
    line += "means (for c_x: what each start took to settle)" if r.accuracy else "means"
    lines = [line if r.finished else f"{line}; interrupted"]
    if scene.vibrates and r.accuracy is None:
        if r.settled is False:
            lines.append(
                "warning      not settled: drift or falls trend behind the transient; ask for more "
                "periods"
            )
        elif scene.annulus is not None and r.periods < SETTLING:
            lines.append(f"warning      an annulus needs {SETTLING} periods or more to settle")
    if r.wedged:
        lines.append(
            f"warning      wedged: {r.wedged:.0%} of the rods have kept off or on the plate for "
            f"{wedged_periods(scene):.0f} {unit}"
        )
    n, each = scene.rods.count, r.run_seconds / max(r.rod_steps, 1) * 1e9
    lines.append(
        f"cost         {r.rod_steps:.3g} rod-steps of dt = {r.dt:.3g} sqrt(d/g) ({n} "
        f"rod{'s' * (n > 1)}, {r.steps_per_period} steps a {unit.removesuffix('s')}) in "
        f"{r.run_seconds:.3g} s, {each:.3g} ns each; compiled in {r.compile_seconds:.2g} s"
    )
    return lines


def accuracy_lines(result: Result) -> list[str]:
    """Lines on step and error of a run with a tolerance, and on the price of the next digit."""
    a, scene = result.accuracy, result.scene
    if a is None:
        return []
    state = a.state if result.finished else "interrupted"
    verdict = f"accuracy     {state if state == 'reached' else state.upper()}"
    if not isfinite(a.error):
        return [f"{verdict}: ended too early to tell the error"]
    drift = abs(result.c_x)
    if drift + a.error < NOTHING * scene.plate_speed:
        return [f"{verdict}: nothing drifts; c_x is below {NOTHING:g} of the plate's velocity"]
    size = max(drift, a.floor)
    of = "c_x" if drift >= a.floor else f"the floor {a.floor:.3g} sqrt(g d)"
    bias = f"its bias is within {a.bias_error / size:.1g}"
    if a.bias_measured:
        bias = (
            f"its bias {a.bias / size:+.2g} +- {a.bias_error / size:.1g}, measured by steps twice "
            "as long, is taken off"
        )
    lines = [
        f"{verdict}: {a.tolerance:.3g} of {of} asked for; c_x is within {a.error:.2g} sqrt(g d) = "
        f"{a.error * scene.cm_per_s:.2g} cm/s, {a.error / size:.2g} of it, at {a.confidence:.4g} "
        "confidence",
        f"step         dt = {result.dt:.3g}, {a.per_contact:.3g} steps a contact; {bias}; "
        f"the statistical error is {a.statistical / size:.2g}",
        f"starts       {a.starts}, {a.made} periods in all, for c_x; all else is of the first",
    ]
    if a.chance < UNLIKELY[scene.annulus is not None]:
        lines.append(
            "             they differ: the scene has several states; their scatter counts; more "
            "--workers tell it better"
        )
    if a.fell:
        lines.append(
            f"warning      rods fell over {a.fell} times: a decay of the drift that is slower than "
            "the run cannot be seen"
        )
    if a.state == "not settled":
        lines.append("             drift or falls still trend; the error is the change seen")
    if a.state == "not reached" and isfinite(a.needed_seconds):
        lines.append(f"             this would take about {a.needed_seconds:.3g} s of run time")
    if a.error / size > a.tolerance / 10 and isfinite(a.next_digit_seconds):
        lines.append(
            f"next digit   {a.tolerance / 10:.3g} would take about {a.next_digit_seconds:.3g} s"
        )
    return lines


def result_json(r: Result) -> dict[str, Any]:
    """Result as a dictionary for JSON, in reduced units, with these units in cm and s."""
    cm, speed = r.scene.rods.diameter_cm, r.scene.cm_per_s
    period = cm / speed / r.scene.frequency
    units = {"length_cm": cm, "velocity_cm_s": speed, "time_s": cm / speed, "period_s": period}
    return {**r.as_dict(), "units": units, "scene_in_cm": in_cm(as_dict(r.scene))}
