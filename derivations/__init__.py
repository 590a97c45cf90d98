'''The paper, derived from Newton's laws with SymPy and compared with what is printed.

`equation` gives any of them as an expression, `function` as a NumPy function; `symbols` holds the
letters, which know their signs:

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
symbols, proof                      the paper's letters; an equation, its verdict, its proof
newton                              (1)-(6): the laws from which all else is computed
slide, slip_stick, slip_reversal    (7)-(22), (B1)-(B12): the regimes of an impact
bodies, thin_rod, drift             rods; boundaries, (23); stationary translation, (24)-(31)
laws, appendix, references          other restitutions, energy; Appendix A; cited figures
registry                            all entries in the paper's order
rewrites                            rules that make a form compute well, each one proved
map_functions, rod_functions        which functions are generated, by which rules
codegen, readme                     impact/_generated.py; the tables of the README
presentation, typeset, prose        forms, formulas and sentences to be read
lookup                              `equation`, `function`: one entry by its tag
report, __main__                    the report; the command line

To add an equation: how a falling rod rebounds
----------------------------------------------
1. derivations/drift.py, after the function `landing_velocity`: derived from what is there
    @cache
    def rebound() -> sp.Expr:
        """-c_z'/c_z of a fall without spin and friction on a plate at rest."""
        after = slide.cm_velocity(*slide.impulse())[1].subs({mu: 0, omega: 0, V_z: 0})
        return sp.factor(-after / c_z)

2. derivations/drift.py, last in `EQUATIONS`: what is claimed, and how it is proved
    Equation(
        tag="V: rebound",
        what="what a fall without spin and friction leaves of the centre's speed",
        symbol="-c_z'/c_z",
        derive=rebound,
        check=lambda: (  # angular momentum about the contact point, and restitution there
            rebound() + X**2 / k**2 * (1 + rebound()) - epsilon,
        ),
        verdict="new",
        note="zero where X^2 = epsilon k^2",
    ),

   What the paper prints goes into `printed`, with the verdict "agrees", or "erratum" and what
   contradicts it (`proof`). If it should be a function:

3. derivations/rod_functions.py, last in `FUNCTIONS`: what is generated, by which rules
    Function(
        name="rebound",
        summary="What a fall without spin and friction leaves of the centre's speed.",
        detail="x = |X|/k.",
        arguments=(_x, epsilon),
        outputs={_name("rebound"): _thin(drift.rebound())},
        rules=(
            recast(
                "bounded",
                "x^2 may overflow: then p is 0",
                p=1 / (1 + _x**2),
                rest=1 - _name("p"),
                rebound=epsilon * _name("p") - _name("rest"),
            ),
        ),
    ),

Try it: all proofs, impact/_generated.py and the README's tables anew, the report.

    python -m derivations check
    python -m derivations generate
    python -m derivations report

How it becomes public stands in `help(impact)`.
'''

from . import symbols
from .lookup import equation, function

__all__ = ["equation", "function", "symbols"]
