"""Run a scene: period by period, with touches, energy, standard errors, checkpoint and resume."""

import json
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from tqdm import TqdmWarning
from tqdm import tqdm as plain_bar

from .cache import SIGNALS, digest
from .domains import InputError, whole
from .files import distinct, naming, replacing, writable
from .host import prepare, step_of
from .measures import Tables, transient
from .records import Trajectory, is_trajectory
from .result import Result
from .scene import Scene

with warnings.catch_warnings():
    warnings.simplefilter("ignore", TqdmWarning)  # a notebook without ipywidgets shows no bar
    from tqdm.auto import tqdm

progress_bar = tqdm
plain_bar.set_lock(threading.RLock())  # a semaphore would be left behind by a worker that is ended
MOST_PERIODS = 10**7  # of a run
LOSSES = (
    "plate_normal",
    "plate_friction",
    "rods_normal",
    "rods_friction",
    "walls_normal",
    "walls_friction",
)
_SAVED = 60.0  # seconds from one checkpoint to the next


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Note Ctrl-C instead of raising it in the middle of a step.

    Yields a function that says whether it was pressed.

    Every signal that is Ctrl-C to Python is noted, as SIGTERM is for the command; a handler that
    somebody else has set stays.
    """
    pressed, usual = threading.Event(), signal.default_int_handler
    main = threading.current_thread() is threading.main_thread()
    with ExitStack() as stack:
        for number in SIGNALS:
            if main and signal.getsignal(number) is usual:
                stack.callback(signal.signal, number, usual)
                signal.signal(number, lambda *_: pressed.set())
        yield pressed.is_set


def _names(scene: Scene) -> dict[str, str]:
    """Digests of sources and scene, by which a checkpoint knows its run."""
    return {"code": digest(), "scene": scene.digest()}


def _read(path: Path, scene: Scene) -> tuple[dict, dict[str, np.ndarray]]:
    """Read a checkpoint of this scene: its numbers, and its arrays."""
    try:
        with path.open("rb") as file, np.load(file) as saved:
            arrays = dict(saved)
        about = json.loads(str(arrays.pop("about")))
        other = [key for key, value in _names(scene).items() if about.pop(key) != value]
    except OSError as error:
        raise InputError(f"checkpoint {path} cannot be read: {error}") from None
    except Exception:
        raise InputError(f"checkpoint {path} cannot be read: not one, or cut short") from None
    if other:
        whose = "another scene, or to another step of it"
        if "code" in other:
            whose = "an earlier version of md or other sources"
        raise InputError(f"checkpoint {path} belongs to {whose}; remove it to start again")
    return about, arrays


class Run:
    """A run in progress with its files; the arguments are those of `run`."""

    def __init__(
        self,
        scene: Scene,
        periods: int,
        *,
        ledger: bool = True,
        observe: Callable[[np.ndarray], None] | None = None,
        trajectory: str | Path | None = None,
        frames: int | None = None,
        checkpoint: str | Path | None = None,
        progress: bool = False,
    ):
        periods = whole("periods", periods, 1, MOST_PERIODS)
        path = None
        if trajectory is not None:
            path = writable("trajectory", trajectory, is_trajectory, "one of frames")
        elif frames is not None:
            raise InputError("frames has no meaning without trajectory")
        frames = whole("frames", 1 if frames is None else frames, 1, step_of(scene)[1])
        distinct(trajectory=trajectory, checkpoint=checkpoint)
        if observe is not None and not callable(observe):
            raise InputError(f"observe must be a function, got {observe!r}")
        saved, self.checkpoint = None, None
        if checkpoint is not None:
            writable("checkpoint", checkpoint)
            self.checkpoint = Path(checkpoint)
            if self.checkpoint.exists():
                saved = _read(self.checkpoint, scene)
        self.trajectory: Trajectory | None = None
        if path is not None:
            before = saved[0]["trajectory"] if saved else None
            self.trajectory = Trajectory(path, scene, frames, before)
        self.observe = observe
        self.engine = engine = prepare(scene, ledger=ledger)
        self.tables = Tables(engine, periods)
        self.bar = progress_bar(  # None: on a terminal and in a notebook
            total=periods, unit=" periods", delay=2, disable=None if progress else True
        )
        notice = threading.Timer(
            2.0,
            self.bar.write,
            ["compiling the kernels for such a scene, once: 10 to 30 s"],
            {"file": sys.stderr},
        )
        if not self.bar.disable:
            notice.start()
        begin = perf_counter()
        try:
            engine.go(0, self.tables.series)  # compiles
        finally:
            notice.cancel()
        self.seconds, self.compile_seconds = 0.0, perf_counter() - begin
        self.energy = engine.energy() if engine.ledger is not None else 0.0  # at the start
        if saved is not None:
            self._restore(*saved, periods)

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.close()
        if self.trajectory is not None:
            self.trajectory.close()

    @property
    def made(self) -> int:
        """Number of whole periods made."""
        return self.engine.step // self.engine.per

    def _restore(self, about: dict[str, Any], arrays: dict[str, np.ndarray], periods: int) -> None:
        """Restore the state of a checkpoint."""
        engine = self.engine
        if about["step"] > periods * engine.per:
            raise InputError(
                f"checkpoint {self.checkpoint} is {about['step'] // engine.per} periods long "
                "already: ask for more, or remove it"
            )
        if engine.ledger is not None and "ledger" not in arrays:
            raise InputError(
                f"ledger must be False, as checkpoint {self.checkpoint} was saved without it; "
                "or remove it to start again"
            )
        self.tables.restore(arrays)
        engine.restore(arrays, about["step"])
        self.seconds, self.energy = about["seconds"], about["energy"]

    def save(self) -> None:
        """Write the frames, and then a checkpoint, to the disk."""
        trajectory, path, place = self.trajectory, self.checkpoint, ("", 0)
        if trajectory is not None:
            with naming(trajectory.path):
                trajectory.flush()
            place = trajectory.place
        if path is None:
            return
        about = {
            "step": self.engine.step,
            "energy": self.energy,
            "seconds": self.seconds,
            "trajectory": place,
            **_names(self.engine.scene),
        }
        arrays: dict[str, Any] = self.tables.arrays(self.made) | self.engine.arrays()
        with naming(path), replacing(path) as part, part.open("wb") as file:
            np.savez(file, about=json.dumps(about), **arrays)

    def march(self, periods: int, stop: Callable[[], bool]) -> None:
        """March until so many periods are made, or `stop` says so, call by call of the kernel."""
        engine, saved = self.engine, perf_counter()
        self.bar.total, end = periods, periods * engine.per
        while engine.step < end and not stop():
            steps = min(engine.pace, end - engine.step)
            if (trajectory := self.trajectory) is not None:
                frames = trajectory.per_period
                number, since = divmod(engine.step * frames, engine.per)
                if since < frames:  # the first step at or behind `number` parts of the period
                    now = engine.step / engine.per, engine.plate_height
                    with naming(trajectory.path):
                        trajectory.write(engine.rods, *now, engine.effects.inertia.rolling or 0.0)
                steps = min(steps, -(-(number + 1) * engine.per // frames) - engine.step)
            begin = perf_counter()
            engine.go(steps, self.tables.series)
            self.seconds += perf_counter() - begin
            if (record := engine.record) is not None and record.count[0]:
                rows = record.rows[: record.count[0]]
                self.tables.add(rows)
                if self.observe is not None:
                    self.observe(rows.copy())
                record.count[0] = 0
            self.bar.update(self.made - self.bar.n)
            if perf_counter() - saved > _SAVED:
                self.save()
                saved = perf_counter()

    def history(self) -> np.ndarray:
        """Drift [sqrt(g d)] and number of falls of each period made, (2, periods)."""
        return np.array(self.tables.by_period(self.made)[::2])

    def _energy(self) -> dict[str, float] | None:
        """Balance of the energy, m g d; None without a ledger."""
        if self.engine.ledger is None:
            return None
        change = self.engine.energy() - self.energy
        work, *losses = map(float, self.engine.ledger)
        return {
            "plate_work": work,
            **dict(zip(LOSSES, losses, strict=False)),
            "change": change,
            "residual": work - sum(losses) - change,
        }

    def result(self, finished: bool) -> Result:
        """`Result` of the periods made; checkpoint and trajectory are written up to its end.

        Where these cannot be written, the error tells the result.
        """
        engine, tables, periods = self.engine, self.tables, self.made
        c_x, tilt, fell = tables.by_period(periods)
        cut = transient(periods)
        drift, drift_error = tables.mean(c_x[cut:])
        lean, lean_error = tables.mean(tilt[cut:])
        found = Result(
            scene=engine.scene,
            c_x=drift,
            c_x_stderr=drift_error,
            tilt_deg=lean,
            tilt_stderr_deg=lean_error,
            periods=periods,
            discarded=cut,
            steps_per_period=engine.per,
            dt=engine.dt,
            run_seconds=self.seconds,
            compile_seconds=self.compile_seconds,
            energy=self._energy(),
            fell=int(fell.sum()) if engine.scene.annulus is None else None,
            **tables.results(cut, periods),
            c_x_series=c_x,
            tilt_series=tilt,
            fell_series=fell,
            rods=engine.rods.copy(),
            finished=finished,
        )
        try:
            self.save()
        except OSError as error:
            raise OSError(f"{error}\n{found}") from None
        return found


def run(scene: Scene, *, periods: int = 200, **options: Any) -> Result:
    """Run a scene and measure it.

    Parameters
    ----------
    scene : Scene
    periods : of the plate, or, if nothing vibrates, units of sqrt(d/g)
    ledger : whether to account for the energy (default True)
    observe : called now and then with new touches, (n, touches.WIDTH), which `md.records.touches`
        gives names; they are not kept
    trajectory : file for extended XYZ, a new one or one of frames, which are replaced; when a
        checkpoint is resumed, those of the periods after it, behind the frames that the run had so
        far, or in a new file
    frames : of the trajectory, per period, evenly, at most one a step (default 1)
    checkpoint : file to save in every minute and at the end; if it is there, the run goes on from
        it and gives bit for bit the numbers of a run that never stopped
    progress : whether to show a progress bar, on a terminal, after two seconds (default False)

    Ctrl-C ends the run: the result has `finished` False and covers the whole periods made.

    Raises
    ------
    ValueError
        If an argument is out of its domain, the step is not stable, the checkpoint is of another
        scene or of other sources, or a file holds other data, or other frames than the run had so
        far. No file is changed.
    RunError
        If a state stops being finite, or a contact is deeper than d/2.
    OSError
        If a file takes no more, as on a full disk; the last checkpoint stays. Where only the last
        save failed, the error tells the result as text.
    """
    with Run(scene, periods, **options) as running, interruptible() as pressed:
        running.march(periods, pressed)
        return running.result(running.made == periods)
