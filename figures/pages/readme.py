"""Parts of the README that are measured, made of `gallery/claims.json` and `gallery/prices.json`.

>>> from figures.pages import readme
>>> text = readme.TARGET.read_text(encoding="utf-8")
>>> readme.refreshed(text) == text
True

A part stands between `<!-- name: begin -->` and `<!-- name: end -->`; `python -m figures readme`
writes all of them anew. What is derived is in `derivations/EQUATIONS.md`.
"""

import json
import re
from pathlib import Path
from typing import Any

from derivations.equations_page import table

from ..claims.verdicts import GRADES, counts, judged_rows, restored, shown
from ..cost.effect_prices import plus_minus
from ..cost.price_page import CHECKED

GALLERY = Path(__file__).resolve().parents[1] / "gallery"
TARGET = GALLERY.parents[1] / "README.md"
RUNGS = {  # of the ladder, and what they are called here
    "(24), $V_0/2$": "closed form (24), plate velocity at landing taken as V_0/2",
    "3000 landings": "one rigid rod that bounces at fixed tilt, 3000 landings",
    "3 periods": "the row of 40, 3 periods, 36 steps a contact",
    "30 periods": "the same, 30 periods",
    "$t_c/36$": "the same, 400 periods",
    "$t_c/18$": "18 steps a contact instead",
    "$k_n=5\\cdot10^5$": "contacts ten times softer",
    "$k_n=5\\cdot10^3$": "contacts a thousand times softer",
    "$N=10$": "10 rods instead of 40",
    "App. A": "Appendix A as printed instead of a restitution of 0.65",
}


def _time(seconds: float) -> str:
    """With two digits, in a unit that suits."""
    units = (("s", 1.0), ("ms", 1e-3), ("microseconds", 1e-6), ("ns", 1e-9))
    unit, size = next((one for one in units if seconds >= one[1]), units[-1])
    value = seconds / size
    return f"{value:.{1 if value < 10 else 0}f} {unit}"


def costs(prices: dict[str, Any], _: dict[str, Any]) -> str:
    """What an answer to one question costs, and one impact."""
    ladder = {rung["label"]: rung for rung in prices["ladder"]}
    rows = []
    for label, name in RUNGS.items():
        rung = ladder[label]
        off = f"{100 * rung['deviation']:+.1f} ± {100 * rung['error']:.1f} %"
        scatter = f"{100 * rung['scatter']:.1f} %" if rung["scatter"] else ""
        rows.append((name, _time(rung["seconds"]), off, scatter))
    run, ns = prices["tolerance"][-1], prices["impact_ns"]
    worst = max(max(law["largest"]) for law in prices["impact_ulp"])
    return "\n".join(
        [
            table(("drift of the paper's row, Fig. 3(b)", "takes", "off by", "scatter"), rows),
            "",
            "Off by: mean over independent starts and its standard error; scatter: of one start. "
            f"`--tolerance {run['tolerance']:g}` chose {run['per_contact']:.0f} steps a contact "
            f"and {run['periods']:.0f} periods, and took {_time(run['seconds'])}; it was off by "
            f"{100 * run['error']:.2g} %. One rigid impact takes {ns['numpy newton']:.0f} ns by "
            f"NumPy, {ns['compiled newton']:.0f} ns compiled; the largest error of {CHECKED:,}"
            f" random ones is {worst:.1f} units in the last place of what cancels.",
            "",
            f"({prices['machine']})",
        ]
    )


def effects(prices: dict[str, Any], _: dict[str, Any]) -> str:
    """What each effect costs, and what leaving it out does."""
    rows = [
        (row["name"], plus_minus(*row["alone"]), plus_minus(*row["within"]), row["drift"])
        for row in prices["effects"]
    ]
    plane, lifted, around = (kernel["ns"][0] for kernel in prices["kernels"])
    header = "effect", "alone", "in the full scene", "change of the drift (cm/s)"
    cores, (value, error) = prices["cores"][-1], prices["drift_cm_s"]
    return "\n".join(
        [
            f"Nanoseconds a step of a rod; all together {plus_minus(*prices['full'])}, a rod that"
            f" only flies {plus_minus(*prices['bare'])}; drift {value:.2f} ± {error:.2f}"
            " cm/s.",
            "",
            table(header, rows),
            "",
            f"Motion in space takes {lifted / plane:.1f} times as long for the same rods "
            f"({plane:.0f} and {lifted:.0f} ns), each of 44 rods in the annulus {around:.0f} ns. "
            f"{cores['count']} cores do {cores['gain']:.2f} times the work of one.",
        ]
    )


def claims(_: dict[str, Any], report: dict[str, Any]) -> str:
    """Counts of the verdicts, and those claims that hold and that do not."""
    rows = []
    for verdict in (GRADES[0], GRADES[2]):
        for claim in report["claims"]:
            if claim["verdict"] == verdict:
                found = (f"{row['name']}: {shown(row)}" for row in judged_rows(claim))
                rows.append((f"{claim['id']} {verdict}", claim["says"], "; ".join(found)))
    judged = table(("claim", "the paper says", "measured"), rows)
    rest = "Those that hold in part are on the page."
    return f"**{counts(report)}**\n\n{judged}\n\n{rest}"


FINDINGS = """\
- **The impact map is right where it applies.** One soft impact with friction as a constraint has
  the regime of the closed forms at {S15.coulomb_regimes} of 17 tilts; a landing in the row that no
  other rod pushes follows the map to {S22.map_isolated} of its change.
- **Landings are short, not isolated**: {S22.contact} of a period, but {S22.pushed} of them are
  pushed by a neighbour meanwhile; with these the map is off by {S22.map} of the change. Landings do
  slide through: {S21.weighted} of them, weighted by the change they make, at the tilt of Fig. 3(b).
- **The drift is {S16.peak} of the theory's** at its largest, at {S16.peak_tilt}, not
  {S16.peak_theory}, and there is no bump. In theory it stays finite as friction goes to zero; in
  the row it does too, but takes ever longer to come about.
- **Appendix A as printed** gives a restitution of {S1.mean}, {S1.head_on} head on, not 0.65 to 0.7,
  and {S15.printed_regimes} regimes of 17. With it rows sink, and drift backwards where they lean
  most.
- **Flights shorten at {S13.change}**, half of the tilt claimed, and {S13.sharp} of the change
  happens between 25 and 35 degrees.
- **Reverse drift near Gamma = 1 is there**, without walls at {E2.points} points of the map of
  Fig. 2, up to Gamma = {E2.end}, at most {E2.slower} of the forward drift; in the annulus
  at {E2.ring_back} point. Its sign is not that of the plate's mean velocity at landing:
  {E2.follows} of the drifts up to 1.6 have that sign without walls, {E2.ring_follows} in the
  annulus.
- **Rolling does ease the slowdown** that the paper sees between 18 and 35 degrees in the annulus
  and puts down to the rotation it left out: rods that roll are {S20.faster} times as fast there.
  Without rolling the dip is {S20.still_dip} of the maxima, with it {S20.dip}.
- **A single rod with one flat end** can lean by {E1.flat} in the experiment's annulus, a round one
  by {E1.round}; 23 rods lean by {E1.steepest}, 56 by {E1.most}. Walls with friction of 0.3 slow
  rods {S6.paper} times.
"""


def findings(_: dict[str, Any], report: dict[str, Any]) -> str:
    """What simulations say of the theory, in words."""
    values = {
        f"{claim['id']}.{row['key']}": shown(row)
        for claim in report["claims"]
        for row in claim["numbers"]
    }
    return re.sub(r"\{([\w.]+)\}", lambda found: values[found[1]], FINDINGS).rstrip()


def filled(text: str, name: str, content: str) -> str:
    """`text` with `content` between the markers of that name.

    Raises
    ------
    ValueError
        If it does not hold both.
    """
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    before, _, rest = text.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise ValueError(f"{TARGET.name} must hold {begin} and {end}")
    return f"{before}{begin}\n{content}\n{end}{after}"


PARTS = {"costs": costs, "effects": effects, "claims": claims, "findings": findings}


def refreshed(text: str) -> str:
    """`text` with all parts as the files of the gallery have them."""
    prices = json.loads((GALLERY / "prices.json").read_text(encoding="utf-8"))
    report = restored(json.loads((GALLERY / "claims.json").read_text(encoding="utf-8")))
    for name, part in PARTS.items():
        text = filled(text, name, part(prices, report))
    return text
