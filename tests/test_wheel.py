"""The wheel: what is in it, and every command from it, in an empty folder, without a checkout."""

import os
import re
import shlex
import shutil
import zipfile
from concurrent.futures import ThreadPoolExecutor

import pytest

from .command_line import DOCS, PACKAGES, ROOT, names_in, python, read_toml

VERSION = read_toml("pyproject.toml")["project"]["version"]
WHERE = f"""
import os, {", ".join(PACKAGES)}
from figures.claims import judge as claims
assert len(claims.read()) == 29
for package in ({", ".join(PACKAGES)}):
    assert package.__file__.startswith(os.environ["PYTHONPATH"])
assert impact.__version__ == md.__version__
print(md.__version__)
"""
KEPT = ".py .toml .json .csv .mplstyle .typed .html .css .js .jinja"
# What comes after `python`, its exit code and what it prints, on stderr if it fails.
COMMANDS = {
    "import": (f"-c {shlex.quote(WHERE)}", 0, VERSION),
    "generate": ("-m derivations generate", 2, "needs a source checkout"),
    "impact": ("-m md impact --tilt-deg 20 --c-x .5 --c-z -1 --integrator dop853", 0, "slip-stick"),
    "explore": ("-m figures explore --html out/impact.html", 0, "impact.html"),
    "draw": ("-m figures draw fig10 --quick", 0, "fig10.png"),
}


def test_the_version_stands_in_one_place_and_others_agree():
    """It stands in `pyproject.toml`; citations and the change log's newest heading repeat it."""
    assert f"version = {{{VERSION}}}" in (DOCS / "installation.md").read_text("utf-8")
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.findall(r"^version: (.+)$", citation, re.M) == [VERSION]
    (released,) = re.findall(r"^date-released: (\d{4}-\d\d-\d\d)$", citation, re.M)
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    newest = re.search(r"^## .+$", changes, re.M)[0]
    assert newest in (f"## {VERSION}, unreleased", f"## {VERSION}, {released}")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Built from a copy of the checkout, without network."""
    source = tmp_path_factory.mktemp("source")
    for name in ("pyproject.toml", "README.md", "LICENSE", "CITATION.cff"):
        shutil.copy(ROOT / name, source)
    for package in PACKAGES:
        shutil.copytree(ROOT / package, source / package)
    build = "from setuptools.build_meta import build_wheel; build_wheel('dist')"
    built = python("-c", build, cwd=source)
    assert built.returncode == 0
    (path,) = (source / "dist").iterdir()
    return path


def test_the_wheel_holds_all_sources_and_data_and_nothing_else(wheel):
    wanted = {
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*")
        if path.suffix in KEPT.split()
        and not {"gallery", "docs"} & {*path.relative_to(ROOT / package).parts}  # of a checkout
    }
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    about = {name for name in names if name.startswith(f"rod_impact-{VERSION}.dist-info/")}
    assert names - about == wanted
    assert {"LICENSE", "CITATION.cff"} <= {name.rpartition("/")[2] for name in about}


@pytest.fixture(scope="module")
def outcomes(wheel, tmp_path_factory):
    """What every command did, side by side, in an empty folder, with an empty cache."""
    installed = tmp_path_factory.mktemp("installed")  # as an installation of the wheel
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(installed)
    empty, cache = tmp_path_factory.mktemp("empty"), tmp_path_factory.mktemp("cache")
    # Before the checkout, which this environment may hold too; the wheel's folder stays as it is.
    own = {
        "PYTHONPATH": str(installed),
        "PYTHONDONTWRITEBYTECODE": "1",
        "XDG_CACHE_HOME": str(cache),
        "NUMBA_CACHE_DIR": "",
    }
    before = set(installed.rglob("*"))

    def outcome(name):
        return python(*shlex.split(COMMANDS[name][0]), cwd=empty, **own)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(COMMANDS, pool.map(outcome, COMMANDS), strict=True))
    assert set(installed.rglob("*")) == before  # kernels are cached elsewhere
    assert list(cache.rglob("*.nbc"))
    assert names_in(empty) == {"out"}
    return found


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_run_without_a_checkout(outcomes, name):
    done, (_, code, word) = outcomes[name], COMMANDS[name]
    assert done.returncode == code
    assert word in (done.stderr if code else done.stdout)
    assert not code or done.stderr.count("\n") == 1
