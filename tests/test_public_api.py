"""Domains, dtypes, shapes and errors of the public functions."""

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
    "collide": {"friction": [-0.1], "restitution": [-0.1, 1.5], "geometry": [FLAT, INSIDE_OUT]},
    "classify": {"friction": [-1], "restitution": [2]},
    "thin_rod": {"tilt": [1.6, -2], "length": [0.0, -1.0]},
    "spherocylinder": {"tilt": [3.0], "length": [0.5], "diameter": [-1.0]},
    "flat_ended_rod": {"tilt": [2.0], "length": [0.0], "diameter": [0.0]},
    "critical_tilts": {"friction": [-0.1]},
    "critical_friction": {"geometry": [INSIDE_OUT]},
    "painleve_friction": {"geometry": [INSIDE_OUT]},
    "slide_friction": {"approach_ratio": [0.0, -2.0], "restitution": [1.1], "geometry": [FLAT]},
    "energy_restitution": {"friction": [-1.0], "geometry": [FLAT]},
    "drift": {
        "friction": [-0.3],
        "restitution": [1.01],
        "plate_velocity": [0.0, -1.0],
        "geometry": [FLAT],
    },
    "relaxation": {"friction": [-0.3], "restitution": [1.01], "geometry": [FLAT]},
    "transport_cost": {"friction": [-0.3], "restitution": [1.01], "geometry": [FLAT]},
    "landing_density": {"fall_speed": [0.0, -1.0]},
    "optimal_tilt": {"friction": [-0.3], "restitution": [1.01]},
    "mean_plate_velocity": {"points": [0, 1.5]},
}
OUT_OF_DOMAIN = [
    (function, name, value)
    for function, bad in BAD.items()
    for name, values in bad.items()
    for value in values
]


@pytest.mark.parametrize(("function", "name", "value"), OUT_OF_DOMAIN)
def test_scalar_out_of_domain_is_named(function, name, value):
    with pytest.raises(ValueError, match=name) as error:
        call(function, **{name: value})
    wrong = value.k if isinstance(value, ContactGeometry) else value
    assert repr(wrong) in str(error.value)


@pytest.mark.parametrize(
    ("function", "name", "value"), [case for case in OUT_OF_DOMAIN if case[1] != "points"]
)
def test_array_element_out_of_domain_is_nan(function, name, value):
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
        if name in ROD._fields:
            hit = call("collide", geometry=ROD._replace(**{name: argument}))
        else:
            hit = call("collide", **{name: argument})
        assert np.all(hit.regime == Regime.INVALID)
        assert all(np.isnan(part).all() for part in hit if part is not hit.regime)


def test_nan_friction_is_invalid_and_infinite_friction_is_not():
    assert call("collide", friction=np.nan).regime == Regime.INVALID
    assert call("collide", friction=-np.inf).regime == Regime.INVALID
    assert call("collide", friction=np.inf).regime == Regime.SLIP_STICK
    assert np.isnan(call("critical_tilts", friction=np.nan)).all()
    assert np.isnan(call("critical_tilts", friction=np.inf)).all()
    assert np.isnan(call("drift", friction=np.nan).c_x)


@pytest.mark.parametrize("value", ["fast", None, 1j, [[1], [2, 3]], object()])
@pytest.mark.parametrize(
    ("function", "name"),
    [
        ("collide", "c_x"),
        ("collide", "friction"),
        ("thin_rod", "tilt"),
        ("landing_density", "phase"),
        ("mean_plate_velocity", "plate_speed"),
    ],
)
def test_what_is_no_number_is_named(function, name, value):
    with pytest.raises(impact.InputError, match=f"{name} must be a real number"):
        call(function, **{name: value})


@pytest.mark.parametrize(
    "function", ["collide", "classify", "critical_friction", "slide_friction", "drift"]
)
@pytest.mark.parametrize(
    "value", [None, 3.0, (1.0, 2.0), "rod", {"Z": 0.4, "X": 0.2, "k": 0.3}, {0.4, 0.2, 0.3}]
)
def test_what_is_no_geometry_is_named(value, function):
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


def test_no_warning_ever():
    """Everything that floats can hold, in all arguments at once."""
    rng = np.random.default_rng(1)
    odd = np.array([0.0, -0.0, 5e-324, -1e-310, 1e-300, 1.0, -1.0, 1e300, -1.7e308, np.inf, np.nan])
    arguments = rng.choice(odd, (9, 20_000))
    c_x, c_z, omega, X, Z, k, friction, restitution, plate = arguments
    geometry = ContactGeometry(X, Z, k)
    setting = {"friction": friction, "restitution": restitution, "plate_velocity": plate}
    with warnings.catch_warnings(), np.errstate(all="raise"):
        warnings.simplefilter("error")
        for law in ("newton", "poisson", "stronge"):
            impact.collide(c_x, c_z, omega, geometry=geometry, law=law, **setting)
        impact.drift(geometry, **setting)
        impact.critical_tilts(friction)
        impact.critical_friction(geometry)
        impact.painleve_friction(geometry)
        impact.relaxation(geometry, friction=friction, restitution=restitution)
        impact.transport_cost(geometry, friction=friction, restitution=restitution)
        impact.slide_friction(geometry, approach_ratio=c_x, restitution=restitution)
        impact.energy_restitution(geometry, friction)
        for shape in (impact.thin_rod, impact.spherocylinder, impact.flat_ended_rod):
            shape(c_x, np.abs(X))


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
    rod = impact.thin_rod(np.float32(0.4))
    bodies = {name: impact.Body(*map(np.float32, body)) for name, body in BODIES.items()}
    bodies["first"] = bodies["first"]._replace(c_x=np.ones(3, np.float32))
    for hit in (
        call("collide", c_x=np.ones(3, np.float32), geometry=rod),
        call("collide_pair", **bodies),
    ):
        assert hit.P_x.dtype == hit.P_z.dtype == hit.energy_change.dtype == np.float32
        assert hit.regime.dtype == np.int8
    assert {part.dtype for part in rod} == {np.dtype(np.float32)}
    assert impact.critical_tilts(np.float32(0.3))[0].dtype == np.float32
    assert call("drift", geometry=rod, restitution=np.float32(1)).c_x.dtype == np.float32
    assert call("collide", c_x=1).c_x.dtype == np.float64
    assert call("collide", c_x=np.array([1, 2])).c_x.dtype == np.float64
    assert call("collide", c_x=np.ones(2, np.float32)).c_x.dtype == np.float32  # as ROD is no array
    arrays = impact.thin_rod(np.array([0.4]))
    assert call("collide", c_x=np.ones(2, np.float32), geometry=arrays).c_x.dtype == np.float64
    assert call("collide", c_x=np.ones(2, np.longdouble)).c_x.dtype == np.float64
    assert call("thin_rod", tilt=np.float32(np.pi / 2)).X.dtype == np.float32


@pytest.mark.parametrize("tilt", [np.float32(np.pi / 2), np.full(2, np.pi / 2, np.float32)])
def test_a_lying_rod_in_single_precision_is_not_below_the_plate(tilt):
    rod = impact.thin_rod(tilt)
    assert np.all(rod.Z >= 0)
    assert np.all(call("drift", geometry=rod).c_x > 0)


@pytest.mark.parametrize("size", [(np.float32(0.7), 0.7), (0.7, np.float32(0.7)), (0.7, 0.7)])
def test_a_sphere_is_one_in_the_precision_of_the_result(size):
    """The number 0.7 lies between two of single precision."""
    ball = impact.spherocylinder(np.float32(0.3), *size)
    assert ball.X == 0
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
