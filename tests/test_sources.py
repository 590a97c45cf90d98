"""The digest that decides whether a stored run is stale: formulas and constants, not words."""

import pytest

from md import cache

from .command_line import read_toml

EDITS = read_toml("tests/edits.toml")["sources"]
USED = cache.used(cache.RUN)


@pytest.fixture
def edited(monkeypatch):
    """A function that gives the digest after an edit of a module."""

    def digest(module, source):
        monkeypatch.setitem(cache.SOURCES, module, source.encode())
        cache.used.cache_clear()
        return cache.digest.__wrapped__()

    yield digest
    monkeypatch.undo()
    cache.used.cache_clear()


@pytest.mark.parametrize(("old", "new", "same"), EDITS["edits"])
def test_only_formulas_and_constants_make_what_is_stored_stale(edited, old, new, same):
    """Formulas and constants do; words, hints and comments do not."""
    source = EDITS["module"]
    assert old in source
    assert (edited("laws", source) == edited("laws", source.replace(old, new))) == same


@pytest.mark.parametrize("module", sorted(cache.SOURCES))
def test_each_module_that_a_run_uses_counts(edited, module):
    after = edited(module, cache.SOURCES[module].decode() + "\nMORE = 1\n")
    assert (after != cache.digest()) == (module in USED)


def test_runs_do_not_depend_on_commands_stores_and_sweeps():
    assert {"__init__", "__main__", "cache", "files", "store", "sweep"}.isdisjoint(USED)
    assert {"accuracy", "kernels.march", "kernels.surfaces", "laws", "measures"} <= set(USED)
