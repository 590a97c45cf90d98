"""Vectors as tuples, compiled: of the plane (x, z), of space, and of one number.

Numba compiles a function for each length of its tuples and drops the branches of other lengths.
In the plane a torque and an angular velocity have one component, positive as it turns z towards x.
"""

from ..cache import kernel

ZERO = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)


@kernel
def times(s, a):
    """s a."""
    if len(a) == 1:
        return (s * a[0],)
    if len(a) == 2:
        return s * a[0], s * a[1]
    return s * a[0], s * a[1], s * a[2]


@kernel
def along(a, s, b):
    """a + s b."""
    if len(a) == 1:
        return (a[0] + s * b[0],)
    if len(a) == 2:
        return a[0] + s * b[0], a[1] + s * b[1]
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@kernel
def dot(a, b):
    """Scalar product."""
    if len(a) == 1:
        return a[0] * b[0]
    if len(a) == 2:
        return a[0] * b[0] + a[1] * b[1]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """Vector product, in space."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def torque(arm, force):
    """Torque of a force at an arm."""
    if len(arm) == 2:
        return (arm[1] * force[0] - arm[0] * force[1],)
    return cross(arm, force)


@kernel
def swing(omega, arm):
    """Velocity of the end of an arm that turns with angular velocity omega."""
    if len(arm) == 2:
        return omega[0] * arm[1], -omega[0] * arm[0]
    return cross(omega, arm)


@kernel
def across(v, normal):
    """Part of a vector across a normal: in the plane one number, along (n_z, -n_x)."""
    if len(v) == 2:
        return (v[0] * normal[1] - v[1] * normal[0],)
    return along(v, -dot(v, normal), normal)


@kernel
def spread(tangent, normal):
    """The vector of a part across a normal."""
    if len(tangent) == 1:
        return tangent[0] * normal[1], -tangent[0] * normal[0]
    return tangent


@kernel
def vector(array, i, first):
    """Three numbers of row i."""
    return array[i, first], array[i, first + 1], array[i, first + 2]


@kernel
def add(array, i, first, v):
    """Add a vector to row i."""
    array[i, first] += v[0]
    array[i, first + 1] += v[1]
    array[i, first + 2] += v[2]


@kernel
def put(array, i, first, v):
    """Put a vector into row i."""
    array[i, first], array[i, first + 1], array[i, first + 2] = v
