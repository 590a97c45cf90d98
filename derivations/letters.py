"""The table of letters: what each letter of the report means, and its dimension.

Dimensions are monomials in mass M, length L and time T; 1 is a number. A letter with two meanings
has two lines.
"""

import re
from typing import NamedTuple

import sympy as sp

from .typeset import latex


class Letter(NamedTuple):
    """One line of the table."""

    name: str  # of the symbol
    meaning: str
    dimension: str  # LaTeX

    @property
    def tex(self) -> str:
        """LaTeX of the letter."""
        return {"Vdot_z": r"\dot V_z", "cprime_x": "c_x'", "cprime_z": "c_z'"}.get(
            self.name, latex(sp.Symbol(self.name))
        )


_TABLE = """
A | normal velocity that a unit of normal impulse gives the contact point, per unit mass | 1
a | slope $-a_1$ in the Painlevé region | 1
a_1 | $m\\,dv/dP_z$ while the contact slips forward | 1
a_2 | $m\\,dv/dP_z$ after the slip has stopped | 1
alpha | constant of (4), $m l^2/(4 I)$ | 1
alpha | $V_z/V_0$, in the section on landing phases | 1
b | $c_z'/V_z$ by the closure, in the section on landing phases | 1
B | velocity along one axis that a unit of impulse along the other takes away, per unit mass | 1
C | slip velocity that a unit of tangential impulse gives, per unit mass | 1
c_x | velocity of the centre of mass along the plate, before the impact | L/T
c_z | velocity of the centre of mass upwards, before the impact | L/T
cprime_x | the same, after the impact | L/T
cprime_z | the same, after the impact | L/T
d | diameter of the rod | L
epsilon | coefficient of restitution, from 0 to 1 | 1
eta | $\\sqrt{\\Gamma - 1}$ | 1
F_x | force of the plate on the rod along the plate: friction | M L/T^2
F_z | normal force of the plate on the rod | M L/T^2
g | acceleration of gravity | L/T^2
g | $(1 + \\epsilon)(-c_z/c_x)$, in the largest friction of a slide | 1
Gamma | largest acceleration of the plate over that of gravity | 1
gamma_n | damping constant of Appendix A | 1/(L T)
h_0 | length of a spherocylinder without its caps, over the diameter | 1
I | moment of inertia about the centre of mass | M L^2
k | gyration radius, $I = m k^2$ | L
k_1 | gyration radius of the first of two bodies | L
k_2 | gyration radius of the second | L
k_n | stiffness of Appendix A's normal force | M/(L^{1/2} T^2)
kappa | $(1 - \\epsilon)/(1 + \\epsilon)$ | 1
l | length of the rod | L
L | dimension of a length | L
m | mass of the rod | M
M | mass of a spherocylinder, in virtual spheres; dimension of a mass | M
m_1 | mass of the first of two bodies | M
m_2 | mass of the second | M
m_r | reduced mass of two rods that touch | M
mu | coefficient of friction, static and dynamic | 1
omega | spin, positive where the top turns towards $+x$ | 1/T
omega_x | a misprint in (13), for $\\omega X$ | L/T
P | one component of the impulse | M L/T
P_1 | normal impulse when the slip stops (per unit mass in the section on the laws) | M L/T
P_2 | normal impulse after that | M L/T
P_x | tangential impulse of the plate on the rod | M L/T
P_z | normal impulse of the plate on the rod | M L/T
phi | tilt of the rod from the vertical | 1
q | $|F_x|/F_z$ | 1
q | $|c_z|/V_0$, in the section on landing phases | 1
r | approach ratio $-v_0/u_0$ | 1
sigma | direction of the slip, 1 or -1 | 1
t | time | T
T | $\\tan\\phi$ | 1
T | dimension of a time, in Appendix A | T
tau | duration of the impact | T
theta | phase of the plate at landing | 1
theta_0 | $\\arccos(-q)$: beyond it the plate runs away from the rod | 1
u_* | slip velocity at separation, if it never stops | L/T
u_0 | slip velocity of the contact point before the impact | L/T
u_f | slip velocity at separation | L/T
v | velocity, in Appendix A | L/T
v_0 | normal velocity of the contact point relative to the plate, before the impact | L/T
v_1 | the same, when the slip stops | L/T
v_f | the same, at separation | L/T
V_0 | amplitude of the plate's velocity | L/T
V_z | velocity of the plate, upwards | L/T
Vdot_z | acceleration of the plate | L/T^2
vartheta | turn of the body | 1
x | place of the contact point from the centre of mass, along the plate | L
X | place of the centre of mass from the contact point, along the plate | L
X_1 | $X$ of the first of two bodies | L
X_2 | $X$ of the second | L
xi | place of a point in the body, across | L
z | place of the contact point from the centre of mass, upwards | L
Z | height of the centre of mass over the contact point | L
Z_1 | $Z$ of the first of two bodies | L
Z_2 | $Z$ of the second | L
zeta | place of a point in the body, upwards | L
"""

LETTERS = tuple(
    sorted(
        (Letter(*line.split(" | ")) for line in _TABLE.strip().splitlines()),
        key=lambda letter: (re.sub(r"\\dot |[\\{}]", "", letter.tex).lower(), letter.tex),
    )
)
