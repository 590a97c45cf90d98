"""What is public is listed and documented in NumPy style; examples in docstrings run."""

import doctest
import importlib
import inspect
import re
from enum import Enum
from types import FunctionType

import pytest

from .command_line import PACKAGES, ROOT, python, read_toml
from .test_imports import modules

# The public modules; of each, what `__all__` holds is public, or all of its own without a list.
PUBLIC = [
    "derivations",
    "derivations.registry",
    "figures",
    "impact",
    "impact.bouncing",
    "impact.compiled",
    "md",
    "md.records",
    "md.search",
    "md.store",
    "md.sweep",
]


def own_names(module):
    """Names of what a module defines itself, but those that begin with an underscore."""
    things = vars(importlib.import_module(module)).items()
    return [n for n, x in things if n[0] != "_" and getattr(x, "__module__", None) == module]


def public(module):
    """Public names with their module, and what they are; kernels as the function they compile."""
    loaded = importlib.import_module(module)
    names = getattr(loaded, "__all__", own_names(module))
    things = {name: getattr(loaded, name) for name in names}
    return {f"{module}.{name}": getattr(x, "py_func", x) for name, x in things.items()}


NAMES = {name: thing for module in PUBLIC for name, thing in public(module).items()}


@pytest.mark.parametrize("name", PUBLIC)
def test_public_modules_list_what_is_public(name):
    module = importlib.import_module(name)
    assert {f"{name}.{own}" for own in own_names(name)} <= NAMES.keys()
    assert {f"{name}.{listed}" for listed in dir(module)} >= {*public(name)}  # for `help`
    package = importlib.import_module(name.partition(".")[0])
    assert package is module or name in package.__doc__


def described(doc):
    """Names that a docstring explains, in lines such as `c_x, c_z : velocity ...`."""
    lines = re.findall(r"^(\w+(?:, \w+)*) : \S", inspect.cleandoc(doc), re.M)
    return {name for line in lines for name in line.split(", ")}


def lacks(thing):
    """What has no explanation in a function or class: itself, a parameter, a field, a method.

    That a property has one, ruff sees.
    """
    doc = thing.__doc__ or ""
    if not doc or doc.startswith(f"{thing.__name__}("):  # that a named tuple has by itself
        return {thing.__name__}
    known, found = described(doc) | {"self"}, set()
    if inspect.isclass(thing):
        if issubclass(thing, BaseException | Enum):
            return set()
        for kind in thing.__mro__:
            if kind.__module__.partition(".")[0] in PACKAGES:
                known |= described(kind.__doc__ or "")
        for name, member in vars(thing).items():
            if name[0] != "_" and isinstance(member, FunctionType):
                found |= lacks(member)
    return found | set(inspect.signature(thing).parameters) - known


@pytest.mark.parametrize("name", NAMES)
def test_public_names_are_documented(name):
    """Every parameter, field and method is; constants in the module's docstring."""
    module, _, own = name.rpartition(".")
    if callable(NAMES[name]):
        assert lacks(NAMES[name]) == set()
    else:
        assert f"`{own}`" in importlib.import_module(module).__doc__


TYPED = """
from math import radians
from typing import Any, assert_type

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset

import impact
import md
from impact.bouncing import Bouncing

rod = impact.thin_rod(radians(20))
rods = impact.flat_ended_rod(np.linspace(0, 1, 3), 8)
ball = impact.Body(1.0, 0.6, 0.0, 1.0, 0.0, -1.0)
one = impact.collide(0.1, -0.2, geometry=rod, friction=1, restitution=0.65)
many = impact.collide(0.1, -0.2, geometry=rods, friction=0.3, restitution=0.65)
assert_type(one.c_x, float)
assert_type(one.regime, impact.Regime)
assert_type(many.c_x, NDArray[np.float64])
assert_type(many.regime, NDArray[np.int8])
assert_type(impact.drift(rod, friction=0.3, restitution=0.65).c_x, float)
assert_type(impact.drift(rod, friction=[0.3], restitution=0.65).c_x, NDArray[np.float64])
assert_type(impact.optimal_tilt(friction=0.3, restitution=0.65).tilt, float)
pair = impact.collide_pair(ball, ball.turned(3.0), friction=0.3, restitution=0.65)
assert_type(pair.first.omega, float)
assert_type(impact.classify(0.1, -0.2, geometry=rod, friction=1, restitution=1), impact.Regime)
assert_type(impact.classify(0.1, -0.2, geometry=rods, friction=1, restitution=1), NDArray[np.int8])
assert_type(impact.critical_tilts(1), tuple[float, float])
assert_type(impact.mean_plate_velocity(), float)
numbers = [
    impact.critical_friction(rod),
    impact.painleve_friction(rod),
    impact.slide_friction(rod, approach_ratio=2, restitution=0.65),
    impact.energy_restitution(rod, 0.3),
    impact.relaxation(rod, friction=0.3, restitution=0.65),
    impact.landing_density(0.1),
]
assert_type(numbers, list[float])
arrays = [
    *impact.critical_tilts([0.1]),
    impact.critical_friction(rods),
    impact.painleve_friction(rods),
    impact.slide_friction(rod, approach_ratio=[2], restitution=0.65),
    impact.energy_restitution(rods, 0.3),
    impact.relaxation(rods, friction=0.3, restitution=0.65),
    impact.landing_density(0.1, fall_speed=[1]),
    impact.mean_plate_velocity(plate_speed=[1]),
]
assert_type(arrays, list[NDArray[np.float64]])


def told(result: md.Result, sweep: md.sweep.Sweep, bounced: Bouncing) -> None:
    assert_type(bounced.drift.mean, float)
    assert_type(bounced.phases.error, NDArray[np.float64])
    assert_type(md.run(result.scene).touches, dict[str, dict[str, float]] | None)
    assert_type(result.c_x_cm_s, float)
    assert_type(result.to_xarray(), Dataset)
    assert_type(sweep.to_xarray("a.db", "c_x"), Dataset)
    assert_type(md.records.touches([], result), Dataset)


impact.collide(0.1, -0.2, geometry=rods, frictio=0.3, restitution=0.65)  # type: ignore
"""


def test_public_functions_have_hints():
    """All but `impact.compiled.collide`, which has the type of `impact.collide`."""
    bare = {
        name
        for name, x in NAMES.items()
        if inspect.isfunction(x)
        and any(p.annotation is p.empty for p in inspect.signature(x).parameters.values())
    }
    assert bare == {"impact.compiled.collide"}


def test_types_hold():
    checked = python("-m mypy")
    assert checked.returncode == 0, checked.stdout


def test_a_script_under_strict_mypy_has_numbers_and_arrays(tmp_path):
    """No field of a result that is read is Any; a misspelt name is still told."""
    (tmp_path / "script.py").write_text(TYPED)
    exec(TYPED.rpartition("\nimpact.")[0], {})
    told = python("-m mypy --strict --follow-imports=silent script.py", cwd=tmp_path)
    assert told.returncode == 0, told.stdout


@pytest.mark.parametrize(
    "name",
    [
        name.removesuffix(".__init__")
        for package in PACKAGES
        for name, file in modules(package).items()
        if ">>> " in file.read_text("utf-8")
    ],
)
def test_examples_run(name, here):
    """Examples in docstrings run as they stand, in an empty folder."""
    found = doctest.testmod(importlib.import_module(name))

    assert found.attempted > 0
    assert found.failed == 0


@pytest.mark.parametrize("package", PACKAGES)
def test_the_layout_names_every_file(package):
    """The package's docstring names it in a left column; a folder stands for its modules."""
    folder = ROOT / package
    layout = re.split(
        r"^Files, as one reads them\n-+\n", importlib.import_module(package).__doc__, flags=re.M
    )[1]
    named = set()
    for row in re.findall(r"^(\S.*?)  +\S", layout.split("\n\n")[0], re.M):
        inside = ""
        for name in row.split(", "):
            room, _, own = name.rpartition("/")
            inside = room or inside
            named.add(f"{inside}/{own}".strip("/"))
    rooms = {name for name in named if (folder / name).is_dir()}
    modules = {path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.py")}
    aside = re.compile(rf"({'|'.join(rooms)})/|(.*/)?__init__")
    assert {name for name in modules if not aside.match(name)} == named - rooms


@pytest.mark.parametrize(("file", "names"), read_toml("tests/longer.toml").items())
def test_the_list_of_longer_tests_names_tests(file, names):
    """A test of another name would come back to the quick ones unseen."""
    there = re.findall(r"^def (test_\w+)", (ROOT / f"tests/{file}.py").read_text("utf-8"), re.M)
    for name in names:
        begin = re.match(r"\w+", name)[0]
        assert any(one.startswith(begin) for one in there)
