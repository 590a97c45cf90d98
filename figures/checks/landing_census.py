"""Every touch in the row, and of lone rods, beside the impact map: Sections IV and V, tested.

The map is fed what was measured at each touch (velocities, arms, plate velocity) and the measured
restitution -v_f/v_0, cut to [0, 1]. 40 rods, l = 9.5 d, epsilon = 0.65 head on, mu = 0.3; friction
of the plate as a constraint, unless the law is named. Each touch weighs what it changes of (c_x,
c_z, k omega). "Pushed": another rod pushes at some time during the touch; isolated: none does.
"Kicked": other rods gave more than a tenth of the change as a turn about the contact point, which
the plate cannot give.

(a) Regimes over tilt; (b) touches that are pushed, kicked; (c) error of the map, in isolated
touches also with gravity and the plate's acceleration during the contact allowed for; (d) over
Gamma; (e) over the stiffness, as the duration of a contact; (f) over what rods lose when they meet.
Dotted in (a) to (c): the tilt beyond which friction cannot hold a tip.
"""

from collections.abc import Iterable, Iterator
from functools import cache, partial

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

from impact import critical_friction
from md.scene import both, put, read_tables
from md.sweep import Sweep

from ..lib.runs import FRICTION, GAMMA, gathered, paper_rod, planned
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, Data, painted, points, style, tilt_axis
from ..lib.tables import table
from .census import DISTURBED, counted

CONTACTS = {  # a softer tangential spring between rods allows a larger step
    "constraint": {"contacts.plate.law": "coulomb", "contacts.rods.tangential_ratio": 5},
    "spring": {"contacts.rods.tangential_ratio": 5},
    "appendix_a": both(law="appendix_a", restitution="none"),
}
BOXES = (40.15, 40.6, 41.4, 43, 45.5, 48, 52, 57, 63, 70, 80)
STIFFNESSES = "contacts.plate.stiffness", "contacts.rods.stiffness"
VARIED = {  # keys, their values, those of --quick; the law is the first one where none is named
    "constraint": (("box.length",), BOXES, (40.6, 43, 48, 57, 80)),
    "spring": (("box.length",), BOXES, (43, 57)),
    "appendix_a": (("box.length",), BOXES, (43, 57)),
    "gamma": (("plate.acceleration",), (1.2, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5), (1.5, 3.3, 5)),
    "stiff": (STIFFNESSES, (5e5, 5e6, 5e7), (5e5, 5e6)),
    "lossy": (("contacts.rods.restitution",), (0.3, 0.5, 0.65, 0.8, 0.9, 0.97), (0.3, 0.65, 0.9)),
    "lone": (STIFFNESSES[:1], (5e4, 5e5, 5e6, 5e7, 5e8), (5e4, 5e5, 5e6)),
}
CENSUS_PERIODS = {True: 20, False: 400}  # of rows
THROWN, THROWS = {True: 100, False: 1000}, 5  # lone rods, and their periods
FEWEST_ISOLATED = 30  # isolated touches, below which their mean is not drawn
CENSUS_ROW, LONE = put(read_tables("quasi2d"), {"step.size": "none"}), read_tables("single_rod")
TABLES = {
    "regimes and company": {
        "slide": "slide",
        "slide_number": "slide #",
        "isolated_slide": "slide, iso",
        "stick": "stick",
        "reversal": "reversal",
        "shared": "pushed",
        "shared_number": "pushed #",
        "disturbed": "kicked",
    },
    "error of the map over the change, and agreement on the regime": {
        "isolated_residual": "isolated",
        "isolated_allowed": "allowed for",
        "pushed_residual": "pushed",
        "pushed_kick": "its kick",
        "isolated_agree_number": "agree, iso #",
        "isolated_agree_allowed_number": "allowed #",
        "pushed_agree_number": "pushed #",
    },
    "contact over period, rests, hops, and measured restitution out of [0, 1]": {
        "duration_number": "contact #",
        "isolated_duration": "isolated",
        "rest_number": "rest #",
        "rest": "rest",
        "hop_number": "hop #",
        "below_number": "below 0 #",
        "above_number": "above 1 #",
    },
}
STORED_MEASURES = dict.fromkeys((
    *("tilt", "c_x", "count", "isolated_count", "pushed_duration", "duration", "residual"),
    *("allowed", "agree_number", "agree_allowed_number"),
    *(name for columns in TABLES.values() for name in columns),
))  # fmt: skip


def one_row(quick: bool) -> Sweep:
    """The row at its usual tilt alone."""
    return planned([], CENSUS_PERIODS[quick], CONTACTS["constraint"], CENSUS_ROW, counted)


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Rows over tilt, law by law, over Gamma, stiffness and restitution; lone rods."""
    found = {}
    for name, (keys, full, few) in VARIED.items():
        how = CENSUS_PERIODS[quick], CONTACTS.get(name, CONTACTS["constraint"]), CENSUS_ROW
        if name == "lone":  # thrown on the plate one by one, until they have fallen
            thrown = {"start.speed": 0.5, "start.drop": 0.1, "rods.count": THROWN[quick]}
            how = THROWS, thrown, LONE
        axis = {key: [*(few if quick else full)] for key in keys}
        found[name] = planned([axis], *how, counted)
    return found


@cache
def reversal_tilt() -> float:
    """Tilt [deg] beyond which friction cannot hold the tip of the row's rods."""
    held = brentq(lambda tilt: critical_friction(paper_rod(tilt)) - FRICTION, 0, 0.8)
    return float(np.degrees(held))


def data(quick: bool = False) -> Data:
    """Measures over what each sweep varies: a column (value, error) each, or a number."""
    found = {"reversal_tilt_deg": np.float64(reversal_tilt())}
    for name, sweep in sweeps(quick).items():
        found[name] = sweep.values(VARIED[name][0][0])
        for measure, values in zip(STORED_MEASURES, gathered(sweep, *STORED_MEASURES), strict=True):
            found[f"{name}_{measure}"] = values
    return found


SHARE = {"ylabel": "share of touches", "ylim": (0, 1.03)}
PINK = "#CC79A7"
KINDS = {"pushed_residual": "s:", "isolated_residual": "o-", "isolated_allowed": "^--"}  # of errors
KIND_NAMES = "pushed", "isolated", "allowed for"


def _curve(ax, x, pairs, colour, label=None, form="o-") -> None:
    """Points with their errors, joined."""
    points(ax, x, *pairs.T, colour, label=label, form=form)


def _name_kinds(ax) -> None:
    """Entries of the legend for the lines of `KINDS`."""
    for form, name in zip(KINDS.values(), KIND_NAMES, strict=True):
        ax.plot([], [], form, color="0.4", ms=3, lw=0.7, label=name)


def _draw_regimes(ax, d) -> None:
    x = d["constraint_tilt"][:, 0]
    for name, colour in (("slip-stick", BLACK), ("slip reversal", RED), ("slide", BLUE)):
        _curve(ax, x, d[f"constraint_{name.split('-')[-1].split()[-1]}"], colour, name)
    ax.set(**SHARE)
    ax.legend(loc="center right", fontsize=6)


def _draw_company(ax, d) -> None:
    """Curves with their names beside them, from about 28 degrees on."""
    curves = {
        "pushed": ("constraint", "shared", GREEN),
        f"kicked > {DISTURBED:.0%}": ("constraint", "disturbed", PINK),
        "pushed, Appendix A": ("appendix_a", "shared", ORANGE),
    }
    for name, (law, measure, colour) in curves.items():
        x, share = d[f"{law}_tilt"][:, 0], d[f"{law}_{measure}"]
        _curve(ax, x, share, colour)
        near = np.abs(x - 28).argmin()
        at = x[near], share[near, 0]
        beside = {"textcoords": "offset points", "color": colour, "fontsize": 7}
        ax.annotate(name, at, (0, -11 if colour == PINK else 6), **beside)
    ax.set(**SHARE)


def _draw_residual(ax, d) -> None:
    for law, colour in zip(CONTACTS, (BLACK, BLUE, ORANGE), strict=True):
        tilt, some = d[f"{law}_tilt"][:, 0], d[f"{law}_isolated_count"] >= FEWEST_ISOLATED
        for kind, form in KINDS.items():
            here = some | (kind == "pushed_residual")
            _curve(ax, tilt[here], d[f"{law}_{kind}"][here], colour, form=form)
        ax.plot([], [], color=colour, label=law.replace("_a", " A").replace("app", "App"))
    _name_kinds(ax)
    ax.set(ylabel="error / change", yscale="log", ylim=(1e-6, 1e2))
    ax.legend(loc="upper center", ncols=2, fontsize=6, columnspacing=1)


def _draw_shares(ax, d, sweep: str) -> None:
    """Shares of landings and errors over what a sweep changes."""
    x = d[sweep]
    _curve(ax, x, d[f"{sweep}_shared"], GREEN, "pushed")
    _curve(ax, x, d[f"{sweep}_slide"], BLUE, "slide")
    for kind, name in zip(KINDS, KIND_NAMES[:2], strict=False):
        _curve(ax, x, d[f"{sweep}_{kind}"], BLACK, f"error, {name}", form=KINDS[kind])
    ax.set(**SHARE | {"ylabel": "share; error / change"})
    ax.legend(fontsize=6)


def _draw_duration(ax, d) -> None:
    for sweep, colour, label in (("lone", RED, "lone rods"), ("stiff", BLACK, "row")):
        for kind, form in KINDS.items():
            x = d[f"{sweep}_{kind.partition('_')[0]}_duration"][:, 0]
            _curve(ax, x, d[f"{sweep}_{kind}"], colour, form=form)
        ax.plot([], [], color=colour, label=label)
    _name_kinds(ax)
    ax.set(xlabel="contact / period", ylabel="error / change", xscale="log", yscale="log")
    ax.set(xlim=(1e-3, 0.2), ylim=(1e-6, 1e2))
    ax.legend(loc="upper center", ncols=2, fontsize=6, columnspacing=1)


@style
def draw(d: Data) -> plt.Figure:
    panels = {
        rf"regimes, $\Gamma={GAMMA:g}$": _draw_regimes,
        "not alone": _draw_company,
        "error of the map": _draw_residual,
        "driving": partial(_draw_shares, sweep="gamma"),
        "soft to stiff": _draw_duration,
        "losses between rods": partial(_draw_shares, sweep="lossy"),
    }
    figure = painted(d, panels, rows=2, figsize=(7.0, 4.6))
    *over_tilt, gamma, _, lossy = figure.axes
    gamma.set(xlabel=r"$\Gamma$", xlim=(1, 5.2), xticks=range(1, 6))
    lossy.set(xlabel="restitution between rods", xlim=(0.2, 1.05))
    for ax, top in zip(over_tilt, (1, 1, 0.7), strict=True):  # up to the legend
        tilt_axis(ax, 0, 65)
        ax.axvline(d["reversal_tilt_deg"], 0, top, color="0.4", lw=0.8, ls=":")
    return figure


def summary(d: Data) -> str:
    """Tables in percent, with standard errors."""

    def cells(name: str, i: int, columns: Iterable[str]) -> Iterator[tuple[float, float]]:
        return (tuple(100 * d[f"{name}_{column}"][i]) for column in columns)

    lines = ["percent ± s.e.; #: each touch alike, else weighted by its change of (c_x, c_z, k w)"]
    for title, columns in TABLES.items():
        rows = [
            [name, f"{x:.4g}", f"{d[f'{name}_tilt'][i, 0]:.1f}", *cells(name, i, columns)]
            for name in [*VARIED][:-1]
            for i, x in enumerate(d[name])
        ]
        lines += [title, table(("sweep", "at", "tilt", *columns.values()), rows, ".3g")]
    columns = {"duration": "contact", "residual": "error", "allowed": "allowed for"}
    columns |= {"agree_number": "agreement #", "agree_allowed_number": "allowed for #"}
    rows = [[f"{k:.0e}", *cells("lone", i, columns)] for i, k in enumerate(d["lone"])]
    return "\n".join([*lines, table(("lone rods, k_n", *columns.values()), rows, ".3g")])
