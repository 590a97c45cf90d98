"""Compiled kernels are kept from one process to the next, and never outlive their sources."""

import json
import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib import import_module
from pathlib import Path
from unittest.mock import Mock

import numba
import pytest
from numba.core.caching import IndexDataCacheFile

from impact import _jit
from md import cache

from .command_line import ROOT, python
from .test_files import FULL


def half(x):
    return x / 2


CALL = """
import json, md
from md.kernels.contact import Normal
from md.kernels.march import of_plate
energy = of_plate(Normal(1.0), None, 0.0, (0.0, 0.0), (0.0, 1.0), 0.5)
stats = of_plate._compile_for_args().stats  # of the twin that Python calls
counts = [sum(found.values()) for found in (stats.cache_hits, stats.cache_misses)]
print(json.dumps([md.__file__, energy, *counts]))
"""


@pytest.fixture(autouse=True)
def no_folder_chosen(monkeypatch):
    """Leave out the folder that the environment names, here and in processes."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")


@pytest.fixture
def copy(tmp_path):
    """The package's sources in a place where they can be edited."""
    shutil.copytree(ROOT / "md", tmp_path / "md", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "md"


def run(copy, *words):
    """Run a program with the copy, in a process of its own, with a cache of its own."""
    home, kept_in = copy.parent, str(copy.parent / "cache")
    return python("-c", *words, cwd=home, PYTHONPATH=str(home), XDG_CACHE_HOME=kept_in)


def call(copy):
    """An energy from a fresh process, and whether its kernel was loaded or compiled."""
    done = run(copy, CALL)
    file, *rest = json.loads(done.stdout)
    assert Path(file).parent == copy
    return rest


def kept(copy):
    """Files of the cache and when they were written."""
    files = (copy.parent / "cache" / "rod-impact").rglob("*.nb?")
    return {file: file.stat().st_mtime_ns for file in files}


def test_kernels_are_kept_and_an_edit_anywhere_compiles_anew(copy):
    """An edit of a callee in another file, which Numba's own cache does not see, is not missed.

    `march.of_plate` asks `contact` for the elastic energy, which is doubled there.
    """
    assert call(copy) == [0.4, 0, 1]
    files = kept(copy)

    assert call(copy) == [0.4, 1, 0]
    assert kept(copy) == files

    source = (copy / "kernels" / "contact.py").read_text()
    edited = source.replace("return 0.4 * normal", "return 0.8 * normal")
    assert edited != source
    (copy / "kernels" / "contact.py").write_text(edited)
    assert call(copy) == [0.8, 0, 1]
    assert kept(copy).items() > files.items()  # the old ones are left, in a folder of their own


RACE = """
import sys, time
from numba.core.caching import IndexDataCacheFile
load = IndexDataCacheFile._load_index
def slow(self):
    found = load(self)
    time.sleep(0.5)  # in which the other process looks as well
    return found
IndexDataCacheFile._load_index = slow
from md.kernels import vectors
vectors.times(2.0, eval(sys.argv[1]))
"""


def test_processes_that_compile_at_once_do_not_mix_up_what_they_keep(copy):
    """Two keep the same function for other arguments, and both are there."""
    with ThreadPoolExecutor() as pool:
        for done in pool.map(partial(run, copy, RACE), ("(3.0,)", "(3.0, 4.0)")):
            assert done.returncode == 0
    [index] = [file for file in kept(copy) if file.suffix == ".nbi"]
    assert len({*index.parent.glob(f"{index.stem}.*.nbc")}) == 2


def test_without_a_folder_kernels_are_compiled_each_time(tmp_path, monkeypatch):
    """There can be no folder below a file, whoever asks; one line says so."""
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.warns(RuntimeWarning, match=r"^compiled kernels cannot be kept .*file.*: they are"):
        assert cache.directory.__wrapped__() is None
    monkeypatch.setattr(cache, "directory", lambda: None)
    assert cache.kernel(lambda x: 2 * x)(2.0) == 4.0
    done = python("-m md --help")
    assert (done.returncode, done.stderr.count("\n")) == (0, 1)
    assert "compiled kernels cannot be kept" in done.stderr


@pytest.mark.parametrize(
    ("what", "error", "why"),
    [
        ("_save_index", FULL, "No space left"),
        ("_load_index", Mock(side_effect=EOFError("cut")), "cut"),
    ],
)
def test_a_full_disk_or_a_damaged_file_costs_no_more_than_compiling(monkeypatch, what, error, why):
    """It is told once, whatever else is compiled."""
    monkeypatch.setattr(IndexDataCacheFile, what, error)
    double = cache.kernel(lambda x: 2 * x)
    cache._warn_once.cache_clear()
    with pytest.warns(RuntimeWarning, match=f"kernels cannot be kept in .*: {why}") as told:
        assert (double(2.0), double(2)) == (4.0, 4)
    assert len(told) == 1


def test_folders_of_old_sources_are_removed_in_time(tmp_path, monkeypatch):
    """Old folders go, also from the one that NUMBA_CACHE_DIR names; recent ones stay."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    old, recent = (tmp_path / "rod-impact" / name for name in ("0" * 12, "1" * 12))
    for folder in (old, recent):
        (folder / "kernels").mkdir(parents=True)
    os.utime(old, (0, 0))
    folder = cache.directory.__wrapped__()
    assert folder.name == cache.digest_of_kernels()
    assert {*folder.parent.iterdir()} == {recent, folder}
    monkeypatch.setattr(Path, "iterdir", lambda home: [home / "gone"])  # by another process
    assert cache.directory.__wrapped__() == folder


@pytest.mark.parametrize("compiler", [cache.kernel, partial(_jit.kernel, forceinline=True)])
def test_an_inlined_kernel_is_compiled_without_an_entry_until_python_calls_it(
    compiler, monkeypatch, tmp_path
):
    """No entry is there whichever call comes first, cached or not: it costs a third of the time."""
    monkeypatch.setattr(cache, "directory", lambda: tmp_path)

    def calling(kernel):
        return numba.njit(lambda x: kernel(x))

    for _ in range(2):
        inner, first = compiler(half), compiler(half)
        assert calling(inner)(3.0) == inner(3.0) == 1.5
        assert first(3.0) == calling(first)(3.0) == 1.5
        [compiled] = inner.overloads.values()
        assert not any("cpython" in f.name for f in compiled.library.get_defined_functions())


def test_arithmetic_is_that_of_ieee():
    """No kernel is compiled with `fastmath`, which would reorder sums and drop nan and -0."""
    from impact import bouncing, compiled, flight

    own = [import_module(f"md.{name}") for name in cache.SOURCES if name.startswith("kernels.")]
    modules = map(vars, [bouncing, compiled, flight, *own])
    kernels = [x for names in modules for x in names.values() if hasattr(x, "targetoptions")]
    assert len(kernels) > 100
    for kernel in kernels:
        assert not kernel.targetoptions.get("fastmath")
        assert kernel.targetoptions["error_model"] == "numpy"
