"""One impact as assignments: compensated sums, the branch rule, three laws of restitution.

In the mirror frame in which the contact point slips forward (u_0 >= 0), with N and T of forward
slip (`RESPONSES`) and u_* what a slide would leave of the slip:

    slide          N > 0, u_0 > 0 and u_* >= 0
    slip-stick     else, where X Z <= mu (k^2 + Z^2)
    slip reversal  else

It holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. An impact is the impulse of one phase of forward slip and of what follows its stop, if it
does: sticking or backward slip. Both are computed for every impact and the right ones selected.
"""

import random
from collections.abc import Iterator
from itertools import product

import mpmath
import numpy as np
import sympy as sp

from . import laws, slide, slip_reversal, slip_stick
from .arithmetic import Short
from .axioms import RESTITUTION
from .laws import a_1, a_2
from .newton import approach, spin_jump
from .proof import Equation
from .rewrites import RESPONSES, SQUARES, K, K_z, N, N_back, T, T_back
from .routines import ANY, Meaning, Routine, Situation, low, values
from .symbols import P_1, F_z, V_z, X, Z, c_x, c_z, epsilon, k, m, mu, omega, u_0, v_0
from .trace import derived, solve

_one = {m: sp.Integer(1)}  # impulses per unit mass
LAWS = "newton", "poisson", "stronge"


def _name(name: str) -> sp.Symbol:
    """A name of the text, in the meaning of a later one."""
    return sp.Symbol(name)


# ---- situations -------------------------------------------------------------------------------


def _random(seed: int, names: str, least: float = -2, most: float = 2) -> dict[str, mpmath.mpf]:
    draw = random.Random(f"{names} {seed}")
    return {
        name: mpmath.mpf(draw.randrange(1, 10**9)) / 10**9 * (most - least) + least
        for name in names.split()
    }


def _any_numbers(names: str) -> Iterator[Situation]:
    """Numbers of both signs."""
    return (_random(seed, names) for seed in range(8))


_CLOSE = mpmath.mpf("1e-9")  # relative distance to an edge


def mirrored_situations() -> Iterator[Situation]:
    """Contacts in the mirror frame: of all regimes, at the edges, in the Painleve region."""
    for seed in range(48):
        at = _random(seed, "X Z v_0") | _random(seed, "k mu u_0", 0.02)
        at |= _random(seed, "epsilon", 0.1, 0.9) | {"v_0": -abs(at["v_0"])}
        kind, aside = seed % 12, 1 + (-1) ** (seed // 12) * _CLOSE
        if kind in (1, 4):
            at["X"] = mpmath.sign(at["Z"]) * abs(at["X"])
        if kind in (2, 3, 6):
            at["X"] = -mpmath.sign(at["Z"]) * abs(at["X"])
        xz = at["X"] * at["Z"]
        across, along = (at["k"] ** 2 + at[x] ** 2 for x in "XZ")
        if kind in (1, 10):
            at["u_0"] = mpmath.mpf(0)
        if kind == 10:
            at["Z"] = mpmath.mpf(0)
        elif kind in (2, 6):  # N close to 0, or below it
            at["mu"] = across / abs(xz) * (aside if kind == 2 else 2)
        elif kind in (3, 4):  # T close to 0, or T_back
            at["mu"] = along and abs(xz) / along * aside
        elif kind == 5:
            at["v_0"] = -at["v_0"]
        n, t = across + at["mu"] * xz, xz + at["mu"] * along
        if kind == 7 and n * t > 0:  # u_* close to 0
            at["v_0"] = -at["u_0"] * n / (t * (1 + at["epsilon"])) * aside
        elif kind in (8, 9) and n * t > 0:  # the slip stops late
            at["v_0"] = -at["u_0"] * n / (t * (1 + at["epsilon"] / 2))
        yield at


# Nothing slips and nothing makes it: a contact that neither slides nor slips back.
_AT_REST = {x: mpmath.mpf(x in ("Z", "k")) for x in ("X", "Z", "k", "mu", "u_0", "epsilon")} | {
    "v_0": -1
}


def whole_situations() -> Iterator[Situation]:
    """Impacts of a rod on a moving plate, of both sides, with spins that cancel."""
    for seed, mirrored in enumerate(mirrored_situations()):
        side = 1 - 2 * (seed // 12 % 2)
        at = dict(mirrored) | _random(seed, "omega V_z")
        at["X"] = side * at["X"]
        if seed % 5 == 0:
            at["omega"] = at["omega"] / _CLOSE
        at["c_x"] = side * at["u_0"] + at["omega"] * at["Z"]
        at["c_z"] = at["v_0"] + at["V_z"] - at["omega"] * at["X"]
        yield at


# ---- error-free sums and products -------------------------------------------------------------


def _short_pairs() -> tuple[Short, Short]:
    """All pairs of a short number of one size and one of any size that overlaps it, both signs."""
    whole = np.arange(2 ** (Short.digits - 1), 2**Short.digits, dtype=float)
    sizes = np.ldexp(whole[:, None], np.arange(-Short.digits - 2, 1)).ravel()
    a, b = np.meshgrid(whole, np.concatenate([sizes, -sizes]))
    return Short(a), Short(b)


def _halves_are_exact(routine: Routine) -> bool:
    """Whether the parts of a number add up to it, and products of two such parts are exact."""
    a, _ = _short_pairs()
    found = routine.run("short", {"a": a})
    high, rest = found["high"].value, found["rest"].value
    few = [(np.ldexp(np.frexp(part)[0], Short.digits // 2) % 1 == 0).all() for part in (high, rest)]
    return bool((high + rest == a.value).all() and all(few))


def _sum_is_exact(routine: Routine) -> bool:
    """Whether a rounded sum and its error are the sum, in both orders of size."""
    a, b = _short_pairs()
    both = (routine.run("short", {"a": x, "b": y}) for x, y in ((a, b), (b, a)))
    return all((r["s"].value + r["error"].value == a.value + b.value).all() for r in both)


def _product_is_exact(routine: Routine) -> bool:
    """Whether a rounded product and its error are the product."""
    a, b = _short_pairs()
    split = _SPLIT.run("short", {"a": a}), _SPLIT.run("short", {"a": b})
    first, second = ((part["a"], part["high"], part["rest"]) for part in split)
    found = routine.run("short", {"first": first, "second": second})
    return bool((found["p"].value + found["error"].value == a.value * b.value).all())


_a, _b, _rest = (_name(x) for x in ("a", "b", "rest"))

_TWOFOLD = {"a": _a, "a_low": low(_a), "b": _b, "b_low": low(_b)}

_SPLIT = Routine(
    name="split",
    what="A number with its upper and lower half, whose products with other halves are exact.",
    note="Veltkamp. Where a product and a sum can be had with one rounding, it is not needed.",
    arguments="a",
    text="""
        t = SPLIT * a
        high = t - (t - a)
        rest = a - high
    """,
    returned="a, high, rest",
    means=lambda law: {"a": _a, "t": (2**27 + 1) * _a, "high": _a},
    situations=lambda: _any_numbers("a"),
    check=_halves_are_exact,
)

_SUMS = (
    _SPLIT,
    Routine(
        name="two_product",
        what="Rounded product of two split numbers and its error, exact together.",
        note="Dekker.",
        arguments="first second",
        text="""
            a, a_high, a_rest = first
            b, b_high, b_rest = second
            p = a * b
            error = ((a_high * b_high - p) + a_high * b_rest + a_rest * b_high) + a_rest * b_rest
        """,
        returned="p, error",
        means=lambda law: {
            "first": (_a, _a - _rest, _rest),
            "second": (_b, _b / 2, _b / 2),
            "a": _a,
            "a_high": _a - _rest,
            "a_rest": _rest,
            "b": _b,
            "b_high": _b / 2,
            "b_rest": _b / 2,
            "p": _a * _b,
        },
        situations=lambda: _any_numbers("a b rest"),
        check=_product_is_exact,
    ),
    Routine(
        name="two_sum",
        what="Rounded sum of two numbers and its error, exact together.",
        note="Knuth.",
        arguments="a b",
        text="""
            s = a + b
            part = s - a
            error = (a - (s - part)) + (b - part)
        """,
        returned="s, error",
        means=lambda law: {"a": _a, "b": _b, "s": _a + _b, "part": _b},
        situations=lambda: _any_numbers("a b"),
        check=_sum_is_exact,
    ),
    Routine(
        name="total",
        what="a + b + rest for a small rest: the rounded sum and what it lacks.",
        arguments="a b rest",
        text="""
            s, error = two_sum(a, b)
            small = error + rest
            whole = s + small
            lack = small - (whole - s)
        """,
        returned="whole, lack",
        means=lambda law: {
            "a": _a,
            "b": _b,
            "rest": _rest,
            "s": _a + _b,
            "small": _rest,
            "whole": _a + _b + _rest,
        },
        situations=lambda: (
            {**at, "rest": mpmath.mpf(rest)} for at in _any_numbers("a b") for rest in (0, 1)
        ),
    ),
    Routine(
        name="twofold_sum",
        what="Sum of two numbers in twice the digits.",
        arguments="a a_low b b_low",
        text="high, rest = total(a, b, a_low + b_low)",
        returned="high, rest",
        means=lambda law: {**_TWOFOLD, "high": _a + _b},
        situations=lambda: _any_numbers("a b"),
        accurate={"high + rest": (0, "")},
    ),
    Routine(
        name="twofold_product",
        what="Product of two numbers in twice the digits.",
        arguments="a a_low b b_low",
        text="""
            p, error = two_product(split(a), split(b))
            high, rest = total(p, 0.0, error + (a * b_low + a_low * b))
        """,
        returned="high, rest",
        means=lambda law: {**_TWOFOLD, "p": _a * _b, "high": _a * _b},
        situations=lambda: _any_numbers("a b"),
        accurate={"high + rest": (0, "")},
    ),
    Routine(
        name="twofold_quotient",
        what="Quotient of two rounded numbers in twice the digits.",
        arguments="a b",
        text="""
            q = a / b
            p, error = two_product(split(q), split(b))
            high, rest = total(q, 0.0, ((a - p) - error) / b)
        """,
        returned="high, rest",
        means=lambda law: {"a": _a, "b": _b, "q": _a / _b, "p": _a, "high": _a / _b},
        situations=lambda: _any_numbers("a b"),
        accurate={"high + rest": (0, "")},
    ),
    Routine(
        name="lacking",
        what="What a quotient q = a/b lacks for the low parts of a and b, to first order.",
        arguments="q a_low b b_low",
        text="missing = (a_low - b_low * q) * (1 / b)  # a reciprocal need not wait for q",
        returned="missing",
        means=lambda law: {
            **{name: _name(name) for name in ("q", "a_low", "b", "b_low")},
            "missing": _first_order(),
        },
        situations=lambda: _any_numbers("q a_low b b_low"),
    ),
)


def _first_order() -> sp.Expr:
    """Derivative of a/b as both change by their low parts, at a = q b."""
    t, q, b = sp.Symbol("t"), _name("q"), _b
    return ((q * b + t * _name("a_low")) / (b + t * _name("b_low"))).diff(t).subs(t, 0)


# ---- contact ----------------------------------------------------------------------------------

_N, _T, _N_back, _T_back = (RESPONSES[letter] for letter in (N, T, N_back, T_back))
_K, _K_z = SQUARES[K], SQUARES[K_z]
_LENGTHS = {"X": X, "Z": Z, "k": k}
_CONTACT = (_N, _T, _N_back, _T_back, _K, _K_z, low(_N), low(_T))
_VELOCITIES = u_0, v_0, low(u_0), low(v_0)
_GIVEN = {"velocities": _VELOCITIES, "contact": _CONTACT, "k": k, "epsilon": epsilon}
_PARTS = {"u_0": u_0, "v_0": v_0} | dict(
    zip(("N", "T", "N_back", "T_back", "K", "K_z"), _CONTACT, strict=False)
)
_ALL = c_x, c_z, omega, V_z, X, Z, k, mu, epsilon
_WHOLE = {"given": _ALL, "friction": mu} | {str(letter): letter for letter in _ALL}
_U, _V = dict(approach())[u_0], dict(approach())[v_0]
_MIRRORED = {
    "u": _U,
    "side": sp.Piecewise((1, _U > 0), (-1, _U < 0), (1, X * Z >= 0), (-1, True)),
    "mu": mu,
    "ahead": _name("side") * X,
    "u_0": sp.Abs(_U),
    "v_0": _V,
    "velocities": (sp.Abs(_U), _V, 0, 0),
    "contact": tuple(
        part.subs(X, _name("ahead")) for part in (*_CONTACT[:6], sp.S.Zero, sp.S.Zero)
    ),
    **{
        name: part.subs(X, _name("ahead"))
        for name, part in zip(("N", "T", "N_back", "T_back", "K", "K_z"), _CONTACT, strict=False)
    },
}

_CONTACTS = (
    Routine(
        name="contact_velocity",
        what="Velocity $(u_0, v_0)$ of the contact point, (3), and what the rounded numbers lack.",
        note="What the centre of mass does and what the spin adds may nearly cancel.",
        arguments="c_x c_z omega V_z X Z",
        text="""
            spin = split(omega)
            turn, turn_error = two_product(spin, split(Z))
            lift, lift_error = two_product(spin, split(X))
            fall, fall_error = two_sum(c_z, -V_z)
            u_0, u_low = total(c_x, -turn, -turn_error)
            v_0, v_low = total(fall, lift, fall_error + lift_error)
        """,
        returned="u_0, v_0, u_low, v_low",
        means=lambda law: {
            **{str(x): x for x in (c_x, c_z, omega, V_z, X, Z)},
            "spin": omega,
            "turn": omega * Z,
            "lift": omega * X,
            "fall": c_z - V_z,
            "u_0": dict(approach())[u_0],
            "v_0": dict(approach())[v_0],
        },
        situations=whole_situations,
        accurate={"u_0 + u_low": (0, ""), "v_0 + v_low": (0, "")},
    ),
    Routine(
        name="responses",
        what="$N$, $T$, $N_{back}$, $T_{back}$, $K = k^2 + X^2 + Z^2$, $K_z = k^2 + Z^2$; low "
        "parts of $N$, $T$.",
        note="$N$ and $T$ are $k^2$ times $dv/dP_z$ and $-du/dP_z$ in forward slip, (5), (6); the "
        r"two after them the same for $-\mu$. All are relatively accurate where terms cancel.",
        arguments="X Z k mu",
        text="""
            x = split(X)
            z = split(Z)
            radius = split(k)
            factor = split(mu)
            kk, kk_error = two_product(radius, radius)
            xx, xx_error = two_product(x, x)
            zz, zz_error = two_product(z, z)
            xz, xz_error = two_product(x, z)
            across, across_rest = two_sum(kk, xx)
            across_error = across_rest + (kk_error + xx_error)
            along, along_rest = two_sum(kk, zz)
            along_error = along_rest + (kk_error + zz_error)
            press, press_rest = two_product(factor, split(xz))
            press_error = press_rest + mu * xz_error
            hold, hold_rest = two_product(factor, split(along))
            hold_error = hold_rest + mu * along_error
            N, N_low = total(across, press, across_error + press_error)
            T, T_low = total(xz, hold, xz_error + hold_error)
            # what follows a stop needs no low parts, but sums that are rounded once
            K, _ = total(across, zz, across_error + zz_error)
            N_back, _ = total(across, -press, across_error - press_error)
            T_back = (xz - hold) + (xz_error - hold_error)
            K_z = along + along_error
        """,
        returned="N, T, N_back, T_back, K, K_z, N_low, T_low",
        means=lambda law: {
            **{str(x): x for x in (X, Z, k, mu)},
            "x": X,
            "z": Z,
            "radius": k,
            "factor": mu,
            "kk": k**2,
            "xx": X**2,
            "zz": Z**2,
            "xz": X * Z,
            "across": k**2 + X**2,
            "along": k**2 + Z**2,
            "press": mu * X * Z,
            "hold": mu * _K_z,
            "N": _N,
            "T": _T,
            "K": _K,
            "N_back": _N_back,
            "T_back": _T_back,
            "K_z": _K_z,
        },
        situations=mirrored_situations,
        accurate={
            "N + N_low": (0, ""),
            "T + T_low": (0, ""),
            **{"N_back": (1, ""), "T_back": (2, ""), "K": (1, ""), "K_z": (1, "")},
        },
    ),
)


# ---- the branch rule --------------------------------------------------------------------------

_EXCESS = slide.slide_excess().subs(_one)  # u_*
_J_STOP = slide.stop()[1].subs(_one) / k**2
_HITS, _SLIDES, _STICKS = (_name(x) for x in ("hits", "slides", "sticks"))
_REGIME = sp.Piecewise((0, sp.Not(_HITS)), (1, _SLIDES), (2, _STICKS), (3, True))
_SUM_OF_PHASES = _name("forward") * _name("j_1") + _name("j_2") * sp.Piecewise(
    (_name("held"), _STICKS), (_name("back"), True)
)


def _stopped(form: sp.Expr) -> sp.Expr:
    """A form that has its meaning where the contact closes and its slip stops."""
    return sp.Piecewise((ANY, sp.Or(_SLIDES, sp.Not(_HITS))), (form, True))


_BRANCHES = {
    "v_slide": RESTITUTION({}),
    "gain_slide": RESTITUTION({}) - v_0,
    "j_rounded": slide.impulse()[1].subs(_one) / k**2,
    "u_rounded": _EXCESS,
    "j_slide": slide.impulse()[1].subs(_one) / k**2,
    "u_slide": _EXCESS,
    "hits": sp.Lt(v_0, 0),
    "slides": sp.And(_EXCESS >= 0, u_0 > 0, _N > 0),
    "sticks": sp.Ge(slip_stick.stick_margin(), 0),
}


def _slope_after() -> sp.Expr:
    """dv/dP_z per unit mass after the stop."""
    after = laws.slopes()
    return sp.Piecewise((after["stick"], _STICKS), (after["back"], True))


def _of_contact(form: sp.Expr) -> sp.Expr:
    """A form of the slopes a_1, a_2 and the impulse P_1, for the contact."""
    values = {a_1: _N / k**2, a_2: _slope_after(), P_1: slide.stop()[1].subs(_one)}
    return form.subs(values, simultaneous=True)


def _until(form: sp.Expr) -> sp.Expr:
    """A form under kinematic restitution, for any v_f instead."""
    return form.subs(_one).subs(epsilon, -_name("v_f") / v_0)


_SLIDING = (_name("v_slide"), _name("gain_slide"), sp.S.Zero, _SLIDES, _STICKS)
_RISE = slide.stop()[2] - v_0
_STOPPED = (_J_STOP, _RISE, low(_RISE))


def _one_history(routine: Routine) -> bool:
    """Whether just one history of each impact obeys all laws: that which the branch rule names.

    A slide that ends before the slip does; a slip that stops, and sticks within the cone of
    friction; or one that stops and then slips back, driven by more than friction can hold.
    """
    mobility = sp.lambdify((X, Z, k), [laws.mobility()[x] for x in (laws.A, laws.B, laws.C)])
    seen = set()
    for at in values(routine):
        mu, u, v, epsilon = (at[x] for x in ("mu", "u_0", "v_0", "epsilon"))
        A, B, C = mobility(at["X"], at["Z"], at["k"])
        end = -(1 + epsilon) * v / (A + mu * B)
        stop = u / (B + mu * C) if u else u
        before_end = stop >= 0 and v + (A + mu * B) * stop <= -epsilon * v
        histories = (
            u > 0 and end > 0 and u - (B + mu * C) * end >= 0,
            before_end and abs(B) <= mu * C and A - B * B / C > 0,
            before_end and mu * C < B and mu * B < A,
        )
        found = routine.run("exact", {x: at[x] for x in ("velocities", "contact", "epsilon")})
        named = found["slides"], not found["slides"] and found["sticks"]
        if found["hits"] and (sum(histories) != 1 or histories[:2] != named):
            return False
        seen.add(histories)
    return len(seen) >= 3


def _given(*names: str) -> dict[str, Meaning]:
    """Meanings of arguments and of what they are unpacked to."""
    return {name: _GIVEN[name] for name in names} | _PARTS


_RULE = (
    Routine(
        name="branches",
        what="The branch rule: what a slide would do, whether the contact closes, slides, sticks.",
        note="In the mirror frame; $u_* = u_{slide}$. For a contact of any mobilities $A$, $B$, "
        "$C$ the rod's $k^2$ counts as one, $K$ as $A C - B^2$ and $K_z$ as $C$.",
        arguments="velocities contact epsilon",
        text="""
            u_0, v_0, u_low, v_low = velocities
            N, T, N_back, T_back, K, K_z, N_low, T_low = contact
            v_slide = -epsilon * v_0
            gain_slide = v_slide - v_0
            gain_low = (v_slide - (gain_slide + v_0)) - (1 + epsilon) * v_low
            j_rounded, u_rounded = slide(gain_slide, u_0, N, T)
            j_low = lacking(j_rounded, gain_low, N, N_low)
            j_slide = j_rounded + j_low
            u_slide = u_rounded + ((u_low - T_low * j_rounded) - T * j_low)
            hits = v_0 < 0
            slides = (u_slide >= 0) & (u_0 > 0) & (N > 0)
            sticks = T_back <= 0
        """,
        returned="v_slide, gain_slide, gain_low, j_slide, u_slide, hits, slides, sticks",
        means=lambda law: _given("velocities", "contact", "epsilon") | _BRANCHES,
        situations=lambda: (*mirrored_situations(), _AT_REST),
        accurate={
            "gain_slide + gain_low": (1, ""),
            "j_slide": (3, ""),
            "u_slide": (5, "u_0 + u_slide"),
        },
        check=_one_history,
    ),
    Routine(
        name="regime_of",
        what="Code of the regime: 0 no impact, 1 slide, 2 slip-stick, 3 slip reversal.",
        arguments="hits slides sticks",
        text="regime = select(hits, select(slides, 1, select(sticks, 2, 3)), 0)",
        returned="regime",
        means=lambda law: {"hits": _HITS, "slides": _SLIDES, "sticks": _STICKS, "regime": _REGIME},
        situations=lambda: (
            dict(zip(("hits", "slides", "sticks"), each, strict=True))
            for each in product((False, True), repeat=3)
        ),
    ),
    Routine(
        name="mirrored",
        what="An impact mirrored to $u_0 \\ge 0$: side, $X$, friction, velocities, contact.",
        note="Where $u_0 = 0$ the mirror is chosen such that $XZ \\ge 0$. Friction beyond the "
        "constant gives the same impact to the last digit: it stands for infinity, the limit.",
        arguments="given",
        text="""
            c_x, c_z, omega, V_z, X, Z, k, friction, epsilon = given
            u, v_0, u_low, v_low = contact_velocity(c_x, c_z, omega, V_z, X, Z)
            side = copysign(1.0, select(u == 0, X * Z, u))
            mu = smaller(friction, HUGE_FRICTION)
            ahead = side * X
            u_0 = abs(u)
            side_low = side * u_low
            velocities = (u_0, v_0, side_low, v_low)
            contact = responses(ahead, Z, k, mu)
        """,
        returned="side, ahead, mu, velocities, contact",
        means=lambda law: _WHOLE | _MIRRORED,
        situations=whole_situations,
    ),
)

# ---- restitution ------------------------------------------------------------------------------

_LAW = "velocities contact k epsilon sliding stopped"


def _of_law(*names: str) -> dict[str, Meaning]:
    """Meanings of what is known where a law of restitution comes in."""
    return {
        **_given("velocities", "contact", "k", "epsilon"),
        **_BRANCHES,
        "sliding": _SLIDING,
        "stopped": _STOPPED,
        **dict(zip(("j_stop", "rise"), _STOPPED, strict=False)),
        "after": k**2 * _slope_after(),
        "w": _of_contact(a_2 * P_1),
        "r": _of_contact(a_2 / a_1),
        "v_1": slide.stop()[2],
        "v_late": sp.Min(sp.Max(_name("v_1"), 0), _name("v_slide")),
    }


def _law(name: str) -> dict[str, Meaning]:
    """Meanings of the names in a law that is not the paper's."""
    square = 2 if name == "stronge" else 1
    early, late = (_of_contact(laws.final_velocity(name, order)) for order in ("early", "late"))
    soon = _name("soon")
    stopped = _stopped(sp.Piecewise((early, soon), (late, True)))
    v_f = sp.Piecewise((_name("v_slide"), _SLIDES), (stopped, True))
    return {
        **_of_law(),
        "soon": sp.Lt(_name("v_1"), 0),
        "early": _stopped(early**square),
        "late": _stopped(sp.Piecewise((ANY, soon), (late**square, True))),
        "square": stopped**2,
        "v_stopped": stopped,
        "v_f": v_f,
        "gain": v_f - v_0,
    }


_RESTITUTION = (
    Routine(
        name="newton",
        what="$v_f$, $v_f - v_0$ and its low part under kinematic restitution.",
        arguments=_LAW,
        text="v_f, gain, gain_low, slides, sticks = sliding",
        returned="v_f, gain, gain_low",
        means=lambda law: _of_law() | {"v_f": RESTITUTION({}), "gain": RESTITUTION({}) - v_0},
        situations=mirrored_situations,
    ),
    Routine(
        name="after_stop",
        what="$w$ and $r$ of the phase after the stop, $v_1$, and $v_1$ within its bounds.",
        arguments="velocities contact k sliding stopped",
        text="""
            u_0, v_0, u_low, v_low = velocities
            N, T, N_back, T_back, K, K_z, N_low, T_low = contact
            v_slide, gain_slide, gain_low, slides, sticks = sliding
            j_stop, rise, rise_low = stopped
            after = select(sticks, stick_response(k, K, K_z), N_back)
            w, r = slopes(j_stop, N, after)
            v_1 = (v_0 + rise) + (v_low + rise_low)
            v_late = smaller(larger(v_1, 0.0), v_slide)  # rounding at the slide's edge
        """,
        returned="w, r, v_1, v_late",
        means=lambda law: _of_law(),
        situations=mirrored_situations,
        accurate={"v_1": (2, "v_0 + rise")},
    ),
    Routine(
        name="gained",
        what="$v_f$, $v_f - v_0$ and its low part under a law that gives $v_f$ after a stop.",
        arguments="velocities sliding v_stopped",
        text="""
            u_0, v_0, u_low, v_low = velocities
            v_slide, gain_slide, slide_low, slides, sticks = sliding
            v_f = select(slides, v_slide, v_stopped)
            gain = v_f - v_0
            gain_low = (v_f - (gain + v_0)) - v_low
        """,
        returned="v_f, gain, gain_low",
        means=lambda law: _law("poisson"),
        situations=mirrored_situations,
        accurate={"gain + gain_low": (1, "v_f")},
    ),
    Routine(
        name="poisson",
        what="$v_f$, $v_f - v_0$ and its low part under kinetic restitution.",
        arguments=_LAW,
        text="""
            u_0, v_0, u_low, v_low = velocities
            w, r, v_1, v_late = after_stop(velocities, contact, k, sliding, stopped)
            soon = v_1 < 0
            early = poisson_early(epsilon, v_1, w)
            late = poisson_late(epsilon, v_0, v_late, r)
            v_stopped = select(soon, early, late)
            v_f, gain, gain_low = gained(velocities, sliding, v_stopped)
        """,
        returned="v_f, gain, gain_low",
        means=lambda law: _law("poisson"),
        situations=mirrored_situations,
    ),
    Routine(
        name="stronge",
        what="$v_f$, $v_f - v_0$ and its low part under energetic restitution.",
        arguments=_LAW,
        text="""
            u_0, v_0, u_low, v_low = velocities
            w, r, v_1, v_late = after_stop(velocities, contact, k, sliding, stopped)
            soon = v_1 < 0
            early = stronge_early(epsilon, v_0, v_1, w)
            late = stronge_late(epsilon, v_0, v_late, r)
            square = select(soon, early, late)
            v_stopped = sqrt(square)
            v_f, gain, gain_low = gained(velocities, sliding, v_stopped)
        """,
        returned="v_f, gain, gain_low",
        means=lambda law: _law("stronge"),
        situations=mirrored_situations,
    ),
)

# ---- the whole impact -------------------------------------------------------------------------


def _final(law: str) -> sp.Expr:
    """v_f of an impact under a law."""
    return RESTITUTION({}) if law == "newton" else _law(law)["v_f"]


def _by_regime(slid: sp.Expr, stuck: sp.Expr, back: sp.Expr) -> sp.Expr:
    return sp.Piecewise((slid, _SLIDES), (stuck, _STICKS), (back, True))


def _later(impulse: sp.Expr) -> sp.Expr:
    """Normal impulse after the stop."""
    return _until(impulse - slide.stop()[1])


def _phases(law: str) -> dict[str, Meaning]:
    """Meanings of the names of `phases`."""
    closing = _name("v_closing")
    back = _until(slip_reversal.final_slip())
    return {
        **_of_law(),
        "soon": sp.Lt(_name("v_1"), 0),
        "v_closing": _final(law),
        "gain": closing - v_0,
        "v_f": sp.Piecewise((closing, _HITS), (v_0, True)),
        "slips": u_0 > 0,
        "T_slip": sp.Piecewise((_T, u_0 > 0), (1, True)),
        "j_rounded": _J_STOP,
        "rest": _stopped(closing - slide.stop()[2]),
        "j_after": _stopped(
            sp.Piecewise(
                (_later(slip_stick.impulse()[1]) / _K_z, _STICKS),
                (_later(slip_reversal.impulse()[1]) / k**2, True),
            )
        ),
        "u_back": _stopped(sp.Piecewise((0, _STICKS), (back, True))),
        "j_1": sp.Piecewise((_BRANCHES["j_slide"], _SLIDES), (_J_STOP, True)),
        "j_2": sp.Piecewise((0, _SLIDES), (_name("j_after"), True)),
        "u_end": sp.Piecewise((_EXCESS, _SLIDES), (_name("u_back"), True)),
        "u_f": sp.Piecewise((_name("u_end"), _HITS), (u_0, True)),
    }


def _impact(law: str) -> dict[str, Meaning]:
    """Meanings of the names of `impact`: the state after it, and its balance of energy."""
    impulses = (part.impulse() for part in (slide, slip_stick, slip_reversal))
    along, up = zip(*impulses, strict=True)
    pushed, lifted = (
        sp.Piecewise((_by_regime(*map(_until, parts)), _HITS), (0, True)) for parts in (along, up)
    )
    slip_after = _by_regime(_EXCESS, sp.S.Zero, _until(slip_reversal.final_slip()))
    ahead = {
        **{name: _BRANCHES[name] for name in ("v_slide", "hits", "slides", "sticks")},
        "v_1": slide.stop()[2],
        "soon": sp.Lt(_name("v_1"), 0),
        "v_f": sp.Piecewise((_final(law), _HITS), (v_0, True)),
        "u_f": sp.Piecewise((slip_after, _HITS), (u_0, True)),
        "push": mu * k**2,
        "lift": k**2,
        "turn": spin_jump(-mu * k**2, k**2).subs(_one),
        "back": spin_jump(mu * k**2, k**2).subs(_one),
        "K_z": _K_z,
        "push_held": slip_stick.sticking_force().subs(F_z, _K_z),
        "lift_held": _K_z,
        "turn_held": spin_jump(slip_stick.sticking_force().subs(F_z, _K_z), _K_z).subs(_one),
        "j_1": ANY,
        "j_2": ANY,
        "P_ahead": pushed,
        "P_z": lifted,
        "spin": spin_jump(_name("P_ahead"), _name("P_z")).subs(_one),
    }
    side, c_x_after, c_z_after, omega_after, p_x = (
        _name(name) for name in ("side", "c_x_after", "c_z_after", "omega_after", "P_x")
    )
    energies = (
        (x**2 + (z - V_z) ** 2 + (k * turn) ** 2) / 2
        for x, z, turn in ((c_x_after, c_z_after, omega_after), (c_x, c_z, omega))
    )
    after, before = energies
    return {
        **_WHOLE,
        **_MIRRORED,
        **{name: form.subs(X, _name("ahead")) for name, form in ahead.items()},
        "regime": _REGIME,
        "P_x": side * _name("P_ahead"),
        "c_x_after": c_x + p_x,
        "c_z_after": c_z + _name("P_z"),
        "omega_after": omega + side * _name("spin"),
        "slip_after": side * _name("u_f"),
        "energy": after - before,
    }


_WHOLE_IMPACT = (
    Routine(
        name="phases",
        what="Impulses over $k^2$ of forward slip and of what follows; contact velocities after.",
        arguments="law velocities contact k epsilon",
        text="""
            u_0, v_0, u_low, v_low = velocities
            N, T, N_back, T_back, K, K_z, N_low, T_low = contact
            v_slide, gain_slide, slide_low, j_slide, u_slide, hits, slides, sticks = branches(
                velocities, contact, epsilon
            )
            slips = u_0 > 0
            T_slip = select(slips, T, 1.0)  # without slip nothing is divided by T, which may be 0
            j_rounded, rise = stop(u_0, N, T_slip)
            j_low = lacking(j_rounded, u_low, T_slip, T_low)
            rise_low = N_low * j_rounded + N * j_low
            j_stop = j_rounded + j_low
            sliding = (v_slide, gain_slide, slide_low, slides, sticks)
            stopped = (j_stop, rise, rise_low)
            v_closing, gain, gain_low = law(velocities, contact, k, epsilon, sliding, stopped)
            # v_f - v_1: nothing pulls, though rounding may; so P_z > 0, and the way back is back
            rest = larger((gain - rise) + (gain_low - rise_low), 0.0)
            j_after, u_back = reverse(rest, select(sticks, K, N_back), larger(T_back, 0.0))
            j_1 = select(slides, j_slide, j_stop)
            j_2 = select(slides, 0.0, j_after)
            u_end = select(slides, u_slide, u_back)
            u_f = select(hits, u_end, u_0)
            v_f = select(hits, v_closing, v_0)
        """,
        returned="j_1, j_2, u_f, v_f, hits, slides, sticks",
        means=_phases,
        situations=mirrored_situations,
        laws=LAWS,
        accurate={
            "rise + rise_low": (2, ""),
            "j_stop": (2, ""),
            "rest": (7, "gain + rise"),
        },
    ),
    Routine(
        name="added",
        what="Sum over the phases of what a unit of each one's impulse gives; 0 without an impact.",
        arguments="hits sticks j_1 j_2 forward back held",
        text="amount = select(hits, select(sticks, held, back) * j_2 + forward * j_1, 0.0)",
        returned="amount",
        means=lambda law: {
            **{x: _name(x) for x in ("hits", "sticks", "j_1", "j_2", "forward", "back", "held")},
            "amount": sp.Piecewise((_SUM_OF_PHASES, _HITS), (0, True)),
        },
        situations=lambda: (
            {**_random(seed, "j_1 j_2 forward back held"), "hits": hits, "sticks": sticks}
            for seed, (hits, sticks) in enumerate(product((False, True), repeat=2))
        ),
    ),
    Routine(
        name="impact",
        what="State of a rod after an impact under a law; the fields of `Collision`.",
        arguments="law given",
        text="""
            c_x, c_z, omega, V_z, X, Z, k, friction, epsilon = given
            side, ahead, mu, velocities, contact = mirrored(given)
            u_0, v_0, u_low, v_low = velocities
            N, T, N_back, T_back, K, K_z, N_low, T_low = contact
            j_1, j_2, u_f, v_f, hits, slides, sticks = phases(law, velocities, contact, k, epsilon)
            push, lift, turn, back = slip(ahead, Z, k, mu)
            push_held, lift_held, turn_held = stick(ahead, Z, K_z)
            P_ahead = added(hits, sticks, j_1, j_2, -push, push, push_held)
            P_z = added(hits, sticks, j_1, j_2, lift, lift, lift_held)
            spin = added(hits, sticks, j_1, j_2, turn, back, turn_held)
            regime = regime_of(hits, slides, sticks)
            energy = energy_change(P_ahead, P_z, u_0, v_0, u_f, v_f)
            P_x = side * P_ahead
            c_x_after = c_x + P_x
            c_z_after = c_z + P_z
            omega_after = omega + side * spin
            slip_after = side * u_f
        """,
        returned="c_x_after, c_z_after, omega_after, regime, P_x, P_z, slip_after, v_f, energy",
        means=_impact,
        situations=whole_situations,
        laws=LAWS,
    ),
)


@derived
def ways_on() -> sp.Matrix:
    """T at the friction that makes N zero, and N_back at the one that makes T_back zero."""
    (lifts,), (holds,) = solve(_N, mu), solve(_T_back, mu)
    return sp.Matrix([sp.factor(_T.subs(mu, lifts)), sp.factor(_N_back.subs(mu, holds))])


def _by_mobilities(form: sp.Matrix) -> list[sp.Expr]:
    """T = -k^2 (A C - B^2)/B and N_back = k^2 (A C - B^2)/C."""
    values = laws.mobility()
    A, B, C = (values[letter] for letter in (laws.A, laws.B, laws.C))
    return [form[0] * B + k**2 * (A * C - B**2), form[1] * C - k**2 * (A * C - B**2)]


EQUATIONS = (
    Equation(
        tag="kernel: one way on",
        what="$T$ at the friction where $N = 0$, $N_{back}$ at the friction where $T_{back} = 0$",
        symbol="(T, N_{back})",
        derive=ways_on,
        check=_by_mobilities,
        verdict="new",
        note="both positive, as the first needs $XZ < 0$ and the second $XZ > 0$. $T$ rises with "
        "friction: where friction outweighs what presses the contact apart ($N \\le 0$), the slip "
        "stops. $N_{back}$ falls with friction: where the slip turns back ($T_{back} > 0$), the "
        "contact is still pressed apart",
    ),
)

ROUTINES = (*_SUMS, *_CONTACTS, *_RULE, *_RESTITUTION, *_WHOLE_IMPACT)
