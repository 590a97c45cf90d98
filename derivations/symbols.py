"""The paper's letters, with the sign of each where it is known.

Coordinates and velocities are general reals, so that whatever is proved holds for both signs. Only
what is positive by its meaning (mass, gyration radius, length, V_0) is declared positive. `NAMED`
holds the letters by their names in print: "l" is `length`, "I" is `moment`.
"""

import sympy as sp

m, moment, k, length, diameter = sp.symbols("m I k l d", positive=True)
h_0 = sp.Symbol("h_0", nonnegative=True)
alpha = sp.Symbol("alpha", positive=True)  # m l^2/(4 I), of Eq. (4)
mu, epsilon = sp.symbols("mu epsilon", nonnegative=True)

X, Z = sp.symbols("X Z", real=True)
phi = sp.Symbol("phi", real=True)
c_x, c_z, omega, V_z = sp.symbols("c_x c_z omega V_z", real=True)
u_0, v_0, u_f, v_f = sp.symbols("u_0 v_0 u_f v_f", real=True)
v_1 = sp.Symbol("v_1", real=True)

P_x, P_z = sp.symbols("P_x P_z", real=True)
P_1 = sp.Symbol("P_1", positive=True)  # a normal impulse
F_x, F_z = sp.symbols("F_x F_z", real=True)

t, theta = sp.symbols("t theta", real=True)
V_0 = sp.Symbol("V_0", positive=True)

# By the names they are printed with: "I" and "l" as well as "mu".
NAMED = {letter.name: letter for letter in list(vars().values()) if isinstance(letter, sp.Symbol)}


def __getattr__(name: str) -> sp.Symbol:
    """A letter by its printed name: `symbols.l` is `symbols.length`."""
    if name not in NAMED:
        raise AttributeError(f"there is no letter {name!r}; there are {', '.join(NAMED)}")
    return NAMED[name]
