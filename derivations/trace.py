"""What a derivation rests on, noted while it is computed.

An axiom notes its use (`note`). `derived` caches a derivation together with the axioms that it
used, so that a cached result hands the note on.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any

_open: list[set[str]] = []  # axioms used by the derivations now being computed, the inner one last

STEPS: dict[str, Callable[..., Any]] = {}  # every derivation step, by module and name
_caches: list[dict] = []
_bent: dict[str, Callable[[Any], Any]] = {}  # steps whose result is changed, for a trial


def note(*tags: str) -> None:
    """Count axioms among those that the derivation now being computed rests on."""
    if _open:
        _open[-1].update(tags)


@contextmanager
def noted() -> Iterator[set[str]]:
    """Collect the tags of the axioms that are used inside; they count outside, too."""
    used: set[str] = set()
    _open.append(used)
    try:
        yield used
    finally:
        _open.pop()
        note(*used)


def remembered(function: Callable[..., Any]) -> Callable[..., Any]:
    """Cache results by positional arguments, each with the axioms that it rests on."""
    results: dict[tuple, tuple[Any, set[str]]] = {}

    @wraps(function)
    def cached(*given: Any) -> Any:
        if given not in results:
            with noted() as used:
                results[given] = function(*given), used
        value, used = results[given]
        note(*used)
        return value

    _caches.append(results)
    return cached


def derived(function: Callable[..., Any]) -> Callable[..., Any]:
    """Register a derivation step, and cache it as `remembered` does."""
    name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"

    @wraps(function)
    def step(*given: Any) -> Any:
        value = function(*given)
        return _bent[name](value) if name in _bent else value

    STEPS[name] = function
    return remembered(step)


def forget() -> None:
    """Empty all caches, so that every derivation is computed again."""
    for results in _caches:
        results.clear()


@contextmanager
def bent(name: str, change: Callable[[Any], Any]) -> Iterator[None]:
    """Change what one step of `STEPS` gives, for a trial; everything is derived again."""
    _bent[name] = change
    forget()
    try:
        yield
    finally:
        del _bent[name]
        forget()
