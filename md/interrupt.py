"""Signals held back until a compilation or a call of compiled code has ended.

A handler that raises in the midst of a compilation leaves Numba with half a function, or is lost
in a callback of LLVM. `impact._interrupt` is a twin: neither package imports the other.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

SIGNALS = signal.SIGINT, signal.SIGTERM, signal.SIGALRM


@contextmanager
def deferred() -> Iterator[None]:
    """Hold back the `SIGNALS` that Python handles; their handlers run at the end. May be nested."""
    usual: dict[int, Any] = {}
    noted: dict[int, bool] = {}
    over = False
    if threading.current_thread() is threading.main_thread():  # no other one runs handlers
        usual = {n: found for n in SIGNALS if callable(found := signal.getsignal(n))}

    def note(number: int, frame: Any) -> None:
        if over:
            usual[number](number, frame)
        noted[number] = True

    try:
        for number in usual:
            signal.signal(number, note)
        yield
    finally:
        over = True
        for number, handler in usual.items():
            signal.signal(number, handler)
        with ExitStack() as stack:  # one that raises keeps none of the others from running
            for number in noted:
                stack.callback(signal.raise_signal, number)
