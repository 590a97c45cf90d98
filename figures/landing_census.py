"""Every landing in the row, and of lone rods, beside the impact map: Sections IV and V, tested.

The map is fed what was measured at each touch (velocities, arms, plate velocity) and the measured
restitution -v_f/v_0, cut to [0, 1]. 40 rods, l = 9.5 d, epsilon = 0.65 head on, mu = 0.3; friction
of the plate as a constraint, unless the law is named. Full symbols: each landing weighs what it
changes, (c_x, c_z, k omega); open ones: each alike, grazing touches and rests included.

Look at (c) and (e): if no other rod pushes meanwhile the map is right; it errs by what gravity and
the plate's acceleration do during the contact (open symbols: that allowed for). (b): such landings
are the fewer the more upright the row. (f): below the dotted line no point can lie; on it, the
whole error is a turn about the contact point, which other rods can give and the plate cannot.
(a), (d): landings that slide through are there at each tilt beyond some 12 degrees and each Gamma
beyond 1.5; most of them are light ones.
"""

import math
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import md
from impact import ContactGeometry, critical_friction

from .landings import DISTURBED, Census, census, measures
from .shared import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style, tilt_axis

GAMMA, LENGTH = 3.3, 43.0  # where not swept
BOXES = (40.15, 40.6, 41.4, 43, 45.5, 48, 52, 57, 63, 70, 80)
GAMMAS = (1.2, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5)
STIFFNESS = (5e5, 5e6, 5e7)
LONE_STIFFNESS = (5e4, 5e5, 5e6, 5e7, 5e8)
LAWS = {"coulomb": ["contacts.plate.law=coulomb"], "constant": []}
SWEEPS = ("tilt", "constant", "gamma", "stiff")
FEW = 30  # isolated landings, below which their mean is not drawn
DOTS = 1500  # landings drawn one by one


def _row(periods: int, law: str = "coulomb", **changes: float) -> tuple[Census, md.Result]:
    """A row of 40; a softer tangential spring between rods allows a larger step."""
    settings = [f"{key.replace('__', '.')}={value}" for key, value in changes.items()]
    common = ["step.size=none", "contacts.rods.tangential_ratio=5"]
    return census(md.load("quasi2d", common + LAWS[law] + settings), periods)


def _table(runs: list[tuple[Census, md.Result]]) -> dict[str, np.ndarray]:
    """A column (value, standard error) for each measure, a row a run."""
    found = [measures(landings) for landings, _ in runs]
    table = {name: np.array([each[name] for each in found]) for name in found[0]}
    table["tilt"] = np.array([(r.tilt_deg, r.tilt_stderr_deg) for _, r in runs])
    table["c_x"] = np.array([(r.c_x, r.c_x_stderr) for _, r in runs])
    table["count"] = np.array([len(landings.jump) for landings, _ in runs])
    table["isolated_count"] = np.array([landings.isolated.sum() for landings, _ in runs])
    return table


def _lone(quick: bool) -> dict[str, np.ndarray]:
    """Rods thrown on the plate one by one, on plates soft and stiff, until they have fallen."""
    common = ["start.speed=0.5", "start.drop=0.1", f"rods.count={100 if quick else 1000}"]
    runs = [
        census(md.load("single_rod", [*common, f"contacts.plate.stiffness={k}"]), 5, by_rod=True)
        for k in LONE_STIFFNESS
    ]
    wanted = ("residual", "allowed", "agree_number", "agree_allowed_number", "duration", "count")
    return {name: values for name, values in _table(runs).items() if name in wanted}


@cache
def reversal_tilt(friction: float = 0.3, length: float = 9.5) -> float:
    """Tilt [deg] beyond which friction cannot hold the tip of the row's rods."""

    def excess(tilt):
        half = (length - 1) / 2
        rod = ContactGeometry(half * np.sin(tilt), half * np.cos(tilt) + 0.5, length / 12**0.5)
        return critical_friction(rod) - friction

    return float(np.degrees(brentq(excess, 0, 0.8)))


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Measures over tilt, Gamma and stiffness, each with its standard error; landings for dots."""
    periods = 40 if quick else 400
    boxes, gammas, stiffness = (BOXES, GAMMAS, STIFFNESS)
    if quick:
        boxes, gammas, stiffness = boxes[1::2], gammas[::2], stiffness[:2]
    by_tilt = [_row(periods, box__length=box) for box in boxes]
    tables = {
        "tilt": _table(by_tilt),
        "constant": _table([_row(periods, "constant", box__length=box) for box in boxes]),
        "gamma": _table([_row(periods, plate__acceleration=gamma) for gamma in gammas]),
        "stiff": _table(
            [
                _row(periods, contacts__plate__stiffness=k, contacts__rods__stiffness=k)
                for k in stiffness
            ]
        ),
        "lone": _lone(quick),
    }
    some = by_tilt[boxes.index(LENGTH)][0]
    chosen = np.random.default_rng(1).permutation(len(some.jump))[:DOTS]
    dots = {f"dot_{name}": getattr(some, name)[chosen] for name in ("jump", "residual", "kick")}
    return {
        "box": np.array(boxes),
        "gamma": np.array(gammas),
        "stiffness": np.array(stiffness),
        "lone_stiffness": np.array(LONE_STIFFNESS),
        "reversal_tilt_deg": np.float64(reversal_tilt()),
        **{f"{sweep}_{name}": v for sweep, table in tables.items() for name, v in table.items()},
        **dots,
        "dot_isolated": some.isolated[chosen].astype(float),
    }


def _curve(ax, x, pairs, colour, label=None, **kwargs) -> None:
    """Points with their errors, joined; `open=True` for hollow ones."""
    if kwargs.pop("open", False):
        kwargs |= {"mfc": "white", "mew": 0.7, "ls": "--"}
    kwargs = {"marker": "o", "ms": 3, "lw": 0.8, "elinewidth": 0.6, **kwargs}
    ax.errorbar(x, pairs[..., 0], pairs[..., 1], color=colour, label=label, **kwargs)


SHARE = {"ylabel": "share of landings", "ylim": (0, 1.5), "yticks": np.arange(0, 1.1, 0.25)}
ABOVE = {"loc": "upper center", "ncols": 2, "columnspacing": 1, "handlelength": 1.4, "fontsize": 6}


def _draw_regimes(ax, d) -> None:
    x = d["tilt_tilt"][:, 0]
    _curve(ax, x, d["tilt_stick"], BLACK, "slip-stick", marker="s")
    _curve(ax, x, d["tilt_reversal"], RED, "slip reversal", marker="^")
    _curve(ax, x, d["tilt_slide"], BLUE, "slide")
    _curve(ax, x, d["tilt_slide_number"], BLUE, "slide, by number", open=True)
    ax.set(**SHARE)
    ax.legend(**ABOVE)


def _draw_company(ax, d) -> None:
    x = d["tilt_tilt"][:, 0]
    _curve(ax, x, d["tilt_shared"], GREEN, "another rod pushes")
    _curve(ax, x, d["tilt_shared_number"], GREEN, "the same, by number", open=True)
    _curve(ax, x, d["tilt_disturbed"], ORANGE, f"and kicks: > {DISTURBED:.0%}", marker="s")
    ax.set(**SHARE)
    ax.legend(loc="upper left")


def _draw_residual(ax, d) -> None:
    for sweep, colour, law in (("tilt", BLACK, "constraint"), ("constant", ORANGE, "spring")):
        x = d[f"{sweep}_tilt"][:, 0]
        for part, marker in (("pushed_residual", "s"), ("isolated_residual", "o")):
            some = d[f"{sweep}_isolated_count"] >= FEW if marker == "o" else slice(None)
            _curve(ax, x[some], d[f"{sweep}_{part}"][some], colour, marker=marker)
        allowed = d[f"{sweep}_isolated_allowed"][some]
        _curve(ax, x[some], allowed, colour, open=True)
        ax.plot([], [], color=colour, label=law)
    ax.set(ylabel="error / change", yscale="log", ylim=(3e-6, 3))
    for text, y in (("pushed", 0.8), ("isolated", 0.07), ("isolated, allowed for", 6e-4)):
        ax.text(63, y, text, ha="right", va="center", fontsize=7)
    ax.legend(loc="lower left", ncols=2, columnspacing=1, handlelength=1.4)


def _draw_gamma(ax, d) -> None:
    x = d["gamma"]
    _curve(ax, x, d["gamma_shared"], GREEN, "another pushes")
    _curve(ax, x, d["gamma_slide"], BLUE, "slide")
    _curve(ax, x, d["gamma_slide_number"], BLUE, "by number", open=True)
    _curve(ax, x, d["gamma_pushed_residual"], BLACK, "error, pushed", marker="s")
    _curve(ax, x, d["gamma_isolated_residual"], BLACK, "isolated")
    ax.set(xlabel=r"$\Gamma$", xlim=(1, 5.2), xticks=range(1, 6), **SHARE)
    ax.set(ylabel="share; error / change", ylim=(0, 1.75))
    ax.legend(**ABOVE)


def _draw_duration(ax, d) -> None:
    for sweep, part, colour, label in (
        ("lone", "", BLUE, "lone rods"),
        ("stiff", "isolated_", BLACK, "row, isolated"),
    ):
        x = d[f"{sweep}_{part}duration"][:, 0]
        _curve(ax, x, d[f"{sweep}_{part}residual"], colour, label)
        _curve(ax, x, d[f"{sweep}_{part}allowed"], colour, open=True)
    x = d["stiff_pushed_duration"][:, 0]
    _curve(ax, x, d["stiff_pushed_residual"], BLACK, "row, pushed", marker="s")
    ax.set(xlabel="contact / period", ylabel="error / change", xscale="log", yscale="log")
    ax.set(xlim=(1e-3, 0.2), ylim=(1e-7, 2))
    ax.legend(loc="lower right")


def _draw_kick(ax, d) -> None:
    kick, miss = d["dot_kick"] / d["dot_jump"], d["dot_residual"] / d["dot_jump"]
    for alone, colour, label in ((0, BLACK, "pushed"), (1, ORANGE, "isolated")):
        some = d["dot_isolated"] == alone
        size = 6 * np.sqrt(d["dot_jump"][some])
        ax.scatter(kick[some], miss[some], s=size, c=colour, lw=0, alpha=0.5, label=label)
    ends = np.array([1e-5, 1])
    ax.plot(ends, ends, color=BLUE, lw=0.8, ls=":")
    ax.set(xlabel="kick by other rods / change", ylabel="error / change")
    ax.set(xscale="log", yscale="log", xlim=(3e-6, 3), ylim=(3e-4, 20))
    ax.legend(loc="upper left", markerscale=2)


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.6))
    panels = (_draw_regimes, _draw_company, _draw_residual, _draw_gamma, _draw_duration, _draw_kick)
    titles = (
        *(rf"regimes, $\Gamma={GAMMA:g}$", "not alone", "error of the map"),
        *(f"L = {LENGTH:g} d", "soft to stiff", f"each landing, L = {LENGTH:g} d"),
    )
    for ax, panel, letter, title in zip(axes.flat, panels, "abcdef", titles, strict=True):
        panel(ax, d)
        name_panel(ax, letter, title)
    for ax in axes[0]:
        tilt_axis(ax, 0, 65)
        ax.axvline(d["reversal_tilt_deg"], color="0.4", lw=0.8, ls=":")
    return figure


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


def _text(pair: np.ndarray) -> str:
    value, error = 100 * pair
    if not np.isfinite(error):
        return "-"
    digits = min(max(-math.floor(math.log10(error)), 0), 4) if error > 0 else 0
    return f"{value:.{digits}f} ±{error:.{digits}f}"


def summary(d: dict[str, np.ndarray]) -> str:
    """Tables in percent, with standard errors."""
    lines = ["percent; #: each landing alike, else weighted by its change of (c_x, c_z, k omega)"]
    for title, columns in TABLES.items():
        lines.append(f"{title}\n{'sweep':9}{'':>6}{'tilt':>6}")
        lines[-1] += "".join(f"{head:>15}" for head in columns.values())
        for sweep, axis in zip(SWEEPS, ("box", "box", "gamma", "stiffness"), strict=True):
            for i, x in enumerate(d[axis]):
                cells = "".join(f"{_text(d[f'{sweep}_{name}'][i]):>15}" for name in columns)
                lines.append(f"{sweep:9}{x:6.4g}{d[f'{sweep}_tilt'][i, 0]:6.1f}{cells}")
    lines.append("lone rods: contact, error, allowed for, agreement #, allowed for #")
    wanted = ("duration", "residual", "allowed", "agree_number", "agree_allowed_number")
    for i, stiffness in enumerate(d["lone_stiffness"]):
        cells = "".join(f"{_text(d[f'lone_{name}'][i]):>15}" for name in wanted)
        lines.append(f"k_n ={stiffness:6.0e}{'':9}{cells}")
    return "\n".join(lines)
