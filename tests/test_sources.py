"""The digest that decides whether a stored run is stale: formulas and constants, not words."""

import pytest

from md import cache

from .command_line import python, read_toml

EDITS = read_toml("tests/edits.toml")["sources"]
ROW = cache.used(cache.RUN, annulus=False)
ANNULUS = set(cache.used(cache.RUN)) - set(ROW)


@pytest.fixture
def edited(monkeypatch):
    """A function that gives the digests of a row and of an annulus after an edit of a module."""

    def digests(module, source):
        monkeypatch.setitem(cache.SOURCES, module, source.encode())
        cache.used.cache_clear()
        cache.digest.cache_clear()
        return cache.digest(), cache.digest(annulus=True)

    yield digests
    monkeypatch.undo()
    cache.used.cache_clear()
    cache.digest.cache_clear()


@pytest.mark.parametrize(("old", "new", "same"), EDITS["edits"])
def test_only_formulas_and_constants_make_what_is_stored_stale(edited, old, new, same):
    """Formulas and constants do; words, hints and comments do not."""
    source = EDITS["module"]
    assert old in source
    before, after = edited("laws", source), edited("laws", source.replace(old, new))
    assert [a == b for a, b in zip(before, after, strict=True)] == [same, same]


@pytest.mark.parametrize("module", sorted(cache.SOURCES))
def test_each_module_counts_for_the_runs_that_use_it(edited, module):
    row, annulus = cache.digest(), cache.digest(annulus=True)
    after = edited(module, cache.SOURCES[module].decode() + "\nMORE = 1\n")
    assert (after[0] != row) == (module in ROW)
    assert (after[1] != annulus) == (module in ROW or module in ANNULUS)


def test_runs_do_not_depend_on_commands_stores_and_sweeps():
    outside = {"__init__", "__main__", "accuracy", "cache", "files", "store", "sweep"}
    assert outside <= cache.SOURCES.keys() - set(ROW) - ANNULUS
    assert {"kernels.march", "kernels.touches", "laws", "measures"} <= set(ROW)
    assert {"kernels.walls", "placement"} == ANNULUS
    assert "accuracy" in cache.used(cache.WITH_TOLERANCE)


def test_a_row_runs_without_what_only_an_annulus_uses():
    """Every function of those modules fails here, and the row does not notice."""
    program = f"""
import importlib, md
for name in {sorted(ANNULUS)}:
    module = importlib.import_module(f"md.{{name}}")
    for key, value in list(vars(module).items()):
        if getattr(value, "__module__", "").startswith("md.") and callable(value):
            if value.__module__ == module.__name__ and not isinstance(value, type):
                setattr(module, key, None)
scene = md.load("quasi2d", ["rods.count=2", "box.length=3", "step.coarse=true", "step.size=5e-4"])
assert md.run(scene, periods=2).finished
"""
    assert python("-c", program).returncode == 0
