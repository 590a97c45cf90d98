"""Mass, moment of inertia and contact of three rods, by integration; the paper's note [12]."""

import sympy as sp

from .equality import Pair, Residuals, Triple
from .lecture import meaning
from .proof import Equation, Repair
from .symbols import X, Z, diameter, h_0, k, length, m, phi
from .trace import derived

Profile = tuple[Triple, ...]  # (radius, from, to) along the axis

_z = sp.Symbol("z", real=True)


def mass_and_inertia(profile: Profile, density: sp.Expr) -> Pair:
    """Mass and transverse moment of inertia of a body of revolution, sliced into discs."""
    mass = inertia = 0
    for radius, low, high in profile:
        disc = density * sp.pi * radius**2  # mass per thickness
        mass += sp.integrate(disc, (_z, low, high))
        inertia += sp.integrate(disc * (_z**2 + radius**2 / 4), (_z, low, high))
    return sp.expand(mass), sp.expand(inertia)


@derived("m/m_s", "I/(m_s d^2)")
def spherocylinder() -> Pair:
    """Mass and inertia in units of the virtual sphere: diameter 1, mass 1; length $h_0 + 1$."""
    half = h_0 / 2
    end = half + sp.S.Half
    cap = sp.sqrt(sp.Rational(1, 4) - (_z - half) ** 2)
    mirrored = cap.subs(_z, -_z)
    profile = (mirrored, -end, -half), (sp.S.Half, -half, half), (cap, half, end)
    return mass_and_inertia(profile, 6 / sp.pi)


@derived("k^2_{round}")
def spherocylinder_gyration() -> sp.Expr:
    """$k^2$ of a solid spherocylinder of overall length $l$ and diameter $d$."""
    mass, inertia = spherocylinder()
    ratio = (inertia / mass).subs(h_0, meaning(h_0))
    return sp.factor(diameter**2 * ratio)


@derived("k^2_{flat}")
def cylinder_gyration() -> sp.Expr:
    """$k^2$ of a solid flat-ended cylinder of length $l$ and diameter $d$."""
    mass, inertia = mass_and_inertia(
        ((diameter / 2, -length / 2, length / 2),), sp.Symbol("rho", positive=True)
    )
    return sp.expand(inertia / mass)


@derived("k^2")
def thin_gyration() -> sp.Expr:
    """$k^2$ of a thin rod, the mean squared distance from its middle: the cylinder's, $d = 0$."""
    return cylinder_gyration().subs(diameter, 0)


def _stand(lowest: sp.Matrix) -> Pair:
    """(X, Z) of the centre of mass seen from the lowest point, which is given from the centre."""
    return tuple(-lowest)


_axis = sp.Matrix([sp.sin(phi), sp.cos(phi)])
_across = sp.Matrix([sp.cos(phi), -sp.sin(phi)])  # the side that a positive tilt turns down
_down = sp.Matrix([0, -1])


def thin_contact() -> Pair:
    """(X, Z) of a thin rod that stands on its lower end."""
    return _stand(-length / 2 * _axis)


@derived("X_{round}", "Z_{round}")
def round_contact() -> Pair:
    """$(X, Z)$ of a spherocylinder, which touches straight below the centre of its lower cap."""
    return _stand(-(length - diameter) / 2 * _axis + diameter / 2 * _down)


@derived("X_{flat}", "Z_{flat}")
def flat_contact() -> Pair:
    """$(X, Z)$ of a flat-ended rod on the lower edge of its end, for positive tilt."""
    return _stand(-length / 2 * _axis + diameter / 2 * _across)


def _contact_checks(form: sp.Matrix) -> Residuals:
    """Residuals of contacts: virtual work, radius of curvature of the end, height at two tilts."""
    x_round, z_round, x_flat, z_flat = form
    for x, z, curvature in ((x_round, z_round, diameter / 2), (x_flat, z_flat, 0)):
        yield from (
            x + z.diff(phi),
            z.diff(phi, 2) + z - curvature,
            z.subs(phi, 0) - length / 2,
            z.subs(phi, sp.pi / 2) - diameter / 2,
        )


def _gyration_checks(form: sp.Matrix) -> Residuals:
    """Residuals of both k^2: shifted parts (Steiner); mean x^2 + z^2 over a cylinder's volume."""
    mass, inertia = (part.subs(h_0, length / diameter - 1) for part in _by_parts())
    r, turn = sp.symbols("r theta", positive=True)
    inner = sp.integrate((_z**2 + r**2 * sp.cos(turn) ** 2) * r, (r, 0, diameter / 2))
    volume = sp.pi * diameter**2 * length / 4
    square = sp.integrate(inner, (turn, 0, 2 * sp.pi), (_z, -length / 2, length / 2)) / volume
    return [form[0] - diameter**2 * inertia / mass, form[1] - square]


def _by_parts(mass: sp.Expr = 1 + 3 * h_0 / 2) -> Pair:
    """Mass and inertia of a spherocylinder as a cylinder and two shifted half-balls.

    A second route to `spherocylinder`, in its units.
    """
    balls = mass.subs(h_0, 0)
    cylinder, cap = mass - balls, balls / 2
    own = cap * sp.Rational(2, 5) / 4 - cap * sp.Rational(3, 16) ** 2  # about its own centre
    shifted = own + cap * (h_0 / 2 + sp.Rational(3, 16)) ** 2
    return cylinder + 2 * cap, cylinder * (sp.Rational(1, 16) + h_0**2 / 12) + 2 * shifted


EQUATIONS = (
    Equation(
        "IV: thin rod",
        "$X$, $Z$, $k$ and $I$ of a thin rod",
        "(X, Z, k, I)",
        formulas=tuple(f"IV: thin rod, {letter}" for letter in "XZkI"),
        derive=lambda: (*thin_contact(), sp.sqrt(thin_gyration()), m * thin_gyration()),
    ),
)

BEYOND = (
    Equation(
        "[12]: mass",
        "mass of a spherocylinder, in virtual spheres",
        "m/m_s",
        derive=lambda: spherocylinder()[0],
    ),
    Equation(
        "[12]: inertia",
        "moment of inertia of a spherocylinder",
        "I/(m_s d^2)",
        derive=lambda: spherocylinder()[1],
        contradicted_by=("[12]: mass",),
        contradiction=lambda mass: _by_parts(mass)[1],
        repair=(
            Repair("15/32", "9/32"),
            Repair("+ h_0^2", "+ 1/4h_0^2"),
        ),
    ),
    Equation(
        "bodies: gyration radius",
        "$k^2$ of a solid spherocylinder and of a solid flat-ended cylinder",
        "(k^2_{round}, k^2_{flat})",
        derive=lambda: (spherocylinder_gyration(), cylinder_gyration()),
        check=_gyration_checks,
    ),
    Equation(
        "bodies: contact",
        "$(X, Z)$ of a spherocylinder and of a flat-ended rod on its edge",
        "(X_{round}, Z_{round}, X_{flat}, Z_{flat})",
        derive=lambda: (*round_contact(), *flat_contact()),
        check=_contact_checks,
    ),
)

THIN = {X: thin_contact()[0], Z: thin_contact()[1], k: sp.sqrt(thin_gyration())}
T = sp.Symbol(r"{\tan\phi}", positive=True)


def over_tangent(form: sp.Expr) -> sp.Expr:
    """A form of a thin rod as a function of T = tan(phi)."""
    form = sp.expand_trig(form.subs(THIN)).subs(sp.sin(phi), T * sp.cos(phi))
    return sp.factor(form.subs(sp.cos(phi), 1 / sp.sqrt(1 + T**2)))
