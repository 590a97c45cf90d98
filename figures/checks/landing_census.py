"""Every landing in the row, and of lone rods, beside the impact map: Sections IV and V, tested.

The map is fed what was measured at each touch (velocities, arms, plate velocity) and the measured
restitution -v_f/v_0, cut to [0, 1]. 40 rods, l = 9.5 d, epsilon = 0.65 head on, mu = 0.3; friction
of the plate as a constraint, unless the law is named. Each landing weighs what it changes of
(c_x, c_z, k omega), or, by number, as much as any other, grazing touches and rests included.
"Pushed": another rod pushes at some time during the contact; isolated: none does.

Look at (c) and (e): if no other rod pushes meanwhile the map is right; it errs by what gravity and
the plate's acceleration do during the contact (open symbols: that allowed for), but for Appendix
A's spring, which gives its energy back. (b): such landings are the fewer the more upright the row,
and (f) the more the rods lose when they meet, whatever (e) the stiffness. (a), (d), (f): landings
that slide through are there at each tilt beyond some 12 degrees and each Gamma from 1.5 on; most of
them are light ones. "Kicked": other rods gave more than a tenth of the change as a turn about the
contact point, which the plate cannot give.
"""

import math
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import md
from impact import ContactGeometry, critical_friction

from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style, tilt_axis
from .landings import DISTURBED, Census, census, measures

GAMMA = 3.3  # where not swept; the box is 43 d long there
BOXES = (40.15, 40.6, 41.4, 43, 45.5, 48, 52, 57, 63, 70, 80)
GAMMAS = (1.2, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5)
STIFFNESS = (5e5, 5e6, 5e7)
LONE_STIFFNESS = (5e4, 5e5, 5e6, 5e7, 5e8)
RESTITUTIONS = (0.3, 0.5, 0.65, 0.8, 0.9, 0.97)  # between rods
LAWS = {  # a softer tangential spring between rods allows a larger step
    "constraint": ["contacts.plate.law=coulomb", "contacts.rods.tangential_ratio=5"],
    "spring": ["contacts.rods.tangential_ratio=5"],
    "appendix_a": [
        f"contacts.{pair}.{key}"
        for pair in ("plate", "rods")
        for key in ("law=appendix_a", "restitution=none")
    ],
}
FEW = 30  # isolated landings, below which their mean is not drawn


def _row(periods: int, law: str = "constraint", **changes: float) -> tuple[Census, md.Result]:
    """A row of 40; `changes` are keys of the scene with __ for the dot."""
    settings = [f"{key.replace('__', '.')}={value}" for key, value in changes.items()]
    return census(md.load("quasi2d", ["step.size=none", *LAWS[law], *settings]), periods)


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
    """Measures over tilt for each law, over Gamma, stiffness and restitution, with their errors."""
    periods = 40 if quick else 400
    sweeps = {
        **dict.fromkeys(LAWS, ("box__length", BOXES[1::2] if quick else BOXES)),
        "gamma": ("plate__acceleration", GAMMAS[::2] if quick else GAMMAS),
        "stiff": ("contacts__plate__stiffness", STIFFNESS[:2] if quick else STIFFNESS),
        "lossy": ("contacts__rods__restitution", RESTITUTIONS[::2] if quick else RESTITUTIONS),
    }
    found = {"reversal_tilt_deg": np.float64(reversal_tilt())}
    for sweep, (key, values) in sweeps.items():
        runs = []
        for value in values:
            changes = {key: value}
            if sweep == "stiff":
                changes["contacts__rods__stiffness"] = value
            runs.append(_row(periods, sweep if sweep in LAWS else "constraint", **changes))
        found[sweep] = np.array(values)
        found |= {f"{sweep}_{name}": pairs for name, pairs in _table(runs).items()}
    found["lone"] = np.array(LONE_STIFFNESS)
    return found | {f"lone_{name}": pairs for name, pairs in _lone(quick).items()}


def _curve(ax, x, pairs, colour, label=None, **kwargs) -> None:
    """Points with their errors, joined; `open=True` for hollow ones."""
    if kwargs.pop("open", False):
        kwargs |= {"mfc": "white", "mew": 0.7, "ls": "--"}
    kwargs = {"marker": "o", "ms": 3, "lw": 0.8, "elinewidth": 0.6, **kwargs}
    ax.errorbar(x, pairs[..., 0], pairs[..., 1], color=colour, label=label, **kwargs)


SHARE = {"ylabel": "share of landings", "ylim": (0, 1.5), "yticks": np.arange(0, 1.1, 0.25)}
ABOVE = {"loc": "upper center", "ncols": 2, "fontsize": 6, "columnspacing": 0.8}
ABOVE |= {"handlelength": 1.4, "handletextpad": 0.5, "borderaxespad": 0.2}
OPEN = ("allowed for", "o", "white")


def _draw_regimes(ax, d) -> None:
    x = d["constraint_tilt"][:, 0]
    _curve(ax, x, d["constraint_stick"], BLACK, "slip-stick", marker="s")
    _curve(ax, x, d["constraint_reversal"], RED, "slip reversal", marker="^")
    _curve(ax, x, d["constraint_slide"], BLUE, "slide")
    _curve(ax, x, d["constraint_slide_number"], BLUE, "slide, by number", open=True)
    ax.set(**SHARE)
    ax.legend(**ABOVE)


def _draw_company(ax, d) -> None:
    x = d["constraint_tilt"][:, 0]
    _curve(ax, x, d["constraint_shared"], BLACK, "pushed")
    _curve(ax, x, d["constraint_shared_number"], BLACK, "by number", open=True)
    _curve(ax, x, d["constraint_disturbed"], BLUE, f"kicked > {DISTURBED:.0%}", marker="s")
    x = d["appendix_a_tilt"][:, 0]
    _curve(ax, x, d["appendix_a_shared"], ORANGE, "Appendix A", marker="^")
    ax.set(**SHARE)
    ax.legend(**ABOVE)


def _draw_residual(ax, d) -> None:
    for law, colour in zip(LAWS, (BLACK, GREEN, ORANGE), strict=True):
        tilt, some = d[f"{law}_tilt"][:, 0], d[f"{law}_isolated_count"] >= FEW
        _curve(ax, tilt, d[f"{law}_pushed_residual"], colour, marker="s")
        _curve(ax, tilt[some], d[f"{law}_isolated_residual"][some], colour)
        _curve(ax, tilt[some], d[f"{law}_isolated_allowed"][some], colour, open=True)
        ax.plot([], [], color=colour, label=law.replace("_a", " A").replace("app", "App"))
    for label, marker, fill in (("pushed", "s", "0.4"), ("isolated", "o", "0.4"), OPEN):
        ax.plot([], [], ls="", marker=marker, ms=3, mec="0.4", mfc=fill, label=label)
    ax.set(ylabel="error / change", yscale="log", ylim=(1e-6, 100))
    ax.legend(**ABOVE)


def _draw_shares(ax, d, sweep: str) -> None:
    """Shares of landings and errors over what a sweep changes."""
    x = d[sweep]
    _curve(ax, x, d[f"{sweep}_shared"], GREEN, "pushed", marker="^")
    _curve(ax, x, d[f"{sweep}_slide"], BLUE, "slide")
    _curve(ax, x, d[f"{sweep}_slide_number"], BLUE, "slide, by number", open=True)
    _curve(ax, x, d[f"{sweep}_pushed_residual"], BLACK, "error, pushed", marker="s")
    _curve(ax, x, d[f"{sweep}_isolated_residual"], BLACK, "error, isolated")
    ax.set(**SHARE)
    ax.set(ylabel="share; error / change", ylim=(0, 1.75))
    ax.legend(**ABOVE)


def _draw_gamma(ax, d) -> None:
    _draw_shares(ax, d, "gamma")
    ax.set(xlabel=r"$\Gamma$", xlim=(1, 5.2), xticks=range(1, 6))


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


def _draw_lossy(ax, d) -> None:
    _draw_shares(ax, d, "lossy")
    ax.set(xlabel="restitution between rods", xlim=(0.2, 1.05))


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.6))
    panels = (
        _draw_regimes,
        _draw_company,
        _draw_residual,
        _draw_gamma,
        _draw_duration,
        _draw_lossy,
    )
    titles = (
        *(rf"regimes, $\Gamma={GAMMA:g}$", "not alone", "error of the map"),
        *("driving", "soft to stiff", "losses between rods"),
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
    if not np.isfinite(error):  # a run too short to tell it, or nothing to tell of
        return f"{value:.3g}" if np.isfinite(value) else "-"
    digits = min(max(-math.floor(math.log10(error)), 0), 4) if error > 0 else 0
    return f"{value:.{digits}f} ±{error:.{digits}f}"


def summary(d: dict[str, np.ndarray]) -> str:
    """Tables in percent, with standard errors."""
    lines = ["percent; #: each landing alike, else weighted by its change of (c_x, c_z, k omega)"]
    for title, columns in TABLES.items():
        lines.append(f"{title}\n{'sweep':10}{'':>6}{'tilt':>6}")
        lines[-1] += "".join(f"{head:>16}" for head in columns.values())
        for sweep in (*LAWS, "gamma", "stiff", "lossy"):
            for i, x in enumerate(d[sweep]):
                cells = "".join(f"{_text(d[f'{sweep}_{name}'][i]):>16}" for name in columns)
                lines.append(f"{sweep:10}{x:6.4g}{d[f'{sweep}_tilt'][i, 0]:6.1f}{cells}")
    lines.append("lone rods: contact, error, allowed for, agreement #, allowed for #")
    wanted = ("duration", "residual", "allowed", "agree_number", "agree_allowed_number")
    for i, stiffness in enumerate(d["lone"]):
        cells = "".join(f"{_text(d[f'lone_{name}'][i]):>16}" for name in wanted)
        lines.append(f"k_n ={stiffness:6.0e}{'':9}{cells}")
    return "\n".join(lines)
