"""Commands of the figures and their files: what is kept, printed, and never replaced."""

import shutil

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose, assert_array_equal

import figures
from figures.lib import data as kept
from figures.lib import drawing, runs
from figures.lib.printing import printed
from figures.paper import fig10
from impact._generated import DIGEST

from .command_line import ROOT, enter, names_in
from .quick_figures import tiny

# Files


def test_a_drawn_figure_is_three_files(tmp_path):
    out = tmp_path / "new" / "folder"
    said = f"{out}/fig10.png  fig10.pdf  fig10.npz\n"
    assert enter("figures draw fig10 --quick --out", out) == (said, "")
    assert names_in(out) == {"fig10.npz", "fig10.png", "fig10.pdf"}
    made = kept.made(out / "fig10.npz")
    assert (made["impact"], made["numpy"], made["quick"]) == (DIGEST, np.__version__, True)


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [(KeyboardInterrupt(), 130, "interrupted"), (OSError(28, "No space left"), 2, "No space left")],
)
def test_what_ends_a_drawing_leaves_nothing_half_written(tmp_path, monkeypatch, error, code, words):
    def ended(self, path, **_):
        path.write_bytes(b"half a picture")
        raise error

    monkeypatch.setattr(Figure, "savefig", ended)
    said = enter("figures draw fig10 --quick --out", tmp_path, code=code).err
    assert words in said
    assert said.count("\n") == 1
    assert names_in(tmp_path) == {"fig10.npz"}


def test_a_figure_that_fails_leaves_the_others(tmp_path, monkeypatch):
    """In this process and in others; a mistake of ours is told with its traceback."""
    for name, alone in (("unknown_to_others", False), ("without_module", True)):
        monkeypatch.setitem(figures.FIGURES, name, figures.Entry("paper", "", alone=alone))
    drawn = "figures draw unknown_to_others without_module fig10 --quick --jobs 2 --out"
    printed = enter(drawn, tmp_path, code=1)
    assert "unknown_to_others failed: there is no figure" in printed.err
    assert "without_module failed: Traceback" in printed.err
    assert printed.err.endswith("failed: unknown_to_others, without_module\n")
    assert printed.out.count(".png") == 1
    assert {path.stem for path in tmp_path.iterdir()} == {"fig10"}


# Data that are kept


def test_data_in_a_folder_are_read_if_of_this_size_and_these_sources(tmp_path, monkeypatch):
    kept.keep(tmp_path / "fig10.npz", "fig10", True, fig10.data(quick=True))
    monkeypatch.setattr(fig10, "data", lambda quick: {"computed": quick})
    assert "provenance" not in kept.figure_data("fig10", True, tmp_path)
    assert kept.figure_data("fig10", False, tmp_path) == {"computed": False}
    for elsewhere in (tmp_path / "other", None):
        assert kept.figure_data("fig10", True, elsewhere) == {"computed": True}
    np.savez(tmp_path / "fig11.npz", tilt=np.zeros(2))
    assert kept.stored_data("fig11", True, tmp_path) is None
    monkeypatch.setattr(kept, "sources", lambda name: "others")
    assert kept.figure_data("fig10", True, tmp_path) == {"computed": True}


def test_sources_are_those_that_decide(tmp_path, monkeypatch):
    """An edit of a number counts where it is used; words and other figures do not."""
    for folder in ("derivations", "figures", "impact", "md"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.setattr(kept, "_HOUSE", tmp_path)

    def digest(name="fig10"):
        kept._digest.cache_clear()
        return kept.sources(name)

    for name, counts in {
        "figures/paper/fig10.py": True,
        "figures/lib/style.py": True,
        "impact/boundaries.py": True,
        "figures/paper/fig11.py": False,
    }.items():
        before, path = digest(), tmp_path / name
        text = path.read_text()
        path.write_text('"""Other words."""\n' + text.split('"""', 2)[2] + "# and a remark\n")
        assert digest() == before
        path.write_text(f"{text}\nANOTHER = 1\n")
        assert (digest() != before) == counts
    for name, table in {
        "two_codes": "checks/two_codes.toml",
        "any_rods": "claims/claims.toml",
    }.items():
        module = tmp_path / f"figures/checks/{name}.py"
        module.write_text('"""Other words."""\n' + module.read_text().split('"""', 2)[2])
        before, path = digest(name), tmp_path / "figures" / table
        path.write_text(path.read_text() + "# another run\n")
        assert digest(name) != before
    before = [digest(name) for name in ("fig10", "fig11")]
    formulas = tmp_path / "derivations/drift.py"
    formulas.write_text(f"{formulas.read_text()}\nANOTHER = 1\n")
    after = [digest(name) for name in ("fig10", "fig11")]
    assert np.equal(before, after).tolist() == [True, False]  # Fig. 11 draws one of them


def test_quick_pictures_say_so_and_full_ones_do_not(tmp_path, monkeypatch):
    """Computed, or drawn from data that a folder keeps."""
    written = []

    def savefig(self, path, **_):
        path.touch()
        written.append(self.get_supxlabel())

    monkeypatch.setattr(Figure, "savefig", savefig)
    for quick in (True, False):
        drawing.produce("fig10", tmp_path, quick)
        drawing.produce("fig10", tmp_path, False, kept=tmp_path)
        assert ["quick" in words for words in written[-4:]] == 4 * [quick]
    drawing.produce("fig10", tmp_path, True, own={"friction": 0.2, "length": 3.0})
    drawing.produce("fig10", tmp_path, False, kept=tmp_path)
    assert all(words.endswith("$); quick; values not the paper's") for words in written[-4:])


@pytest.mark.parametrize("name", ["fig10", "fig11"])
def test_a_figure_is_drawn_from_the_data_of_a_folder(tmp_path, name):
    """Of whatever sources; nothing is computed, the data are not written again."""
    out, data = tmp_path / "out", tmp_path / f"{name}.npz"
    np.savez(data, **figures.load(name).data(quick=True))
    enter(f"figures draw {name} --data", tmp_path, "--out", out)
    assert names_in(out) == {f"{name}.png", f"{name}.pdf"}
    for others in (lambda: data.write_bytes(b"no data"), lambda: np.savez(data, mine=1.0)):
        others()
        said = enter(f"figures draw {name} --data", tmp_path, "--out", out, code=2).err
        assert f"{name}.npz holds no data of {name}" in said


# Runs


def of_start(scene, periods):
    """A measure that needs no run."""
    return {"seeds": [scene.start.seed, periods], "half": scene.start.seed / 2}


def test_a_measure_is_stored_by_its_sources(tmp_path):
    axes = [{"start.seed": [1, 2]}]
    with tiny() as patch:
        patch.setattr(runs, "STORE", tmp_path / "rows.db")
        plan = runs.planned(axes, 3, measure=of_start)
        seeds, half = runs.gathered(plan, "seeds", "half")
        patch.setattr(runs, "sources_of", lambda _: "others")
        others = runs.planned(axes, 3, measure=of_start), runs.planned(axes, 3)
    assert_array_equal(seeds, [[1, 3], [2, 3]])
    assert_array_equal(half, [0.5, 1])
    assert len({point.key for sweep in (plan, *others) for point in sweep.points}) == 6


def test_the_larger_error_of_runs_counts():
    """Between the runs where they differ, within them where they agree or some are missing."""
    mean = np.array([[1.0, 3.0], [2.0, 2.0], [2.0, np.nan]])
    within = np.array([[0.5, 0.5], [0.5, 0.5], [0.1, np.nan]])
    _, error = runs.larger_error(mean, within)
    assert_allclose(error, [1.0, 0.5 / np.sqrt(2), 0.1])


# What is printed


def test_numbers_are_printed_with_their_errors():
    """Arrays of one length abreast, a column for each place of other axes; large ones in sum."""
    text = printed(
        {
            "law": np.array(["a", "b"]),
            "x": np.array([[1.25, 2], [3, np.nan]]),
            "x_error": np.array([[0.125, 0.5], [1, np.nan]]),
            "n": np.int64(7),
            "map": np.arange(900.0).reshape(30, 30),
        }
    )
    assert text.splitlines() == [
        "map: 30 x 30 values, 0 to 899",
        "law         x[0]       x[1]",
        "  a  1.25 ± 0.12      3 ± 1",
        "  b      2 ± 0.5  nan ± nan",
        "n",
        "7",
    ]
