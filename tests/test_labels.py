"""Labelled arguments (pandas, xarray) are never paired by position against their labels."""

import inspect
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

import impact

from .test_public_api import BODIES, call


class Index(list):
    """As much of a pandas index as is looked at."""

    def equals(self, other):
        return self == other


def labelled(values, **labels):
    """What looks like a pandas object (`axes`), or like an xarray one (`dims`, `indexes`)."""
    kind = type("Like", (SimpleNamespace,), {"__array__": lambda *_, **__: np.array(values)})
    return kind(**labels)


def pair(name, *index):
    """Two elements of an argument, labelled by an index; of a body, or a geometry's tilt."""
    array = np.full(2, {"c_z": -2.0, "length": 8.0}.get(name, 0.4))
    array = labelled(array, axes=[Index(index)]) if index else array
    if name in BODIES:
        return BODIES[name]._replace(c_x=array)
    return impact.thin_rod(array) if name == "geometry" else array


PAIRED = [
    (function, *names)
    for function in (x for x in impact.__all__ if inspect.isfunction(getattr(impact, x)))
    for names in combinations(inspect.signature(getattr(impact, function)).parameters, 2)
    if not {*names} & {"law", "density", "points"}
]


@pytest.mark.parametrize(("function", "one", "other"), PAIRED)
def test_labels_that_differ_are_refused_and_equal_ones_are_not(function, one, other):
    """Whichever two arguments bear them: none are paired by position against their labels."""
    unlike = r"must have equal labels, got \[7, [89]\] .* \[7, [89]\];"
    with pytest.raises(ValueError, match=unlike) as error:
        call(function, **{one: pair(one, 7, 8), other: pair(other, 7, 9)})
    assert one in str(error.value)
    assert other in str(error.value)
    alike = call(function, **{name: pair(name, 7, 8) for name in (one, other)})
    np.testing.assert_equal(alike, call(function, **{name: pair(name) for name in (one, other)}))


def test_labels_are_compared_as_axes_are_paired():
    """From the last axis; a dimension without an index, and a plain array, fit to any labels."""
    along = labelled([1.0, 2.0], dims=["x"], indexes={"x": Index("ab")})
    table = labelled(np.ones((2, 2)), dims=["y", "x"], indexes={"x": Index("ab")})
    bare = labelled([0.3, 0.4], dims=["x"])
    for fine in (bare, table, np.full((2, 2), 0.3), labelled([0.3, 0.4], axes=[Index("ab")])):
        assert np.shape(call("collide", c_x=along, friction=fine).c_x)[-1:] == (2,)
    across = labelled([0.3, 0.4], dims=["y"])
    turned = labelled(np.ones((2, 2)), dims=["x", "y"])
    for unlike in (across, turned, labelled([0.3, 0.4], axes=[Index("ac")])):
        with pytest.raises(ValueError, match=r"c_x and friction must .* got ('x'|\['a', 'b'\])"):
            call("collide", c_x=along, friction=unlike)
    with pytest.raises(ValueError, match=r"got \['a', 'b', 'c'\] where the other has \['a', 'b'\]"):
        call("collide", c_x=labelled([1.0] * 3, axes=[Index("abc")]), friction=along)
