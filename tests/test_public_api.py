"""Domains, dtypes, shapes and errors of the public functions."""

import inspect
import tracemalloc
import warnings

import numpy as np
import pytest

import impact
from impact import ContactGeometry, Regime

ROD = impact.thin_rod(0.4)
BODIES = {
    "first": impact.Body(1.0, 0.3, 0.1, 0.4, 0.0, -1.0),
    "second": impact.Body(2.0, 0.3, -0.1, -0.4, 0.0, 1.0),
}
HIT = {"geometry": ROD, "friction": 0.3, "restitution": 0.65}


SENSIBLE = {
    "collide": {"c_x": 1.0, "c_z": -2.0, **HIT},
    "classify": {"c_x": 1.0, "c_z": -2.0, **HIT},
    "thin_rod": {"tilt": 0.4},
    "spherocylinder": {"tilt": 0.4, "length": 8.0},
    "flat_ended_rod": {"tilt": 0.4, "length": 8.0},
    "critical_tilts": {"friction": 0.3},
    "critical_friction": {"geometry": ROD},
    "painleve_friction": {"geometry": ROD},
    "slide_friction": {"geometry": ROD, "approach_ratio": 2.0, "restitution": 0.8},
    "energy_restitution": {"geometry": ROD, "friction": 0.3},
    "drift": HIT,
    "relaxation": HIT,
    "transport_cost": HIT,
    "optimal_tilt": {"friction": 0.3, "restitution": 0.65},
    "mean_plate_velocity": {},
    "landing_density": {"phase": 1.0},
    "collide_pair": {**BODIES, "friction": 0.3, "restitution": 0.65},
}


def call(function, /, **changed):
    """`function` with sensible arguments, some of them changed."""
    return getattr(impact, function)(**{**SENSIBLE[function], **changed})


FLAT, INSIDE_OUT = ContactGeometry(0.1, 0.2, 0.0), ContactGeometry(0.1, 0.2, -1.0)
BAD = {
    **{"friction": [-0.1], "restitution": [-0.1, 1.5], "geometry": [FLAT, INSIDE_OUT]},
    **{"tilt": [1.6, -2], "length": [0.0, -1.0], "diameter": [0.0, -1.0]},
    **{"approach_ratio": [0.0, -2.0], "fall_speed": [0.0, -1.0], "points": [0, 1.5]},
}
# Every argument of every public function.
ARGUMENTS = [
    (function, name)
    for function in SENSIBLE
    for name in inspect.signature(getattr(impact, function)).parameters
]
NUMBERS = [
    (function, name)
    for function, name in ARGUMENTS
    if name not in ("geometry", "first", "second", "law", "density", "points")
]
OUT_OF_DOMAIN = [
    *((*argument, value) for argument in ARGUMENTS for value in BAD.get(argument[1], [])),
    *(("drift", "plate_velocity", value) for value in (0.0, -1.0)),
    ("spherocylinder", "length", 0.5),  # shorter than it is thick
]


def test_every_function_is_walked_through():
    assert SENSIBLE.keys() == {n for n in impact.__all__ if inspect.isfunction(getattr(impact, n))}


@pytest.mark.parametrize(("function", "name", "value"), OUT_OF_DOMAIN)
def test_what_is_out_of_its_domain(function, name, value):
    """A scalar is named; an element is nan or INVALID, and those beside it are as they were."""
    with pytest.raises(ValueError, match=name) as error:
        call(function, **{name: value})
    wrong = value.k if isinstance(value, ContactGeometry) else value
    assert repr(wrong) in str(error.value)
    if name == "points" or function == "collide_pair":  # whose elements `test_pairs` has
        return
    sensible = SENSIBLE[function].get(name, 1.0)
    if name == "geometry":
        array = ContactGeometry(*(np.array(both) for both in zip(value, sensible, strict=True)))
    else:
        array = np.array([value, sensible])
    result, good = call(function, **{name: array}), call(function)
    if not isinstance(result, tuple):
        result, good = (result,), (good,)
    for part, wanted in zip(result, good, strict=True):
        bad, fine = np.broadcast_to(part, 2)
        assert bad == Regime.INVALID if part.dtype == np.int8 else np.isnan(bad)
        assert fine == wanted


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    "name", ["c_x", "c_z", "omega", "plate_velocity", "restitution", *ROD._fields]
)
def test_nan_and_infinity_give_nan_scalar_or_array(name, value):
    for argument in (value, np.array([value])):
        changed = {name: argument}
        if name in ROD._fields:
            changed = {"geometry": ROD._replace(**changed)}
        hit = call("collide", **changed)
        assert np.all(hit.regime == Regime.INVALID)
        assert all(np.isnan(part).all() for part in hit if part is not hit.regime)


def test_nan_friction_is_invalid_and_infinite_friction_is_not():
    for friction, regime in ((np.nan, -1), (-np.inf, -1), (np.inf, Regime.SLIP_STICK)):
        assert call("collide", friction=friction).regime == regime
    assert np.isnan(call("critical_tilts", friction=np.array([np.nan, np.inf]))).all()
    assert np.isnan(call("drift", friction=np.nan).c_x)


@pytest.mark.parametrize(("function", "name"), NUMBERS)
def test_what_is_no_number_is_named(function, name):
    for value in ("fast", None, 1j, [[1], [2, 3]], object()):
        with pytest.raises(impact.InputError, match=f"{name} must be a real number"):
            call(function, **{name: value})


@pytest.mark.parametrize("function", [name for name, of in ARGUMENTS if of == "geometry"])
def test_what_is_no_geometry_is_named(function):
    for value in (None, 3.0, (1.0, 2.0), "rod", {"X": 0.2, "Z": 0.4, "k": 0.3}, {1.0, 2.0, 3.0}):
        with pytest.raises(TypeError, match="geometry"):
            call(function, geometry=value)


def test_unknown_law_is_named():
    said = "law must be one of newton, poisson, stronge, got 'hooke'"
    with pytest.raises(ValueError, match=said):
        call("collide", law="hooke")


def test_density_must_be_one():
    for density in (lambda t: np.cos(t), lambda t: 0 * t, lambda t: t * np.nan):
        with pytest.raises(ValueError, match="density"):
            impact.mean_plate_velocity(density)


ODD = np.array([0.0, -0.0, 5e-324, -1e-310, 1e-300, 1.0, -1.0, 1e300, -1.7e308, np.inf, np.nan])


@pytest.mark.parametrize("function", SENSIBLE)
def test_no_warning_ever(function):
    """Everything that floats can hold, in all arguments at once."""
    rng = np.random.default_rng(1)
    shapes = {"geometry": ContactGeometry, "first": impact.Body, "second": impact.Body}
    given = {}
    for name in (name for of, name in ARGUMENTS if of == function):
        if (function, name) in NUMBERS:
            given[name] = rng.choice(ODD, 20_000)
        elif name in shapes:
            shape = shapes[name]
            given[name] = shape(*rng.choice(ODD, (len(shape._fields), 20_000)))
    laws = ["newton", "poisson", "stronge"] if (function, "law") in ARGUMENTS else []
    with warnings.catch_warnings(), np.errstate(all="raise"):
        warnings.simplefilter("error")
        for law in [{"law": law} for law in laws] or [{}]:
            call(function, **given, **law)


def test_shapes_broadcast_and_scalars_stay_scalars():
    hit = call("collide", c_x=np.ones((3, 1)), geometry=impact.thin_rod(np.linspace(0, 1, 4)))
    assert {part.shape for part in hit} == {(3, 4)}
    assert isinstance(call("collide").regime, Regime)
    assert np.ndim(call("collide").c_x) == 0
    assert isinstance(call("classify"), Regime)
    assert isinstance(call("drift").regime, Regime)
    assert call("collide", c_x=np.array(1.0)) == call("collide")
    empty = call("collide", c_x=np.empty((0, 3)))
    assert {part.shape for part in empty} == {(0, 3)}
    with pytest.raises(ValueError, match="broadcast"):
        call("collide", c_x=np.ones(3), c_z=np.ones(4))


def test_non_contiguous_arrays_give_the_same():
    rng = np.random.default_rng(2)
    c = rng.normal(size=(2, 500, 7))
    whole = call("collide", c_x=c[0], c_z=c[1])
    parts = call("collide", c_x=c[0, ::-1, ::2], c_z=c[1, ::-1, ::2])
    for a, b in zip(whole, parts, strict=True):
        np.testing.assert_array_equal(a[::-1, ::2], b)


def test_dtypes():
    """Single precision where all arguments have it, but for Python's numbers."""
    single, ones = np.float32, np.ones(3, np.float32)
    rod = impact.thin_rod(single(0.4))
    bodies = {name: impact.Body(*map(single, body)) for name, body in BODIES.items()}
    bodies["first"] = bodies["first"]._replace(c_x=ones)
    for hit in (call("collide", c_x=ones, geometry=rod), call("collide_pair", **bodies)):
        assert hit.P_x.dtype == hit.P_z.dtype == hit.energy_change.dtype == single
        assert hit.regime.dtype == np.int8
    assert {part.dtype for part in rod} == {np.dtype(single)}
    assert impact.critical_tilts(single(0.3))[0].dtype == single
    assert call("mean_plate_velocity", plate_speed=ones).dtype == single
    assert call("drift", geometry=rod, restitution=single(1)).c_x.dtype == single
    assert call("collide", c_x=ones).c_x.dtype == single  # as ROD is no array
    assert call("collide", c_x=ones, geometry=impact.thin_rod(np.array([0.4]))).c_x.dtype == float
    for c_x in (1, np.array([1, 2]), np.ones(2, np.longdouble)):
        assert call("collide", c_x=c_x).c_x.dtype == np.float64


@pytest.mark.parametrize("tilt", [np.float32(np.pi / 2), np.full(2, np.pi / 2, np.float32)])
def test_a_lying_rod_in_single_precision_is_not_below_the_plate(tilt):
    rod = impact.thin_rod(tilt)
    assert np.all(rod.Z >= 0)
    assert np.all(call("drift", geometry=rod).c_x > 0)


@pytest.mark.parametrize("size", [(np.float32(0.7), 0.7), (0.7, np.float32(0.7)), (0.7, 0.7)])
def test_a_sphere_is_one_in_the_precision_of_the_result(size):
    """The number 0.7 lies between two of single precision."""
    ball = impact.spherocylinder(np.float32(0.3), *size)
    assert ball.X >= 0
    assert ball == pytest.approx((0.0, 0.35, 0.7 / np.sqrt(10)), rel=1e-7, abs=1e-8)
    row = impact.spherocylinder(np.full(2, 0.3, np.float32), *size)
    assert np.all(np.transpose(row) == ball)


def test_masked_elements_are_invalid():
    hit = call("collide", c_x=np.ma.masked_array([1.0, 2.0], mask=[True, False]))
    assert hit.regime.tolist() == [Regime.INVALID, Regime.SLIP_REVERSAL]
    assert np.isnan(hit.c_x[0])
    assert np.isfinite(hit.c_x[1])


def test_arguments_are_not_changed():
    c_x, friction = np.array([1.0, np.nan, 3.0]), np.array([0.3, 0.3, -1.0])
    call("collide", c_x=c_x, friction=friction)
    np.testing.assert_array_equal(c_x, [1.0, np.nan, 3.0])
    np.testing.assert_array_equal(friction, [0.3, 0.3, -1.0])


def test_blocks_do_not_show():
    """A result does not depend on where the element stands, or on its neighbours' scales."""
    rng = np.random.default_rng(3)
    c_x, c_z = rng.normal(size=(2, 30_000))
    one = call("collide", c_x=c_x, c_z=c_z)
    c_x[::1000] = 1e200
    other = call("collide", c_x=c_x, c_z=c_z)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(np.delete(a, np.s_[::1000]), np.delete(b, np.s_[::1000]))
    for index in rng.integers(0, 30_000, 50):
        scalar = call("collide", c_x=c_x[index], c_z=c_z[index])
        assert all(part == whole[index] for part, whole in zip(scalar, other, strict=True))


def test_memory_in_flight_is_bounded():
    n = 10**6
    arguments = np.random.default_rng(4).normal(size=(2, n))
    tracemalloc.start()
    call("collide", c_x=arguments[0], c_z=arguments[1])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 40 * 8 * n
