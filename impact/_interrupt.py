"""Signals held back until a compilation or a call of compiled code has ended.

A handler that raises in the midst of a compilation leaves Numba with half a function, or is lost
in a callback of LLVM. `md.cache.deferred` is a twin: neither package imports the other.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

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
