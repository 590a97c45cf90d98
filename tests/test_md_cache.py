"""Compiled kernels are kept from one process to the next, and never outlive their sources."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

import md
from md import cache

PACKAGE = Path(md.__file__).parent
CALL = """
import json, md
from md.contact import Spring
from md.reference import STICK, held
force = held(Spring(root=1.0), 0.3, STICK, 1.0, 1.0, 0.1, 0.0, 0.0, 1.0)[0]
counts = [sum(found.values()) for found in (held.stats.cache_hits, held.stats.cache_misses)]
print(json.dumps([md.__file__, force, *counts]))
"""


@pytest.fixture
def copy(tmp_path) -> Path:
    """The package's sources in a place where they can be edited."""
    shutil.copytree(PACKAGE, tmp_path / "md", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "md"


def call(copy: Path) -> tuple[float, int, int]:
    """A force from a fresh process, and whether its kernel was loaded or compiled."""
    home = copy.parent
    environment = {**os.environ, "PYTHONPATH": str(home), "XDG_CACHE_HOME": str(home / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", CALL],
        **{"env": environment, "cwd": home, "capture_output": True, "text": True, "check": True},
    )
    file, *rest = json.loads(done.stdout)
    assert Path(file).parent == copy
    return tuple(rest)


def kept(copy: Path) -> dict[Path, int]:
    """Files of the cache and when they were written."""
    files = (copy.parent / "cache" / "rod-impact").rglob("*.nb?")
    return {file: file.stat().st_mtime_ns for file in files}


def test_kernels_are_kept_and_an_edit_anywhere_compiles_anew(copy):
    """An edit of a callee in another file, which Numba's own cache does not see, is not missed.

    `reference.held` asks `contact` for the stiffness of the spring, which is doubled there.
    """
    assert call(copy) == (-0.1, 0, 1)
    files = kept(copy)
    assert {file.suffix for file in files} == {".nbc", ".nbi"}
    assert any("reference.held" in file.name for file in files)

    assert call(copy) == (-0.1, 1, 0)
    assert kept(copy) == files

    source = (copy / "contact.py").read_text()
    edited = source.replace("k += root * sqrt", "k += 2 * root * sqrt")
    assert edited != source
    (copy / "contact.py").write_text(edited)
    assert call(copy) == (-0.2, 0, 1)
    assert kept(copy).items() > files.items()  # the old ones are left, in a folder of their own


def test_digest_is_of_the_sources_that_decide_and_of_nothing_else(copy, monkeypatch):
    """Not of the command, the store and what else gives no number of a run."""
    monkeypatch.setattr(cache, "__file__", str(copy / "cache.py"))
    before = cache.digest()
    assert before == cache.digest()
    (copy / "notes.txt").write_text("no source")
    os.utime(copy / "laws.py", (0, 0))
    assert cache.digest() == before
    for path in sorted(copy.glob("*.py")):
        source = path.read_bytes()
        path.write_bytes(source + b"\n")
        apart = path.name in cache._APART
        assert (cache.digest() == before) == apart
        path.write_bytes(source)
    assert cache.digest() == before
    (copy / "laws.py").rename(copy / "rules.py")
    assert cache.digest() != before


def test_a_home_that_cannot_be_written_costs_no_more_than_compiling(tmp_path, monkeypatch):
    """Below a file there can be no folder, whoever asks."""
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = cache.directory.__wrapped__()
    assert folder.is_dir()
    assert folder.is_relative_to(tmp_path)
    assert folder.name == cache.digest()


def test_folders_of_old_sources_are_removed_in_time(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    old, recent = (tmp_path / "rod-impact" / name for name in ("0" * 12, "1" * 12))
    for folder in (old, recent):
        folder.mkdir(parents=True)
        (folder / "kernel.nbc").touch()
    os.utime(old, (0, 0))
    folder = cache.directory.__wrapped__()
    assert set((tmp_path / "rod-impact").iterdir()) == {recent, folder}


def test_arithmetic_is_that_of_ieee():
    """No kernel is compiled with `fastmath`, which would reorder sums and drop nan and -0."""
    from md import contact, integrators, reference

    kernels = [
        kernel
        for module in (contact, integrators, reference)
        for kernel in vars(module).values()
        if hasattr(kernel, "targetoptions")
    ]
    assert len(kernels) > 20
    for kernel in kernels:
        assert not kernel.targetoptions.get("fastmath")
        assert kernel.targetoptions["error_model"] == "numpy"
