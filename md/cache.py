"""Compile once, and never run a stale kernel.

Numba's disk cache looks at the file of a function, not at the files of what it calls. Here it is
given a folder named after the bytes of all files with kernels and of what these use; an edit of any
of them compiles all kernels again. The folder is below NUMBA_CACHE_DIR, else in the user's cache.
"""

import fcntl
import math
import multiprocessing
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import NullCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import NativeLowering

from .files import warn
from .interrupt import deferred
from .sources import digest_of_kernels

_KEPT = 30 * 86400  # seconds an unused folder of other sources is kept
_OPTIONS = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True, "nogil": True}


@cache
def directory() -> Path | None:
    """Folder of the compiled kernels, of these sources; None if it takes no files."""
    try:
        chosen = numba.config.CACHE_DIR or os.environ.get("XDG_CACHE_HOME")
        home = Path(chosen or Path.home() / ".cache") / "rod-impact"
        folder = home / digest_of_kernels()
        folder.mkdir(parents=True, exist_ok=True)
        folder.touch()
        with tempfile.TemporaryFile(dir=folder):
            pass
        for other in home.iterdir():
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
    """Warn once, and not in each worker as well."""
    if multiprocessing.current_process().name == "MainProcess":
        warn(message)


class _Part(JITCodeLibrary):
    """Code that only goes into that of its callers, where it is optimised and made native."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _PartLowering(NativeLowering):
    """Numba's step from types to LLVM's language, of a function without an address."""

    _name = "part_lowering"

    def run_pass(self, state: Any) -> bool:
        """Leave the code where callers find it."""
        state.library = _Part(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        found_by = object()
        state.targetctx.insert_user_function(found_by, state.cr.fndesc, [state.library])
        state.cr = state.cr._replace(cfunc=found_by)
        return True


class _PartCompiler(CompilerBase):
    """Numba's, with `_PartLowering`."""

    def define_pipelines(self) -> list[PassManager]:
        """The usual steps but one."""
        passes = PassManager("part")
        for step, purpose in DefaultPassBuilder.define_nopython_pipeline(self.state).passes:
            passes.add_pass(_PartLowering if step is NativeLowering else step, purpose)
        passes.finalize()
        return [passes]


def kernel(function: Callable | None = None, *, inline: bool = True) -> Callable:
    """Compile on first call and keep the result; IEEE arithmetic, no exception on a division.

    What is small goes into its caller: a call would return its tuple through memory. No kernel
    counts references to arrays (`_nrt`): in inlined functions that took three quarters of the time
    of a step. In return a kernel cannot allocate, and Numba refuses one that would.

    What is inlined has neither an entry for calls from Python, into which a third of the time to
    compile would go, nor native code of its own, which takes a fifth of the rest; it is not kept.
    Where Python calls such a function, a twin with an entry is compiled; Numba's public options
    cannot say so, and two private methods of its dispatcher are replaced.
    """
    if function is None:
        return partial(kernel, inline=inline)
    if numba.config.DISABLE_JIT:
        if "sqrt" in function.__globals__:
            function.__globals__["sqrt"] = _root
        return function
    if not inline:
        return _kept(function)
    options = {"forceinline": True, "no_cpython_wrapper": True, "pipeline_class": _PartCompiler}
    part = _compiling(numba.njit(**options, **_OPTIONS)(function))
    called = cache(partial(_kept, function))
    part._insert = lambda *_: None  # what has no entry cannot be called, and crashes
    part._compile_for_args = lambda *_, **__: called()
    return part


def _root(x: float) -> float:
    """Square root as compiled code has it: Python's own raises for a negative number."""
    return math.sqrt(x) if x >= 0.0 else math.nan


def _kept(function: Callable) -> Any:
    """Numba's dispatcher; what it compiles is kept in our folder, where that can be."""
    return _compiling(_cached(function) or numba.njit(**_OPTIONS)(function))


def _compiling(made: Any) -> Any:
    """Let a dispatcher compile without an interruption, and go on where nothing can be kept."""
    usual = made.compile

    def compiled(signature: Any) -> Any:
        if isinstance(signature, tuple):  # one kernel for all values of a constant
            signature = tuple(map(numba.types.unliteral, signature))
        with deferred():
            try:
                return usual(signature)
            except OSError as error:
                _warn_once(f"compiled kernels cannot be kept in {directory()}: {error.strerror}")
                made._cache = NullCache()
                return usual(signature)

    made.compile = compiled
    return made


def _one_at_a_time(made: Any, folder: Path) -> Any:
    """Let one process keep what it compiles at a time: Numba gives two the same file to write."""
    save = made._cache.save_overload

    def saved(*compiled: Any) -> None:
        with (folder / "lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            save(*compiled)

    made._cache.save_overload = saved
    return made


def _cached(function: Callable) -> Any:
    """Numba's dispatcher that keeps what it compiles in our folder; None where it would not."""
    folder, usual = directory(), numba.config.CACHE_DIR
    if folder is None:
        return None
    try:
        numba.config.CACHE_DIR = str(folder)  # read when a function is decorated, not later
        made = numba.njit(cache=True, **_OPTIONS)(function)
        if Path(made.stats.cache_path).is_relative_to(folder):  # else it is beside the sources
            return _one_at_a_time(made, folder)
    except (OSError, RuntimeError):  # RuntimeError: no place at all
        pass
    finally:
        numba.config.CACHE_DIR = usual
    _warn_once(f"compiled kernels cannot be kept in {folder}")
    return None
