"""Fig. 5: rods in the annulus seen from above: the zig-zag, and where it breaks.

(a, b): a line from the lower to the upper cap's centre, with a dot at the upper one; colour: tilt;
circles: the walls. The paper shows 55 and 44 rods; an odd number cannot be a perfect zig-zag, and
56 rods have the tilt of the paper's 55. All start as a zig-zag. (c): order of the zig-zag (1
perfect, 0 none) and share of rods that lean `MORE_DEG` more than the mean; green: how much more the
place around the annulus that leans most does than the one that leans least, tilts smoothed over
three rods; each point a number of rods, means over the second half of a run. (d): tilts around the
annulus, over the rods in order of azimuth.
"""

import matplotlib.pyplot as plt
import numpy as np
from joblib import Parallel, delayed
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from md.host import prepare
from md.scene import Scene, from_tables, put

from ..lib import annulus_runs as ring
from ..lib.style import BLACK, BLUE, GREEN, RED, name_panel, style

SHOWN = (56, 44)  # numbers of rods of (a) and (b)
MORE_DEG = 3.0
FULL = (56, 54, 52, 50, 48, 46, 44, 42, 40, 36, 32), 400, (1, 2)
QUICK = (56, 54, 50, 44, 40), 40, (1, 2)
EVERY = 5  # periods from one look to the next
MEASURED = ("mean", "spread", "zigzag", "contrast", "share")


def looked_at(rods: np.ndarray) -> tuple[float, ...]:
    """What `MEASURED` names, of one state: tilts in degrees, orders and a share."""
    tilt = ring.tilts_deg(ring.in_order(rods))
    share = np.mean(tilt > tilt.mean() + MORE_DEG)
    return tilt.mean(), tilt.std(), ring.zigzag(rods), ring.contrast(tilt), float(share)


def watched(scene: Scene, periods: int) -> tuple[np.ndarray, np.ndarray]:
    """Rods at the end, and what is seen of them every few periods of a run."""
    engine, seen = prepare(scene), []
    for _ in range(periods // EVERY):
        engine.go(EVERY * engine.per)
        seen.append(looked_at(engine.rods))
    return engine.rods[:, :6].copy(), np.array(seen)


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Final states of the numbers shown, and measures (number of rods, seed, time, measure)."""
    counts, periods, seeds = QUICK if quick else FULL
    scenes = [
        from_tables(put(ring.BASE, {"rods.count": n, "start.seed": seed}))
        for n in counts
        for seed in seeds
    ]
    done = Parallel(n_jobs=-1)(delayed(watched)(scene, periods) for scene in scenes)
    series = np.array([seen for _, seen in done]).reshape(
        len(counts), len(seeds), -1, len(MEASURED)
    )
    late = series[:, :, series.shape[2] // 2 :].mean(axis=2)
    first = {n: done[i * len(seeds)][0] for i, n in enumerate(counts)}
    found = {
        name: late[..., i].mean(axis=1) for i, name in enumerate(MEASURED)
    }  # over time and seeds
    errors = {
        f"{name}_error": late[..., i].std(axis=1, ddof=1) / np.sqrt(len(seeds))
        for i, name in enumerate(MEASURED)
    }
    return {
        "count": np.array(counts),
        "time": EVERY * (1 + np.arange(series.shape[2])),
        "series": series,
        **{f"rods_{n}": first[n] for n in SHOWN},
        **found,
        **errors,
    }


def _from_above(ax: Axes, rods: np.ndarray, norm: plt.Normalize) -> LineCollection:
    gap, half = ring.SCENE.annulus, (ring.SCENE.rods.length - 1) / 2
    for radius in (gap.inner, gap.outer):
        ax.add_patch(plt.Circle((0, 0), radius, fill=False, color="0.5", lw=0.7))
    up = np.sign(rods[:, 5:6]) * half * rods[:, 3:5]
    ends = np.stack([rods[:, :2] - up, rods[:, :2] + up], axis=1)
    tilt = ring.tilts_deg(rods)
    lines = ax.add_collection(LineCollection(ends, array=tilt, cmap=TILTS, norm=norm, lw=1.6))
    ax.scatter(*ends[:, 1].T, c=tilt, cmap=TILTS, norm=norm, s=7, lw=0)
    edge = 1.04 * gap.outer
    ax.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal", xlabel="$x/d$", ylabel="$y/d$")
    return lines


TILTS = plt.get_cmap("viridis_r")


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, ((a, b), (c, e)) = plt.subplots(2, 2, figsize=(7.0, 5.6), height_ratios=(1.6, 1))
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.97))  # titles over panels of fixed aspect
    states = [d[f"rods_{n}"] for n in SHOWN]
    tilts = [ring.tilts_deg(ring.in_order(rods)) for rods in states]
    norm = plt.Normalize(0, np.ceil(max(tilt.max() for tilt in tilts) / 5) * 5)
    for ax, n, rods, tilt, letter in zip((a, b), SHOWN, states, tilts, "ab", strict=True):
        lines = _from_above(ax, rods, norm)
        name_panel(ax, letter, rf"$N={n}$, mean tilt {tilt.mean():.0f}°")
    figure.colorbar(lines, ax=[a, b], label=r"tilt $\phi$ (deg)", pad=0.02, aspect=30)
    looks = {
        "zigzag": ("o-", BLACK, "order of the zig-zag"),
        "share": ("^:", RED, f"share {MORE_DEG:g}° beyond the mean"),
        "contrast": ("s--", GREEN, "contrast of tilts"),
    }
    beside = c.twinx()
    for name, (form, colour, label) in looks.items():
        ax = beside if name == "contrast" else c
        bars = {"xerr": d["mean_error"], "yerr": d[f"{name}_error"], "elinewidth": 0.7}
        ax.errorbar(d["mean"], d[name], **bars, fmt=form, color=colour, label=label, ms=3, lw=0.8)
    c.axhline(0, color="0.7", lw=0.6)
    c.set(xlabel=r"mean tilt $\phi$ (deg)", ylabel="order, share", ylim=(-0.1, 1.7))
    beside.set_ylim(*np.array([-0.1, 1.7]) * 1.2 * d["contrast"].max())
    beside.set_ylabel("contrast (deg)", color=GREEN)
    beside.tick_params(colors=GREEN)
    handles = [part for ax in (c, beside) for part in ax.get_legend_handles_labels()[0]]
    c.legend(handles=handles, fontsize=6.5, loc="upper right")
    name_panel(c, "c")
    for n, tilt, colour in zip(SHOWN, tilts, (BLUE, BLACK), strict=True):
        e.plot(np.arange(n) / n, tilt, "o-", ms=2.5, lw=0.6, color=colour, label=rf"$N={n}$")
        e.axhline(tilt.mean(), color=colour, lw=0.6, ls=":")
    e.set(xlabel="place around the annulus", ylabel=r"tilt $\phi$ (deg)", xlim=(0, 1))
    e.set_ylim(0, 1.3 * max(tilt.max() for tilt in tilts))
    e.legend(fontsize=6.5, loc="upper right", ncols=2)
    name_panel(e, "d")
    figure.supxlabel(rf"$\Gamma={ring.GAMMA}$, {ring.SAID}", fontsize=6.5)
    return figure


def summary(d: dict[str, np.ndarray]) -> str:
    """Measures over the number of rods."""
    lines = ["Fig. 5. second half of the runs, +- one s.e. over seeds"]
    lines.append(f"rods: mean tilt and spread (deg), {', '.join(MEASURED[2:])}")
    for i, n in enumerate(d["count"]):
        cells = (f"{d[name][i]:7.3f} +- {d[f'{name}_error'][i]:.3f}" for name in MEASURED)
        lines.append(f"  {n:4d} " + " ".join(cells))
    return "\n".join(lines)
