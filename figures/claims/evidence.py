"""What the claims are measured on: data of figures and rows over tilt, each read or made once."""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

import md

from ..checks import landing_census, landings
from ..lib import row_runs as rows
from ..lib.data import figure_data
from . import over_tilt


@dataclass
class Evidence:
    """Data to measure claims on.

    quick : the figures' quick data, shorter and coarser
    out : folder whose stored figures are read where they are current; None: all are computed
    """

    quick: bool = False
    out: Path | None = None
    _figures: dict[str, dict[str, np.ndarray]] = field(default_factory=dict)

    def figure(self, name: str) -> dict[str, np.ndarray]:
        """Data of a figure."""
        if name not in self._figures:
            self._figures[name] = figure_data(name, self.quick, self.out)
        return self._figures[name]

    @cached_property
    def over_tilt(self) -> dict[str, np.ndarray]:
        """The paper's row over tilt."""
        return over_tilt.table(rows.tilt_plan(self.quick), rows.tilts(self.quick))

    @cached_property
    def census(self) -> dict[str, tuple[float, float]]:
        """Measures of the landings of one row, each with its standard error."""
        scene = md.load("quasi2d", ["step.size=none", *landing_census.LAWS["constraint"]])
        return landings.measures(landings.census(scene, 40 if self.quick else 400)[0])
