"""Domains, labels, dtypes, shapes and errors of all public functions."""

import inspect
import tracemalloc

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

import impact
from impact import Regime

ROD = impact.thin_rod(0.4)
HOW = {"friction": 0.3, "restitution": 0.65}
HIT = {"geometry": ROD, **HOW}
IMPACT = {"c_x": 1.0, "c_z": -2.0, "omega": 0.0, "plate_velocity": 0.0, **HIT}
SOLID = {"tilt": 0.4, "length": 8.0, "diameter": 1.0}
BODIES = {
    "first": impact.Body(1.0, 0.3, 0.1, 0.4, 0.0, -1.0, 0.0),
    "second": impact.Body(2.0, 0.3, -0.1, -0.4, 0.0, 1.0, 0.0),
}
SENSIBLE = {
    "collide": IMPACT,
    "classify": IMPACT,
    "collide_pair": {**BODIES, **HOW},
    "thin_rod": {"tilt": 0.4, "length": 1.0},
    "spherocylinder": SOLID,
    "flat_ended_rod": SOLID,
    "critical_tilts": {"friction": 0.3},
    "critical_friction": {"geometry": ROD},
    "painleve_friction": {"geometry": ROD},
    "slide_friction": {"geometry": ROD, "approach_ratio": 2.0, "restitution": 0.8},
    "energy_restitution": {"geometry": ROD, "friction": 0.3},
    "drift": {**HIT, "plate_velocity": 1.0},
    "relaxation": HIT,
    "optimal_tilt": HOW,
    "mean_plate_velocity": {"plate_speed": 1.0},
    "landing_density": {"phase": 1.0, "fall_speed": 1.0},
}
NO_NUMBERS = {"law", "density", "points"}
each_function = pytest.mark.parametrize("function", SENSIBLE)


def numbers_of(function):
    """Sensible numbers by their names; fields of a tuple as `geometry.X`."""
    found = {}
    for name, value in SENSIBLE[function].items():
        fields = value._asdict() if isinstance(value, tuple) else {}
        found |= {f"{name}.{field}": x for field, x in fields.items()} or {name: value}
    return found


def call(function, /, **changed):
    """Result with sensible arguments, some of them, or fields of them, changed."""
    given = dict(SENSIBLE[function])
    for name, value in changed.items():
        argument, _, field = name.partition(".")
        given[argument] = given[argument]._replace(**{field: value}) if field else value
    return getattr(impact, function)(**given)


def computed(function, /, **changed):
    """Every number that is computed, one after another; of bodies, their velocities."""
    result = call(function, **changed)
    if not isinstance(result, tuple):
        return (result,)
    if isinstance(result, impact.PairCollision):
        return *result.first[4:], *result.second[4:], *result[2:]
    return result


def is_invalid(part):
    return np.where(np.asarray(part).dtype.kind == "i", part == Regime.INVALID, np.isnan(part))


NUMBERS = [(function, name) for function in SENSIBLE for name in numbers_of(function)]
each_number = pytest.mark.parametrize(("function", "name"), NUMBERS)
POSITIVE = "k", "mass", "length", "diameter", "approach_ratio", "fall_speed", "drift plate_velocity"
BAD = {name: [0.0, -1.0] for name in POSITIVE} | {
    "friction": [-0.1],
    "restitution": [-0.1, 1.5],
    "tilt": [1.6, -2.0],
    "spherocylinder length": [0.5],  # shorter than it is thick
}


def test_every_argument_of_every_function_is_walked_through():
    functions = {name: getattr(impact, name) for name in impact.__all__}
    arguments = {
        name: inspect.signature(function).parameters.keys() - NO_NUMBERS
        for name, function in functions.items()
        if inspect.isfunction(function)
    }
    assert arguments == {name: given.keys() for name, given in SENSIBLE.items()}


@each_number
def test_what_is_out_of_its_domain(function, name):
    """A scalar is refused by name; nan, inf and elements give nan, and those beside keep theirs."""
    kind = name.rpartition(".")[2]
    bad = BAD.get(kind, []) + BAD.get(f"{function} {kind}", [])
    odd = [np.nan, -np.inf, *[np.inf] * (kind not in ("friction", "mass"))]
    for value in bad:
        with pytest.raises(ValueError, match=name) as error:
            call(function, **{name: value})
        assert repr(value) in str(error.value)
    for value in odd:
        assert all(map(is_invalid, computed(function, **{name: value})))
    array = np.array([*bad, *odd, numbers_of(function)[name]])
    for part, scalar in zip(computed(function, **{name: array}), computed(function), strict=True):
        assert is_invalid(part[:-1]).all()
        assert part[-1] == scalar


@each_number
def test_what_is_no_number_is_named(function, name):
    for value in ("fast", None, 1j, [[1], [2, 3]], object()):
        with pytest.raises(impact.InputError, match=f"{name} must be a real number"):
            call(function, **{name: value})


TUPLES = [
    (function, name, value)
    for function, arguments in SENSIBLE.items()
    for name, given in arguments.items()
    if isinstance(given, tuple)
    for value in (None, 3.0, given[:2], "rod", given._asdict(), {*range(len(given))})
]


@pytest.mark.parametrize(("function", "name", "value"), TUPLES)
def test_what_is_no_tuple_is_named(function, name, value):
    with pytest.raises(impact.InputError, match=f"{name} must be "):
        call(function, **{name: value})


ODD = np.array([0.0, -0.0, 5e-324, -1e-310, 1e-300, 1.0, -1.0, 1e300, -1.7e308, np.inf, np.nan])
OTHER_LAWS = [
    (f, {"law": law}) for f in ("collide", "collide_pair") for law in ("poisson", "stronge")
]


@pytest.mark.parametrize(("function", "law"), [*((f, {}) for f in SENSIBLE), *OTHER_LAWS])
def test_no_warning_ever(function, law):
    """All that floats can hold, in all arguments at once, gives no warning and stays as it is."""
    rng = default_rng(1)
    given = {name: rng.choice(ODD, 20_000) for name in numbers_of(function)}
    for values in given.values():
        values.flags.writeable = False
    with np.errstate(all="raise"):
        call(function, **given, **law)


@each_function
def test_shapes_broadcast_and_scalars_stay_scalars(function):
    scalar = computed(function)
    assert {type(part) for part in scalar} <= {np.float64, Regime}
    names = [*numbers_of(function)]
    first, last = (numbers_of(function)[name] for name in (names[0], names[-1]))
    assert computed(function, **{names[0]: np.array(first)}) == scalar
    for shape in ((3, 1), (0, 1)):
        arrays = {names[0]: np.full(shape, first), names[-1]: np.full((2, 1, 4), last)}
        wanted = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        for part, one in zip(computed(function, **arrays), scalar, strict=True):
            assert_array_equal(part, np.full(wanted, one))


@each_function
def test_dtypes(function):
    """Results are single where all arguments are, but for Python's and float64 numbers."""
    first, *_ = numbers_of(function)
    single = {name: np.full(2, x, np.float32) for name, x in numbers_of(function).items()}
    for changed, dtype in (
        (single, np.float32),
        ({first: single[first]}, np.float32),
        (single | {first: np.full(2, 0.5)}, np.float64),
        (single | {first: np.ones(2, int)}, np.float64),
        ({first: np.ones(2, np.longdouble)}, np.float64),
    ):
        dtypes = {part.dtype for part in computed(function, **changed)}
        assert dtypes - {np.dtype(np.int8)} <= {np.dtype(dtype)}


@pytest.mark.parametrize("tilt", [np.float32(np.pi / 2), np.full(2, np.pi / 2, np.float32)])
def test_a_lying_rod_in_single_precision_is_not_below_the_plate(tilt):
    rod = impact.thin_rod(tilt)
    assert np.all(rod.Z >= 0)
    assert np.all(call("drift", geometry=rod).c_x > 0)


@pytest.mark.parametrize("size", [(np.float32(0.7), 0.7), (0.7, np.float32(0.7)), (0.7, 0.7)])
def test_a_sphere_is_one_in_the_precision_of_the_result(size):
    """The number 0.7 lies between two of single precision."""
    for tilt in (np.float32(0.3), np.full(2, 0.3, np.float32)):
        ball = np.transpose(impact.spherocylinder(tilt, *size))
        assert (ball[..., 0] >= 0).all()
        assert_allclose(ball, ball * 0 + [0, 0.35, 0.7 / np.sqrt(10)], rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize(
    "function", [f for f in SENSIBLE if "geometry" in SENSIBLE[f] and f != "collide"]
)
def test_units_of_length_cancel(function):
    """They cancel bit for bit; spins have one, which `test_collision` has."""
    for unit in (2.0**-900, 2.0**900):
        scaled = computed(function, geometry=ROD._make(unit * length for length in ROD))
        assert scaled == computed(function)


def test_masked_elements_are_invalid():
    hit = call("collide", c_x=np.ma.masked_array([1.0, 2.0], mask=[True, False]))
    assert hit.regime.tolist() == [Regime.INVALID, Regime.SLIP_REVERSAL]
    assert np.isnan(hit.c_x).tolist() == [True, False]


def test_blocks_do_not_show():
    """A result does not depend on where the element stands, or on its neighbours' scales."""
    rng = default_rng(3)
    c_x, c_z = rng.normal(size=(2, 300, 100))
    usual = call("collide", c_x=c_x, c_z=c_z)
    c_x[::10] = 1e200
    whole = call("collide", c_x=c_x, c_z=c_z)
    turned = call("collide", c_x=c_x[::-1, ::2], c_z=c_z[::-1, ::2])
    for one, other, part in zip(usual, whole, turned, strict=True):
        assert_array_equal(np.delete(one, np.s_[::10], 0), np.delete(other, np.s_[::10], 0))
        assert_array_equal(other[::-1, ::2], part)


def test_memory_in_flight_is_bounded():
    n = 10**6
    c_x, c_z = default_rng(4).normal(size=(2, n))
    tracemalloc.start()
    call("collide", c_x=c_x, c_z=c_z)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 40 * 8 * n


def test_results_are_told_in_a_line_and_shown_as_a_table():
    """A line names no types of NumPy, and shows a long array by its ends."""
    drift = call("drift")
    assert repr(drift).startswith(f"Drift(c_x={drift.c_x:.6g}, c_z={drift.c_z:.6g}, regime=<Regime")
    several = call("collide", c_x=np.linspace(0, 1, 200))
    for result in (call("collide"), call("collide_pair"), ROD, several):
        assert "np." not in repr(result)
        assert len(repr(result).splitlines()) == 1
        assert len(repr(result)) < 900
    rows = call("collide")._repr_html_().split("<tr>")[1:]
    assert [row.partition("</td>")[0] for row in rows] == [f"<td>{x}" for x in several._fields]
    assert "&lt;Regime.SLIP_REVERSAL" in rows[3]
