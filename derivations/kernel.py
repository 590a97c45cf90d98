"""One impact as assignments: what each name in kernel.toml stands for.

In the mirror frame in which the contact point slips forward (u_0 >= 0), with N and T of forward
slip (`RESPONSES`) and u_* what a slide would leave of the slip:

    slide          N > 0, u_0 > 0 and u_* >= 0
    slip-stick     else, where X Z <= mu (k^2 + Z^2)
    slip reversal  else

It holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. An impact is the impulse of one phase of forward slip and of what follows its stop, if it
does: sticking or backward slip. Both are computed for every impact and the right ones selected.
"""

from itertools import product

import sympy as sp

from . import contacts, error_free, laws, slide, slip_reversal, slip_stick
from .axioms import RESTITUTION
from .laws import a_1, a_2
from .newton import approach, spin_jump
from .proof import Equation
from .rewrites import RESPONSES, SQUARES, K, K_z, N, N_back, T, T_back
from .routines import ANY, Meaning, Routine, low, read, values
from .symbols import P_1, F_z, V_z, X, Z, c_x, c_z, epsilon, k, m, mu, omega, u_0, v_0
from .trace import derived, solve

Meanings = dict[str, Meaning]
LAWS = "newton", "poisson", "stronge"
_one = {m: sp.Integer(1)}  # impulses per unit mass
# Names that meanings refer to.
_hits, _slides, _sticks, _soon = sp.symbols("hits slides sticks soon")
_v_1, _v_slide, _gain_slide, _v_closing, _v_f, _u_f = sp.symbols(
    "v_1 v_slide gain_slide v_closing v_f u_f"
)
_side, _ahead, _P_ahead, _P_x, _P_z, _spin = sp.symbols("side ahead P_ahead P_x P_z spin")
_forward, _back, _held, _j_1, _j_2 = sp.symbols("forward back held j_1 j_2")


def _zero(names: str) -> Meanings:
    """Meanings of low parts."""
    return dict.fromkeys(names.split(), sp.S.Zero)


# ---- contact ----------------------------------------------------------------------------------

_N, _T, _N_back, _T_back = (RESPONSES[letter] for letter in (N, T, N_back, T_back))
_K, _K_z = SQUARES[K], SQUARES[K_z]
_RESPONSES = {"N": _N, "T": _T, "N_back": _N_back, "T_back": _T_back, "K": _K, "K_z": _K_z}
_U, _V = (dict(approach())[speed] for speed in (u_0, v_0))
_ALL = c_x, c_z, omega, V_z, X, Z, k, mu, epsilon
_LETTERS = {str(letter): letter for letter in _ALL}
_LENGTHS = {name: _LETTERS[name] for name in ("X", "Z", "k", "mu")}
_MIRRORED = {
    "given": _ALL,
    **{"u": _U, "v_0": _V, "u_0": sp.Abs(_U)},
    "side": sp.Piecewise((1, _U > 0), (-1, _U < 0), (1, X * Z >= 0), (-1, True)),
    **{"mu": sp.Min(mu, 2**500), "ahead": _side * X},
    **{name: form.subs(X, _ahead) for name, form in _RESPONSES.items()},
    "velocities": (sp.Abs(_U), _V, 0, 0),
    "contact": (*(form.subs(X, _ahead) for form in _RESPONSES.values()), 0, 0),
}
_SQUARES = {"kk": k**2, "xx": X**2, "zz": Z**2, "xz": X * Z, "press": mu * X * Z, "hold": mu * _K_z}
_CONTACTS = (
    read(
        "contact_velocity",
        lambda law: _LETTERS | {"u_0": _U, "v_0": _V} | _zero("turn_error u_low v_low"),
        contacts.whole,
    ),
    read(
        "responses",
        lambda law: _LENGTHS | _RESPONSES | _SQUARES | _zero("N_low T_low"),
        contacts.mirrored,
    ),
)

# ---- the branch rule --------------------------------------------------------------------------

_GIVEN = {
    "velocities": (u_0, v_0, low(u_0), low(v_0)),
    "contact": (*_RESPONSES.values(), low(_N), low(_T)),
    **{"k": k, "epsilon": epsilon},
}
_EXCESS = slide.slide_excess().subs(_one)  # u_*
_J_SLIDE, _J_STOP = (part[1].subs(_one) / k**2 for part in (slide.impulse(), slide.stop()))
_RISE = slide.stop()[2] - v_0
_RULE = {
    "hits": sp.Lt(v_0, 0),
    "slides": sp.And(*(sp.Gt(x, 0) for x in (u_0, _N)), sp.Ge(_EXCESS, 0)),
    "sticks": sp.Ge(slip_stick.stick_margin(), 0),
}
_SLIDE = {"v_slide": RESTITUTION({}), "gain_slide": RESTITUTION({}) - v_0}
_BRANCHES = _GIVEN | _SLIDE | _RULE | {"j_slide": _J_SLIDE, "u_slide": _EXCESS} | _zero("j_low")
_REGIME = sp.Piecewise((0, sp.Not(_hits)), (1, _slides), (2, _sticks), (3, True))


def _one_history(routine: Routine) -> bool:
    """Whether just one history of each impact obeys all laws, that which the branch rule names.

    A slide that ends before the slip does, or with it; a slip that stops, and sticks within the
    cone of friction; or one that stops and then slips back, driven by more than friction can hold.
    """
    mobility = sp.lambdify((X, Z, k), [laws.mobility()[x] for x in (laws.A, laws.B, laws.C)])
    for at in values(routine):
        friction, u, v = at["mu"], at["u_0"], at["v_0"]
        A, B, C = mobility(at["X"], at["Z"], at["k"])
        gain = -(1 + at["epsilon"]) * v
        end = gain / (A + friction * B)
        stop = u / (B + friction * C) if u else u
        stops = stop >= 0 and (A + friction * B) * stop < gain
        histories = (
            u > 0 and end > 0 and u >= (B + friction * C) * end,
            stops and abs(B) <= friction * C and B * B < A * C,
            stops and friction * C < B and friction * B < A,
        )
        found = routine.run("exact", {name: at[name] for name in routine.given})
        named = found["slides"], not found["slides"] and found["sticks"]
        if found["hits"] and (sum(histories) != 1 or histories[:2] != named):
            return False
    return True


_DECISIONS = (
    read(
        "branches",
        lambda law: _BRANCHES,
        lambda: (*contacts.mirrored(), contacts.AT_REST),
        check=_one_history,
    ),
    read(
        "regime_of",
        lambda law: {"hits": _hits, "slides": _slides, "sticks": _sticks, "regime": _REGIME},
        lambda: (
            dict(zip(("hits", "slides", "sticks"), each, strict=True))
            for each in product((False, True), repeat=3)
        ),
    ),
    read("mirrored", lambda law: _MIRRORED, contacts.whole),
)

# ---- restitution ------------------------------------------------------------------------------

_SLOPES = laws.slopes()
_SLOPE_AFTER = sp.Piecewise((_SLOPES["stick"], _sticks), (_SLOPES["back"], True))
_AT_STOP = {
    **_BRANCHES,
    "sliding": (_v_slide, _gain_slide, low(_gain_slide), _slides, _sticks),
    "stopped": (_J_STOP, _RISE, low(_RISE)),
    "v_1": slide.stop()[2],
    "soon": _v_1 < 0,
}


def _of_contact(form: sp.Expr) -> sp.Expr:
    """A form of the slopes a_1, a_2 and the impulse P_1, for the contact."""
    known = {a_1: _N / k**2, a_2: _SLOPE_AFTER, P_1: slide.stop()[1].subs(_one)}
    return form.subs(known, simultaneous=True)


def _stopped(form: sp.Expr) -> sp.Expr:
    """A form that has its meaning where the contact closes and its slip stops."""
    return sp.Piecewise((ANY, sp.Or(_slides, sp.Not(_hits))), (form, True))


def _after_stop(law: str) -> Meanings:
    """What is known after the stop."""
    return _AT_STOP | {
        "after": k**2 * _SLOPE_AFTER,
        **{"w": _of_contact(a_2 * P_1), "r": _of_contact(a_2 / a_1)},
        "v_late": sp.Min(sp.Max(_v_1, 0), _v_slide),
    }


def _restitution(law: str) -> Meanings:
    """Poisson's or Stronge's law; Stronge's gives squares of velocities first."""
    early, late = (_of_contact(laws.final_velocity(law, order)) for order in ("early", "late"))
    stopped = _stopped(sp.Piecewise((early, _soon), (late, True)))
    v_f = sp.Piecewise((_v_slide, _slides), (stopped, True))
    power = 2 if law == "stronge" else 1
    return _AT_STOP | {
        "early": _stopped(early**power),
        "late": _stopped(sp.Piecewise((ANY, _soon), (late**power, True))),
        **{"v_stopped": stopped, "v_f": v_f, "gain": v_f - v_0, "gain_low": sp.S.Zero},
    }


def _final(law: str) -> sp.Expr:
    """v_f of an impact under a law."""
    return _v_slide if law == "newton" else _restitution(law)["v_f"]


_RESTITUTION = (
    read(
        "newton",
        lambda law: _AT_STOP | {"v_f": RESTITUTION({}), "gain": _gain_slide},
        contacts.mirrored,
    ),
    read("after_stop", _after_stop, contacts.mirrored),
    read("gained", lambda law: _restitution("poisson"), contacts.mirrored),
    read("poisson", lambda law: _restitution("poisson"), contacts.mirrored),
    read("stronge", lambda law: _restitution("stronge"), contacts.mirrored),
)

# ---- the whole impact -------------------------------------------------------------------------


def _until(form: sp.Expr, v_f: sp.Expr = _v_f) -> sp.Expr:
    """A form under kinematic restitution, for any v_f instead."""
    return form.subs(_one).subs(epsilon, -v_f / v_0)


def _by_regime(slid: sp.Expr, stuck: sp.Expr, back: sp.Expr, no_impact: sp.Expr) -> sp.Expr:
    """What a value is without an impact, in a slide, in slip-stick, in slip reversal."""
    return sp.Piecewise((no_impact, sp.Not(_hits)), (slid, _slides), (stuck, _sticks), (back, True))


def _phases(law: str) -> Meanings:
    """Impulses over k^2 of both phases."""
    stuck, back = (
        _until(part.impulse()[1] - slide.stop()[1], _v_closing) / scale
        for part, scale in ((slip_stick, _K_z), (slip_reversal, k**2))
    )
    u_back = _until(slip_reversal.final_slip(), _v_closing)
    return _AT_STOP | {
        **{"v_closing": _final(law), "gain": _v_closing - v_0},
        **{"j_rounded": _J_STOP, "j_stop": _J_STOP, "rise": _RISE},
        "rest": _stopped(_v_closing - slide.stop()[2]),
        "j_after": _stopped(sp.Piecewise((stuck, _sticks), (back, True))),
        "j_1": sp.Piecewise((_J_SLIDE, _slides), (_J_STOP, True)),
        "j_2": _by_regime(sp.S.Zero, stuck, back, ANY),
        "u_f": _by_regime(_EXCESS, sp.S.Zero, u_back, u_0),
        "v_f": sp.Piecewise((_v_closing, _hits), (v_0, True)),
    }


def _impulse(parts: tuple[sp.Expr, ...]) -> sp.Expr:
    slid, stuck, back = map(_until, parts)
    return _by_regime(slid, stuck, back, sp.S.Zero)


def _impact(law: str) -> Meanings:
    """The state after the impact, and kinetic energy after minus before it."""
    along, up = zip(*(part.impulse() for part in (slide, slip_stick, slip_reversal)), strict=True)
    u_f = _by_regime(_EXCESS, sp.S.Zero, _until(slip_reversal.final_slip()), u_0)
    sticking = slip_stick.sticking_force().subs(F_z, _K_z)
    forms = {
        **_RULE,
        **{"v_slide": RESTITUTION({}), "v_1": slide.stop()[2], "soon": _v_1 < 0},
        **{"v_f": sp.Piecewise((_final(law), _hits), (v_0, True)), "u_f": u_f},
        **{"push": mu * k**2, "turn": spin_jump(-mu * k**2, k**2).subs(_one)},
        **{"lift": k**2, "back": spin_jump(mu * k**2, k**2).subs(_one)},
        **{"push_held": sticking, "turn_held": spin_jump(sticking, _K_z).subs(_one)},
        "P_ahead": _impulse(along),
        "P_z": _impulse(up),
        "spin": spin_jump(_P_ahead, _P_z).subs(_one),
    }
    after = sp.symbols("c_x_after c_z_after omega_after")
    energies = [
        (x**2 + (z - V_z) ** 2 + (k * turn) ** 2) / 2 for x, z, turn in (after, (c_x, c_z, omega))
    ]
    return {
        **_MIRRORED,
        **{name: form.subs(X, _ahead) for name, form in forms.items()},
        **{"regime": _REGIME, "P_x": _side * _P_ahead, "slip_after": _side * _u_f},
        **{"c_x_after": c_x + _P_x, "c_z_after": c_z + _P_z},
        **{"omega_after": omega + _side * _spin, "energy": energies[0] - energies[1]},
        "returned": (*after, *sp.symbols("regime P_x P_z slip_after v_f energy")),
    }


def _added(law: str) -> Meanings:
    second = sp.Piecewise((_held, _sticks), (_back, True))
    whole = sp.Piecewise((_forward * _j_1 + second * _j_2, _hits), (0, True))
    parts = _hits, _sticks, _j_1, _j_2, _forward, _back, _held
    return {str(part): part for part in parts} | {"amount": whole}


_WHOLE = (
    read("phases", _phases, lambda: (*contacts.mirrored(), contacts.AT_REST), laws=LAWS),
    read(
        "added",
        _added,
        lambda: (
            contacts.numbers(seed, "j_1 j_2 forward back held") | {"hits": hits, "sticks": sticks}
            for seed, (hits, sticks) in enumerate(product((False, True), repeat=2))
        ),
    ),
    read("impact", _impact, contacts.whole, laws=LAWS),
)

ROUTINES = (*error_free.ROUTINES, *_CONTACTS, *_DECISIONS, *_RESTITUTION, *_WHOLE)


@derived
def ways_on() -> sp.Matrix:
    """T at the friction that makes N zero, and N_back at the one that makes T_back zero."""
    (lifts,), (holds,) = solve(_N, mu), solve(_T_back, mu)
    return sp.Matrix([sp.factor(_T.subs(mu, lifts)), sp.factor(_N_back.subs(mu, holds))])


def _by_mobilities(form: sp.Matrix) -> list[sp.Expr]:
    """T = -k^2 (A C - B^2)/B and N_back = k^2 (A C - B^2)/C."""
    A, B, C = (laws.mobility()[letter] for letter in (laws.A, laws.B, laws.C))
    return [form[0] * B + k**2 * (A * C - B**2), form[1] * C - k**2 * (A * C - B**2)]


EQUATIONS = (Equation.read("kernel: one way on", derive=ways_on, check=_by_mobilities),)
