"""Numba's compiler as this package uses it: IEEE arithmetic, compiled without an interruption."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numba

from ._interrupt import deferred


class CompilerError(ImportError):
    """Numba's compiler is switched off, which no kernel of this package can do without."""

    exit_code = 2  # of a command that it ends


if numba.config.DISABLE_JIT:
    raise CompilerError("NUMBA_DISABLE_JIT is set: the compiled part of impact needs the compiler")


def kernel(function: Callable | None = None, **options: Any) -> Any:
    """Compile on first call; no exception on a division."""
    if function is None:
        return partial(kernel, **options)
    made = numba.njit(error_model="numpy", **options)(function)
    made.compile = deferred()(made.compile)
    return made
