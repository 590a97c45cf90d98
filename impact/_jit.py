"""Numba's compiler as this package uses it: IEEE arithmetic, compiled without an interruption."""

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numba

from ._interrupt import deferred


class CompilerError(ImportError):
    """Error: Numba's compiler is switched off, which every kernel of this package needs."""

    exit_code = 2  # of a command that it ends


if numba.config.DISABLE_JIT:
    raise CompilerError("NUMBA_DISABLE_JIT is set: the compiled part of impact needs the compiler")


def kernel(function: Callable | None = None, *, forceinline: bool = False) -> Any:
    """Compile a function on its first call; a division by zero raises nothing.

    A function that is inlined gets no entry for calls from Python: a third of the time to compile
    would go into these. Where Python calls such a function, a twin with an entry is compiled;
    `md.cache` does the same.
    """
    if function is None:
        return partial(kernel, forceinline=forceinline)
    if not forceinline:
        return _dispatcher(function)
    made = _dispatcher(function, forceinline=True, no_cpython_wrapper=True)
    called = cache(partial(_dispatcher, function))
    made._insert = lambda *_: None  # a function without an entry crashes when Python calls it
    made._compile_for_args = lambda *_, **__: called()
    return made


def _dispatcher(function: Callable, **options: Any) -> Any:
    """Dispatcher of Numba, whose compilation is not interrupted by signals."""
    made = numba.njit(error_model="numpy", no_cfunc_wrapper=True, **options)(function)
    made.compile = deferred()(made.compile)
    return made
