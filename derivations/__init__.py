"""The paper, derived from Newton's laws with SymPy and compared with what is printed.

`equation` gives one of its equations as an expression, `function` as a NumPy function; `symbols`
holds the letters, with their signs:

>>> import derivations
>>> from derivations import symbols
>>> derivations.equation("16")
mu*(Z**2 + k**2) > X*Z
>>> derivations.equation("24").subs(symbols.epsilon, 1)
2*V_z*Z/X
>>> derivations.function("23")(mu=[0.25, 0.5, 0.75]).round(3)  # tilts in rad
array([0.331, 0.652, 1.107])

`derivations.registry` holds every equation as printed and as derived, with a verdict and its proof.
From a shell: `python -m derivations check`, `report`, `generate`.

Files, as one reads them
------------------------
symbols, paper                      the paper's letters; its formulas, read from paper.toml
equality, proof                     whether forms are equal; an equation, its verdict, its proof
axioms, trace                       what is assumed; the steps that a derivation rests on
newton                              (1)-(6): the contact point's equations of motion
slide, slip_stick, slip_reversal    (7)-(22), (B1)-(B12): the regimes of an impact
bodies, thin_rod, drift             rods; boundaries, (23); stationary translation, (24)-(31)
optimum                             best tilt, stability, Painleve's paradox
landing_phases                      landing phases by the flux of impacts, and V_z with them
laws, pairs                         other restitutions, energy; any two bodies
statements                          sentences of the text; dimensions of Appendix A
second_routes                       whole impacts from conservation laws, for the proofs
texts                               checks of what sentences say of equations and letters; the
                                    seal of the words that were read
registry                            all entries: the paper's way first, then what is new
rewrites                            rules that make a form compute well, each one proved
closed_forms                        what generated functions compute (functions.toml: how)
kernel, trials                      one impact, impact/_kernel.py: run on letters and on numbers
                                    that know their roundings, and proved
codegen                             assignments as the text of functions
languages                           the impact map in C and JavaScript (languages.toml)
files                               impact/_generated.py, EQUATIONS.md; writing files
typeset, lecture                    formulas as LaTeX and MathML; text, letters (lecture.toml);
                                    numbers of the notes, and words only where they are true
steps, drawings                     the steps for a reader; drawings as SVG
lookup                              `equation`, `function`: one entry by its tag
report, __main__, command_line      the report, from templates/; the commands

To add an equation
------------------
1. A function beside its relatives (`drift.py`, `laws.py`, ...) derives it from what is there.
   A step that is worth a name is marked `@derived` with the left sides of its values; the first
   line of its docstring is the sentence that a reader finds there. `say` adds a line between.
2. An `Equation` in that module's `EQUATIONS`, or `BEYOND` if the paper does not have it, holds
   its words beside its form. What the paper prints stands under its tag in paper.toml; `shown`
   is a form that reads better than the derived one. Its verdict is "agrees" by default. It is
   "erratum" with the `repair` that makes the printed form right and the formulas that contradict
   it. A result that the paper does not have is "new" and needs a second route, `check` (module
   `proof`). Numbers in a note are computed. Words that depend on a computation go through
   `lecture.so`, which refuses them if they are not true. Formulas in sentences stand between
   dollar signs; a left side such as v_f - v_1 is read and must have its step's value (module
   `trace`). Its letters stand in lecture.toml, with their dimensions. A number such as (5) must be
   that of an equation whose value was taken (module `texts`). Whoever changes words reads them
   beside their forms, on the page, and renews their seal, `texts.READ`, which `check` asks for.
3. If it should be a function: a `Function` in `closed_forms.py` derives its outputs;
   functions.toml has its words, and the assignments that compute it well, as they are generated
   (module `rewrites` proves them).
4. An algorithm goes into impact/_kernel.py, and what it returns, as derived, into `kernel.py`.

`check` proves it, tests/test_mutants.py tries to fool the proof, `generate` writes
impact/_generated.py and EQUATIONS.md, `report` shows it.
How it becomes public stands in `help(impact)`.
"""

from . import command_line  # noqa: F401  (before slow imports)

# isort: split
import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if sys.argv[:1] == ["-m"] and "derivations" in sys.orig_argv:  # its commands
    os.environ.setdefault("SYMPY_CACHE_SIZE", "None")  # without a limit SymPy is a tenth faster
if TYPE_CHECKING:
    from . import symbols
    from .lookup import equation, function

__all__ = ["equation", "function", "symbols"]


def __getattr__(name: str) -> Any:
    """Look up what needs SymPy, or the version, only when asked: `figures` takes `command_line`."""
    if name == "__version__":  # a checkout that is not installed has none
        from importlib.metadata import version

        return version("rod-impact")
    if name == "symbols":
        return import_module(".symbols", __name__)
    if name in __all__:
        return getattr(import_module(".lookup", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names of the package, also of what is not looked up yet."""
    return sorted({*globals(), *__all__})
