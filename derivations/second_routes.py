"""Second routes to whole impacts, for proofs: conservation laws and one system of equations.

Nothing here uses the contact point's equations of motion, (5) and (6): the spin about the contact
point is conserved, since the impulse passes through it, and the rest is a linear system.
"""

from functools import cache

import sympy as sp

from .equality import Pair, Triple
from .symbols import V_z, X, Z, c_x, c_z, epsilon, k, m, mu, omega

State = Triple  # velocity of the centre of mass, and spin


def _spin_about_contact(state: State) -> sp.Expr:
    v_x, v_z, spin = state
    return k**2 * spin + Z * v_x - X * v_z


@cache
def impact(regime: str) -> State:
    """(c_x', c_z', omega') after a "slide", "stick" or "back", under kinematic restitution."""
    before: State = (c_x, c_z, omega)
    after: State = sp.symbols("a_x a_z a_w")
    stopped: State = sp.symbols("s_x s_z s_w")
    p_1, p_2, q_2 = sp.symbols("p_1 p_2 q_2")  # normal impulses; the second tangential one

    def struck(state: State, p_x: sp.Expr, p_z: sp.Expr) -> list[sp.Expr]:
        return [
            m * (state[0] - c_x) - p_x,
            m * (state[1] - c_z) - p_z,
            _spin_about_contact(state) - _spin_about_contact(before),
        ]

    def slip(state: State) -> sp.Expr:
        return state[0] - state[2] * Z

    def rise(state: State) -> sp.Expr:
        return state[1] - V_z + state[2] * X

    equations = [
        *struck(after, -mu * p_1 + q_2, p_1 + p_2),
        rise(after) + epsilon * rise(before),
        *struck(stopped, -mu * p_1, p_1),
    ]
    equations += {
        "slide": [p_2, q_2],
        "stick": [slip(stopped), slip(after)],
        "back": [slip(stopped), q_2 - mu * p_2],
    }[regime]
    (solution,) = sp.linsolve(equations, *after, *stopped, p_1, p_2, q_2)
    return solution[:3]


def landed(regime: str) -> State:
    """(c_x', c_z', omega') after a landing without spin in a regime."""
    return tuple(part.subs(omega, 0) for part in impact(regime))


@cache
def energy_created(regime: str) -> sp.Expr:
    """Discriminant of the energy change in c_x: zero where an impact can just create energy.

    There is no spin before, and the plate is at rest.
    """
    v_x, v_z, spin = landed(regime)
    change = v_x**2 + v_z**2 + k**2 * spin**2 - c_x**2 - c_z**2  # twice, per unit mass
    a, b, c = sp.Poly(change.subs({V_z: 0, c_z: -1}), c_x).all_coeffs()
    return b**2 - 4 * a * c  # SymPy's own discriminant takes seconds


@cache
def landing(regime: str) -> Pair:
    """(c_x, c_z) before a landing without spin that keeps c_x and turns c_z round."""
    v_x, v_z, _ = landed(regime)
    (found,) = sp.linsolve([v_x - c_x, v_z + c_z], c_x, c_z)
    return tuple(found)
