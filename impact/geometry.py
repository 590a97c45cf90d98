"""Position of the centre of mass over the contact point, for three kinds of rod."""

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, overload

import numpy as np

from . import _generated as closed
from ._arguments import (
    InputError,
    Labelled,
    Number,
    Numbers,
    evaluated,
    fields_of,
    labels_of,
    shown,
    typed_as,
)


@shown
class ContactGeometry(NamedTuple, Generic[Number]):
    """Contact geometry: three lengths in one unit, numbers or arrays that broadcast.

    Attributes
    ----------
    X, Z : centre of mass over the contact point, any finite numbers; X is positive for a rod that
        tilts towards +x
    k : gyration radius, > 0

    Notes
    -----
    From labelled arguments (pandas, xarray) `thin_rod` and the other shapes make arrays without
    labels, which remember them: a call that pairs them with other labels is refused.
    """

    X: Number
    Z: Number
    k: Number


def lengths_of(geometry: ContactGeometry) -> dict[str, Any]:
    """X, Z and k of a contact geometry by name; raises `InputError` for anything else."""
    return fields_of("geometry", geometry, ContactGeometry)


def unit_lengths(X: Any, Z: Any, k: Any) -> tuple[Any, Any, Any]:
    """X, Z, k scaled by the power of two next to the largest, so that squares stay in range."""
    _, exponent = np.frexp(np.maximum(np.maximum(np.abs(X), np.abs(Z)), k))
    return np.ldexp(X, -exponent), np.ldexp(Z, -exponent), np.ldexp(k, -exponent)


ROUND = 1 + 2.0**-23  # diameter over length of a sphere in single precision, at most


def _rod(contact: Callable[..., tuple], tilt: Any, **sizes: Any) -> ContactGeometry:
    """Contact geometry from `contact(sin, cos, *sizes)`; arguments held to their domains."""

    def block(phi, *lengths):
        phi = np.clip(phi, -np.pi / 2, np.pi / 2)  # cos >= 0
        return contact(np.sin(phi), np.cos(phi), *lengths)

    parts = evaluated(block, {"tilt": tilt, **sizes}, (None,) * 3)
    labels = max(map(labels_of, (tilt, *sizes.values())), key=len)
    if labels:  # results of this geometry must agree with them
        parts = tuple(part.view(Labelled) for part in parts)
        for part in parts:
            part.labels = labels
    return ContactGeometry(*parts)


@overload
def thin_rod(tilt: float, length: float = ...) -> ContactGeometry[float]: ...
@overload
def thin_rod(tilt: Any, length: Any = ...) -> ContactGeometry[Numbers]: ...
def thin_rod(tilt: Any, length: Any = 1.0) -> ContactGeometry:
    """Thin rod on its lower end: X = l sin(phi)/2, Z = l cos(phi)/2, k = l/sqrt(12).

    Parameters
    ----------
    tilt : angle from the vertical, rad, between -pi/2 and pi/2; any shape
    length : length of the rod, > 0; broadcasts with `tilt`

    Returns
    -------
    ContactGeometry
        In the unit of `length`; nan where an array element is out of its domain.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.

    Notes
    -----
    Section IV of the paper. Mirror-symmetric bit for bit: `tilt -> -tilt` turns X to -X.
    """

    def contact(sin, cos, length):
        return length * sin / 2, length * cos / 2, length / np.sqrt(12.0)

    return _rod(contact, tilt, length=length)


@overload
def spherocylinder(tilt: float, length: float, diameter: float = ...) -> ContactGeometry[float]: ...
@overload
def spherocylinder(tilt: Any, length: Any, diameter: Any = ...) -> ContactGeometry[Numbers]: ...
def spherocylinder(tilt: Any, length: Any, diameter: Any = 1.0) -> ContactGeometry:
    """Solid spherocylinder on its round tip, straight below the centre of its lower cap.

    Parameters
    ----------
    tilt : angle from the vertical, rad, between -pi/2 and pi/2; any shape
    length : overall length, caps included (the paper's l = h_0 + d), >= `diameter`
    diameter : > 0, in the unit of `length`; 1 suits lengths in diameters alone

    Returns
    -------
    ContactGeometry
        In the unit of the lengths; nan where an array element is out of its domain.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.

    Notes
    -----
    Exact moment of inertia of the uniform solid, by integration; the one printed in note [12] of
    our copy of the paper is wrong in two of its four terms.
    """

    def contact(sin, cos, length, diameter):
        lacks = diameter - ROUND * length
        if np.ndim(lacks) == 0 and 0 < lacks < np.inf:
            raise InputError(f"length must be >= diameter ({diameter:g}), got {length:g}")
        length = np.where(lacks > 0, np.nan, np.maximum(length, diameter))
        X, Z, gyration = closed.round_rod(length, diameter, diameter / length, sin, cos)
        return X, Z, length * np.sqrt(gyration)

    return _rod(contact, tilt, length=length, diameter=diameter)


@typed_as(spherocylinder)
def flat_ended_rod(tilt: Any, length: Any, diameter: Any = 1.0) -> ContactGeometry:
    """Solid flat-ended cylinder that lands on the lower edge of its end.

    Parameters
    ----------
    tilt : angle from the vertical, rad, between -pi/2 and pi/2; any shape
    length : > 0
    diameter : > 0, in the unit of `length`; 1 suits lengths in diameters alone

    Returns
    -------
    ContactGeometry
        In the unit of the lengths; nan where an array element is out of its domain.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.

    Notes
    -----
    Below a tilt of arctan(diameter/length) the centre of mass stands on the other side of the
    edge and X has the sign opposite to the tilt's. At tilt 0 the contact jumps from edge to edge;
    the sign of the zero chooses the edge (+0.0: the limit from positive tilts).
    """

    def contact(sin, cos, length, diameter):
        X, Z, gyration = closed.flat_rod(length, diameter, diameter / length, np.abs(sin), cos)
        return np.copysign(1.0, sin) * X, Z, length * np.sqrt(gyration)

    return _rod(contact, tilt, length=length, diameter=diameter)
