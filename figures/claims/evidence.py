"""What the claims are measured on: data of figures and rows over tilt, each read or made once."""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from md import RunError

from .. import load
from ..checks import landing_census
from ..lib import runs
from ..lib.data import figure_data
from ..lib.style import Data
from . import over_tilt
from .uncertainty import Number, standard


class Whole(dict):
    """Data of runs; an array that lacks some of them cannot be read.

    Else a drift that is not known would count as none. Errors may be unknown everywhere.
    """

    def __getitem__(self, name: str) -> np.ndarray:
        value, error = super().__getitem__(name), self.get(f"{name}_error")
        if error is not None and (np.isnan(value).any() or 0 < np.isnan(error).mean() < 1):
            raise RunError(f"{name}: runs are missing or have failed")
        return value


ASSUMED = "fig04", "fig05"  # figures that two laws have


@dataclass
class Evidence:
    """Data to measure claims on.

    quick : the figures' quick data, shorter and coarser
    out : folder whose stored figures are read where they are current; None: all are computed
    assumed : `ASSUMED` alone, under the simple law, from few starts
    """

    quick: bool = False
    out: Path | None = None
    assumed: bool = False
    _figures: dict[str, Data] = field(default_factory=dict)

    def figure(self, name: str) -> Data:
        """Data of a figure by its name, read or computed once."""
        if name not in self._figures:
            self._figures[name] = Whole(
                load(name).data(self.quick, assumed=True)
                if self.assumed
                else figure_data(name, self.quick, self.out)
            )
        return self._figures[name]

    @cached_property
    def over_tilt(self) -> Data:
        """Table of the paper's row over tilt, from `over_tilt.table`."""
        return Whole(over_tilt.table(runs.tilt_plan(self.quick), runs.tilts(self.quick)))

    @cached_property
    def census(self) -> dict[str, Number]:
        """Measures of the touches of one row."""
        names = "slide", "residual", "isolated_residual", "disturbed"
        found = runs.gathered(landing_census.one_row(self.quick), *names)
        return {name: standard(*pair) for name, pair in zip(names, found, strict=True)}
