"""The search over contact laws: its laws are scenes that run, its score counts what is fitted."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest

from figures.__main__ import main
from figures.checks import law_strips, which_law
from figures.claims import across_laws, over_laws
from figures.claims.over_laws import FITTED, JUDGED
from figures.lib import runs
from figures.lib.data import kept_data
from figures.pages import gallery
from md.host import step_of
from md.laws import STIFFNESS, appendix_a, constant_restitution

LAWS, BEST = 32, 10


@pytest.fixture(scope="module")
def made():
    """Made-up numbers of a few laws: the first holds all, the last nothing."""
    random = np.random.default_rng(3)

    def of(laws, tilts):
        grades = random.integers(0, 2, (laws, len(JUDGED))).astype(float)
        grades[0], grades[-1] = 2, 0
        return {
            "value": random.random((laws, len(JUDGED))),
            "grade": grades,
            "score": over_laws.score_of(grades),
            "spread": np.full(laws, 0.5),
            "nominal": np.linspace(9, 60, tilts),
            "theory": np.linspace(12, 3, tilts),
            "c_x": random.random((laws, tilts)),
            "c_x_error": np.full((laws, tilts), 0.1),
            "tilt_off": np.linspace(0, 6, laws),
        }

    parts = replace(over_laws.search(), points=LAWS).draw()
    best = {f"best_{name}": values for name, values in of(BEST + 2, 13).items()}
    made = {"parts": parts, **of(LAWS, 7), **best, "best": np.arange(BEST)[::-1]}
    made["round"] = np.zeros(LAWS, int)
    return {**made, "best_parts": parts[: BEST + 2], "best_step": np.ones(BEST + 2)}


def test_every_law_is_a_scene_that_runs_with_a_resolved_spring():
    whole = over_laws.search()
    given = replace(whole, points=16, seeds=(1,), targets=whole.targets[-1:])
    parts = given.draw()
    for row, point in zip(parts, given.sweep(parts).points, strict=True):
        values, plate = given.values(row), point.scene.contacts.plate
        assert step_of(point.scene)[0] > 0  # refused, if the step does not resolve the contact
        assert not point.scene.step.coarse
        if values["form"] == over_laws.CONSTANT:
            assert plate.law.restitution == values["restitution, plate"]
        else:
            assert plate.law.name == "appendix_a"
            assert plate.law.spring.proportional == 95 * plate.law.normal.stiffness  # as printed
            damped = plate.law.normal.constant if values["overlap factor"] == "without" else None
            assert (damped is not None) == (values["overlap factor"] == "without")


def test_the_best_are_run_with_half_the_step_and_rounded_values():
    given = over_laws.search(quick=True)
    parts = given.draw()
    laws = over_laws.laws_of(parts)
    rounded = over_laws.laws_of(np.array([over_laws.rounded(law) for law in laws]))
    for law, exact in zip(rounded, laws, strict=True):
        assert law.keys() == exact.keys()
        for name, value in law.items():
            if isinstance(value, float):
                assert value == pytest.approx(float(f"{value:.2g}"), rel=1e-12)
                assert value == pytest.approx(exact[name], rel=0.06)
    before = given.sweep(parts).points[0].scene
    after = over_laws.confirming(parts, quick=True).points[0].scene
    assert after.step.size == pytest.approx(step_of(before)[0] / 2)
    assert after.start.seed not in given.seeds
    assert after.contacts == before.contacts


def test_the_best_are_run_at_the_tilts_of_the_figures():
    """From four starts, none of which the search has."""
    given = over_laws.search()
    points = over_laws.confirming(given.draw()[:1]).points
    deg = np.degrees([point.scene.tilt for point in points]).reshape(-1, 4)
    assert deg[:, 0] == pytest.approx(runs.tilts(False), abs=2e-3)  # rods start a millionth apart
    starts = {point.scene.start.seed for point in points}
    assert len(starts) == 4
    assert starts.isdisjoint(given.seeds)


def test_a_second_round_lies_between_the_best_of_one_form():
    """With the choices of the best one; laws of the other form that are as good have no part."""
    given = replace(over_laws.search(), points=8)
    parts = replace(given, points=LAWS).draw()
    laws, at = over_laws.laws_of(parts), 3  # restitution of the plate
    constant = np.array([law["form"] == over_laws.CONSTANT for law in laws])
    score = np.where(constant, parts[:, at], 0.99 * parts[:, at].max())
    score[np.argmax(np.where(constant, score, 0))] = 1
    near = over_laws.closer(given, parts, score)
    assert near.shape == (8, parts.shape[1])
    assert {law["form"] for law in over_laws.laws_of(near)} == {over_laws.CONSTANT}
    best = np.sort(parts[constant, at])[-over_laws.BEST :]
    assert (near[:, at] >= best[0]).all()
    assert (near[:, at] <= best[-1]).all()
    score = np.where(constant, 0, 1.0)
    score[chosen := int(np.argmax(score))] = 2
    for law in over_laws.laws_of(over_laws.closer(given, parts, score)):
        assert all(law[name] == laws[chosen][name] for name in ("form", "overlap factor", "mass"))


def test_laws_known_without_search_are_those_of_their_names():
    known = np.array([over_laws.rounded(law) for law in over_laws.KNOWN.values()])
    one, printed = (over_laws.search().sweep(row[None]).points[0].scene.contacts for row in known)
    assert one.plate.law == one.rods.law
    assert one.plate.law.spring.root == pytest.approx(3 * STIFFNESS, rel=1e-12)
    assert one.plate.law.normal == constant_restitution(0.65).normal
    assert printed.plate.law == printed.rods.law == appendix_a()


def test_the_score_counts_the_fitted_claims_alone(made):
    held_out = {name.partition(".")[0] for name in np.array(list(JUDGED))[~FITTED]}
    assert {"S2", "S3"} <= held_out
    assert made["score"][0] == FITTED.sum() < len(JUDGED)
    assert made["score"][-1] == 0
    changed = np.where(FITTED, made["grade"], 0)
    assert np.array_equal(over_laws.score_of(changed), made["score"])
    assert (over_laws.score_of(np.full_like(changed, np.nan)) == 0).all()


def test_of_equal_laws_the_cheapest_is_singled_out(made):
    score = np.full(BEST + 2, 5.0)
    score[[1, 4, 7]] = 9.8, 10.0, 9.4
    step = np.ones(BEST + 2)
    step[[0, 1, 7]] = 4, 2, 3
    d = {**made, "best_score": score, "best_step": step}
    assert over_laws.singled_out(d) == 1  # within 0.5 of the best one, of larger steps
    assert over_laws.as_good(d).tolist() == [1, 4]
    told = over_laws.outcome(d)
    assert (told["best"], told["score"], told["as_good"]) == (10, 9.8, 2)
    assert told["next"] == [9.8, 0.5]


def test_numbers_that_exclude_each_other_are_told(made):
    """If they never hold together, and by chance would: under eight of 32 laws."""
    grades = np.zeros_like(made["grade"])
    grades[:16, 0] = grades[16:, 1] = grades[16:, 2] = grades[:15, 3] = 2
    first, second, third, *_ = JUDGED
    found = across_laws.excluded({**made, "grade": grades})
    assert found == [(first, second, 8), (first, third, 8)]
    grades[0, 1] = 2
    found = across_laws.excluded({**made, "grade": grades})
    assert found == [(first, third, 8)]


def test_what_a_number_follows_is_told_with_the_values_where_it_holds(made):
    """Among laws of constant restitution that keep the tilt, which here are all of that form."""
    laws = over_laws.laws_of(made["parts"])
    constant = np.array([law["form"] == over_laws.CONSTANT for law in laws])
    rods = np.array([float(law.get("restitution, rods", np.nan)) for law in laws])
    d = {key: made[key].copy() for key in ("parts", "round", "value", "grade", "tilt_off")}
    d["tilt_off"][:] = np.where(constant, 0, 9)
    d["value"][:, 0], d["value"][:, 1] = -rods, np.random.default_rng(4).random(LAWS)
    d["grade"][:, 0] = np.where(rods > 0.7, 2, 1)
    of_all = across_laws.numbers(d)
    assert constant.sum() < across_laws.FEW  # too few
    assert all(of["follows"] is None for of in of_all.values())
    d = {key: np.concatenate([x, x]) for key, x in d.items()}
    first, second, *_ = across_laws.numbers(d).values()
    high = rods[rods > 0.7]
    assert first["counts"] == [2 * len(high), 2 * (constant.sum() - len(high)), 0]
    assert first["follows"] == {
        "parameter": "restitution, rods",
        "rank": pytest.approx(-1),
        "middle": pytest.approx(np.percentile(np.concatenate([high, high]), [25, 75])),
    }
    assert second["follows"] is None  # it follows none
    d["grade"][:, 0] = 1
    assert next(iter(across_laws.numbers(d).values()))["follows"]["middle"] == []
    half = constant.sum(), len(constant)
    assert across_laws.forms(d)[over_laws.CONSTANT] == [2 * half[0]] * 2
    assert across_laws.forms(d)[over_laws.APPENDIX] == [0, 2 * (half[1] - half[0])]


def test_drift_over_that_of_the_theory_is_told_on_both_sides_of_30_degrees(made):
    lean = made["best_nominal"] > 30
    d = {**made, "best_score": np.arange(BEST + 2.0)}
    chosen = over_laws.singled_out(d)
    assert chosen == BEST + 1
    ratio = np.where(lean, 2.0, 0.5)
    ratio[[0, -1]] = 0.25, 3
    drift = made["best_c_x"].copy()
    drift[chosen] = ratio * made["best_theory"]
    few = {"c_x": np.where(made["nominal"] > 30, 0.75, 0.5) * made["theory"] * np.ones((LAWS, 1))}
    found = across_laws.over_theory({**d, **few, "best_c_x": drift})
    assert found["law"] == pytest.approx([0.25, 0.5, 2, 3])
    assert found["laws"] == pytest.approx([0.5, 0.75])


def test_the_picture_shows_the_best_law_first(made):
    figure = which_law.draw(made)
    labels = [text.get_text() for ax in figure.axes for text in ax.get_yticklabels()]
    assert sum("/" in label for label in labels) == BEST
    assert set(over_laws.KNOWN) < set(labels)
    assert len(figure.axes) == 12
    plt.close(figure)


def test_strips_hold_every_law_and_mark_the_best(made):
    figure = law_strips.draw(made)
    shown = [ax for ax in figure.axes if ax.lines]
    assert len(shown) == over_laws.HEADED.sum()
    assert all(sum(len(line.get_xdata()) for line in ax.lines) == LAWS + 2 for ax in shown)
    heads = {row.get("head", "").replace("\n", " "): j for j, row in enumerate(JUDGED.values())}
    for ax in shown:
        j = next(j for head, j in heads.items() if head and ax.get_ylabel().endswith(f" {head}"))
        confirmed, searched = (line.get_xdata()[0] for line in ax.lines[-2:])
        low, high = ax.get_xlim()
        chosen = over_laws.singled_out(made)
        assert confirmed == np.clip(made["best_value"][chosen, j], low, high)
        assert searched == np.clip(made["value"][made["best"][chosen], j], low, high)
    plt.close(figure)


def test_the_laws_of_the_figures_are_singled_out_and_another_confirmed_one():
    d = kept_data("which_law", gallery.GALLERY)
    found = over_laws.laws_of(d["best_parts"])
    first, second = (
        {
            "form": over_laws.CONSTANT,
            **{
                f"{option.replace('_', ' ')}, {part}": pytest.approx(value)
                for option, pair in of.items()
                for part, value in zip(runs.PARTS, pair, strict=True)
            },
        }
        for of in (runs.LAW_OF, runs.SECOND_OF)
    )
    assert found[over_laws.singled_out(d)] == first
    assert second in found


def test_the_kept_search_is_confirmed_as_the_code_asks():
    d, given = kept_data("which_law", gallery.GALLERY), over_laws.CONFIRMED[False]
    np.testing.assert_array_equal(d["best_nominal"], given["tilts"])
    assert len(d["best"]) == given["best"]
    assert len(d["best_parts"]) == given["best"] + len(over_laws.KNOWN)


def test_the_search_of_the_gallery_is_drawn(tmp_path, capsys):
    command = ["draw", "which_law", "law_strips", "--data", str(gallery.GALLERY)]
    assert main([*command, "--numbers", "--out", str(tmp_path)]) == 0
    assert "parts: 320 x 13 values" in capsys.readouterr().out
    assert (gallery.GALLERY / "which_law.npz").stat().st_size < 500_000
