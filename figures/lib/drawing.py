"""Figures computed and drawn into files, by several processes."""

import io
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
from joblib import delayed
from joblib.externals.loky import get_reusable_executor
from tqdm import tqdm

from impact import InputError
from impact._generated import DIGEST
from md.files import replacing
from md.sweep import pool

from .. import FIGURES, load
from . import runs
from .data import NOTHING, Own, keep, kept_data, made
from .printing import printed
from .style import note, style

KINDS = "npz", "png", "pdf"


class Drawn(NamedTuple):
    """Outcome of drawing one figure: its files and numbers, or why there are none."""

    name: str
    files: str = ""  # their names, in a line
    numbers: str = ""  # of the figure, as tables
    failure: str = ""  # why there are no files
    code: int = 1  # to end with, then
    said: str = ""  # on standard error, while it was computed


def files_of(*names: str) -> list[str]:
    """Names of the files of figures: NAME.npz, NAME.png and NAME.pdf of each."""
    return [f"{name}.{kind}" for name in names for kind in KINDS]


def produce(
    name: str, out: Path, quick: bool, kept: Path | None = None, own: Own = NOTHING
) -> Drawn:
    """Compute and draw one figure: NAME.npz, NAME.png and NAME.pdf in the folder `out`.

    Data that are `kept` in a folder are drawn as they are; NAME.npz is not written. Of `own` values
    the figure takes those that it knows, in place of the paper's.
    """
    module, own = load(name), {key: own[key] for key in FIGURES[name].own if key in own}
    data = module.data(quick=quick, **own) if kept is None else kept_data(name, kept)
    try:
        picture = module.draw(data)
    except KeyError as error:
        if kept is None:
            raise
        raise InputError(f"{kept / name}.npz holds no data of {name}: {error} is missing") from None
    by = {"quick": quick, "own": own} if kept is None else made(kept / f"{name}.npz")
    marks = [by.get("quick") and "quick", by.get("own") and "values not the paper's"]
    if any(marks):
        words = filter(None, [picture.get_supxlabel(), *marks])
        style(note)(picture, "; ".join(words))
    stamp = {"Title": f"{FIGURES[name].title} (impact {DIGEST})"}
    npz, png, pdf = (out / file for file in files_of(name))
    try:
        if kept is None:
            with replacing(npz) as part:
                keep(part, name, quick, data, own)
        for path in (png, pdf):
            with replacing(path) as part:
                picture.savefig(part, dpi=200, metadata=stamp)
    finally:
        plt.close(picture)
    files = f"{png}  {pdf.name}" + ("" if kept else f"  {npz.name}")
    return Drawn(name, files, printed(data))


def _tried(name: str, *how: Any) -> Drawn:
    """`produce`; a failure is returned, not raised, so that others go on."""
    try:
        return produce(name, *how)
    except Exception as error:
        foreseen = isinstance(error, OSError) or hasattr(error, "exit_code")
        why = str(error) if foreseen else traceback.format_exc().rstrip()
        return Drawn(name, failure=why, code=getattr(error, "exit_code", 2 if foreseen else 1))


def _in_a_process(store: Path, *how: Any) -> Drawn:
    """`_tried` in a process of its own; nothing is written onto the terminal."""
    runs.STORE = store
    with redirect_stderr(io.StringIO()) as said:
        drawn = _tried(*how)
    return drawn._replace(said=said.getvalue())


@contextmanager
def _pool(
    names: Sequence[str], out: Path, quick: bool, jobs: int, own: Own
) -> Iterator[Iterator[Drawn]]:
    """Figures as they are drawn by `jobs` processes, which end with this context."""
    tasks = [delayed(_in_a_process)(runs.STORE, name, out, quick, None, own) for name in names]
    try:
        with pool(tasks, jobs, pre_dispatch="all") as results:
            yield results
    except BaseException:
        for file in files_of(*names):
            name, kind = file.split(".")
            (out / f".{name}.part.{kind}").unlink(missing_ok=True)  # of a process that was stopped
        raise
    get_reusable_executor().shutdown()  # a sweep would take over workers grown by Matplotlib


def draw_all(
    names: Sequence[str],
    out: Path,
    quick: bool,
    jobs: int,
    kept: Path | None,
    numbers: bool,
    own: Own,
) -> dict[str, int]:
    """Draw figures and say so; returns the names of those that failed, and their exit codes.

    A failure of the only one is raised: it is the command's, which says it once.

    Parameters
    ----------
    names : of the figures; those that may share the machine come first, by `jobs` processes
    out : folder
    quick : whether on coarse grids
    jobs : processes
    kept : folder of data to draw as they are, one after the other; None: compute
    numbers : whether to print the numbers of each figure
    own : values in place of the paper's; each figure takes those that it knows
    """
    beside = [name for name in names if not FIGURES[name].alone and kept is None]
    beside = beside if min(len(beside), jobs) > 1 else []
    failed = {}
    with tqdm(total=len(names), desc="drawing", unit="figure", disable=None, leave=False) as bar:

        def told(drawn: Drawn) -> None:
            for words in filter(None, (drawn.files, drawn.numbers if numbers else "")):
                bar.write(words)
            if drawn.said:
                bar.write(drawn.said.rstrip(), file=sys.stderr)
            if drawn.failure:
                bar.write(f"{drawn.name} failed: {drawn.failure}", file=sys.stderr)
                failed[drawn.name] = drawn.code
            bar.update()

        if beside:
            with _pool(beside, out, quick, jobs, own) as results:
                for drawn in results:
                    told(drawn)
        for name in names:
            if name not in beside:
                bar.set_postfix_str(name)
                draw = _tried if len(names) > 1 else produce
                told(draw(name, out, quick, kept, own))
    return failed
