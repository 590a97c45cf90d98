"""Labelled arguments (pandas, xarray) are never paired by position against their labels."""

from itertools import combinations

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_equal

from .test_public_api import SOLID, call, each_function, numbers_of


def along(index, value):
    """Two equal elements, with an index if there is one."""
    return pd.Series([value, value], list(index)) if index else np.full(2, value)


def paired(function, **indexes):
    """Result where some numbers are two equal ones, with an index if there is one."""
    values = numbers_of(function)
    return call(function, **{name: along(index, values[name]) for name, index in indexes.items()})


@each_function
def test_labels_that_differ_are_refused_and_equal_ones_are_not(function):
    """No two numbers are paired by position against their labels."""
    for one, other in combinations(numbers_of(function), 2):
        unlike = r"must have equal labels, got \['a', '[bc]'\] .* \['a', '[bc]'\];"
        with pytest.raises(ValueError, match=unlike) as error:
            paired(function, **{one: "ab", other: "ac"})
        assert {one, other} <= {*str(error.value).split()}
        alike = paired(function, **{one: "ab", other: "ab"})
        assert_equal(alike, paired(function, **{one: None, other: None}))


@pytest.mark.parametrize("shape", ["thin_rod", "spherocylinder", "flat_ended_rod"])
def test_a_geometry_keeps_the_labels_of_what_it_was_made_of(shape):
    for size in ("tilt", "length"):
        rod = call(shape, **{size: along("ab", SOLID[size])})
        with pytest.raises(ValueError, match="must have equal labels"):
            call("drift", geometry=rod, friction=along("ac", 0.3))


def test_labels_are_compared_as_axes_are_paired():
    """Labels are compared from the last axis; what has no index fits to any labels."""
    row = xr.DataArray([1.0, 2.0], {"x": list("ab")}, ["x"])
    table = xr.DataArray(np.ones((2, 2)), {"x": list("ab")}, ["y", "x"])
    bare = xr.DataArray([0.3, 0.4], dims=["x"])
    for fine in (bare, table, np.full((2, 2), 0.3), along("ab", 0.3)):
        assert np.shape(call("collide", c_x=row, friction=fine).c_x)[-1:] == (2,)
    across = xr.DataArray([0.3, 0.4], dims=["y"])
    turned = xr.DataArray(np.ones((2, 2)), dims=["x", "y"])
    for unlike in (across, turned, along("ac", 0.3), pd.Series([0.3] * 3, list("abc"))):
        with pytest.raises(ValueError, match=r"c_x and friction must .* got ('x'|\['a', 'b'\])"):
            call("collide", c_x=row, friction=unlike)
