"""Pages: the page of sliders, README and guide, the movie."""

import json
import math
import re
import shutil
import sys
from dataclasses import asdict
from pathlib import Path
from unittest.mock import patch
from urllib.parse import parse_qsl

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from PIL import Image

import impact
import md
from figures.pages import gallery, movie
from figures.pages.explore import CHOICES, RANGES, ROWS, WORDS, Setting

from .command_line import DOCS, ROOT, called, enter, names_in
from .page import Page, stands_alone
from .test_help import ALL

# The page of sliders

NODE = shutil.which("node")
RODS = {"thin": impact.thin_rod, "round": impact.spherocylinder, "flat": impact.flat_ended_rod}
START = asdict(Setting())
CHANGES = [
    {},
    {"shape": "thin"},
    {"shape": "flat", "tilt_deg": 4.0, "friction": 0.05},
    {"law": "poisson"},
    {"law": "stronge", "restitution": 0.3, "ratio": 6.0},
    {"friction": 0.0},
    {"length": 1.0},
    {"tilt_deg": 0.0, "restitution": 1.0},
    {"shape": "thin", "restitution": 1.0, "ratio": 10.0, "friction": 0.6},
    {"ratio": 0.4, "tilt_deg": 60.5},
    {"spin": -1.5},
    {"spin": 2.0, "ratio": 0.2, "tilt_deg": 80.0},  # no impact
]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "new" / "here.html"
    enter("figures explore --html", path)
    assert names_in(path.parent) == {"here.html"}
    return path


def check(changes, shown):
    """Numbers and words of the page, against calls of `impact`."""
    s = START | changes
    tilt, size = math.radians(s["tilt_deg"]), math.hypot(1, s["ratio"])
    rod = RODS[s["shape"]](tilt, s["length"])
    before = 1 / size, -s["ratio"] / size, s["spin"] / rod.k
    losses = {name: s[name] for name in ("friction", "restitution")}
    hit = impact.collide(*before, geometry=rod, **losses, law=s["law"])
    slip, fall = before[0] - before[2] * rod.Z, before[1] + before[2] * rod.X
    after = hit.c_x, hit.c_z, hit.omega * rod.k, hit.slip_velocity, hit.normal_velocity
    expected = {"before": (*before[:2], s["spin"], slip, fall), "after": after, "now": after}
    for column, values in expected.items():
        read = [shown[f"{name}-{column}"].replace("\N{MINUS SIGN}", "-") for name in ROWS]
        assert [*map(float, read)] == pytest.approx(values, abs=5.1e-4)
    words = shown["words"]
    assert words.startswith(WORDS[hit.regime])
    lost = -200 * hit.energy_change / (1 + s["spin"] ** 2)
    if hit.regime > 0:
        (part,) = re.findall(r"([\d.]+) % of the energy", words)
        assert float(part) == pytest.approx(abs(lost), abs=0.051)
        assert ("GAINED" in words) == (lost < -0.05)
    critical = impact.critical_friction(rod)
    assert float(re.search(r"friction (\d\.\d+)", words)[1]) == pytest.approx(critical, abs=5.1e-4)
    c_x = impact.drift(rod, **losses).c_x
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
    script = Path(__file__).with_name("browser.js")
    done = called(NODE, script, path, json.dumps(CHANGES), timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    address, *lines, played, keys = map(json.loads, done.stdout.splitlines())
    assert address == [4, START["tilt_deg"]]  # of nonsense nothing is taken
    assert keys == [START["tilt_deg"] + 0.5, START["friction"] - 0.01, False, True]
    assert played[:6] == [0, "Pause", 0.5, "Pause", 1, "Play"]
    phases, slips, falls = zip(*played[6:], strict=True)
    assert len({*phases}) == 6
    assert slips[1] == slips[0] != slips[2] == falls[3] == "0.000"
    for changes, shown in zip(CHANGES, lines, strict=True):
        check(changes, shown)
        for name in ("rod", "plane", "map", "drift"):
            assert shown[name].startswith("<")
            assert not re.search("NaN|undefined|Infinity", shown[name])
        assert dict(parse_qsl(shown["hash"].strip("#"))) == {
            name: f"{value:g}" if name in RANGES else value for name, value in changes.items()
        }
    heard = " ".join(shown["words"] for shown in lines)
    ends = "GAINED", "not determined", "without bound", "Drift: none", "leans.", "against the way"
    assert all(text in heard for text in (*WORDS.values(), *ends))


def test_every_control_is_labelled_and_has_its_range(path):
    source = path.read_text("utf-8")
    labelled = re.findall(r'<label(?:[^>]* for|><input [^>]*id)="([^"]+)"', source)
    inputs = re.findall("<input ([^>]*)>", source)
    assert len(inputs) == 2 * len(RANGES) + sum(map(len, CHOICES.values())) + 1
    for one in (dict(re.findall(r'([\w-]+)="([^"]*)"', given)) for given in inputs):
        assert one["id"] in labelled or {*one} & {"aria-label", "aria-labelledby"}
        if (name := one["id"].removesuffix("-number")) in RANGES:
            assert (float(one["min"]), float(one["max"])) == RANGES[name][:2]
    stands_alone(source, Page(source), scripts=True)


def test_the_options_are_the_start(tmp_path):
    path = tmp_path / "a.html"
    lowest = {name: low for name, (low, *_) in RANGES.items()}
    given = lowest | {"shape": "flat", "law": "stronge"}
    words = [f"--{name.replace('_', '-')}={value}" for name, value in given.items()]
    enter("figures explore --html", path, *words)
    start = json.loads(re.search(r"const PAGE = (.*);\n", path.read_text())[1])["start"]
    assert start == given


# README and guide

TEXT = (ROOT / "README.md").read_text("utf-8")
GUIDE = "\n".join(page.read_text("utf-8") for page in sorted(DOCS.glob("*.md")))
EXAMPLES = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", TEXT, re.DOTALL)
SCRIPTS = re.findall(r"```python\n(.*?)```", GUIDE, re.DOTALL)
COMMANDS, LONGER = (
    re.findall(r"^    python -m (.*?)(?: {2,}#.*)?$", text, re.M) for text in (TEXT, GUIDE)
)
# The third needs what the first leaves; tests of claims and of one's own rods run others in small.
SLOW = ("sweep", "search", "results", "claims", "draw")


def test_the_readme_is_short_and_measures_nothing_itself():
    """No times, percentages or errors but those of generated parts and outputs of examples."""
    assert len(TEXT.splitlines()) <= 150
    assert len(TEXT.split()) <= 1500
    text = re.sub(r"<!-- (\w+): begin -->.*?<!-- \1: end -->", "", TEXT + GUIDE, flags=re.DOTALL)
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    found = re.findall(r"\d[\d.]*(?:e-?\d+)? ?(?:%|ns|ms|s|microseconds|cm/s)(?![\w/])|±.*", text)
    assert set(found) <= {"5 %"}  # of an example
    assert len(EXAMPLES) == len(re.findall("```python", TEXT)) == 3
    assert len(SCRIPTS) == 8
    assert len(COMMANDS) > 2


@pytest.mark.parametrize("code, output", EXAMPLES)  # noqa: PT006
def test_examples_print_what_stands_below(code, output, capsys):
    """To the letter; a simulated number, which rounding may change, within four of its errors."""
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    if "+-" not in output:
        assert printed == output
        return
    (now, error, *_), (then, before, *_) = (re.findall(r"[\d.]+", t) for t in (printed, output))
    assert abs(float(now) - float(then)) <= 4 * max(float(error), float(before))
    assert float(now) > 3 * float(error) > 0


@pytest.mark.parametrize("code", SCRIPTS)
def test_scripts_of_the_guide_run(code, here, monkeypatch):
    """In an empty folder, short; a law that one adds is gone behind it."""
    monkeypatch.setitem(sys.modules, "distributed", None)  # an extra that no script needs
    with patch.dict(md.LAWS):
        exec(compile(code.replace("130", "5"), "the guide", "exec"), {})


@pytest.mark.parametrize("command", [c for c in COMMANDS if not set(SLOW) & set(c.split())])
def test_commands_run(command, here):
    assert enter(command).out


def test_longer_commands_run(here):
    for command in (one for one in LONGER if "--scheduler" not in one):
        test_commands_run(command, here)
    assert len((here / "drift.csv").read_text().splitlines()) == 22


def test_commands_and_targets_that_are_named_exist():
    named = set(re.findall(r"python -m (\w+) (\w+)", TEXT + GUIDE))
    assert len(named) > 8
    assert named <= {tuple(name.split()) for name in ALL}
    for target in re.findall(r"(?:^    |`)make (\w+)", TEXT + GUIDE, re.M):
        assert called("make", "-n", target, cwd=ROOT).returncode == 0


LINKED = [ROOT / "README.md", *sorted(gallery.GALLERY.glob("*.md")), *sorted(DOCS.rglob("*.md"))]


@pytest.mark.parametrize("page", LINKED)
def test_links_lead_somewhere(page):
    text = page.read_text("utf-8")
    for target, label in re.findall(r"\]\((?!http)([^)#]*)(?:#([^)]+))?\)", text):
        other = (page.parent / target).resolve() if target else page
        assert other.is_file()
        if label:
            heads = re.findall(r"^#+ (.*)$", other.read_text("utf-8").lower(), re.M)
            assert label in [re.sub(r"[^\w -]", "", head).replace(" ", "-") for head in heads]


def test_the_citation_is_that_of_the_file():
    """BibTeX in the guide has the values of CITATION.cff, and no other."""
    cff = (ROOT / "CITATION.cff").read_text("utf-8")
    names = "title|name|family-names|given-names|journal|volume|start|version|date-released|year"
    values = re.findall(rf'^ *(?:- )?({names}): "?(.+?)"?$', cff, re.M)
    expected = {value[:4] if name == "date-released" else value for name, value in values}
    (entries,) = re.findall(r"```bibtex\n(.*?)```", GUIDE, re.DOTALL)
    found = re.findall(r"= \{+(.+?)\}+,", entries)
    authors = [part for name in found[0].split(" and ") for part in name.split(", ")]
    assert {*authors, *found[1:]} == expected


def test_hard_cases_are_where_it_says():
    """The files hold tests of the names that the table gives them."""
    found = set()
    for names, file in re.findall(r"\[([TM]\d[TM\d, -]*)\]\(../../../(tests/\w+\.py)\)", GUIDE):
        numbers = [int(number) for number in re.findall(r"\d+", names)]
        if "-" in names:
            numbers = range(numbers[0], numbers[1] + 1)
        text = (ROOT / file).read_text("utf-8")
        for number in numbers:
            name = f"{names[0]}{number}"
            assert re.search(rf"\b(test_)?{name.lower()}_|\b{name}\b", text)
            found.add(name)
    assert len(found) > 20


# The movie


@pytest.fixture(scope="module")
def film():
    """Fast rods in a short box: each of them passes its end."""
    settings = """
        rods.count=5 box.length=7 step.size=none plate.acceleration=8
        contacts.plate.tangential_ratio=5 contacts.rods.tangential_ratio=5
    """
    return movie.record(md.load("quasi2d", settings.split()), periods=45, frames=2)


def test_film_is_the_run(film):
    """The same rods as a run without a film leaves, and none below the plate."""
    rods, at = md.run(film.scene, periods=29).rods, np.flatnonzero(film.time == 29)[0]
    assert_array_equal(film.x[at], rods[:, 0])
    assert_array_equal(film.z[at], rods[:, 1])
    assert_allclose(np.tan(film.tilt[at]), rods[:, 2] / rods[:, 3])
    assert np.all(film.tips.min(axis=1) > film.plate - 0.02)


def test_picture_shows_each_rod_where_it_is(film):
    """Images fill the box; lengths are true; the trail does not cross the picture."""
    picture = movie.Picture(film)
    picture.show(80)
    axes, number = movie.segments(film, 80 * film.every)
    picture.figure.canvas.draw()
    trail = picture.trail.get_segments()
    assert_allclose(picture.rods.get_segments(), axes)
    assert_allclose(np.linalg.norm(axes[:, 1] - axes[:, 0], axis=1), 8.5)
    centres = axes.mean(axis=1)[:, 0]
    off = (centres - film.x[80 * film.every][number]) / 7
    assert_allclose(off, np.round(off), atol=1e-9)
    assert sorted(number[(centres >= 0) & (centres < 7)]) == [0, 1, 2, 3, 4]
    assert len(trail) > 1
    assert all(np.all(np.abs(np.diff(part[:, 0])) < 1) for part in trail)


def test_command_writes_a_gif_that_loops(tmp_path):
    out = tmp_path / "row.gif"
    command = (
        "figures movie quasi2d --set rods.count=4 --set box.length=5 --set step.size=4e-5"
        " --periods 3 --frames 4 --out"
    )
    assert enter(command, out) == (f"{out}  12 frames\n", "")
    with Image.open(out) as gif:
        assert (gif.n_frames, gif.info["loop"], gif.size[0]) == (12, 0, 600)
    assert names_in(tmp_path) == {"row.gif"}
