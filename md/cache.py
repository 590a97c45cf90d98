"""Compile once, and never run a stale kernel.

Numba's disk cache looks at the file of a function, not at the files of what it calls. Here the
cache lives in a folder named after a digest of all sources of this package, outside the checkout;
an edit anywhere in it compiles anew.
"""

import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

import numba

from .interrupt import deferred

_APART = {
    *("__init__.py", "__main__.py", "interrupt.py", "store.py", "sweep.py", "trajectory.py"),
    "writing.py",
    *("dial/__init__.py", "dial/calibration.py"),
}
_KEPT = 30 * 86400  # seconds an unused folder of other sources is kept


def digest() -> str:
    """Twelve hexadecimal digits that stand for the sources that decide what a run gives."""
    folder = Path(__file__).parent
    content = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        name = path.relative_to(folder).as_posix()
        if name in _APART:
            continue
        content.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    return content.hexdigest()[:12]


@cache
def directory() -> Path:
    """Folder of the compiled kernels; a temporary one where the user's cannot be written."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    home = Path(base) / "rod-impact"
    folder = home / digest()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        folder.touch()
        for other in home.iterdir():
            if other != folder and time.time() - other.stat().st_mtime > _KEPT:
                shutil.rmtree(other, ignore_errors=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"rod-impact-{os.getuid()}" / digest()
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def kernel(function: Callable | None = None, *, inline: bool = True) -> Callable:
    """Compile on first call and keep the result; IEEE arithmetic, no exception on a division.

    What is small goes into its caller: a call would return its tuple through memory. No kernel
    counts references to arrays (`_nrt`): in inlined functions that took three quarters of the time
    of a step. In return a kernel cannot allocate, and Numba refuses one that would.
    """
    if function is None:
        return partial(kernel, inline=inline)
    usual = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(directory())  # read when caching is enabled, not later
    try:
        options = {"cache": True, "error_model": "numpy", "forceinline": inline, "_nrt": False}
        made = numba.njit(**options)(function)
    finally:
        numba.config.CACHE_DIR = usual
    if not numba.config.DISABLE_JIT:
        made.compile = deferred()(made.compile)
    return made
