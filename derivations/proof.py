"""One equation of the paper: as printed, as derived, and the proof of the verdict between them.

Verdicts
--------
agrees     the difference of both forms simplifies to zero; the default where there is a printed
           form that no formula contradicts
erratum    the forms differ: the proof has a point where they do, and other formulas of the paper
           whose printed forms give the derived one; and either the repair, a small change of the
           printed LaTeX that gives the derived form, or, for a sentence, the mistake by which its
           value comes out
assumed    an axiom or closure: there is nothing to derive it from
new        not in the paper; proved by a second route (expressions that must vanish); the default
           without a printed form
noted      words or a citation of the paper, quoted; nothing is proved of it

A printed form is the paper's LaTeX (module `paper`), read. Its left side must be that of the step
which derives it. If the paper prints no left side, or no step has one, the entry gives it, and it
must be that of the step or of the paper. With `where`, the left side itself is read, and must have
the derived value. The words of a note are computed with the entry's proof.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from difflib import SequenceMatcher
from types import FunctionType
from typing import Any, Literal, NamedTuple, TypeAlias

import sympy as sp

from . import paper, trace
from . import symbols as s
from .equality import Form, Residuals, components, equal, is_zero, random_point, same
from .typeset import tidy

Verdict = Literal["", "agrees", "erratum", "assumed", "new", "noted"]
Words: TypeAlias = str | Callable[[], str]  # a function is called once, when the words are needed

# A plain impact of the kind the paper treats (u_0 > 0, v_0 < 0), for counter-examples.
_EXAMPLE = """
    m = 1, k = 1, X = 1, Z = 3/2, mu = 1/5, epsilon = 1/2, omega = 1/10, h_0 = 1
    c_x = 1, c_z = -2, V_z = 1/2, u_0 = 17/20, v_0 = -12/5
"""
EXAMPLE = {s.NAMED[x]: sp.Rational(y) for x, y in re.findall(r"(\w+) = ([-/\d]+)", _EXAMPLE)}


class Proof(NamedTuple):
    """Result of testing a verdict."""

    ok: bool  # whether the verdict stood
    evidence: str  # in words
    computed: bool = True  # whether nothing stopped the computation


@dataclass(frozen=True, slots=True)
class Repair:
    """One change that repairs the printed LaTeX of a form."""

    old: str  # stands once in the LaTeX
    new: str
    name: str = ""  # what is changed, if both are too long to be read

    @property
    def what(self) -> str:
        """The change in words: its name, or old and new LaTeX."""
        return self.name or f"${self.old}$ to ${self.new}$"

    def of(self, tex: str) -> str:
        """Return the LaTeX with the change made; ValueError unless `old` stands in it once."""
        if tex.count(self.old) != 1:
            raise ValueError(f"what the repair changes does not stand once in it: {self.what}")
        return tex.replace(self.old, self.new)

    @property
    def size(self) -> int:
        """Number of characters in which old and new differ."""
        changed = SequenceMatcher(None, self.old, self.new, autojunk=False).get_opcodes()
        return sum(max(b - a, d - c) for kind, a, b, c, d in changed if kind != "equal")


def _column(form: Form | tuple[sp.Expr, ...] | None) -> Form | None:
    """A form as it is; for a tuple, the column of its components."""
    return sp.Matrix(form) if isinstance(form, tuple) else form


@dataclass(slots=True, eq=False)
class Equation:
    """One equation or number-bearing statement, with the verdict that `prove` tests.

    A form that is a column of several values may be given as a tuple of them.

    tag : the paper's equation number, or the section and a key word
    about : what the equation is about, shown after the sentence that it judges
    left : left-hand side, LaTeX, if it is not both the paper's and that of a step
    derive : computes the form from the axioms
    where : gives values of letters in the left side, which is then read
    verdict : on the printed form; by default "erratum" if other formulas contradict it, else
        "agrees", or "new" if there is no printed form
    shown : the derived form, written to be read
    formulas : tags of formulas of the paper (paper.toml), if not the entry's own tag
    said : printed form that a sentence says, in the place of a formula
    put : gives what letters of the printed form stand for
    note : what is right, where the paper is not
    repair : of an erratum: changes that make the printed form right
    mistaken : of an erratum without repair: computes the printed value as `mistake` says
    mistake : the mistake in words
    contradicted_by : tags of formulas of the paper that give the derived form
    contradiction : computes the derived form from the printed forms of these
    at : replaces values of EXAMPLE
    check : second route: zero for a true form
    """

    tag: str
    about: Words
    left: str = ""
    _: KW_ONLY
    derive: Callable[[], Form]
    where: Callable[[], Mapping[str, Any]] | None = None
    verdict: Verdict = ""
    shown: Form | None = None
    formulas: tuple[str, ...] = ()
    said: Form | Callable[[], Form] | None = None
    put: Callable[[], Mapping] = dict
    note: Words = ""
    repair: tuple[Repair, ...] = ()
    mistaken: Callable[[], Form] | None = None
    mistake: str = ""
    contradicted_by: tuple[str, ...] = ()
    contradiction: Callable[..., Form] | None = None
    at: Mapping[sp.Symbol, Any] | None = None
    check: Callable[[Form], Residuals] | None = None

    def __post_init__(self) -> None:
        derive = self.derive
        self.derive = trace.remembered(lambda: _column(derive()))
        self.shown = _column(self.shown)
        if not self.formulas and self.tag in paper.EQUATIONS:
            self.formulas = (self.tag,)
        if not self.verdict:
            printed = self.said is not None or self.formulas
            self.verdict = "erratum" if self.contradicted_by else "agrees" if printed else "new"

    @property
    def own(self) -> tuple[str, ...]:
        """Tags of formulas that print the entry's value; none if a sentence says it instead."""
        return () if self.tag in paper.SENTENCES else self.formulas

    @property
    def lefts(self) -> list[str]:
        """Left side of each value: the one given, which values may share, or else the paper's."""
        if self.left:
            return paper.parts(self.left) or [self.left] * len(components(self.derive()))
        return [paper.left_of(tag) for tag in self.own]

    @property
    def what(self) -> str:
        """What the entry is about, after the sentence of the paper that it judges, if any."""
        quoted = paper.SENTENCES.get(self.tag)
        about = _said(self.about)
        return f'"{quoted}": {about}' if quoted else about

    @property
    def printed(self) -> Form | None:
        """Form in our copy of the paper; None if the copy has none."""
        if self.said is not None or not self.formulas:
            return _column(self.said() if isinstance(self.said, FunctionType) else self.said)
        return self._meant([paper.printed(tag) for tag in self.formulas])

    def _meant(self, forms: list[Form]) -> Form:
        """Printed forms with what their letters stand for; several as a column."""
        put = self.put()
        forms = [form.subs(put, simultaneous=True) if put else form for form in forms]
        return forms[0] if len(forms) == 1 else sp.Matrix(forms)

    @property
    def repairs(self) -> str:
        """All repairs of the printed form, in words."""
        return "; ".join(repair.what for repair in self.repair)

    @property
    def repaired(self) -> Form:
        """The printed form with all repairs made."""
        texts = [paper.EQUATIONS[tag].right for tag in self.formulas]
        for repair in self.repair:
            texts = [repair.of(tex) for tex in texts]
        return self._meant([paper.read(tex, paper.LETTERS) for tex in texts])

    def prove(self) -> Proof:
        """Test the verdict, the left side, and that the form shown has the derived value.

        If a derivation, a check or a note cannot be computed, the proof has failed.
        """
        try:
            if failed := self._failed():
                return Proof(ok=False, evidence=failed)
            if self.check is not None:
                second = self._second_route(self.check)
                if self.verdict == "new" or not second.ok:
                    return second  # of a new result it is the whole proof
            return _erratum(self) if self.verdict == "erratum" else _agrees(self)
        except Exception as error:  # whatever stops a computation, the verdict has no proof
            return Proof(ok=False, evidence=f"{type(error).__name__}: {error}", computed=False)

    def _failed(self) -> str:
        """What is wrong with the entry itself; empty if all is well."""
        if (self.what + told(self)).count("$") % 2:  # false computed words raise here, too
            return "a formula of the note does not end"
        if not paper.sealed():
            return "paper.toml is not what was compared with our copy of the paper"
        if self.verdict == "assumed" and any(step.name != self.tag for step in self.steps):
            return "what is assumed is not derived"
        alone = self.verdict == "new" or self.printed is None
        if alone and (self.check is None or self.verdict not in ("new", "assumed")):
            return f"{self.verdict}: it needs a printed form, or a second route (check)"
        if self.shown is not None and not equal(self.shown, self.derive()):
            return "the form shown as derived has another value"
        lefts = self.lefts
        named = zip(lefts, components(self.derive()), strict=False)
        if misread := trace.misread(self.steps, named):
            return misread
        stepped = self._lefts_of_steps()
        if self.where is not None:
            letters = self.where()
            read = [paper.value_of(x, letters) for x in lefts]
            signs = any(x.has(sp.sign) for x in read)  # of a value without a known sign
            if signs or not equal(sp.Matrix(read), self.derive()):
                return f"the left side has the value {', '.join(map(str, read))}"
        elif self.left:
            printed = [paper.left_of(tag) for tag in self.own]
            for mine, left in zip(lefts, printed if any(printed) else stepped, strict=False):
                if left and paper.bare(left) != paper.bare(mine):
                    return f"the left side is {left}, not {mine}"
        else:
            parts = [x for left in lefts for x in paper.COMPONENTS.get(left, (left,))]
            for left, step in zip(parts, stepped, strict=True):
                known = step and paper.bare(left).startswith(paper.bare(step))  # u is u_* in (7)
                if left and not known:
                    return f"a step calls {step} what is {left}"
        return ""

    def _lefts_of_steps(self) -> list[str]:
        """Left sides that axioms and steps give to the derived values; "" if they give none."""
        form = self.derive()
        values = tuple(form) if isinstance(form, sp.MatrixBase) else (form,)
        named = [pair for step in self.steps for pair in step.values]
        lefts: list[str] = []
        for value in values:  # equal values get different left sides
            same = [left for left, one in named if one == value]
            free = [left for left in same if left not in lefts]
            lefts += (free or same or [""])[:1]
        return lefts

    def _second_route(self, check: Callable[[Form], Residuals]) -> Proof:
        form = self.derive()
        with trace.noted() as taken:
            residuals = [sp.sympify(r) for r in check(form)]
        first, second = (trace.names(steps, "derived") for steps in (self.steps, taken))
        if shared := first & second:
            return Proof(ok=False, evidence=f"both routes take {', '.join(sorted(shared))}")
        if not residuals or not all(map(is_zero, residuals)):
            return Proof(ok=False, evidence="the second route gives something else")
        return Proof(
            ok=True, evidence=f"a second route; expressions that must vanish: {len(residuals)}"
        )

    @property
    def rests_on(self) -> tuple[str, ...]:
        """Tags of the axioms that the derivation used, sorted."""
        return tuple(sorted(trace.names(self.steps, "axiom") - {self.tag}))

    @property
    def steps(self) -> tuple[trace.Step, ...]:
        """Steps that the derivation takes, in their order."""
        with trace.noted() as taken:
            self.derive()
        return tuple(taken)

    def readable(self) -> Form:
        """Return the derived form as it reads best.

        That is `shown`, or the printed form if both agree, or an erratum's printed form, repaired;
        else the derived form, tidied.
        """
        if self.shown is not None:
            return self.shown
        if self.printed is not None and self.verdict != "erratum":
            return self.printed
        if self.repair:
            return self.repaired
        form = self.derive()
        return form.applyfunc(tidy) if isinstance(form, sp.MatrixBase) else tidy(form)


class Noted(NamedTuple):
    """A sentence or a citation of the paper, quoted beside what it does not fit.

    It is shown and never counted: not among the proofs, not among the mistakes.

    tag : section and key word
    quote : the paper's words
    note : what they do not fit
    verdict : "noted" for all of these entries
    """

    tag: str
    quote: str
    note: str
    verdict: Verdict = "noted"

    @property
    def what(self) -> str:
        """The paper's words in quotation marks."""
        return f'"{self.quote}"'

    def prove(self) -> Proof:
        """Test that the quotation is that of our copy; nothing else is proved of it."""
        return Proof(ok=paper.sealed(), evidence="quoted, not proved")


@trace.remembered
def _said(words: Words) -> str:
    return words if isinstance(words, str) else words()


def told(entry: Any) -> str:
    """Text of an entry's note, computed if it has to be."""
    return _said(entry.note)


def _agrees(eq: Equation) -> Proof:
    assumed = eq.verdict == "assumed"
    evidence = "taken as a starting point" if assumed else "difference simplifies to zero"
    return Proof(ok=eq.printed is None or same(eq.printed, eq.derive()), evidence=evidence)


def _erratum(eq: Equation) -> Proof:
    derived = eq.derive()
    free = sp.Tuple(eq.printed, derived).free_symbols
    point = sp.Dict({**random_point(free, seed=0), **EXAMPLE, **(eq.at or {})})
    pairs = [
        (x.subs(point), y.subs(point))
        for x, y in zip(components(eq.printed), components(derived), strict=True)
        if x != y
    ]
    # Of an inequality only the sign counts.
    value = sp.sign if isinstance(derived, sp.Rel) else sp.sympify
    differs = any(abs(sp.N(value(x) - value(y), 30)) > 1e-20 for x, y in pairs)
    evidence = "; ".join(f"printed ${_number(x)}$, derived ${_number(y)}$" for x, y in pairs)
    where = ", ".join(f"${sp.latex(x)} = {_number(point[x])}$" for x in sorted(free, key=str))
    others = [paper.printed(tag) for tag in eq.contradicted_by]
    contradicted = eq.contradiction is not None and equal(eq.contradiction(*others), derived)
    return Proof(
        ok=differs and contradicted and _explained(eq),
        evidence=evidence + (f" at {where}" if where else ""),
    )


def _explained(eq: Equation) -> bool:
    """Whether the named repair gives the derived form, or the named mistake the printed one."""
    if eq.repair:
        length = sum(len(paper.EQUATIONS[tag].right) for tag in eq.formulas)
        small = all(2 * repair.size < length for repair in eq.repair)
        return small and equal(eq.repaired, eq.derive())
    return eq.mistaken is not None and bool(eq.mistake) and equal(eq.mistaken(), eq.printed)


def _number(value: sp.Expr) -> str:
    """LaTeX of an exact value if it is short, else of twelve digits."""
    value = value if len(sp.sstr(value)) <= 16 else sp.N(value, 12)
    return sp.sstr(value) if value.is_Rational else sp.latex(value, fold_short_frac=True)
