"""Run a scene: period by period, with landings, energy, standard errors, checkpoint and resume."""

import json
import os
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any, TextIO
from zipfile import BadZipFile

import numba
import numpy as np
from tqdm import tqdm

from .cache import digest
from .engine import Engine, prepare
from .interrupt import SIGNALS
from .measures import Tables
from .scene import Scene, as_dict, whole
from .statistics import standard_error, transient
from .trajectory import write_frame
from .writing import replacing

_SAVED = 60.0  # seconds from one checkpoint to the next


@dataclass(frozen=True)
class Result:
    """What a run measured; velocities in sqrt(g d) unless the name says cm/s.

    scene : that ran
    c_x, tilt_deg : means over rods and over the periods behind the transient
    c_x_stderr, tilt_stderr_deg : their standard errors
    periods : that were made
    discarded : periods of the transient (MSER-5 on the drift, at most half of the run)
    steps_per_period, dt : the step, in sqrt(d/g)
    run_seconds, compile_seconds : of the clock
    energy : plate work, losses by kind, change and what is left over, in m g d; None if not asked
    landings : mean and standard error over all touches of the plate of each quantity of
        `measures.MEANS`, and touches per rod and period; None without a plate
    merged : the same of `measures.OF_MERGED`, touches less than `measures.HOP` periods apart taken
        as one landing
    turned : times that a rod fell past the horizontal, and passed the vertical
    phases : landings behind the transient in each of 64 equal parts of the plate's cycle, which
        begins where it rises through its mean height; empty without a plate
    c_x_series, tilt_series : period by period, transient included
    rods : x, z, sin and cos of the tilt at the end; c_x, c_z, omega half a step before
    finished : whether nobody ended the run before its time
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
    landings: dict[str, Any] | None
    merged: dict[str, Any] | None
    turned: dict[str, int]
    phases: list[int]
    c_x_series: np.ndarray
    tilt_series: np.ndarray
    rods: np.ndarray
    finished: bool

    @property
    def rod_steps(self) -> int:
        """Steps times rods."""
        return self.periods * self.steps_per_period * self.scene.rods.count

    def as_dict(self) -> dict[str, Any]:
        """For JSON: all but the arrays, with the scene, its digest, seed, law and versions."""
        contact = self.scene.contacts.plate or self.scene.contacts.rods
        skip = ("scene", "phases", "c_x_series", "tilt_series", "rods")
        plain = {key: value for key, value in vars(self).items() if key not in skip}
        return finite(
            {
                **plain,
                "c_x_cm_s": self.c_x * self.scene.cm_per_s,
                "rod_steps": self.rod_steps,
                "scene": as_dict(self.scene),
                "scene_digest": self.scene.digest(),
                "law": contact.law.name if contact else None,
                "seed": self.scene.start.seed,
                "versions": {"md": digest(), "numpy": np.__version__, "numba": numba.__version__},
            }
        )


def finite(value: Any) -> Any:
    """JSON has neither nan nor inf."""
    if isinstance(value, dict):
        return {key: finite(inner) for key, inner in value.items()}
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _result(engine: Engine, tables: Tables, began: dict, periods: int, finished: bool) -> Result:
    c_x, tilt = tables.drift(engine, periods), tables.tilt_deg(periods)
    cut = transient(c_x)
    energy = None
    if engine.ledger is not None:
        change = engine.energy() - began["energy"]
        work, *losses = map(float, engine.ledger)
        names = ("plate_normal", "plate_friction", "rods_normal", "rods_friction")
        energy = {"plate_work": work, **dict(zip(names, losses, strict=True)), "change": change}
        energy["residual"] = work - sum(losses) - change
    return Result(
        scene=engine.scene,
        c_x=float(c_x[cut:].mean()) if periods else float("nan"),
        c_x_stderr=standard_error(c_x[cut:]),
        tilt_deg=float(tilt[cut:].mean()) if periods else float("nan"),
        tilt_stderr_deg=standard_error(tilt[cut:]),
        periods=periods,
        discarded=cut,
        steps_per_period=engine.per,
        dt=engine.dt,
        run_seconds=began["seconds"],
        compile_seconds=began["compile"],
        energy=energy,
        **tables.results(engine, cut, periods),
        c_x_series=c_x,
        tilt_series=tilt,
        rods=engine.rods.copy(),
        finished=finished,
    )


def _writable(name: str, path: Path) -> None:
    """Refuse a file that could not be written in the end."""
    try:
        with (
            tempfile.TemporaryFile(dir=path.parent),
            path.open("a") if path.exists() else ExitStack(),
        ):
            pass
    except OSError as error:
        raise ValueError(f"{name} must be a file that can be written: {error}") from None


def _only_frames(path: Path) -> None:
    """Refuse to write over what is no trajectory."""
    if not path.exists() or path.stat().st_size == 0:
        return
    with path.open("rb") as file:
        file.readline(100)
        if not file.readline(100).startswith(b"Lattice="):
            raise ValueError(f"trajectory must be a new file or one of frames, got {str(path)!r}")


def _opened(path: Path, written: int) -> TextIO:
    """The trajectory, cut off behind what a checkpoint knows of."""
    path.touch()
    file = path.open("r+")
    file.truncate(file.seek(min(written, file.seek(0, os.SEEK_END))))
    return file


def _write(file: TextIO, engine: Engine) -> None:
    """Append a frame of the trajectory."""
    height = float(engine.plate.height[engine.step % engine.per]) if engine.plate else 0.0
    write_frame(file, engine.scene, engine.rods, engine.step / engine.per, height)


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """A function that says whether Ctrl-C was pressed; it is not raised in the middle of a step.

    So is every signal that is Ctrl-C to Python, as SIGTERM is to the command; a handler of
    somebody's own is left to raise what it does.
    """
    pressed, usual = threading.Event(), signal.default_int_handler
    taken = [n for n in SIGNALS if signal.getsignal(n) is usual]
    if threading.current_thread() is not threading.main_thread():
        taken = []
    try:
        for number in taken:
            signal.signal(number, lambda *_: pressed.set())
        yield pressed.is_set
    finally:
        for number in taken:
            signal.signal(number, usual)


def _save(path: Path, engine: Engine, tables: Tables, began: dict) -> None:
    """Checkpoint, beside the old one first."""
    about = {"scene": engine.scene.digest(), "code": digest(), "step": engine.step, **began}
    arrays: dict[str, Any] = tables.arrays(engine.step // engine.per) | engine.arrays()
    with replacing(path) as part, part.open("wb") as file:
        np.savez(file, about=json.dumps(about), **arrays)


def _resume(path: Path, engine: Engine, tables: Tables) -> dict:
    """Go on from a checkpoint."""
    try:
        with path.open("rb") as file, np.load(file) as saved:
            arrays = dict(saved)
        about = json.loads(str(arrays.pop("about")))
    except OSError as error:
        raise ValueError(f"checkpoint {path} cannot be read: {error}") from None
    except (ValueError, KeyError, EOFError, BadZipFile):
        raise ValueError(f"checkpoint {path} cannot be read: not one, or cut short") from None
    for key, mine in (("scene", engine.scene.digest()), ("code", digest())):
        if about.pop(key) != mine:
            raise ValueError(f"checkpoint {path} belongs to another {key}; remove it to start anew")
    step = about.pop("step")
    if step > tables.periods * engine.per:
        raise ValueError(
            f"checkpoint {path} is {step // engine.per} periods long already: ask for more, or "
            "remove it"
        )
    tables.restore(arrays)
    engine.restore(arrays, step)
    return about


def _loop(
    engine: Engine,
    tables: Tables,
    series: Any,
    began: dict,
    goal: int,
    observe: Callable[[np.ndarray], None] | None,
    frame: tuple[int, Callable[[], None]] | None,
    save: Callable[[], None],
    bar: tqdm,
    pressed: Callable[[], bool],
) -> None:
    """March to the step `goal`, call by call of the kernel.

    `frame` is (steps between two frames, function that writes one) or None, `save` a function.
    """
    saved = perf_counter()
    while engine.step < goal and not pressed():
        steps = min(engine.pace, goal - engine.step)
        if frame is not None:
            gap, write = frame
            if engine.step % gap == 0:
                write()
            steps = min(steps, gap - engine.step % gap)
        begin, first = perf_counter(), engine.step
        engine.go(steps, series)
        began["seconds"] += perf_counter() - begin
        if engine.record is not None and engine.record.count[0]:
            rows = engine.record.rows[: engine.record.count[0]]
            tables.add(rows)
            if observe is not None:
                observe(rows.copy())
            engine.record.count[0] = 0
        bar.update(engine.step // engine.per - first // engine.per)
        if perf_counter() - saved > _SAVED:
            save()
            saved = perf_counter()


def run(
    scene: Scene,
    *,
    periods: int = 200,
    ledger: bool = True,
    observe: Callable[[np.ndarray], None] | None = None,
    trajectory: str | Path | None = None,
    frames: int = 1,
    checkpoint: str | Path | None = None,
    progress: bool = False,
    goal: Callable[[np.ndarray], int] | None = None,
) -> Result:
    """Run a scene and measure it.

    Parameters
    ----------
    scene : Scene
    periods : of the plate, or, if nothing vibrates, units of sqrt(d/g)
    ledger : whether to account for the energy
    observe : called now and then with new landings, (n, landings.WIDTH); they are not kept
    trajectory : file for extended XYZ; when a checkpoint is resumed, it goes on behind the frames
        that were written before the checkpoint
    frames : of the trajectory, per period
    checkpoint : file to save in every minute and at the end; if it is there, the run goes on from
        it and gives bit for bit the numbers of a run that never stopped
    progress : whether to show a progress bar, on a terminal, after two seconds
    goal : says how many periods to make in all, given the drift of each one made so far; asked
        again when they are made, until that is enough; `periods` is then the most

    Ctrl-C ends the run: the result has `finished` False and covers the whole periods made.

    Raises
    ------
    ValueError
        If an argument is out of its domain, the step is not stable, or the checkpoint is of
        another scene or of other sources.
    RunError
        If a state stops being finite, or a contact is deeper than d/2.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a md.Scene, as md.load gives, got {scene!r}")
    periods = whole("periods", periods, 1, 10**7)
    frames = whole("frames", frames, 1, 10**6)
    for name, path in (("trajectory", trajectory), ("checkpoint", checkpoint)):
        if path is not None and not Path(path).parent.is_dir():
            raise ValueError(f"{name} must be in a folder that exists, got {str(path)!r}")
        if path is not None and Path(path).is_dir():
            raise ValueError(f"{name} must be a file, got the folder {str(path)!r}")
        if path is not None:
            _writable(name, Path(path))
    if trajectory is not None:
        if checkpoint is not None and Path(trajectory).resolve() == Path(checkpoint).resolve():
            raise ValueError(f"checkpoint must be another file than trajectory, got {trajectory!r}")
        _only_frames(Path(trajectory))
    engine = prepare(scene, ledger=ledger)
    tables = engine.tables(periods)
    series = tables.sampled(engine)
    begin = perf_counter()
    engine.go(0, series)  # compiles
    began: dict[str, Any] = {"compile": perf_counter() - begin, "seconds": 0.0, "written": 0}
    began["energy"] = engine.energy() if engine.ledger is not None else 0.0
    kept = None if checkpoint is None else Path(checkpoint)
    if kept is not None and kept.exists():
        began |= _resume(kept, engine, tables) | {"compile": began["compile"]}

    file = None

    def save() -> None:
        if file is not None:
            file.flush()
            began["written"] = file.tell()
        if kept is not None:
            _save(kept, engine, tables, began)

    with ExitStack() as stack:
        pressed = stack.enter_context(_interruptible())
        frame = None
        if trajectory is not None:
            file = stack.enter_context(_opened(Path(trajectory), began["written"]))
            frame = max(engine.per // frames, 1), partial(_write, file, engine)
        bar = stack.enter_context(
            tqdm(total=periods, unit=" periods", delay=2, disable=None if progress else True)
        )
        made = engine.step // engine.per
        bar.update(made)
        aim = periods if goal is None else 0
        while True:
            if goal is not None:
                aim = min(goal(tables.drift(engine, made)), periods)
                bar.total = aim
            _loop(
                *(engine, tables, series, began, aim * engine.per),
                *(observe, frame, save, bar, pressed),
            )
            enough, made = made >= aim, engine.step // engine.per
            if goal is None or enough or made < aim:
                break
        save()
    return _result(engine, tables, began, made, engine.step >= aim * engine.per)
