"""Labelled arguments (pandas, xarray) are never paired by position against their labels."""

import inspect
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

import impact

from .test_public_api import call


class Index(list):
    """As much of a pandas index as is looked at."""

    def equals(self, other):
        return self == other


def labelled(values, **labels):
    """What looks like a pandas object (`axes`), or like an xarray one (`dims`, `indexes`)."""
    kind = type("Like", (SimpleNamespace,), {"__array__": lambda *_, **__: np.array(values)})
    return kind(**labels)


def pair(name, *index):
    """Two elements of an argument, labelled by an index; a geometry is made from such a tilt."""
    array = np.full(2, {"c_z": -2.0, "length": 8.0}.get(name, 0.4))
    array = labelled(array, axes=[Index(index)]) if index else array
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
    with pytest.raises(ValueError, match=r"must have equal labels, got [89] .* [89];") as error:
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
        with pytest.raises(ValueError, match=r"c_x and friction must .* got '[xb]'"):
            call("collide", c_x=along, friction=unlike)
    with pytest.raises(ValueError, match="got 3 labels where the other has 2 labels"):
        call("collide", c_x=labelled([1.0] * 3, axes=[Index("abc")]), friction=along)


def test_labels_of_pandas():
    pandas = pytest.importorskip("pandas")
    c_x, friction = pandas.Series([1.0, 2.0]), pandas.Series([0.3, 0.4], index=[1, 0])
    with pytest.raises(ValueError, match=r"c_x and friction must have equal labels, got 0 .* 1"):
        call("collide", c_x=c_x, friction=friction)
    with pytest.raises(ValueError, match=r"c_x and geometry\.X must have equal labels"):
        call("collide", c_x=c_x, geometry=impact.thin_rod(friction))
    with pytest.raises(TypeError, match=r"geometry must be \(X, Z, k\)"):  # in this order
        call("collide", geometry=pandas.Series({"Z": 0.4, "X": 0.2, "k": 0.3}))
    plain = call("collide", c_x=c_x.to_numpy(), friction=friction.to_numpy())
    np.testing.assert_equal(call("collide", c_x=c_x.set_axis([1, 0]), friction=friction), plain)


def test_labels_of_xarray():
    xarray = pytest.importorskip("xarray")
    c_x, friction = xarray.DataArray([1.0, 2.0], dims="x"), xarray.DataArray([0.3, 0.4], dims="y")
    with pytest.raises(ValueError, match=r"c_x and friction must .* got 'x' .* 'y'"):
        call("collide", c_x=c_x, friction=friction)
    one, other = (friction.rename(y="x").assign_coords(x=[0, x]) for x in (1, 2))
    with pytest.raises(ValueError, match="friction and restitution must have equal labels, got 1 "):
        call("drift", friction=one, restitution=other)
    assert call("collide", c_x=c_x, friction=one).c_x.shape == (2,)
