"""The site's pages, without Sphinx, which `make docs` alone needs: it takes warnings for errors."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from .command_line import ROOT
from .test_documentation import PUBLIC

DOCS = ROOT / "figures/pages/docs"
NOTEBOOKS = {page.stem: page for page in (DOCS / "notebooks").glob("*.md")}


def cells(page: Path) -> list[str]:
    """Code of a notebook, cell by cell."""
    return re.findall(r"```\{code-cell\}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def test_every_page_is_in_a_table_of_contents():
    listed = ["index"]
    for table in re.findall(
        r"```\{toctree\}\n(.*?)```", (DOCS / "index.md").read_text(), re.DOTALL
    ):
        listed += [line for line in table.splitlines() if line and not line.startswith(":")]
    pages = [path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")]
    assert sorted(listed) == sorted(pages)


def test_the_reference_has_every_public_module():
    text = "".join(page.read_text(encoding="utf-8") for page in (DOCS / "api").iterdir())
    assert sorted(re.findall(r"automodule:: (\S+)", text)) == sorted(PUBLIC)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_cells_compile(name):
    assert len(NOTEBOOKS) == 5
    found = cells(NOTEBOOKS[name])
    assert len(found) > 3
    for cell in found:
        compile(cell, name, "exec")


@pytest.mark.parametrize("name", ["impact", "derivation"])
def test_cheap_notebooks_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    try:
        for cell in cells(NOTEBOOKS[name]):
            exec(compile(cell, name, "exec"), names)
        assert plt.get_fignums()
    finally:
        plt.close("all")
