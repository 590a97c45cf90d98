"""Which contact law obeys which of the paper's claims about the row.

A row a law, a column a claim; the number is what was measured, the colour how it compares with the
paper under the limits of `claims.law_numbers`. Thin rods as in the paper, l = 9.5 d, Gamma = 3.3,
mu = 0.3; tilts from 9 to 60 degrees. Flights, shares of landings on the way down and -c_z/c_z' are
means over landings, in which touches less than 0.2 periods apart count as one; all others are means
over touches.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

from impact import drift, thin_rod
from md.scene import both
from md.sweep import Sweep

from ..claims.law_numbers import CLAIMS
from ..lib.runs import FRICTION, GAMMA, RESTITUTION, boxes, means, planned, plate_speed_cm_s
from ..lib.style import Data, style
from ..lib.tables import pairs, table, text_of

LAW_TILTS_DEG, QUICK_DEG = (9, 15, 22, 28, 34, 45, 60), (9, 28, 45)


def _printed(**options: object) -> dict:
    return both(law="appendix_a", restitution="none", tangential_ratio="none", **options)


CONTACT_LAWS = {  # what each changes in `runs.ROW`
    "App. A as printed": _printed(),
    "A, no overlap factor": _printed(overlap_factor=False),
    "A, damping 1.9e5": _printed(damping=1.9e5),
    "0.65, spring 3": both(),
    "0.65, spring 3, undamped": both(tangential_damping=0),
    "0.65, spring 30": both(tangential_ratio=30),
    "0.65, spring 30, undamped": both(tangential_ratio=30, tangential_damping=0),
    "0.8, spring 3": both(restitution=0.8),
    "0.9, spring 3": both(restitution=0.9),
    "0.9, spring 3, undamped": both(restitution=0.9, tangential_damping=0),
    "0.65, Coulomb on plate": {
        "contacts.plate.law": "coulomb",
        "contacts.plate.tangential_ratio": "none",
    },
}
QUICK_LAWS = ("App. A as printed", "0.65, spring 3", "0.9, spring 3")
LAW_MEANS = {
    "tilt": "tilt_deg",
    "c_x": "c_x_cm_s",
    **{name: f"landings.{name}.mean" for name in ("c_x_before", "c_x_after", "omega_before")},
    "V_z": "landings.plate_velocity.mean",
    "restitution": "landings.restitution.mean",
    "slide": "landings.slide.mean",
    "shared": "landings.not_isolated.mean",
    "contact": "landings.contact_periods.mean",
    "flight": "merged.flight_periods.mean",
    "falling": "merged.falling.mean",
    "c_z_before": "merged.c_z_before.mean",
    "c_z_after": "merged.c_z_after.mean",
    "touches": "merged.touches.mean",
}


def _names(d: Data) -> list[str]:
    return [list(CONTACT_LAWS)[i] for i in d["law"]]


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Of each law: over tilt."""
    names, periods = QUICK_LAWS if quick else tuple(CONTACT_LAWS), 40 if quick else 150
    axes = [{"box.length": boxes(QUICK_DEG if quick else LAW_TILTS_DEG)}]
    axes.append({"start.seed": [1, 2]})
    return {name: planned(axes, periods, CONTACT_LAWS[name]) for name in names}


def data(quick: bool = False) -> Data:
    """Of each law: the tables over tilt, and a number for each claim."""
    nominal, runs = np.array(QUICK_DEG if quick else LAW_TILTS_DEG), sweeps(quick)
    theory = drift(
        thin_rod(np.radians(nominal)),
        friction=FRICTION,
        restitution=RESTITUTION,
        plate_velocity=plate_speed_cm_s() / 2,
    ).c_x
    tables = []
    for sweep in runs.values():
        scene = sweep.points[0].scene
        found = {"nominal": nominal, "theory": theory, **means(sweep, LAW_MEANS)}
        found["ratio"] = -found["c_z_before"] / found["c_z_after"]
        tables.append(found | {"half_length": scene.rods.length / 2, "speed": scene.plate_speed})
    value = np.array([[claim.number(found) for claim in CLAIMS] for found in tables])
    verdict = [[c.verdict(v) for c, v in zip(CLAIMS, row, strict=True)] for row in value]
    return {
        "law": np.array([list(CONTACT_LAWS).index(name) for name in runs]),
        "value": value,
        "verdict": np.array(verdict),
        **{key: np.array([found[key] for found in tables]) for key in tables[0]},
    }


@style
def draw(d: Data) -> plt.Figure:
    n, m = d["value"].shape
    figure, ax = plt.subplots(figsize=(7.4, 1.6 + 0.24 * n))
    colours = ListedColormap(["#EDA677", "#FBF5BE", "#A6DBA0"])
    look = {"cmap": colours, "vmin": -0.5, "vmax": 2.5, "edgecolors": "white", "linewidth": 1}
    ax.pcolormesh(np.arange(m), np.arange(n), d["verdict"], **look)
    for (i, j), value in np.ndenumerate(d["value"]):
        text = text_of(value, CLAIMS[j].digits)
        ax.text(j, i, text, ha="center", va="center", fontsize=5.5)
    ax.set_yticks(range(n), _names(d), fontsize=6.5)
    heads = [f"{claim.name}\n[{claim.paper}]" for claim in CLAIMS]
    ax.set_xticks(range(m), heads, fontsize=5.5, rotation=60, ha="left", rotation_mode="anchor")
    ax.tick_params(length=0, labelbottom=False, labeltop=True)
    ax.invert_yaxis()
    for side in ax.spines.values():
        side.set_visible(False)
    ax.set_xlabel(
        "green: holds, yellow: in part, red: does not; in brackets the paper's statement. Thin "
        rf"rods, $\Gamma={GAMMA}$, $\mu={FRICTION}$, tilts {d['nominal'][0].min()}-"
        rf"{d['nominal'][0].max()}°",
        fontsize=6.5,
    )
    return figure


def summary(d: Data) -> str:
    """Matrix, then what it is made of, law by law."""
    names = _names(d)
    rows = [
        [claim.name.replace("\n", " "), claim.paper]
        + [f"{text_of(v, claim.digits)} {'-~+'[k]}" for v, k in zip(*column, strict=True)]
        for claim, *column in zip(CLAIMS, d["value"].T, d["verdict"].T, strict=True)
    ]
    lines = ["Claims: + holds, ~ in part, - does not", table(("claim", "paper", *names), rows)]
    for i, name in enumerate(names):
        good, fair, bad = ((d["verdict"][i] == k).sum() for k in (2, 1, 0))
        lines.append(f"{name}: holds {good}, in part {fair}, not {bad}")
        columns = {key: d[key][i] for key in ("nominal", "tilt", "theory", "restitution", "ratio")}
        columns |= {key: pairs(d, key, i) for key in ("c_x", "V_z", "flight", "falling")}
        lines.append(table([*columns], zip(*columns.values(), strict=True)))
    return "\n".join(lines)
