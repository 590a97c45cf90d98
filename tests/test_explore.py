"""The page of sliders: whole in one file, labelled, and its numbers are those of `impact`."""

import json
import math
import re
import shutil
import subprocess
from dataclasses import asdict
from html import unescape
from pathlib import Path

import pytest

import impact
from derivations import languages
from figures.__main__ import main
from figures.pages.explore import CHOICES, RANGES, ROWS, WORDS, Setting

from .page import Page, stands_alone

NODE = shutil.which("node")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
RODS = {"thin": impact.thin_rod, "round": impact.spherocylinder, "flat": impact.flat_ended_rod}
START = asdict(Setting())
CHANGES = [
    {},
    {"tilt_deg": 71.5},
    {"friction": 0.62},
    {"restitution": 0.9},
    {"ratio": 0.4},
    {"length": 2.5},
    {"shape": "thin"},
    {"shape": "flat", "tilt_deg": 4.0, "friction": 0.05},
    {"law": "poisson"},
    {"law": "stronge", "restitution": 0.3, "ratio": 6.0},
    {"friction": 0.0},
    {"length": 1.0},
    {"tilt_deg": 0.0, "restitution": 1.0},
    {"shape": "thin", "restitution": 1.0, "ratio": 10.0, "friction": 0.6},
    {"ratio": 0.4, "tilt_deg": 60.0},
    {"spin": -1.5},
    {"spin": 2.0, "ratio": 0.2, "tilt_deg": 80.0},  # no impact
]
PHASES = (
    "Before: the rod comes to the plate.",
    "Compression: the contact point slips to the right.",
    "Compression: the contact point stands.",
    "Largest compression: the contact point slips back to the left.",
    "Restitution: the contact point slips back to the left.",
    "After: the rod leaves the plate.",
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "new" / "here.html"
    assert main(["explore", "--html", str(path)]) == 0
    assert [other.name for other in path.parent.iterdir()] == ["here.html"]
    return path


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-"))


def check(changes: dict, shown: dict[str, str]) -> None:
    """Numbers and words of the page, against calls of `impact`."""
    s = START | changes
    tilt, size = math.radians(s["tilt_deg"]), math.hypot(1, s["ratio"])
    rod = RODS[s["shape"]](tilt, s["length"])
    before = 1 / size, -s["ratio"] / size, s["spin"] / rod.k
    losses = {name: s[name] for name in ("friction", "restitution", "law")}
    hit = impact.collide(*before, geometry=rod, **losses)
    slip, fall = before[0] - before[2] * rod.Z, before[1] + before[2] * rod.X
    expected = {"before": (*before[:2], s["spin"], slip, fall)}
    after = hit.c_x, hit.c_z, hit.omega * rod.k, hit.slip_velocity, hit.normal_velocity
    expected |= {"after": after, "now": after}
    for column, values in expected.items():
        for name, value in zip(ROWS, values, strict=True):
            assert number(shown[f"{name}-{column}"]) == pytest.approx(value, abs=5.1e-4), name
    words = shown["words"]
    assert words.startswith(WORDS[hit.regime])
    lost = -200 * hit.energy_change / (1 + s["spin"] ** 2)
    if hit.regime > 0:
        assert float(re.search(r"([\d.]+) % of the energy", words)[1]) == pytest.approx(
            abs(lost), abs=0.051
        )
        assert ("GAINED" in words) == (lost < -0.05)
    critical = impact.critical_friction(rod)
    assert float(re.search(r"friction (\d\.\d+)", words)[1]) == pytest.approx(critical, abs=5.1e-4)
    c_x = impact.drift(rod, friction=s["friction"], restitution=s["restitution"]).c_x
    way = "the way the rod leans" if c_x > 0 else "against the way the rod leans"
    if math.isnan(c_x):
        drifts = "not determined without friction"
    elif math.isinf(c_x):
        drifts = f"without bound, {way}"
    else:
        drifts = f"{abs(c_x):.3f} of the plate’s velocity, {way}" if abs(c_x) >= 5e-4 else "none"
    assert words.endswith(f"Drift: {drifts}.")


@pytest.mark.skipif(not NODE, reason="no node to run the script")
def test_a_slider_shows_what_impact_says(path):
    words = [NODE, str(Path(__file__).with_name("browser.js")), str(path), json.dumps(CHANGES)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    *lines, played, keys = map(json.loads, done.stdout.splitlines())
    assert keys == [START["tilt_deg"] + 0.5, START["friction"] - 0.01, False, True]
    assert played[:6] == [0, "Pause", 0.5, "Pause", 1, "Play"]
    phases, slips, falls = zip(*played[6:], strict=True)
    assert phases == PHASES
    assert slips[1] == slips[0] != slips[2] == falls[3] == "0.000"
    for changes, shown in zip(CHANGES, lines, strict=True):
        check(changes, shown)
        pictures = [shown[name] for name in ("rod", "plane", "map", "drift")]
        assert not re.search("NaN|undefined|Infinity", "".join(pictures))
        assert all(picture.startswith("<") for picture in pictures)
        told = dict(part.split("=") for part in shown["hash"].strip("#").split("&") if part)
        assert told == {
            name: f"{value:g}" if name in RANGES else value for name, value in changes.items()
        }
    heard = " ".join(shown["words"] for shown in lines)
    ends = "GAINED", "not determined", "without bound", "Drift: none", "leans.", "against the way"
    assert all(text in heard for text in (*WORDS.values(), *ends))


@pytest.mark.skipif(not CHROMIUM, reason="no Chromium")
@pytest.mark.parametrize("changes", CHANGES[:3], ids=str)
def test_a_browser_shows_the_setting_of_the_address(changes, path, tmp_path):
    address = path.as_uri() + "#" + "&".join(f"{name}={value}" for name, value in changes.items())
    options = "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path}"
    words = [CHROMIUM, *options, "--force-prefers-reduced-motion", "--dump-dom", address]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    found = re.findall(r'<(?:td|p) id="([\w-]+)"[^>]*>([^<]*)<', done.stdout)
    shown = {name: unescape(text) for name, text in found}
    assert shown["phase"]
    shown |= {f"{name}-now": shown[f"{name}-after"] for name in ROWS}
    check(changes, shown)


def test_it_is_whole_in_one_file(path):
    source = path.read_text(encoding="utf-8")
    assert languages.source("javascript") in source
    assert not re.search(r"\bsrc=|\bfetch\(|XMLHttp|import[ (]\W", source)
    page = Page(source)
    assert page.links == page.images == []
    stands_alone(source, page, scripts=True)


def test_every_control_is_labelled_and_has_its_range(path):
    source = path.read_text(encoding="utf-8")
    labelled = set(re.findall(r'<label[^>]* for="([^"]+)"', source))
    labelled |= set(re.findall(r'<label><input [^>]*id="([^"]+)"', source))
    inputs = [
        dict(re.findall(r'([\w-]+)="([^"]*)"', one))
        for one in re.findall("<input ([^>]*)>", source)
    ]
    assert len(inputs) == 2 * len(RANGES) + sum(map(len, CHOICES.values())) + 1
    for one in inputs:
        by = one.get("aria-labelledby")
        assert one["id"] in labelled or one.get("aria-label") or f'id="{by}"' in source
        name = one["id"].removesuffix("-number")
        if name in RANGES:
            assert (float(one["min"]), float(one["max"])) == RANGES[name][:2]
    assert all(re.findall(r"<button[^>]*>([^<]*)</button>", source))
    assert "prefers-reduced-motion" in source


def test_the_options_are_the_start(tmp_path):
    path = tmp_path / "a.html"
    given = START | {name: low for name, (low, *_) in RANGES.items()} | {"shape": "flat"}
    given["law"] = "stronge"
    words = [f"--{name.replace('_', '-')}={value}" for name, value in given.items()]
    assert main(["explore", *words, "--html", str(path)]) == 0
    start = json.loads(re.search(r"const PAGE = (.*);\n", path.read_text())[1])["start"]
    assert start == given
