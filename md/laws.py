"""Contact laws, and the overlap, contact time and stable step that follow from them.

=====================  ==========================================  ===============================
law                    normal force                                tangential force
=====================  ==========================================  ===============================
appendix_a             k_n d^(3/2) - gamma M_e d v_n               spring k_t d, dashpot gamma M_e d
constant_restitution   k_n d^(3/2) - c sqrt(M k_n) d^(1/4) v_n     spring and dashpot, both stiff
coulomb                the same                                    constraint: no slip up to mu F_n
=====================  ==========================================  ===============================

d is the overlap, M the effective mass of a contact for a normal force, 1/M = 1/m + X^2/I (for a
friction force, 1/M = 1/m + Z^2/I). F_n is cut at zero: the plate never pulls, and the contact's
force ends before its overlap does. |F_t| never exceeds mu F_n. Reduced units: the rod's diameter
and mass and gravity are 1.

The restitution of a law is that of one contact point. Two rods side by side touch at two and leave
with 0.72 where the law says 0.65; overlapped by a quarter of their length, with 0.57.

A new law is a function that returns a `Law`, and its entry in `LAWS`, where scenes, `md.impact` and
`md sweep` find it; an option of its own is one of `md impact` in `md.__main__`. A dashpot or spring
that `Normal` or `Spring` lacks is a field there, a term in `kernels.contact`, and its part of
`largest_step`. Another elastic force changes every use of `normal.stiffness`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import acos, acosh, atan2, copysign, cos, exp, hypot, inf, sin, sqrt
from typing import Annotated, Literal, NamedTuple

from scipy.optimize import brentq

from .domains import InputError, Part, as_dict, flat, held, not_negative, number, positive
from .kernels import DEEP
from .kernels.contact import Friction, Inertia, Normal, Spring
from .kernels.state import Effects, Motion

STIFFNESS = 5e6  # k_n of Appendix A in m g/d^(3/2)
_MOST_DAMPING = 1e100  # beyond it numbers may overflow
_STIFFNESSES = "spring.proportional", "spring.root"  # more than zero


@dataclass(frozen=True)
class Law(Part):
    """Contact law: the normal force F_n and how friction acts, |F_t| <= mu F_n.

    The coefficient of friction mu belongs to the scene (`Contact`).

    name : key of `LAWS`
    normal : force across the surfaces, `Normal`
    spring : force along them, `Spring`; None: friction is a constraint, no slip up to mu F_n
    restitution : head on, 0 to 1, where it is the same at every speed; else None

    Raises
    ------
    ValueError
        If a stiffness is not > 0 and finite, a dashpot not 0 to 1e100, the restitution not
        between 0 and 1, or a spring without stiffness.
    TypeError
        If a part is of the wrong type.
    """

    name: str
    normal: Normal
    spring: Spring | None
    restitution: Annotated[float, 0.0, 1.0] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        normal, spring = self.normal, self.spring
        if normal.plastic not in (True, None):
            raise InputError(f"normal.plastic must be True or None, got {normal.plastic!r}")
        if spring is not None and spring.proportional is spring.root is None:
            raise InputError("spring must have a stiffness, proportional or root")
        positive("normal.stiffness", normal.stiffness)
        for name, value in flat(as_dict(self)).items():
            if name in _STIFFNESSES:
                positive(name, value)
            elif "." in name and name != "normal.plastic":
                number(name, value, 0.0, _MOST_DAMPING)


def head_on_restitution(damping_ratio: float) -> float:
    """Restitution of a head-on impact with the dashpot 2 zeta sqrt(5/4) sqrt(m k_n) d^(1/4).

    In w = d^(5/4) and the time s with ds = d^(1/4) dt the contact is a linear oscillator of
    frequency sqrt(5/4) and damping ratio zeta, at every speed. It ends with the force, at the
    first turn of the velocity:

        e = exp(-2 zeta arccos(zeta) / sqrt(1 - zeta^2)),  arccosh and zeta^2 - 1 beyond 1.
    """
    zeta = not_negative("damping_ratio", damping_ratio)
    if abs(zeta - 1) < 1e-8:
        return exp(-2 - 4 / 3 * (zeta - 1))
    angle = acos(zeta) if zeta < 1 else acosh(zeta)
    return exp(-2 * zeta * angle / sqrt(abs(1 - zeta) * (1 + zeta)))


def damping_ratio(restitution: float) -> float:
    """Damping ratio zeta that gives a head-on restitution, 0 < restitution <= 1."""
    e = number("restitution", restitution, 1e-6, 1.0)
    return brentq(lambda zeta: head_on_restitution(zeta) - e, 0.0, 1 / sqrt(e), xtol=1e-15)


def appendix_a(
    stiffness: float = STIFFNESS,
    *,
    tangential_ratio: float = 95.0,
    damping: float = 400.0,
    reduced_mass: float = 0.5,
    overlap_factor: bool = True,
) -> Law:
    """Contact law of Appendix A as printed: F_n = k_n delta^(3/2) - gamma_n M_e delta v_n.

    F_t is that of a spring of stiffness k_t delta and a dashpot gamma_t M_e delta. As its stiffness
    follows the overlap, the spring can give energy: where friction is large, some impacts end with
    more than they began with.

    Parameters
    ----------
    stiffness : k_n, in m g/d^(3/2)
    tangential_ratio : k_t/k_n; the spring's stiffness is k_t times the overlap
    damping : gamma_n = gamma_t, in sqrt(g/d)
    reduced_mass : M_e in masses of the rod; 1/2 is printed (for two rods), 1 suits a plate
    overlap_factor : whether the dashpots carry the factor of the overlap that is printed
    """
    k = positive("stiffness", stiffness)
    damping = number("damping", damping, 0.0, _MOST_DAMPING)
    dashpot = damping * positive("reduced_mass", reduced_mass) or None
    spring = positive("tangential_ratio", tangential_ratio) * k
    if held("overlap_factor", overlap_factor, bool):
        rubbing = Spring(spring, proportional_dashpot=dashpot)
        return Law("appendix_a", Normal(k, proportional=dashpot), rubbing)
    return Law("appendix_a", Normal(k, constant=dashpot), Spring(spring, constant_dashpot=dashpot))


def _normal(restitution: float, stiffness: float) -> Normal:
    """Hertz' force with the dashpot of a head-on restitution at every speed; plastic if it is 0."""
    k = positive("stiffness", stiffness)
    if number("restitution", restitution, 0.0, 1.0) == 0:
        return Normal(k, plastic=True)
    dashpot = sqrt(5 * k) * damping_ratio(restitution)
    return Normal(k, quarter=dashpot or None)


def constant_restitution(
    restitution: float = 0.65,
    stiffness: float = STIFFNESS,
    *,
    tangential_ratio: float = 30.0,
    tangential_damping: float = 1.0,
) -> Law:
    """Hertz' force with a dashpot of constant head-on restitution; tangential spring and dashpot.

    F_n = k_n delta^(3/2) - c sqrt(M k_n) delta^(1/4) v_n, where c follows from the restitution; the
    stiffness along the plate is tangential_ratio k_n sqrt(delta).

    Parameters
    ----------
    restitution : of a head-on impact at any speed, 0 or 1e-6 to 1. No dashpot gives 0: there the
        contact is plastic, without force while it opens; not between rods
    stiffness : k_n, in m g/d^(3/2)
    tangential_ratio : tangential stiffness over k_n sqrt(overlap), > 0
    tangential_damping : ratio to the critical one of the contact's tangential mass, 0 to 1e100
    """
    normal = _normal(restitution, stiffness)
    ratio = positive("tangential_ratio", tangential_ratio)
    damping = number("tangential_damping", tangential_damping, 0.0, _MOST_DAMPING)
    spring = Spring(root=ratio * normal.stiffness, damping_ratio=damping or None)
    return Law("constant_restitution", normal, spring, float(restitution))


def coulomb(restitution: float = 0.65, stiffness: float = STIFFNESS) -> Law:
    """Hertz' force as in `constant_restitution`; friction as a constraint: no slip up to mu F_n.

    The law under which the rod meets the theory of rigid impacts as the plate grows stiff.

    Parameters
    ----------
    restitution, stiffness : as in `constant_restitution`
    """
    return Law("coulomb", _normal(restitution, stiffness), None, float(restitution))


LAWS: dict[str, Callable[..., Law]] = {
    "appendix_a": appendix_a,
    "constant_restitution": constant_restitution,
    "coulomb": coulomb,
}


def friction_of(law: Law, coefficient: float) -> Friction | None:
    """Coulomb friction under a law; None if the coefficient is zero."""
    mu = number("friction", coefficient, 0.0, inf)
    if mu == 0:
        return None
    return Friction(min(mu, 1e60), law.spring)  # 1e60 stands in for infinity: no slip


def deepest_overlap(law: Law, speed: float) -> float:
    """Largest overlap of a head-on impact at this speed without dashpot, in d."""
    return (1.25 * speed * speed / law.normal.stiffness) ** 0.4


def contact_time(law: Law, speed: float) -> float:
    """Duration of a head-on impact at this speed without dashpot (Hertz), in sqrt(d/g)."""
    return 2.943275 * deepest_overlap(law, speed) / speed


def largest_step(
    law: Law,
    friction: bool,
    speed: float,
    along: float,
    across: float,
    caps: int = 1,
    late: int | None = None,
    damped: float | None = None,
    *,
    key: str = "",
) -> float:
    """Largest stable step for an impact at this speed, in sqrt(d/g).

    K_n and C_n are stiffness and dashpot of the normal force per mass, at the deepest overlap. The
    dashpot of a contact is solved for. Of n contacts that see each other a step late, those of the
    others are extrapolated: K_n dt^2 + 4 (1 - 1/n) C_n dt = 4 is the limit. A step of C_n dt > 2 n
    would turn a velocity round that the dashpot should stop. Friction adds

    - 1.1 K_t dt^2 over a plate, whose dashpots are solved for,
    - (19/16 - 11/(32 n)) K_t dt^2 + 4 (1 - 1/n) C_t dt of n contacts with a wall,
    - (4.85 K_t - a min(C_t^2, 4 K_t)) dt^2 of up to four contacts of rods, each solved for four
      alike, with K_t and C_t of one and a = 0.9 or less,

    each right to two percent or on the safe side for contacts that slip alike.

    Parameters
    ----------
    law : contact law
    friction : whether there is any
    speed : of the approach, > 0
    along, across : largest Z^2/k^2 and X^2/k^2 of a contact
    caps : how many are pressed at once; several push and turn the rod together
    late : n, number of contacts that see each other a step late; None: caps over a plate, where
        only the lower one sees the other late, as 4/3 contacts would
    damped : a, of contacts of rods with each other: 0 where they are to stick in time; None: others
    key : of the contact in a scene, with a dot at its end, for messages

    Raises
    ------
    ValueError
        If the contact is too soft.
    """
    normal, d = law.normal, deepest_overlap(law, speed)
    if not d < DEEP / 2:
        soft = f"{key}stiffness {normal.stiffness:g} is too soft for an impact at {speed:.3g}"
        raise InputError(f"{soft}: overlap {d:.2g} d")
    others = 1 - (1 / late if late else 3 / (2 + caps))
    light = 1 + across if caps == 1 else 2 * max(1.0, across)
    stiff = 1.5 * normal.stiffness * sqrt(d) * light
    dash = (normal.quarter or 0.0) * sqrt(sqrt(d) / (1 + across)) * light
    dash += ((normal.proportional or 0.0) * d + (normal.constant or 0.0)) * light
    turns = 4 * dash / caps
    if friction and law.spring is not None:
        spring, light = law.spring, 1 + along
        k = (spring.proportional or 0.0) * d + (spring.root or 0.0) * sqrt(d)
        rubbing = (spring.proportional_dashpot or 0.0) * d + (spring.constant_dashpot or 0.0)
        rubbing += 2 * (spring.damping_ratio or 0.0) * sqrt(k / light)
        if damped is not None:
            stiff += (4.85 * k - damped * min(rubbing * rubbing * light, 4 * k)) * light
        elif late:
            stiff += (19 / 16 - 11 / (32 * late)) * k * light * caps
            dash += rubbing * light * caps
        else:
            stiff += 1.1 * k * light * caps
    dash *= 4 * others
    return 8 / max(dash + sqrt(dash * dash + 16 * stiff), turns)


Length = Annotated[float, 1.0, 1000.0]  # d
Mass = Literal["solid", "thin"]  # of the uniform body, or of a thin rod


@dataclass(frozen=True)
class Rod(Part):
    """Rod of diameter 1.

    length : overall, caps included, d, >= 1
    inertia : "solid", of the uniform body, or "thin", the paper's length^2/12
    ends : "round", or "flat" for one impact alone: in the plane an end is then an edge with two
        corners. A corner pushes by the law of a cap with the stiffness of a cap, which is an
        assumption: a sharp edge has no Hertz radius
    """

    length: Length = 9.5
    inertia: Mass = "solid"
    ends: Literal["round", "flat"] = "round"

    @property
    def half_length(self) -> float:
        """Distance from the centre of a rod to the centre of a cap, or to a flat end, in d."""
        return (self.length - (self.ends == "round")) / 2

    @property
    def gyration_squared(self) -> float:
        """Moment of inertia about the centre over the mass, k^2, in d^2."""
        if self.inertia == "thin":
            return self.length**2 / 12
        if self.ends == "flat":
            return self.length**2 / 12 + 1 / 16
        h = self.length - 1  # cylinder between the caps; volumes in units of pi/12
        offset = h / 2 + 3 / 16  # of a cap's centre of mass, half a ball of radius 1/2
        ball = 1 / 10 - (3 / 16) ** 2 + offset**2
        return (3 * h * (h**2 / 12 + 1 / 16) + 2 * ball) / (3 * h + 2)

    @property
    def axial_gyration_squared(self) -> float:
        """Moment of inertia of the uniform body about its axis over its mass, in d^2.

        Cylinder of length h = l - 1 and two half spheres, diameter 1: volumes pi h/4 and pi/6,
        moments of 1/8 and 1/10 of their masses.
        """
        cylinder, caps = (self.length - 1) / 4, 1 / 6
        return (cylinder / 8 + caps / 10) / (cylinder + caps)


def effects_of(
    rod: Rod,
    law: Law | None,
    friction: float,
    gravity: tuple[float, float] | None,
    plate: Motion | None,
) -> Effects:
    """`Effects` on one rod; without a law it has no contact with the plate."""
    half, inertia = rod.half_length, Inertia(1 / rod.gyration_squared)
    normal, rubbing = (law.normal, friction_of(law, friction)) if law else (None, None)
    upper, flat = half > 0 or None, rod.ends == "flat" or None
    return Effects(half, inertia, normal, rubbing, gravity, plate, upper, flat)


class LowerEnd(NamedTuple):
    """End of a rod that touches the plate first: the lower cap, or a corner of a flat end."""

    reach: float  # d, from the centre of mass to the centre of the cap, or to the corner
    offset: float  # rad; the tilt of that line less the rod's
    radius: float  # d, of the cap; 0 of a corner

    def arm(self, tilt: float) -> tuple[float, float]:
        """Arm from the centre of mass to the contact point of this end, at a tilt; in d."""
        lean = tilt + self.offset
        return -self.reach * sin(lean), -(self.reach * cos(lean) + self.radius)


def lower_end(effects: Effects, tilt: float) -> LowerEnd:
    """Lower cap or lower corner as `LowerEnd`; the sign of a zero tilt chooses the corner."""
    half = effects.half_length
    if effects.flat is None:
        return LowerEnd(half, 0.0, 0.5)
    return LowerEnd(hypot(half, 0.5), -copysign(atan2(0.5, half), tilt), 0.0)


def height_of_second(effects: Effects, tilt: float) -> float:
    """Height of the second cap or corner over the one that touches first, in d; a sphere's: inf."""
    if effects.upper is None:
        return inf
    corner = inf if effects.flat is None else abs(sin(tilt))
    return min(2 * effects.half_length * cos(tilt), corner)
