"""Vectors as tuples, compiled: with two components in the plane (x, z), three in space, or one.

Numba compiles a function for each length of its tuples and drops the branches of other lengths.
In the plane a torque, an angular velocity and a tangential part have one component; torque and
angular velocity are positive as they turn z towards x.
"""

from math import cos, sin, sqrt

from ..cache import kernel

ZERO = (0.0, 0.0, 0.0)
IN_PLANE, IN_SPACE = (0.0, 1.0), (0.0, 0.0, 1.0)  # unit vectors upwards


@kernel
def times(s, a):
    """Product s a of a number and a vector."""
    if len(a) == 1:
        return (s * a[0],)
    if len(a) == 2:
        return s * a[0], s * a[1]
    return s * a[0], s * a[1], s * a[2]


@kernel
def along(a, s, b):
    """Sum a + s b of two vectors, with a number s."""
    if len(a) == 1:
        return (a[0] + s * b[0],)
    if len(a) == 2:
        return a[0] + s * b[0], a[1] + s * b[1]
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@kernel
def dot(a, b):
    """Scalar product a . b."""
    if len(a) == 1:
        return a[0] * b[0]
    if len(a) == 2:
        return a[0] * b[0] + a[1] * b[1]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """Vector product a x b, in space."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def torque(arm, force):
    """Torque of a force at an arm: one number, a_z f_x - a_x f_z, in the plane; a x f in space."""
    if len(arm) == 2:
        return (arm[1] * force[0] - arm[0] * force[1],)
    return cross(arm, force)


@kernel
def swing(omega, arm):
    """Velocity of the end of an arm that turns: omega (a_z, -a_x), or omega x a in space."""
    if len(arm) == 2:
        return omega[0] * arm[1], -omega[0] * arm[0]
    return cross(omega, arm)


@kernel
def across(v, normal):
    """Tangential part of a vector: in the plane one number, along (n_z, -n_x); n: unit normal.

    What is a tangential part already, under another normal, is projected in space.
    """
    if len(v) == 1:
        return v
    if len(v) == 2:
        return (v[0] * normal[1] - v[1] * normal[0],)
    return along(v, -dot(v, normal), normal)


@kernel
def spread(tangent, normal):
    """Vector of a tangential part, in the plane of one number along (n_z, -n_x)."""
    if len(tangent) == 1:
        return tangent[0] * normal[1], -tangent[0] * normal[0]
    return tangent


@kernel
def height(v):
    """Vertical component of a vector."""
    return v[-1]


@kernel
def raised(v, height):
    """Vector with `height` added to its vertical component."""
    return (*v[:-1], v[-1] + height)


@kernel
def upward(v):
    """Unit vector upwards, with as many components as v."""
    return raised(nothing(v), 1.0)


@kernel
def nothing(v):
    """Zero vector with as many components as v."""
    return ZERO[: len(v)]


@kernel
def nothing_across(up):
    """Zero tangential part: one number in the plane, three in space."""
    return nothing(across(up, up))


@kernel
def turned(director, angle):
    """Director (sin, cos) after a small turn, kept at length one; error below angle^7/5000."""
    sine, cosine = director
    length = 1.5 - 0.5 * (sine * sine + cosine * cosine)
    q = angle * angle
    c = length * (1 + q * (-1 / 2 + q * (1 / 24 - 1 / 720 * q)))
    s = length * angle * (1 + q * (-1 / 6 + 1 / 120 * q))
    return c * sine + s * cosine, c * cosine - s * sine


@kernel
def rotated(director, turn, dt):
    """Director after turning at the rate `turn` for a time dt, kept at length one."""
    if len(director) == 2:
        return turned(director, turn[0] * dt)
    square = dot(turn, turn) * dt * dt
    one, two = dt, 0.5 * dt * dt
    if square > 1e-4:
        angle = sqrt(square)
        one, two = dt * sin(angle) / angle, dt * dt * (1.0 - cos(angle)) / square
    else:
        one *= 1.0 - square * (1 / 6 - square * (1 / 120))
        two *= 1.0 - square * (1 / 12 - square * (1 / 360))
    first = cross(turn, director)
    v = along(along(director, one, first), two, cross(turn, first))
    return along(v, 0.5 * (1.0 - dot(v, v)), v)


@kernel
def vector(array, i, first, like):
    """Vector in row i of an array from column `first` on; as many components as `like`."""
    if len(like) == 1:
        return (array[i, first],)
    if len(like) == 2:
        return array[i, first], array[i, first + 1]
    return array[i, first], array[i, first + 1], array[i, first + 2]


@kernel
def axial(array, i, first, up):
    """Torque, angular velocity or tangential part in row i from column `first`: 1 or 3 numbers."""
    return vector(array, i, first, nothing_across(up))


@kernel
def add(array, i, first, v):
    """Add a vector to row i of an array, from column `first` on."""
    for c in range(len(v)):
        array[i, first + c] += v[c]


@kernel
def put(array, i, first, v):
    """Store a vector, or numbers of an array, in row i of an array, from column `first` on."""
    for c in range(len(v)):
        array[i, first + c] = v[c]
