"""Data of figures that a folder keeps: read if they are of the present sources, else not."""

import shutil
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import md
from figures.__main__ import main
from figures.lib import data as kept
from figures.lib import drawing, runs
from figures.paper import fig10

HOUSE = Path(__file__).parents[1]
PLACES = {  # files that decide the numbers of Fig. 10, and one that does not
    "figures/paper/fig10.py": True,
    "figures/lib/style.py": True,
    "impact/boundaries.py": True,
    "figures/paper/fig11.py": False,
}


@pytest.fixture
def stored(tmp_path, monkeypatch):
    """A folder with the data of Fig. 10."""
    kept.keep(tmp_path / "fig10.npz", "fig10", True, fig10.data(quick=True))
    monkeypatch.setattr(fig10, "data", lambda quick: {"computed": quick})
    return tmp_path


def test_data_in_the_folder_are_read(stored):
    found = kept.figure_data("fig10", True, stored)
    assert found["regime"].shape == (3, 46, 46)
    assert "provenance" not in found


def test_other_sizes_sources_and_folders_are_computed(stored, tmp_path, monkeypatch):
    assert kept.figure_data("fig10", False, stored) == {"computed": False}
    assert kept.figure_data("fig10", True, tmp_path / "other") == {"computed": True}
    assert kept.figure_data("fig10", True) == {"computed": True}
    np.savez(tmp_path / "fig11.npz", tilt=np.zeros(2))
    assert kept.stored_data("fig11", True, tmp_path) is None
    monkeypatch.setattr(kept, "sources", lambda name: "others")
    assert kept.figure_data("fig10", True, stored) == {"computed": True}


def test_sources_are_those_that_decide(tmp_path, monkeypatch):
    """An edit of a number counts where it is used; words and other figures do not."""
    for folder in ("figures", "impact", "md"):
        shutil.copytree(HOUSE / folder, tmp_path / folder)
    monkeypatch.setattr(kept, "_HOUSE", tmp_path)

    def digest():
        kept._digest.cache_clear()
        return kept.sources("fig10")

    before = digest()
    for name, counts in PLACES.items():
        path = tmp_path / name
        text = path.read_text()
        path.write_text('"""Other words."""\n' + text.split('"""', 2)[2] + "# and a remark\n")
        assert digest() == before, name
        path.write_text(text + "\nANOTHER = 1\n")
        assert (digest() != before) == counts, name
        path.write_text(text)
    kept._digest.cache_clear()


def of_start(scene: md.Scene, periods: int) -> dict:
    """A measure that needs no run."""
    return {"seeds": [scene.start.seed, periods], "half": scene.start.seed / 2}


def test_a_measure_is_stored_by_its_sources(monkeypatch, tmp_path):
    monkeypatch.setattr(runs, "STORE", tmp_path / "rows.db")
    plan = runs.planned([{"start.seed": [1, 2]}], 3, measure=of_start)
    seeds, half = runs.gathered(plan, "seeds", "half")
    np.testing.assert_array_equal(seeds, [[1, 3], [2, 3]])
    np.testing.assert_array_equal(half, [0.5, 1])
    keys = [point.key for point in plan.points]
    assert len({*keys, *(point.key for point in runs.planned(plan.axes, 3).points)}) == 4
    monkeypatch.setattr(runs, "sources_of", lambda _: "others")
    again = runs.planned([{"start.seed": [1, 2]}], 3, measure=of_start)
    assert not {point.key for point in again.points} & {*keys}


def test_quick_pictures_say_so_and_full_ones_do_not(stored, tmp_path, monkeypatch):
    """Computed, or drawn from data that are kept."""
    said = []
    monkeypatch.setattr(
        Figure, "savefig", lambda self, path, **_: said.append({t.get_text() for t in self.texts})
    )
    monkeypatch.setattr(drawing, "replacing", nullcontext)
    monkeypatch.setattr(drawing, "keep", lambda *_: None)
    whole = kept.kept_data("fig10", stored)
    monkeypatch.setattr(fig10, "data", lambda quick: whole)
    kept.keep(tmp_path / "full.npz", "fig10", False, whole)
    (tmp_path / "full").mkdir()
    (tmp_path / "full.npz").rename(tmp_path / "full" / "fig10.npz")
    for quick, folder in ((True, None), (True, stored), (False, None), (False, tmp_path / "full")):
        drawing.produce("fig10", tmp_path, quick, folder)
        assert ["quick" in texts for texts in said[-2:]] == [quick, quick]


def test_a_figure_is_drawn_from_the_data_of_a_folder(stored, tmp_path, capsys):
    """Of whatever sources; nothing is computed, the data are not written again."""
    out = tmp_path / "out"
    assert main(["draw", "fig10", "--data", str(stored), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {"fig10.png", "fig10.pdf"}
    assert main(["draw", "fig10", "--data", str(out)]) == 2
    assert "--data must be a folder that holds fig10.npz" in capsys.readouterr().err
