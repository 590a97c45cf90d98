"""Page of sliders: one impact as it goes on, its path of impulses, regimes, drift; one HTML file.

>>> from figures.pages import explore, explore_page
>>> "<script" in explore_page.page(explore.Setting())
True

What an impact does is computed by the JavaScript that the derivations generate, as
`derivations.languages` writes it; `templates/explore.js` draws. The page asks nothing of the
network. Rod, ranges and words are those of `explore`; a rod may come with spin as well.
"""

import json
from dataclasses import asdict
from pathlib import Path

from markupsafe import Markup

from derivations import languages, report
from derivations.sentences import to_html

from ..lib.style import REGIME_MAP
from .explore import CHOICES, RANGES, STEPS, WORDS, Setting
from .gallery import templates

TITLE = "Rods on a vibrated plate: one impact, and the drift that follows"
ABOUT = (
    "A rod meets a plate: its contact point slips, stops, sticks or slips back. Move the sliders, "
    "play the impact, click the regimes."
)
SPIN = {"spin": (-2, 2, r"spin $k\,\omega$", "%.2f")}
STEPS_OF_SLIDERS = {"tilt_deg": 0.5, "ratio": 0.1, "length": 0.1}  # else 0.01
ROWS = {
    "c_x": "centre, along the plate $c_x$",
    "c_z": "centre, upwards $c_z$",
    "spin": r"spin $k\,\omega$",
    "u": "contact point, along $u$",
    "v": "contact point, upwards $v$",
}
NO_IMPACT = "No impact: the contact point moves away from the plate."


def page(start: Setting) -> str:
    """Return the page as HTML, its controls at `start`."""
    ranges = RANGES | SPIN
    given = {
        "start": asdict(start) | {"spin": 0.0},
        "ranges": {name: ends for name, (*ends, _, _) in ranges.items()},
        "choices": CHOICES,
        "rows": ROWS,
        "steps": STEPS.tolist(),
        "words": {regime.value: text for regime, text in WORDS.items()} | {0: NO_IMPACT},
    }
    drawn = Path(__file__).with_name("templates") / "explore.js"
    main = templates.get_template("explore.html").render(
        ranges={
            name: (low, high, Markup(to_html(label)), STEPS_OF_SLIDERS.get(name, 0.01))
            for name, (low, high, label, _) in ranges.items()
        },
        choices=CHOICES,
        rows={name: Markup(to_html(text)) for name, text in ROWS.items()},
        regimes=[text.partition(":")[0].lower() for text in WORDS.values()],
        physics=Markup(languages.source("javascript")),
        page=Markup(json.dumps(given).replace("</", "<\\/")),
        script=Markup(drawn.read_text(encoding="utf-8")),
    )
    style = templates.get_template("explore.css").render(colours=REGIME_MAP.colors)
    return report.document(TITLE, ABOUT, main, style)
