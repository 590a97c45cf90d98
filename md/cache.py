"""Compile once, and never run a stale kernel.

Numba's disk cache looks at the file of a function, not at the files of what it calls. Here the
cache lives outside the checkout, in a folder named after the bytes of all files with kernels and of
what these use; an edit of any of them compiles all kernels again.
"""

import math
import multiprocessing
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator

from .files import warn
from .interrupt import deferred
from .sources import digest_of_kernels

_KEPT = 30 * 86400  # seconds an unused folder of other sources is kept


@cache
def directory() -> Path | None:
    """Folder of the compiled kernels; a temporary one where the user's takes no files, or None."""
    try:
        home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rod-impact"
        folder = _usable(home)
        for other in home.iterdir():
            if other != folder and time.time() - other.stat().st_mtime > _KEPT:
                shutil.rmtree(other, ignore_errors=True)
        return folder
    except (OSError, RuntimeError) as error:  # RuntimeError: a user without a home
        refused = f"compiled kernels cannot be kept in the user's cache ({error})"
    try:
        folder = _usable(Path(tempfile.gettempdir()) / f"rod-impact-{os.getuid()}")
    except OSError:
        _warn_once(f"{refused} nor in a temporary folder: they are compiled each time")
        return None
    _warn_once(f"{refused}: they are in {folder}")
    return folder


def _usable(home: Path) -> Path:
    """The folder of these sources, which takes files."""
    folder = home / digest_of_kernels()
    folder.mkdir(parents=True, exist_ok=True)
    folder.touch()
    with tempfile.TemporaryFile(dir=folder):
        return folder


@cache
def _warn_once(message: str) -> None:
    """Warn once, and not in each worker as well."""
    if multiprocessing.current_process().name == "MainProcess":
        warn(message)


class _Kernels(CompileResultCacheImpl):
    _locator_classes = (UserProvidedCacheLocator,)  # never beside the sources, where it goes stale


class _Cache(FunctionCache):
    """Numba's cache of one function; what cannot be read or kept is compiled each time."""

    _impl_class = _Kernels

    def __init__(self, function: Callable, options: dict[str, Any]) -> None:
        super().__init__(function)
        self._options = tuple(sorted(options.items()))

    def _index_key(self, sig: Any, codegen: Any) -> tuple:
        return *super()._index_key(sig, codegen), self._options

    @contextmanager
    def _guard_against_spurious_io_errors(self) -> Iterator[None]:  # Numba's own is for Windows
        try:
            yield
        except OSError as error:
            _warn_once(f"compiled kernels cannot be kept in {directory()}: {error.strerror}")


def kernel(function: Callable | None = None, *, inline: bool = True) -> Callable:
    """Compile on first call and keep the result; IEEE arithmetic, no exception on a division.

    What is small goes into its caller: a call would return its tuple through memory. No kernel
    counts references to arrays (`_nrt`): in inlined functions that took three quarters of the time
    of a step. In return a kernel cannot allocate, and Numba refuses one that would.

    What is inlined has no entry for calls from Python: a third of the time to compile would go into
    these. Where Python calls such a function, a twin with an entry is compiled.
    """
    if function is None:
        return partial(kernel, inline=inline)
    found = _dispatcher(function, forceinline=inline, no_cpython_wrapper=inline)
    if numba.config.DISABLE_JIT:
        if "sqrt" in function.__globals__:
            function.__globals__["sqrt"] = _root
        return found
    if inline:
        called = cache(partial(_dispatcher, function))
        found._insert = lambda *_: None  # what has no entry cannot be called, and crashes
        found._compile_for_args = lambda *_, **__: called()
    return found


def _root(x: float) -> float:
    """Square root as compiled code has it: Python's own raises for a negative number."""
    return math.sqrt(x) if x >= 0.0 else math.nan


def _dispatcher(function: Callable, **options: bool) -> Any:
    """Numba's, with the cache of this module."""
    how = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True, "nogil": True}
    found = numba.njit(**how, **options)(function)
    usual, folder = numba.config.CACHE_DIR, directory()
    numba.config.CACHE_DIR = str(folder or "")  # read when a cache is made, not later
    try:
        if folder is not None:
            found._cache = _Cache(function, options)  # as `enable_caching` does with its own
    except (OSError, RuntimeError):  # RuntimeError: no locator
        _warn_once(f"compiled kernels cannot be kept in {folder}")
    finally:
        numba.config.CACHE_DIR = usual
    if not numba.config.DISABLE_JIT:
        found.compile = deferred()(found.compile)
    return found
