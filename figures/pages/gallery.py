"""Pages of the gallery and measured parts of the README, from claims.json and prices.json there.

>>> from figures.pages import gallery
>>> all(path.read_text(encoding="utf-8") == text for path, text in gallery.pages().items())
True

The words stand in `templates/`; a word that depends on a number is chosen there by a rule. A part
of the README stands between `<!-- name: begin -->` and `<!-- name: end -->`.
"""

import json
import re
from functools import cache
from math import isfinite
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from impact import InputError
from md.host import STEPS_PER_CONTACT

from .. import load
from ..claims import judge
from ..claims.limits import ONE_STATE_DEG, Record
from ..cost.effect_prices import plus_minus
from ..cost.price_page import CHECKED

GALLERY = Path(__file__).resolve().parents[1] / "gallery"
README = GALLERY.parents[1] / "README.md"
PARTS = "costs", "effects", "findings"  # of the README


def _time(seconds: float) -> str:
    """A time with two digits, in a unit that suits."""
    units = (("s", 1.0), ("ms", 1e-3), ("microseconds", 1e-6), ("ns", 1e-9))
    unit, size = next((one for one in units if seconds >= one[1]), units[-1])
    value = seconds / size
    return f"{value:.{1 if value < 10 else 0}f} {unit}"


@cache
def _runs_of(figure: str, quick: bool) -> list[str]:
    """Starts and periods of each sweep of a figure, in words."""
    module = load(figure)
    sweeps = module.sweeps(quick) if hasattr(module, "sweeps") else {}
    found = []
    for name, sweep in sweeps.items():
        starts = {point.scene.start.seed for point in sweep.points}
        found.append(f"{name} {len(starts)} x {sweep.points[0].periods}")
    return found


templates = Environment(
    loader=PackageLoader("figures.pages"),
    autoescape=lambda name: bool(name and name.endswith(".html")),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)
templates.filters |= {"time": _time, "shown": judge.shown, "limits": judge.limits_shown}
templates.globals |= {
    "judge": judge,
    "one_state_deg": ONE_STATE_DEG,
    "checked": CHECKED,
    "pm": plus_minus,
    "runs_of": _runs_of,
}


def claims_page(report: Record) -> str:
    """The verdicts as a page: a table, then a section for each claim."""
    from ..claims import any_rods  # late: it compiles
    from ..lib import runs

    quick = report["provenance"]["quick"]
    return templates.get_template("claims.md.jinja").render(
        report=report,
        law=runs.LAW_NAME,
        assumed=runs.ASSUMED_NAME,
        starts=len(runs.SEEDS["start.seed"]),
        periods=runs.periods_of(quick),
        kinds_deg=any_rods.TILTS_DEG[quick],
        kinds_periods=any_rods.PERIODS[quick],
    )


def pages() -> dict[Path, str]:
    """Files that are made of the gallery's numbers, the README among them, with their texts.

    Raises
    ------
    ValueError
        If the README lacks the markers of a part.
    """
    prices = json.loads((GALLERY / "prices.json").read_text(encoding="utf-8"))
    report = judge.load(GALLERY / "claims.json")
    numbers = {name: _short(row) for name, row in judge.numbers(report).items()}
    ladder = {rung["label"]: rung for rung in prices["ladder"]}
    given = {
        "prices": prices,
        "report": report,
        "number": numbers,
        "ladder": ladder,
        "plain": f"$t_c/{STEPS_PER_CONTACT}$",  # the row at the usual step
    }
    made = {GALLERY / "claims.md": claims_page(report)}
    for name in ("costs.md", "effects.md"):
        made[GALLERY / name] = templates.get_template(f"{name}.jinja").render(given)
    text = README.read_text(encoding="utf-8")
    for name in PARTS:
        part = templates.get_template(f"readme_{name}.md.jinja").render(given)
        text = _filled(text, name, part.strip())
    return made | {README: text}


def _short(row: Record) -> str:
    """A number to two digits, or three if it would else pass for a whole one; degrees to one."""
    value = row["value"]
    if not isfinite(value):
        return judge.shown(row)
    if row.get("unit") == "deg":
        return f"{value:.0f} degrees"
    short = f"{value:.2g}"
    return f"{value:.3g}" if float(short) == round(value) != value else short


def _filled(text: str, name: str, content: str) -> str:
    """`text` with `content` between the markers of that name."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    made, found = re.subn(
        f"{begin}.*?{end}", lambda _: f"{begin}\n{content}\n{end}", text, count=1, flags=re.DOTALL
    )
    if not found:
        raise InputError(f"{README.name} must hold {begin} and {end}")
    return made
