"""The code of one impact: its proof, its language, and what the proof would miss."""

import ast
import random
import re
from copy import deepcopy
from functools import cache
from itertools import product

import mpmath
import numpy as np
from numpy.random import default_rng

from derivations import files, kernel, trials
from impact import Regime, _kernel

from .command_line import read_toml

EDITS = read_toml("tests/edits.toml")["kernel"]
CODE = kernel.KERNEL.read_text("utf-8")
TREE = ast.parse(CODE)
SWAPS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
TURNS = {
    ast.Lt: (ast.Gt, ast.LtE),
    ast.LtE: (ast.GtE, ast.Lt),
    ast.Gt: (ast.Lt, ast.GtE),
    ast.GtE: (ast.LtE, ast.Gt),
    ast.Eq: (ast.NotEq,),
}
COMMUTE = "two_sum", "two_product", "larger", "smaller", "total"  # in their first two arguments


def changed(node, names):
    """What may stand by mistake in place of a node."""
    match node:
        case ast.BinOp(left, ast.BitAnd(), right):
            yield from (left, right)
        case ast.BinOp(left, operation, right):
            yield ast.BinOp(left, SWAPS[type(operation)](), right)
            yield from (left, right)  # a dropped term or factor
            yield ast.BinOp(node, ast.Mult(), ast.Constant(2))
        case ast.Compare(left, [comparison], right):
            yield from (ast.Compare(left, [turn()], right) for turn in TURNS[type(comparison)])
        case ast.UnaryOp(ast.USub(), operand):
            yield operand
        case ast.Constant(int() | float() as value):
            yield ast.Constant(value + 1)
        case ast.Call(ast.Name(name), arguments):
            if name in ("larger", "smaller", "select", "abs"):
                yield from arguments  # a dropped clamp
            for i in range(name in COMMUTE, len(arguments) - 1):
                turned = arguments.copy()
                turned[i : i + 2] = arguments[i + 1], arguments[i]
                yield ast.Call(node.func, turned, [])
        case ast.Name(name, ast.Load()) if name in names:
            yield ast.Name(names[names.index(name) - 1], ast.Load())


def mistakes():
    """Function, line and changed line of every small change of the code."""
    for function in filter(lambda node: isinstance(node, ast.FunctionDef), TREE.body):
        names = [a.arg for a in function.args.args if a.arg != "law"]
        for node in ast.walk(function):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                names.append(node.id)
        for line in function.body[1:]:
            for node in ast.walk(line.value):
                for new in changed(node, names):
                    other = ast.unparse(deepcopy(line, {id(node): new}))
                    if other != ast.unparse(line):
                        yield function.name, ast.unparse(line), other


MISTAKES = sorted(set(mistakes()))


def with_mistake(name, old, new):
    """The code with one line changed."""
    tree = deepcopy(TREE)
    (function,) = (node for node in tree.body if getattr(node, "name", "") == name)
    i = [*map(ast.unparse, function.body)].index(old)
    function.body[i] = ast.parse(new).body[0]
    return ast.unparse(tree)


PRIMITIVES = {x: getattr(_kernel, x) for x in ("select", "larger", "smaller", "copysign", "sqrt")}


@cache
def on_edges(n=20_000):
    """Impacts whose slip stops just before the contact leaves, or just after; N close to 0, too."""
    rng = default_rng(5)
    X, Z = rng.uniform(-2, 2, (2, n))
    k, mu = 10 ** rng.uniform(-1.5, 0.5, (2, n))
    u, epsilon = rng.uniform(0, 1, (2, n))
    lifts = -(k**2 + X**2) / (X * Z) * (1 + rng.integers(-3, 3, n) * 2.0**-53)
    mu = np.where((np.arange(n) % 2 == 0) & (lifts > 0), lifts, mu)
    mu[:100] = 2.0**500
    X[100:2000] = Z[100:2000] = epsilon[100:2000] = 0.0
    k[100:2000] = 1.0  # v_1 = v_f = 0, to the last digit
    N, T, *_ = kernel.loaded(CODE, PRIMITIVES)["responses"](X, Z, k, mu)
    close = 1 + rng.integers(-4, 5, n) * 2.0**-52
    v = -np.abs(u * N / T) / (1 + epsilon) * close
    mu[:100] = np.inf
    return u, v, 0.0, 0.0, X, Z, k, mu, epsilon


def out_of_bounds(code):
    """What the code, in floating-point numbers, does that no impact does."""
    space, given = kernel.loaded(code, PRIMITIVES), on_edges()
    for law in kernel.LAWS:
        with np.errstate(all="ignore"):
            after = space["impact"](space[law], given)
        regime, P_x, P_z, slip, v_f, energy = after[3:]
        hits = regime > 0
        assert np.mean(hits) > 0.9
        if not np.all(np.isfinite(after)):
            yield "not a number"
        elif np.any(P_z[hits] <= 0):
            yield "the plate pulls"
        elif np.any(slip[hits & (regime == kernel.BACK)] > 0):
            yield "the contact slips back forward"
        elif np.any(v_f[hits] < 0):
            yield "the contact does not open"
        elif law != "newton" and np.any(energy[hits] > 1e-15 * (P_x**2 + P_z**2)[hits]):
            yield "energy is made"


def caught(name, old, new):
    """Whether the proofs, or bounds, see a mistake; code that stops is seen."""
    code = with_mistake(name, old, new)
    tries = [proof.wrong for proof in kernel.CODE[:2] if name in proof.shown]
    if name not in kernel.CODE[0].shown and not name.startswith("twofold"):
        tries += [out_of_bounds, kernel.wrong_impacts]
    try:
        return any(next(wrong(code), "") for wrong in tries)
    except Exception:
        return True


# Changes that change nothing.
ALIKE = {(name, new) for name, new, _ in EDITS["alike"]}


def test_mistakes_in_the_code_are_caught():
    """Some mistakes, others with every edit of the code, are caught."""
    others = [(name, old, new) for name, old, new in MISTAKES if (name, new) not in ALIKE]
    for mistake in random.Random(CODE).sample(others, 25):
        assert caught(*mistake)


def test_all_mistakes_but_those_that_change_nothing_are_caught():
    assert {(name, new) for name, old, new in MISTAKES if not caught(name, old, new)} == ALIKE


def test_a_claim_on_a_function_that_never_runs_is_no_proof():
    renamed = re.sub(r"\bbranches\b", "ways", CODE)
    assert "branches" in next(kernel.wrong_impacts(renamed), "")


def test_no_bound_is_broken():
    assert list(out_of_bounds(CODE)) == []


def test_claimed_roundings_hold_where_levers_are_long():
    """They hold where P_z loses 43,800 times its last digit: what cancels there is larger."""
    rows = [[7, 5.3, 0.1, 57, 0, 1, 1.3203025]]
    rows += (10 ** default_rng(8).uniform(-2.5, 2.5, (60, 7))).tolist()
    with mpmath.workdps(60):
        for law, (side, row) in product(kernel.LAWS, enumerate(rows)):
            X, Z, k, mu, epsilon, u_0, v_0 = map(mpmath.mpf, row)
            fixed = X * (1 - 2 * (side % 2)), Z, k, mu, min(epsilon, 1), u_0, -v_0, 0, 0, 1
            at = dict(zip(trials.LETTERS, fixed, strict=True))
            *_, found = kernel.on_numbers(CODE, law, at)
            assert list(kernel.wrong_roundings(found)) == []
            if side == 0:
                P_z = found["impact"]["P_z"]
                assert P_z.error > 40_000 * P_z.value


def test_a_changed_constant_changes_the_digest(monkeypatch, tmp_path):
    """The digest says whether figures are of the present theory."""
    changed = tmp_path / "kernel.py"
    changed.write_text(CODE.replace("2.0**27 + 1", "2.0**26 + 1"), "utf-8")
    monkeypatch.setattr(files, "KERNEL", changed)
    before = files.CLOSED_FORMS.read_text("utf-8").splitlines()
    after = files.source().splitlines()
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 1


def test_closed_forms_are_read_again_once_they_change(monkeypatch, tmp_path):
    changed = tmp_path / "closed_forms.py"
    text = files.CLOSED_FORMS.read_text("utf-8").replace(files.digest(), "another")
    changed.write_text(text, "utf-8")
    monkeypatch.setattr(kernel, "CLOSED_FORMS", changed)
    assert files.digest() == "another"


def test_code_that_stops_is_no_proof(monkeypatch, tmp_path):
    changed = tmp_path / "kernel.py"
    changed.write_text(CODE.replace("w, r = slopes(", "w, r = unknown("), "utf-8")
    monkeypatch.setattr(kernel, "KERNEL", changed)
    proof = kernel.CODE[2].prove()
    assert not proof.ok
    assert "NameError" in proof.evidence


def test_codes_are_told_as_they_are():
    told = _kernel.regime_of.__doc__.replace("-", " ")
    for regime in Regime:
        name = regime.name.lower().replace("_", " ")
        assert regime < 0 or f"{regime.value} {name}" in told
