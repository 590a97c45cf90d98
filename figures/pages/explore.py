"""Page of sliders: one impact as it goes on, its path of impulses, regimes, drift; one HTML file.

>>> from figures.pages import explore
>>> "<script" in explore.page(explore.Setting())
True

What an impact does is computed by the JavaScript that the derivations generate, as
`derivations.languages` writes it; `templates/explore.js` draws. The page asks nothing of the
network. The rod leans the way it moves. Drift is that of the paper's closure: Newton's restitution,
no landing slides through.
"""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from markupsafe import Markup

from derivations import languages, report
from derivations.lecture import to_html
from impact import InputError, Regime

from ..lib.style import REGIME_MAP, RESTITUTION_LAWS, SHAPES
from .gallery import templates

TITLE = "Rods on a vibrated plate: one impact, and the drift that follows"
ABOUT = (
    "A rod meets a plate: its contact point slips, stops, sticks or slips back. Move the sliders, "
    "play the impact, click the regimes."
)
WORDS = {
    Regime.NO_IMPACT: "No impact: the contact point moves away from the plate.",
    Regime.SLIDE: "Slide: the contact point slips until it leaves the plate.",
    Regime.SLIP_STICK: "Slip-stick: the contact point slips, stops, and friction holds it.",
    Regime.SLIP_REVERSAL: "Slip reversal: the contact point slips, stops, and slips back.",
}
RANGES = {  # ends of a slider, its name, its step
    "tilt_deg": (0, 90, r"tilt $\phi$ (deg)", 0.5),
    "friction": (0, 1, r"friction $\mu$", 0.01),
    "restitution": (0, 1, r"restitution $\epsilon$", 0.01),
    "ratio": (0.1, 10, r"approach $-c_z/c_x$", 0.1),
    "spin": (-2, 2, r"spin $k\,\omega$", 0.01),
    "length": (1, 20, "length $l/d$", 0.1),
}
CHOICES = {"shape": SHAPES, "law": {law: law.title() for law in RESTITUTION_LAWS}}
ROWS = {
    "c_x": "centre, along the plate $c_x$",
    "c_z": "centre, upwards $c_z$",
    "spin": r"spin $k\,\omega$",
    "u": "contact point, along $u$",
    "v": "contact point, upwards $v$",
}
# Ends of the drift's axis, so that it mostly stands still; without losses there is no bound.
STEPS = (0.05, 0.5, 1, 2, 4, 6, 10)


@dataclass(frozen=True, slots=True)
class Setting:
    """Values of the controls; the length of a thin rod changes nothing that is drawn."""

    tilt_deg: float = 30.0
    friction: float = 0.3
    restitution: float = 0.65
    ratio: float = 2.0
    spin: float = 0.0
    length: float = 8.0
    shape: str = "round"
    law: str = "newton"

    def __post_init__(self):
        for name, (low, high, *_) in RANGES.items():
            if not low <= (value := getattr(self, name)) <= high:
                raise InputError(f"{name} must be between {low:g} and {high:g}, got {value!r}")
        for name, choices in CHOICES.items():
            if (value := getattr(self, name)) not in choices:
                raise InputError(f"{name} must be one of {', '.join(choices)}, got {value!r}")


def page(start: Setting) -> str:
    """Return the page as HTML, its controls at `start`."""
    given = {
        "start": asdict(start),
        "ranges": {name: ends for name, (*ends, _, _) in RANGES.items()},
        "choices": CHOICES,
        "rows": ROWS,
        "steps": STEPS,
        "words": WORDS,
    }
    drawn = Path(__file__).with_name("templates") / "explore.js"
    main = templates.get_template("explore.html").render(
        ranges={
            name: (low, high, Markup(to_html(label)), step)
            for name, (low, high, label, step) in RANGES.items()
        },
        choices=CHOICES,
        rows={name: Markup(to_html(text)) for name, text in ROWS.items()},
        regimes=[WORDS[regime].partition(":")[0].lower() for regime in Regime if regime > 0],
        physics=Markup(languages.source("javascript")),
        page=Markup(json.dumps(given).replace("</", "<\\/")),
        script=Markup(drawn.read_text(encoding="utf-8")),
    )
    style = templates.get_template("explore.css").render(colours=REGIME_MAP.colors)
    return report.document(TITLE, ABOUT, main, style)
