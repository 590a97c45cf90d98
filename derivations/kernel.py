"""One impact, impact/_kernel.py: the code that ships, read as a file, run and proved.

In the mirror frame in which the contact point slips forward (u_0 >= 0), with N and T of forward
slip (`RESPONSES`) and u_* what a slide would leave of the slip, the code's branch rule is

    slide          N > 0, u_0 > 0 and u_* >= 0
    slip-stick     else, where X Z <= mu (k^2 + Z^2)
    slip reversal  else

It holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. The code is plain arithmetic and choices, so it runs on whatever numbers its primitives are
made for. A proof runs it in every situation of `trials`, under each law, on

numbers   of 60 digits, each with what every rounding on its way would add to it, to first order:
          the regime is that of the only history of the impact that obeys all laws, and what is
          claimed to be accurate has no more roundings left than `ACCURATE` says
letters   along the path that the numbers took, by the same decisions: what is returned is what
          was derived for that regime, identically

Sums and products that carry their error are theorems of Knuth and Dekker. Their text is tried on
all numbers of eleven binary digits; those of 53, odd as well, part in the same way.

Not shown: what shows in no situation, in terms of second order alone, in a clamp that acts on
rounding errors alone, or beyond the range of floating-point numbers.
"""

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, reduce
from itertools import product
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from . import laws, slide, slip_reversal, slip_stick
from .axioms import RESTITUTION
from .equality import DIGITS, is_zero
from .laws import a_1, a_2
from .lecture import negative, so
from .newton import approach, spin_jump
from .proof import Equation, Proof, Verdict
from .rewrites import RESPONSES, N, N_back, T, T_back
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
from .trace import derived, remembered, solve
from .trials import SIDE, Rounded, Situation, numbers, situations

Values = dict[str, Any]

_IMPACT = Path(__file__).resolve().parent.parent / "impact"
CLOSED_FORMS, KERNEL = _IMPACT / "_generated.py", _IMPACT / "_kernel.py"
LAWS = "newton", "poisson", "stronge"
SLIDE, STICK, BACK = 1, 2, 3  # codes of regimes; 0 is no impact
_RETURNED = "c_x", "c_z", "omega", "regime", "P_x", "P_z", "slip", "v_f", "energy"
# Roundings left in a sum of names of a function, each as large as that sum, or as another one.
ACCURATE: Mapping[str, tuple[str, ...]] = {
    "contact_velocity": ("u_0 + u_low: 0", "v_0 + v_low: 0"),
    "responses": ("N + N_low: 0", "T + T_low: 0", "N_back: 1", "T_back: 2", "K: 1", "K_z: 1"),
    "branches": ("gain_slide + gain_low: 1", "j_slide: 3", "u_slide: 5 of u_0 + u_slide"),
    "newton": ("v_f: 2", "rest: 4 of gain + rise"),
    "slopes": ("j_1: 2",),
    "after_stop": ("v_1: 4 of v_0 + rise",),
    "gained": ("v_f: 7 of v_0 + v_f + w", "rest: 9 of gain + rise + w"),
    "phases": ("j_1: 3", "u_f: 10 of u_0 + u_f"),
    "impact": ("P_z: 7 of P_z + gain + rise", "P_x: 7 of P_x + P_z + gain + rise"),
}


# ---- the code, run ------------------------------------------------------------------------------


@cache
def _trees(code: str) -> list[ast.Module]:
    """The closed forms and the kernel, without what they import."""
    trees = [ast.parse(text) for text in (CLOSED_FORMS.read_text(encoding="utf-8"), code)]
    for tree in trees:
        tree.body = [node for node in tree.body if not isinstance(node, ast.ImportFrom)]
    return trees


@cache
def _compiled(code: str) -> list[Any]:
    return [compile(tree, "kernel", "exec") for tree in _trees(code)]


def loaded(code: str, primitives: Values) -> dict[str, Any]:
    """All functions of the closed forms and of the kernel's text, which call these primitives."""
    space: dict[str, Any] = {}
    for compiled in _compiled(code):
        exec(compiled, space)
    space.update(primitives)
    return space


def functions(code: str) -> list[ast.FunctionDef]:
    """Functions of the closed forms and of the kernel's text."""
    nodes = [node for tree in _trees(code) for node in tree.body]
    return [node for node in nodes if isinstance(node, ast.FunctionDef)]


def _choices(decide: Callable[[Any], bool]) -> Values:
    """Primitives that take one of two numbers."""
    return {
        "select": lambda condition, a, b: a if decide(condition) else b,
        "larger": lambda a, b: a if decide(a >= b) else b,
        "smaller": lambda a, b: a if decide(a <= b) else b,
        "copysign": lambda size, sign: -size if decide(sign < 0) else size,
        "abs": lambda a: -a if decide(a < 0) else a,
        "split": lambda a: a,
    }


def on_numbers(code: str) -> tuple[dict[str, Any], list[bool], dict[str, Values]]:
    """The code for `Rounded` numbers; what runs fill: decisions, and functions' numbers by name."""
    path: list[bool] = []
    found: dict[str, Values] = {}

    def decide(condition: Any) -> bool:
        path.append(bool(condition))
        return path[-1]

    def noting(node: ast.FunctionDef, function: Callable[..., Any]) -> Callable[..., Any]:
        *_, last = node.body
        assert isinstance(last, ast.Return)
        assert last.value is not None
        names = last.value.elts if isinstance(last.value, ast.Tuple) else [last.value]

        def noted(*given: Any) -> Any:
            value = function(*given)
            values = value if isinstance(value, tuple) else (value,)
            found[node.name] = {
                **{argument.arg: x for argument, x in zip(node.args.args, given, strict=True)},
                **{ast.unparse(name): x for name, x in zip(names, values, strict=False)},
            }
            return value

        return noted

    exact = {
        "sqrt": Rounded.sqrt,
        "two_sum": lambda a, b: Rounded.of(a).plus(b).parted(),
        "two_product": lambda a, b: Rounded.of(a).times(b).parted(),
    }
    space = loaded(code, _choices(decide) | exact)
    for node in functions(code):
        if node.name not in exact and node.name != "split":
            space[node.name] = noting(node, space[node.name])
    return space, path, found


def on_letters(code: str, path: list[bool]) -> dict[str, Any]:
    """The code for expressions, along a path."""
    decisions = iter(path)
    exact = {
        "sqrt": sp.sqrt,
        "two_sum": lambda a, b: (a + b, sp.S.Zero),
        "two_product": lambda a, b: (a * b, sp.S.Zero),
    }
    return loaded(code, _choices(lambda _: next(decisions)) | exact)


# ---- what an impact is --------------------------------------------------------------------------


@cache
def _function(form: sp.Expr, letters: tuple[sp.Symbol, ...]) -> Callable[..., Any]:
    return sp.lambdify(letters, form, "mpmath")


def value(form: sp.Expr, at: Situation) -> Any:
    """A form as a number."""
    return _function(form, tuple(at))(*at.values())


@remembered
def given() -> list[sp.Expr]:
    """Arguments of an impact that is mirrored to the letters."""
    ahead = {X: SIDE * X}
    start = approach()
    along, up = (c - start[w].subs(ahead) for c, w in ((c_x, u_0), (c_z, v_0)))
    return [along + SIDE * u_0, up + v_0, omega, V_z, SIDE * X, Z, k, mu, epsilon]


def history(at: Situation) -> int:
    """Code of the regime of the only history that obeys all laws; -1 if it is not the only one.

    A slide that ends before the slip does, or with it; a slip that stops, and sticks within the
    cone of friction; or one that stops and then slips back, driven by more than friction can hold.
    """
    if at[v_0] >= 0:
        return 0
    mobility = laws.mobility()
    A, B, C = (value(mobility[letter], at) for letter in (laws.A, laws.B, laws.C))
    friction, u, gain = at[mu], at[u_0], -(1 + at[epsilon]) * at[v_0]
    end = gain / (A + friction * B)
    stop = u / (B + friction * C) if u else u
    stops = stop >= 0 and (A + friction * B) * stop < gain
    histories = (
        u > 0 and end > 0 and u >= (B + friction * C) * end,
        stops and abs(B) <= friction * C and B * B < A * C,
        stops and friction * C < B and friction * B < A,
    )
    return histories.index(True) + 1 if sum(histories) == 1 else -1


@remembered
def _final_velocity(law: str, regime: int, order: str) -> sp.Expr:
    """v_f, as derived."""
    if regime == SLIDE or law == "newton":
        return RESTITUTION({})
    slopes = laws.slopes()
    after = slopes["stick" if regime == STICK else "back"]
    known = {a_1: slopes["slip"], a_2: after, P_1: slide.stop()[1].subs(m, 1)}
    return laws.final_velocity(law, order).subs(known, simultaneous=True)


@remembered
def _returned(regime: int) -> list[sp.Expr]:
    """What an impact returns, as derived, for a final normal velocity v_f."""
    P_ahead, up, u_left, v_left = sp.S.Zero, sp.S.Zero, u_0, v_0
    if regime:
        part = {SLIDE: slide, STICK: slip_stick, BACK: slip_reversal}[regime]
        left = {SLIDE: slide.slide_excess, BACK: slip_reversal.final_slip}
        forms = *part.impulse(), left.get(regime, lambda: sp.S.Zero)()
        P_ahead, up, u_left = (x.subs(m, 1).subs(epsilon, -v_f / v_0) for x in forms)
        v_left = v_f
    moved = {P_x: P_ahead, P_z: up, u_f: u_left, v_f: v_left}
    energy = laws.energy_of_impulse().subs(moved, simultaneous=True)
    along, turn = SIDE * P_ahead, SIDE * spin_jump(P_ahead, up).subs(m, 1)
    before = given()
    moving = before[0] + along, before[1] + up, omega + turn
    return [*moving, sp.Integer(regime), along, up, SIDE * u_left, v_left, energy]


# ---- proofs -------------------------------------------------------------------------------------


def _is_meant(found: Any, meant: sp.Expr, known: Mapping[sp.Symbol, sp.Expr]) -> bool:
    """Whether an expression is what was derived; 0/0 there, in the limit of no slip."""
    form = sp.sympify(found)
    exact = form.xreplace({x: sp.Rational(x) for x in form.atoms(sp.Float)})
    there = meant.subs(known)
    if there is sp.nan:
        there = sp.cancel(meant.subs(u_0, 0)).subs(known)
    return is_zero(exact - there)


def _wrong_letters(code: str, law: str, at: Situation, path: list[bool]) -> Iterator[str]:
    """What is not as derived, along the path of a situation."""
    early = at[u_0] == 0 or value(slide.stop()[2].subs(m, 1), at) < 0
    regime, order = history(at), "early" if early else "late"
    known = {letter: sp.S.Zero for letter in at if at[letter] == 0}
    known |= {SIDE: sp.Integer(at[SIDE])}
    space = on_letters(code, path)
    power = 2 if law == "stronge" else 1
    final = _final_velocity(law, regime, order) ** power
    wrong = []

    def any_law(*contact: Any) -> tuple[Any, ...]:
        """The law itself; after a stop, any v_f in its place."""
        v_end, gain, low = space[law](*contact)
        if regime in (STICK, BACK):
            same = _is_meant(v_end**power, final, known) and is_zero(gain + low - v_end + v_0)
            wrong.extend([] if same else ["v_f"])
            return v_f, v_f - v_0, sp.S.Zero
        return v_end, gain, low

    start = tuple(form.subs(known) for form in given())
    found = space["impact"](any_law, start)
    slid = {v_f: RESTITUTION({})} if regime == SLIDE else {}
    for name, form, meant in zip(_RETURNED, found, _returned(regime), strict=True):
        if not _is_meant(form, meant.subs(slid), known):
            wrong.append(name)
    yield from (f"{name} is not what was derived" for name in wrong)


def wrong_roundings(found: Mapping[str, Values]) -> Iterator[str]:
    """Claims of `ACCURATE` that do not hold in a run."""
    whole_run = {name: x for names in found.values() for name, x in names.items()}
    for function in ACCURATE.keys() & found.keys():  # Newton's law knows no `after_stop`
        names = whole_run | found[function]
        for claim in ACCURATE[function]:
            whole, _, left = claim.partition(": ")
            most, _, unit = left.partition(" of ")
            parts = [Rounded.of(names[name]) for name in whole.split(" + ")]
            size = sum(abs(Rounded.of(names[name]).value) for name in (unit or whole).split(" + "))
            within = (int(most) + mpmath.mpf("1e-6")) * size
            if not reduce(Rounded.plus, parts).error <= within:  # nan is wrong as well
                yield f"{whole} has more than {left} roundings left"


def wrong_impacts(code: str) -> Iterator[str]:
    """What the code gets wrong in some situation."""
    seen = set()
    with mpmath.workdps(DIGITS + 20):
        for law, at in product(LAWS, situations()):
            space, path, found = on_numbers(code)
            start = tuple(Rounded(value(form, at)) for form in given())
            _, _, _, regime, *_ = space["impact"](space[law], start)
            if regime != history(at):
                yield f"the regime is not that of the only history at {at}"
            yield from wrong_roundings(found)
            way = law, tuple(path), tuple(at[x] == 0 for x in at), at[SIDE]
            if way not in seen:
                seen.add(way)
                yield from _wrong_letters(code, law, at, path)


def wrong_pairs(code: str) -> Iterator[str]:
    """Sums and products of numbers of eleven binary digits that lose something.

    Sums of all numbers of one size with every eighth of one no larger, either first; all products.
    """
    space = loaded(code, {"SPLIT": np.float16(2**6 + 1)})
    ones = (1 + np.arange(1024) / 1024).astype(np.float16)
    other = [sign * np.ldexp(ones[-size % 8 :: 8], -size) for size in range(13) for sign in (1, -1)]
    a, b = np.meshgrid(ones, np.concatenate(other).astype(np.float16))
    halves = [space["split"](x) for x in (ones, ones[:, None])]
    with np.errstate(all="ignore"):
        for true, (rounded, error) in (
            (np.add(a, b, dtype=float), space["two_sum"](a, b)),
            (np.add(a, b, dtype=float), space["two_sum"](b, a)),
            (np.multiply(ones, ones[:, None], dtype=float), space["two_product"](*halves)),
        ):
            if np.any(rounded != true.astype(np.float16)) or np.any(error != true - rounded):
                yield "a sum or product and its error are not exact together"


def wrong_twofold(code: str) -> Iterator[str]:
    """Operations in twice the digits that leave a rounding."""
    space, *_ = on_numbers(code)
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
                if not max(abs(whole.value - true), whole.error) <= mpmath.mpf(10) ** -DIGITS:
                    yield f"{name} leaves a rounding, or has another value"


@dataclass(frozen=True, kw_only=True)
class Code:
    """Functions of the kernel, and what is proved of them."""

    tag: str  # among the registry's entries
    what: str  # is proved
    note: str = ""  # more about it
    shown: tuple[str, ...]  # names of the functions that show it
    wrong: Callable[[str], Iterator[str]]  # what is wrong with the file's text, in words
    tried: str  # on what
    verdict: Verdict = "new"  # of all
    printed: None = None  # no equation of the paper
    contradicted_by: str = ""  # nothing

    @property
    def text(self) -> str:
        """The functions that show it."""
        code = KERNEL.read_text(encoding="utf-8")
        shown = [node for node in functions(code) if node.name in self.shown]
        return "\n\n".join(ast.get_source_segment(code, node) or "" for node in shown)

    def prove(self) -> Proof:
        """Run the code that ships."""
        try:
            wrong = next(self.wrong(KERNEL.read_text(encoding="utf-8")), "")
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
        tried="tried on numbers of eleven binary digits",
    ),
    Code(
        tag="kernel: twice the digits",
        what="Sum, product and quotient in twice the digits: no rounding is left of first order",
        shown=("total", "carried", "twofold_sum", "twofold_product", "twofold_quotient"),
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
            *("newton", "after_stop", "gained", "poisson", "stronge", "phases", "added", "impact"),
        ),
        wrong=wrong_impacts,
        tried=f"run in {len(list(situations()))} situations under {len(LAWS)} laws, on numbers of "
        f"{DIGITS} digits, with every rounding followed to first order, and on letters along every "
        "path that these took. Roundings left, each as large as its sum or the one that is named: "
        + "; ".join(claim for claims in ACCURATE.values() for claim in claims),
    ),
)


@derived("T", "N_{back}")
def ways_on() -> sp.Matrix:
    """T at the friction that makes N zero, and N_back at the one that makes T_back zero."""
    (lifts,), (holds,) = (solve(RESPONSES[letter], mu) for letter in (N, T_back))
    forms = RESPONSES[T].subs(mu, lifts), RESPONSES[N_back].subs(mu, holds)
    return sp.Matrix([sp.factor(form) for form in forms])


def _ways_told() -> str:
    """The signs of both, and of their slopes over friction."""
    stops, parts = ways_on()
    rates = negative(-RESPONSES[T].diff(mu)) and negative(RESPONSES[N_back].diff(mu))
    return so(
        "both positive, as the first needs $XZ < 0$ and the second $XZ > 0$. $T$ rises with "
        r"friction: where friction outweighs what presses the contact apart ($N \le 0$), the slip "
        r"stops. $N_{back}$ falls with friction: where the slip turns back ($T_{back} > 0$), the "
        "contact is still pressed apart",
        negative(-stops, {X: -X}) and negative(-parts) and rates,
    )


def _by_mobilities(form: sp.Matrix) -> list[sp.Expr]:
    """T = -k^2 (A C - B^2)/B and N_back = k^2 (A C - B^2)/C."""
    A, B, C = (laws.mobility()[letter] for letter in (laws.A, laws.B, laws.C))
    return [form[0] * B + k**2 * (A * C - B**2), form[1] * C - k**2 * (A * C - B**2)]


EQUATIONS = (
    Equation(
        "kernel: one way on",
        ("$T$ at the friction where $N = 0$, $N_{back}$ at the friction where $T_{back} = 0$"),
        "(T, N_{back})",
        derive=ways_on,
        check=_by_mobilities,
        note=_ways_told,
    ),
)
