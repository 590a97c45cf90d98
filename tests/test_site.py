"""The site's pages, without Sphinx, which `make docs` alone needs: it takes warnings for errors."""

import re

import matplotlib.pyplot as plt
import pytest

import figures
import md

from .command_line import DOCS
from .test_documentation import PUBLIC

NOTEBOOKS = {page.stem: page for page in (DOCS / "notebooks").glob("*.md")}


def cells(name):
    """Code of a notebook, cell by cell."""
    return re.findall(r"(?s)```\{code-cell\}\n(.*?)```", NOTEBOOKS[name].read_text("utf-8"))


def test_every_page_is_in_a_table_of_contents():
    tables = re.findall(r"(?s)```\{toctree\}\n(.*?)```", (DOCS / "index.md").read_text("utf-8"))
    listed = re.findall(r"(?m)^[^:\n].*", "".join(tables))
    pages = [path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")]
    assert sorted(["index", *listed]) == sorted(pages)


def test_the_reference_has_every_public_module():
    text = "".join(page.read_text("utf-8") for page in (DOCS / "api").iterdir())
    assert sorted(re.findall(r"automodule:: (\S+)", text)) == sorted(PUBLIC)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_cells_compile(name):
    assert len(NOTEBOOKS) == 5
    found = cells(name)
    assert len(found) > 3
    for cell in found:
        compile(cell, name, "exec")


@pytest.mark.parametrize("name", ["impact", "derivation"])
def test_cheap_notebooks_run(name, here):
    names = {}
    for cell in cells(name):
        exec(cell, names)
    assert plt.get_fignums()


def test_a_notebook_shows_a_picture_once(monkeypatch):
    """It is the value of the cell: an open figure would be shown again at its end."""
    fig11 = figures.load("fig11")
    d = fig11.data(quick=True)
    assert plt.fignum_exists(fig11.draw(d).number)
    plt.close("all")
    monkeypatch.setattr(plt, "get_backend", lambda: "inline")
    assert fig11.draw(d).axes
    assert not plt.get_fignums()


def test_a_notebook_shows_a_scene_and_a_sweep_as_the_command_prints_them():
    """They are one line as the value of a name, several as a text."""
    scene = md.load("annulus")
    assert repr(scene).startswith("<Scene: rods 44 of 5.08 by 0.635 cm, between cylinders")
    sweep = md.sweep.expand({"scene": "single_rod", "axes": [{"start.seed": [1, 2]}]})
    assert str(sweep) == "2 points\nstart.seed = [1, 2]"
    for thing in (scene, sweep):
        assert "\n" not in repr(thing)
        assert len(str(thing).splitlines()) == 2
        assert thing._repr_html_() == f"<pre>{thing}</pre>"
