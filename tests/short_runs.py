"""Short runs for tests of figures, in a store of their own."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from figures.lib import runs
from figures.paper import fig02, fig04, fig05, fig07, fig08
from md.sweep import Tally, execute, expand

FEW = {
    **{"count": [24, 34, 40], "gamma": [1.6, 2.0, 3.3], "wall": [0.1, 0.3], "plate": [0.1, 0.3]},
    **{"plane": [15, 45], "seeds": [1, 2], "few_seeds": [1, 2], "periods": 6},
}


def shortened(patch: pytest.MonkeyPatch, folder: Path, periods: int = 6) -> list[Tally]:
    """Runs of at most so many periods, few rods in the annulus; what each sweep did."""
    done: list[Tally] = []
    estimate = SimpleNamespace(mean=1.0, error=0.0)
    lone = SimpleNamespace(flight=estimate, falling=estimate)

    def watched(*args, **options):
        done.append(execute(*args, **options))

    def short(tables, base):
        return expand({**tables, "periods": min(tables["periods"], periods)}, base)

    patch.setattr(runs, "STORE", folder / "rows.db")
    patch.setattr(runs, "execute", watched)
    patch.setattr(runs, "expand", short)
    patch.setattr(runs, "SEEDS", {"start.seed": [1, 2]})
    for module in (fig07, fig08):
        patch.setattr(module, "lone", lambda _: (np.array([0.0]), [lone]))
    patch.setattr(fig07, "TRANSIENT", 2)
    patch.setattr(fig02, "MAP_COUNTS", {True: (34, 24)})
    patch.setattr(fig04, "SIZES", {name: (few, few) for name, few in FEW.items()})
    patch.setattr(fig04, "GAMMA_COUNTS", (40, 34, 24))
    patch.setattr(fig04, "ANNULUS_COUNT", 32)
    patch.setattr(fig05, "SHOWN_COUNTS", (32, 24))
    patch.setattr(fig05, "SNAPSHOT_COUNTS", {True: (32, 24)})
    return done
