"""The table of letters: what each letter of the report means (lecture.toml), and its dimension.

Dimensions are monomials in mass M, length L and time T; 1 is a number. A letter with two meanings
has two lines.
"""

import re
from typing import NamedTuple

import sympy as sp

from .lecture import TEXTS
from .typeset import latex


class Letter(NamedTuple):
    """One line of the table."""

    name: str  # of the symbol
    meaning: str
    dimension: str  # LaTeX

    @property
    def tex(self) -> str:
        """LaTeX of the letter."""
        return {"Vdot_z": r"\dot V_z", "cprime_x": "c_x'", "cprime_z": "c_z'"}.get(
            self.name, latex(sp.Symbol(self.name))
        )


LETTERS = tuple(
    sorted(
        (Letter(*line.split(" | ")) for line in TEXTS["letters"].splitlines()),
        key=lambda letter: (re.sub(r"\\dot |[\\{}]", "", letter.tex).lower(), letter.tex),
    )
)
