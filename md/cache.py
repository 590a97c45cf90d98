"""Compiled kernels kept, and what decides whether anything that was kept is stale.

A run in a store is found by its `key`, of the scene, the length and the sources; a checkpoint is
of the same scene and the same `digest`; compiled kernels lie in a folder named after
`digest_of_kernels`; data of figures carry `code_of` the files of `md` (`figures.lib.data`).

A `digest` is taken of syntax trees without docstrings, comments, annotations and the text of
exceptions: an edit of these keeps what is stored, an edit of a formula, of a constant or of any
other string does not. It covers the modules that a run imports, and those which they import.

Kernels are compiled on first call and kept below NUMBA_CACHE_DIR, else in the user's cache; an edit
of any file with kernels, or of what these use, compiles all of them again.
"""

import ast
import fcntl
import hashlib
import multiprocessing
import os
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache, partial
from importlib.util import resolve_name
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import numba
from numba.core.caching import NullCache

from .files import warn

RUN = "accuracy"  # module where a run begins
# Imported by a run, without a part in its numbers.
APART = {"cache", "files", "records"}
_LEFT_OUT = {"annotation", "ctx", "kind", "msg", "returns", "type_comment", "type_params"}


def read(folder: Path) -> dict[str, bytes]:
    """Read the sources of a package, by the names of its modules, as "kernels.contact"."""
    found = {}
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        found[".".join(parts).removesuffix(".__init__")] = path.read_bytes()
    return found


SOURCES = read(Path(__file__).parent)  # what this process runs, whatever is edited meanwhile


@cache
def imported(module: str, source: bytes) -> set[str]:
    """Modules of this package, and names in them, that a module imports, also in functions."""
    folders = {name.rpartition(".")[0] for name in SOURCES}
    folder = module if module in folders else module.rpartition(".")[0]
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.level:
            relative = "." * node.level + (node.module or "")
            name = resolve_name(relative, f"md.{folder}".rstrip("."))
            found |= {name, *(f"{name}.{alias.name}" for alias in node.names)}
    return {name.removeprefix("md.") for name in found}


@cache
def used(*roots: str) -> tuple[str, ...]:
    """Modules that `roots` need, themselves included, but for those of `APART`.

    Parameters
    ----------
    roots : names of modules, as "simulation" or "kernels.contact"
    """
    found: set[str] = set()
    todo = set(roots)
    while todo:
        module = todo.pop()
        if module not in found | APART:
            found.add(module)
            todo |= imported(module, SOURCES[module]) & SOURCES.keys()
    return tuple(sorted(found))


def essence(node: object) -> str:
    """Text of the parts of a syntax tree that decide what it computes.

    It is the same in all versions of Python.
    """
    match node:
        case ast.Expr(value=ast.Constant(value=str())) | ast.If(test=ast.Name(id="TYPE_CHECKING")):
            return ""
        case ast.Raise(exc=ast.Call(func=kind)):
            return f"Raise({essence(kind)})"
        case ast.AnnAssign(target=target, value=value):  # as an assignment without the annotation
            return f"Assign(targets={essence([target])}, value={essence(value)})" if value else ""
        case ast.AST():
            parts = [
                (name, essence(x)) for name, x in ast.iter_fields(node) if name not in _LEFT_OUT
            ]
            if isinstance(node, ast.ClassDef):  # annotations make fields of a dataclass
                fields = [x.target for x in node.body if isinstance(x, ast.AnnAssign)]
                parts.append(("fields", essence(fields)))
            return f"{type(node).__name__}({', '.join(f'{n}={x}' for n, x in parts if x)})"
        case list():
            return f"[{' '.join(filter(None, map(essence, node)))}]" if node else ""
    return "" if node is None else repr(node)


@cache
def code_of(source: bytes) -> str:
    """`essence` of a source file; each is read once, for however many digests."""
    return essence(ast.parse(source))


@cache
def digest() -> str:
    """Twelve hexadecimal digits that stand for the sources which decide what a run gives."""
    content = hashlib.sha256()
    for module in used(RUN):
        content.update(f"{module}\0{code_of(SOURCES[module])}\0".encode())
    return content.hexdigest()[:12]


def key(scene: Any, length: dict[str, Any], measure: Any = None) -> str:
    """Key of a run in a store, which holds no other one for it.

    Digest of the scene, the length, the sources (`digest`) and the measure: a stored run is stale,
    and computed again, where one of these has changed.

    Parameters
    ----------
    scene : of the run
    length : arguments of `md.run` that say how long it is
    measure : `sweep.Measure`; None: the results of `md.run`
    """
    said = f"{scene.contents} {length} {digest()} "
    if measure is not None:
        said += f"{measure.function.__qualname__} {measure.code}"
    return hashlib.sha256(said.encode()).hexdigest()[:24]


@cache
def digest_of_kernels() -> str:
    """Digest of the bytes of all files with compiled functions, and of the modules they use."""
    roots = (name for name, source in SOURCES.items() if b"\n@kernel" in source)
    content = hashlib.sha256(SOURCES["cache"])
    for module in used(*roots):
        content.update(module.encode() + b"\0" + SOURCES[module] + b"\0")
    return content.hexdigest()[:12]


# A handler that raises in the midst of a compilation leaves Numba with half a function, or is lost
# in a callback of LLVM. `impact._interrupt` has the same: neither package imports the other.
SIGNALS = signal.SIGINT, signal.SIGTERM, signal.SIGALRM


@contextmanager
def deferred() -> Iterator[None]:
    """Hold back the `SIGNALS` that Python handles; their handlers run at the end. May be nested."""
    noted = set()

    def handle(number: int) -> None:
        if number in noted:
            signal.raise_signal(number)

    with ExitStack() as stack:  # one handler that raises keeps none of the others from running
        if threading.current_thread() is threading.main_thread():  # no other one runs handlers
            for number in SIGNALS:
                if callable(usual := signal.getsignal(number)):
                    stack.callback(handle, number)
                    stack.callback(signal.signal, number, usual)
                    signal.signal(number, lambda n, _: noted.add(n))
        yield


_KEPT = 30 * 86400  # seconds an unused folder of other sources is kept
_OPTIONS = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True, "nogil": True}


@cache
def directory() -> Path | None:
    """Folder for the compiled kernels of these sources; None if there can be none."""
    try:
        chosen = numba.config.CACHE_DIR or os.environ.get("XDG_CACHE_HOME")
        home = Path(chosen or Path.home() / ".cache") / "rod-impact"
        folder = home / digest_of_kernels()
        folder.mkdir(parents=True, exist_ok=True)
        folder.touch()
        for other in home.iterdir():
            with suppress(FileNotFoundError):  # another process has removed it
                if other != folder and time.time() - other.stat().st_mtime > _KEPT:
                    shutil.rmtree(other, ignore_errors=True)
        return folder
    except (OSError, RuntimeError) as error:  # RuntimeError: a user without a home
        _warn_once(
            f"compiled kernels cannot be kept ({error}): they are compiled each time, unless "
            "NUMBA_CACHE_DIR names a folder for them"
        )
        return None


@cache
def _warn_once(message: str) -> None:
    """Warn once, in the main process alone."""
    if multiprocessing.current_process().name == "MainProcess":
        warn(message)


def kernel(
    function: Callable | None = None, *, inline: bool = True, entry: bool = False
) -> Callable:
    """Compile on first call; IEEE arithmetic, no exception on a division.

    What is small goes into its caller: a call would return its tuple through memory. No kernel
    counts references to arrays (`_nrt`): in inlined functions that took three quarters of the time
    of a step. In return a kernel cannot allocate, and Numba refuses one that would.

    A kernel that others call has no entry for calls from Python, into which a third of the time to
    compile would go; it is kept as a part of its callers. Where Python calls it all the same, a
    twin with an entry is compiled; Numba's public options cannot say so, and two private methods of
    its dispatcher are replaced.

    Parameters
    ----------
    function : to be compiled
    inline : whether it goes into its callers
    entry : whether Python calls it; it is kept by itself
    """
    if function is None:
        return partial(kernel, inline=inline, entry=entry)
    if numba.config.DISABLE_JIT:
        return function
    if entry:
        return _kept(function)
    options = {"forceinline": inline, "no_cpython_wrapper": True, **_OPTIONS}
    part = _compiling(numba.njit(**options)(function))
    called = cache(partial(_kept, function))
    part._insert = lambda *_: None  # what has no entry cannot be called, and crashes
    part._compile_for_args = lambda *_, **__: called()
    return part


def _kept(function: Callable) -> Any:
    """Dispatcher of Numba that keeps its kernels in our folder, or in no folder if it cannot."""
    folder, usual = directory(), numba.config.CACHE_DIR
    if folder is not None:
        try:
            numba.config.CACHE_DIR = str(folder)  # read when a function is decorated, not later
            made = numba.njit(cache=True, **_OPTIONS)(function)
            if Path(made.stats.cache_path).is_relative_to(folder):  # else it is beside the sources
                return _compiling(_one_at_a_time(made, folder))
        except (OSError, RuntimeError):  # RuntimeError: no place at all
            pass
        finally:
            numba.config.CACHE_DIR = usual
        _warn_once(f"compiled kernels cannot be kept in {folder}")
    return _compiling(numba.njit(**_OPTIONS)(function))


def _compiling(made: Any) -> Any:
    """Make a dispatcher compile without an interruption, also where nothing can be kept."""
    usual = made.compile

    def compiled(signature: Any) -> Any:
        if isinstance(signature, tuple):  # one kernel for all values of a constant
            signature = tuple(map(numba.types.unliteral, signature))
        with deferred():
            try:
                return usual(signature)
            except (OSError, EOFError, UnpicklingError) as error:  # full, or damaged
                why = getattr(error, "strerror", error)
                _warn_once(f"compiled kernels cannot be kept in {directory()}: {why}")
                made._cache = NullCache()
                return usual(signature)

    made.compile = compiled
    return made


def _one_at_a_time(made: Any, folder: Path) -> Any:
    """Make processes keep kernels one at a time: Numba would give two the same file to write."""
    save = made._cache.save_overload

    def saved(*compiled: Any) -> None:
        with (folder / "lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            save(*compiled)

    made._cache.save_overload = saved
    return made
