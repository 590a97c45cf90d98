"""Proof of the code of one impact, impact/_kernel.py, which is read as a file and run.

The code's branch rule stands in the mirror frame, in which the contact point slips forward
(u_0 >= 0). N and T are those of forward slip (`RESPONSES`), u_* is what a slide would leave of the
slip:

    slide          N > 0, u_0 > 0 and u_* >= 0
    slip-stick     otherwise, if X Z <= mu (k^2 + Z^2)
    slip reversal  otherwise

The rule holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. The code is plain arithmetic and choices, so it runs on any numbers that its primitives are
made for. A proof runs it in every situation of `trials`, under each law, on

numbers   of 60 digits, each with what every rounding on its way would add to it, to first order:
          the regime must be that of the only history of the impact that obeys all laws, and no
          sum named in `ACCURATE` may have more roundings left than stand there
letters   along the path that the numbers took, by the decisions that they took: what is returned
          must be what was derived for that regime and law, to 40 digits at random points

Theorems of Knuth and Dekker say that sums and products carry their error exactly. The code's text
of these is tried on numbers of eleven binary digits. Those of 53 digits split in the same way,
since 53 is odd as well.

The proof misses what shows in no situation, in terms of second order alone, in a clamp that acts
on rounding errors alone, or beyond the range of floating-point numbers.
"""

import ast
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache, reduce
from itertools import product
from operator import or_
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp

from . import laws, slide, slip_reversal, slip_stick
from .axioms import RESTITUTION
from .equality import DIGITS, equal_at_random_points, value
from .laws import LAWS, A, B, C, a_1, a_2
from .newton import approach, spin_jump
from .proof import Equation, Proof, Verdict
from .rewrites import RESPONSES, SQUARES, K
from .symbols import (
    P_1,
    P_x,
    P_z,
    V_z,
    X,
    Z,
    c_x,
    c_z,
    epsilon,
    k,
    m,
    mu,
    omega,
    u_0,
    u_f,
    v_0,
    v_f,
)
from .trace import remembered
from .trials import SIDE, Rounded, Situation, numbers, situations

Values = dict[str, Any]

_IMPACT = Path(__file__).resolve().parent.parent / "impact"
CLOSED_FORMS, KERNEL = _IMPACT / "_generated.py", _IMPACT / "_kernel.py"
SLIDE, STICK, BACK = 1, 2, 3  # codes of regimes; 0 is no impact
_RETURNED = "c_x", "c_z", "omega", "regime", "P_x", "P_z", "slip", "v_f", "energy"
# By function: a sum of its names, and how many roundings are left in it at most. Each is as large
# as that sum, or as what stands after "of", of the sizes of its names.
ACCURATE = {
    "contact_velocity": ("u_0 + u_low: 0", "v_0 + v_low: 0"),
    "responses": ("N + N_low: 0", "T + T_low: 0", "N_back: 1", "T_back: 2", "K: 1", "K_z: 1"),
    "branches": (
        "v_slide: 2",
        "gain_slide + gain_low: 1",
        "j_slide: 3",
        "u_slide: 5 of u_0 + u_slide",
    ),
    "slopes": ("j_1: 2",),
    "after_stop": (
        "v_1 + v_1_low: 2 of rise",
        "j_2: 4 of j_2 * ((gain_slide + rise) / left + (v_0 + rise) / v_1)",
    ),
    "poisson": (
        "early: 9 of epsilon * (v_0 + rise + w)",
        "late_rest: 12 of r * (gain_slide + rise)",
    ),
    "stronge": ("more: 18 of r * (gain_slide + rise) * (v_1 + v_slide)",),
    "phases": (
        "j_1: 3",
        "left: 4 of gain_slide + rise",
        "v_f: 5 of v_0 + v_f",
        "u_f: 10 of u_0 + u_f",
    ),
    "impact": (
        "P_z: 6 of P_z + gain_slide + rise",
        "P_x: 6 of P_x + P_z + gain_slide + rise",
    ),
}


# ---- the code, run ------------------------------------------------------------------------------


def _whole(code: str) -> str:
    """The closed forms, as the file has them now, and the kernel's text."""
    return CLOSED_FORMS.read_text("utf-8") + code


@cache
def _tree(whole: str) -> ast.Module:
    """Syntax tree of such a text, without its imports."""
    tree = ast.parse(whole)
    tree.body = [node for node in tree.body if not isinstance(node, ast.ImportFrom)]
    return tree


@cache
def _compiled(whole: str) -> Any:
    return compile(_tree(whole), "kernel", "exec")


def loaded(code: str, primitives: Values) -> Values:
    """Names of the closed forms and the kernel's text, run; its functions call these primitives."""
    space: Values = {}
    exec(_compiled(_whole(code)), space)
    space.update(primitives)
    return space


def functions(code: str) -> list[ast.FunctionDef]:
    """Syntax trees of the functions of the closed forms and of the kernel's text."""
    return [node for node in _tree(_whole(code)).body if isinstance(node, ast.FunctionDef)]


def choices(decide: Callable[[Any], bool]) -> Values:
    """Primitives that choose one of two numbers, by what `decide` says of a condition."""
    return {
        "select": lambda condition, a, b: a if decide(condition) else b,
        "larger": lambda a, b: a if decide(a >= b) else b,
        "smaller": lambda a, b: a if decide(a <= b) else b,
        "copysign": lambda size, sign: -size if decide(sign < 0) else size,
        "abs": lambda a: -a if decide(a < 0) else a,
    }


def whole_sums(sqrt: Callable[[Any], Any], zero: Any) -> Values:
    """Primitives for numbers or letters whose sums and products have no second part."""
    return {
        "split": lambda a: a,
        "sqrt": sqrt,
        "two_sum": lambda a, b: (a + b, zero),
        "two_product": lambda a, b: (a * b, zero),
    }


_ON_NUMBERS = {
    "split": lambda a: a,
    "sqrt": Rounded.sqrt,
    "two_sum": lambda a, b: Rounded.of(a).plus(b).parted(),
    "two_product": lambda a, b: Rounded.of(a).times(b).parted(),
}
_ON_LETTERS = whole_sums(sp.sqrt, sp.S.Zero)


def on_numbers(code: str, law: str, at: Situation) -> tuple[Any, list[bool], dict[str, Values]]:
    """Run an impact on `Rounded` numbers: its result, its decisions, local values by function."""
    path: list[bool] = []
    found: dict[str, Values] = {}

    def decide(condition: Any) -> bool:
        path.append(bool(condition))
        return path[-1]

    def note(frame: FrameType, event: str, _: Any) -> None:
        if event == "return" and frame.f_code.co_filename == "kernel":
            found[frame.f_code.co_name] = dict(frame.f_locals)

    space = loaded(code, choices(decide) | _ON_NUMBERS)
    start = tuple(Rounded(value(form, at)) for form in given())
    sys.setprofile(note)
    try:
        return space["impact"](space[law], start), path, found
    finally:
        sys.setprofile(None)


# ---- what an impact is --------------------------------------------------------------------------


@remembered
def given() -> list[sp.Expr]:
    """Arguments of an impact that has the letters' values once the code has mirrored it."""
    u, v = (form.subs(X, SIDE * X) for form in approach().values())
    before = c_x - u + SIDE * u_0, c_z - v + v_0
    return [*before, omega, V_z, SIDE * X, Z, k, mu, epsilon]


def history(at: Situation) -> int:
    """Code of the regime of the only history that obeys all laws; -1 if there is not just one.

    Without approach it is 0. The histories are a slide that ends before the slip does, or with it;
    a slip that stops, and sticks within the cone of friction; a slip that stops and turns back,
    driven by more than friction can hold.
    """
    if at[v_0] >= 0:
        return 0
    a, b, c = (value(form.subs(m, 1), at) for form in laws.mobility().values())
    friction, u, gain = at[mu], at[u_0], -(1 + at[epsilon]) * at[v_0]
    n, t = a + friction * b, b + friction * c  # N and T over k^2
    end = gain / n
    stop = u / t if u else u
    stops = stop >= 0 and n * stop < gain
    histories = (
        u > 0 and end > 0 and u >= t * end,
        stops and abs(b) <= friction * c and b * b < a * c,
        stops and friction * c < b and friction * b < a,
    )
    return histories.index(True) + 1 if sum(histories) == 1 else -1


def _final_velocity(law: str, regime: int, order: str) -> sp.Expr:
    """Final normal velocity v_f, as derived for a law, a regime, and an early or late stop."""
    if regime == SLIDE:
        return RESTITUTION({})
    slopes = laws.slopes()
    after = slopes["stick" if regime == STICK else "back"]
    known = {a_1: slopes["slip"], a_2: after, P_1: slide.stop()[1]}
    return laws.final_velocity(law, order).subs(known, simultaneous=True).subs(m, 1)


@remembered
def impulse(law: str, regime: int, order: str) -> list[sp.Expr]:
    """Impulse of an impact, per unit mass, and the contact velocity after it, as derived."""
    part = {SLIDE: slide, STICK: slip_stick, BACK: slip_reversal}[regime]
    left = {SLIDE: slide.slide_excess, BACK: slip_reversal.final_slip}
    u_left, v_left = left.get(regime, lambda: sp.S.Zero)(), _final_velocity(law, regime, order)
    forms = (x.subs(m, 1).subs(epsilon, -v_left / v_0) for x in (*part.impulse(), u_left))
    return [*forms, v_left]


def _returned(law: str, regime: int, order: str) -> list[sp.Expr]:
    """Derived forms of what the code returns of an impact, in the order of `_RETURNED`."""
    unchanged = sp.S.Zero, sp.S.Zero, u_0, v_0
    after = impulse(law, regime, order) if regime else unchanged
    moved = dict(zip((P_x, P_z, u_f, v_f), after, strict=True))
    along, up, u_left, v_left = after
    before, turn = given(), spin_jump(along, up).subs(m, 1)
    moving = before[0] + SIDE * along, before[1] + up, omega + SIDE * turn
    energy = laws.energy_of_impulse().subs(moved, simultaneous=True)
    return [*moving, sp.Integer(regime), SIDE * along, up, SIDE * u_left, v_left, energy]


# ---- proofs -------------------------------------------------------------------------------------


def _wrong_letters(code: str, law: str, at: Situation, path: list[bool]) -> Iterator[str]:
    """Messages on results that are not as derived, in letters along the path of a situation."""
    early = at[u_0] == 0 or value(slide.stop()[2].subs(m, 1), at) < 0
    known = {letter: 0 for letter in at if at[letter] == 0} | {SIDE: at[SIDE]}
    decisions = iter(path)
    space = loaded(code, choices(lambda _: next(decisions)) | _ON_LETTERS)
    found = space["impact"](space[law], tuple(form.subs(known) for form in given()))
    derived = _returned(law, history(at), "early" if early else "late")
    for name, form, meant in zip(_RETURNED, found, derived, strict=True):
        there = meant.subs(known)
        if there is sp.nan:  # 0/0: the limit of no slip
            there = sp.cancel(meant.subs(u_0, 0)).subs(known)
        if not equal_at_random_points(sp.sympify(form), there, points=2):
            yield f"{name} is not what was derived"


def wrong_roundings(found: Mapping[str, Values]) -> Iterator[str]:
    """Messages on claims of `ACCURATE` that do not hold in a run."""
    whole_run: Values = reduce(or_, found.values(), {})
    for function in ACCURATE.keys() & found.keys():  # Newton's law calls no `after_stop`
        names = whole_run | found[function]
        for claim in ACCURATE[function]:
            whole, _, left = claim.partition(": ")
            most, _, unit = left.partition(" of ")
            parts = [Rounded.of(names[name]) for name in whole.split(" + ")]
            form = compile(unit or whole, whole, "eval")
            sizes = {x: np.float64(abs(Rounded.of(names[x]).value)) for x in form.co_names}
            error = reduce(Rounded.plus, parts).error
            with np.errstate(all="ignore"):
                within = error == 0 or error <= (int(most) + 1e-6) * eval(form, sizes)
            if not within:  # nan is wrong as well
                yield f"{whole} has more than {left} roundings left"


def wrong_impacts(code: str) -> Iterator[str]:
    """Messages on regimes, roundings and results that the code gets wrong in any situation."""
    seen, idle = set(), set(ACCURATE)
    with mpmath.workdps(DIGITS + 20):
        for law, at in product(LAWS, situations()):
            (_, _, _, regime, *_), path, found = on_numbers(code, law, at)
            idle -= found.keys()
            if regime != history(at):
                yield f"the regime is not that of the only history at {at}"
            yield from wrong_roundings(found)
            way = law, tuple(path), tuple(at[x] == 0 for x in at), at[SIDE]
            if way not in seen:
                seen.add(way)
                yield from _wrong_letters(code, law, at, path)
    if idle:
        yield f"claims on functions that have not run: {', '.join(sorted(idle))}"


def _splitter(kind: Any) -> Any:
    """Veltkamp's constant for a type of numbers: their upper half has at most half the digits."""
    return kind(2 ** (np.finfo(kind).nmant // 2 + 1) + 1)


def wrong_pairs(code: str) -> Iterator[str]:
    """Messages on sums and products of numbers of eleven binary digits that lose something.

    Tried are sums of all numbers of one size with every eighth number of no larger size, in either
    order, and all products. The constant that splits numbers of 53 digits is compared, too.
    """
    if loaded(code, {})["SPLIT"] != _splitter(np.float64):
        yield "the constant of numbers of 53 binary digits is another one"
    space = loaded(code, {"SPLIT": _splitter(np.float16)})
    ones = (1 + np.arange(1024) / 1024).astype(np.float16)
    other = [sign * np.ldexp(ones[-size % 8 :: 8], -size) for size in range(13) for sign in (1, -1)]
    a, b = np.meshgrid(ones, np.concatenate(other).astype(np.float16))
    halves = [space["split"](x) for x in (ones, ones[:, None])]
    total = np.add(a, b, dtype=float)
    with np.errstate(all="ignore"):
        for true, (rounded, error) in (
            (total, space["two_sum"](a, b)),
            (total, space["two_sum"](b, a)),
            (np.multiply(ones, ones[:, None], dtype=float), space["two_product"](*halves)),
        ):
            if np.any(rounded != true.astype(np.float16)) or np.any(error != true - rounded):
                yield "a sum or product and its error are not exact together"


def wrong_twofold(code: str) -> Iterator[str]:
    """Messages on operations in twice the digits that leave a rounding or have another value."""
    space = loaded(code, _ON_NUMBERS)
    with mpmath.workdps(DIGITS + 20):
        for seed in range(8):
            a, b = map(Rounded, numbers(seed, "a b").values())
            given = *a.parted(), *b.parted()
            for name, parts, true in (
                ("twofold_sum", given, a.value + b.value),
                ("twofold_product", given, a.value * b.value),
                ("twofold_quotient", (a, b), a.value / b.value),
            ):
                whole = reduce(Rounded.plus, space[name](*parts))
                if not abs(whole.value - true) <= mpmath.mpf(10) ** -DIGITS:
                    yield f"{name} has another value"
                if not whole.error < 1e-9:
                    yield f"{name} leaves a rounding"


class Code(NamedTuple):
    """Entry of the registry for functions of the kernel, with what is proved of them.

    tag : name of the entry in the registry
    what : the statement that is proved
    shown : names of the functions that are shown with it
    wrong : gives messages on what is wrong with the file's text
    tried : what the proof tried it on, in words
    note : more about the statement
    verdict : "new" for all of these entries
    """

    tag: str
    what: str
    shown: tuple[str, ...]
    wrong: Callable[[str], Iterator[str]]
    tried: str
    note: str = ""
    verdict: Verdict = "new"

    @property
    def text(self) -> str:
        """Source of the functions that are named in `shown`."""
        code = KERNEL.read_text("utf-8")
        shown = [node for node in ast.parse(code).body if getattr(node, "name", "") in self.shown]
        return "\n\n".join(ast.get_source_segment(code, node) or "" for node in shown)

    def prove(self) -> Proof:
        """Test the statement on the code that ships; what is wrong first is the evidence."""
        try:
            wrong = next(self.wrong(KERNEL.read_text("utf-8")), "")
        except Exception as error:  # whatever stops a computation, there is no proof
            return Proof(ok=False, evidence=f"{type(error).__name__}: {error}", computed=False)
        return Proof(ok=not wrong, evidence=wrong or self.tried)


CODE = (
    Code(
        tag="kernel: sums and products",
        what="Sum or product of two numbers and its error, exact together",
        note="After Knuth, Dekker and Veltkamp",
        shown=("split", "two_product", "two_sum"),
        wrong=wrong_pairs,
        tried=f"tried on numbers of {np.finfo(np.float16).nmant + 1} binary digits",
    ),
    Code(
        tag="kernel: twice the digits",
        what="Sum, product and quotient in twice the digits: no rounding is left of first order",
        shown=(
            "total",
            "carried",
            "twofold_sum",
            "twofold_of_product",
            "twofold_product",
            "lack_of_quotient",
            "twofold_quotient",
        ),
        wrong=wrong_twofold,
        tried="every rounding followed to first order",
    ),
    Code(
        tag="kernel: impact",
        what="One impact: its regime is that of the only history that obeys all laws, and what it "
        "gives is what was derived for that regime and law",
        note="impulses have the digits of the velocities that the impact changes: where these "
        "cancel, a small impulse has fewer of its own",
        shown=(
            *("lacking", "contact_velocity", "responses", "branches", "regime_of", "mirrored"),
            *("newton", "after_stop", "poisson", "stronge", "phases", "added", "impact"),
        ),
        wrong=wrong_impacts,
        tried=f"run in {len(list(situations()))} situations under {len(LAWS)} laws, on numbers of "
        f"{DIGITS + 20} digits, with every rounding followed to first order, and on letters along "
        "every path that these took. Roundings left, each as large as its sum or the one that is "
        "named: " + "; ".join(claim for claims in ACCURATE.values() for claim in claims),
    ),
)


EQUATIONS = (
    Equation(
        "kernel: one way on",
        "what ties the responses to each other, in forward slip and in slip reversal",
        "((k^2 + Z^2) N - X Z T, (k^2 + Z^2) N_{back} - X Z T_{back})",
        where=lambda: dict(
            zip(("N", "T", "N_{back}", "T_{back}"), RESPONSES.values(), strict=True)
        ),
        derive=lambda: (k**2 * SQUARES[K],) * 2,
        check=lambda form: (
            form / k**4 - sp.ones(2, 1) * (m**2 * (A * C - B**2)).subs(laws.mobility())
        ),
        note="where friction outweighs what presses the contact apart, $N \\le 0$, $XZ < 0$ and so "
        "$T > 0$: the slip stops. Where the slip turns back, $T_{back} > 0$, $XZ > 0$ and so "
        "$N_{back} > 0$: the contact is still pressed apart",
    ),
)
