"""Searches: parameters are found again within their errors, and the file of a search is read."""

import json
from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
from numpy.random import default_rng

from md import sweep
from md.__main__ import search_text
from md.domains import InputError, RunError
from md.scene import put, read_tables
from md.search import _draws, expand, search

from .command_line import enter

TRUE = {"friction": 0.3, "restitution": 0.65}
ERROR = 0.05
BOXES = 41.0, 43.0, 46.0, 50.0
PARAMETERS = [
    {
        "name": part,
        "keys": [f"contacts.plate.{part}", f"contacts.rods.{part}"],
        "from": low,
        "to": high,
    }
    for part, low, high in (("friction", 0.1, 0.6), ("restitution", 0.4, 0.95))
]
BASE = put(read_tables("quasi2d"), {"contacts.rods.restitution": 0.5})


def drift(friction, restitution, box):
    """A drift that depends on both in a smooth way, unlike at different boxes."""
    return 3 + 8 * friction * (box - 38) / 5 + 6 * restitution**2 - 4 * friction * restitution


def made_run(point):
    """What a run would store: the drift, with a scatter of its own for each start."""
    contact, box = point.scene.contacts.plate, point.scene.box.length
    scatter = default_rng([point.scene.start.seed, int(1e6 * contact.friction)])
    value = drift(contact.friction, contact.law.restitution, box)
    return {"c_x_cm_s": scatter.normal(value, 0.03), "periods": point.periods}


def tables(folder, friction=TRUE["friction"], error=ERROR, **changes):
    """A search with data of the formula."""
    truth = TRUE | {"friction": friction}
    rows = [f"{box},{drift(**truth, box=box):.6f},{error}" for box in BOXES]
    lines = ["box.length,c_x_cm_s,error", *rows, "60,,"]
    (folder / "drift.csv").write_text("\n".join(lines) + "\n")
    data = {"file": "drift.csv", "result": "c_x_cm_s"}
    return {"parameters": PARAMETERS, "data": data, "points": 16, "rounds": 2} | changes


def searched(folder, base=BASE, measure=made_run, **given):
    """The search of these `tables` in a folder, by made-up runs."""
    asked = expand(tables(folder, **given), base, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "_of_run", measure)
        return search(asked, folder / "runs.db", workers=1)


ONE = {"parameters": PARAMETERS[:1], "points": 8}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("search")


@pytest.fixture(scope="module")
def found(folder):
    return searched(folder)


def test_parameters_are_recovered_and_carried_to_what_is_predicted(found):
    """And the second round looks closer."""
    first, second = np.split(found.parts, 2)
    assert (np.ptp(second, axis=0) < np.ptp(first, axis=0)).all()
    assert found.misfits.argmin() >= len(first)
    parameters, correlation, results, misfit = found.estimates
    assert misfit < len(BOXES)
    for name, true in TRUE.items():
        assert abs(parameters[name].value - true) < 3 * parameters[name].error < 0.15
    assert abs(correlation[0, 1]) < 1
    assert len(results) == len(BOXES) + 1
    unseen = drift(**TRUE, box=60.0)
    assert abs(results[-1].value - unseen) < 3 * results[-1].error < 1.0
    assert results[-1].error > results[0].error  # far from all data


def test_stated_errors_are_those_of_many_data_sets(found):
    """Data that scatter by their errors: estimates scatter by theirs."""
    random, off = default_rng(4), []
    for _ in range(20):
        moved = tuple(
            target._replace(value=random.normal(target.value, ERROR))
            for target in found.search.targets
        )
        told = replace(found, search=replace(found.search, targets=moved)).estimates.parameters
        off.append([(told[name].value - true) / told[name].error for name, true in TRUE.items()])
    spread = np.sqrt(np.mean(np.square(off), axis=0))
    assert (spread > 0.7).all()
    assert (spread < 1.4).all()


@pytest.mark.parametrize(
    ("friction", "error"), [(0.6, 0.05), (0.3, 50.0)], ids=["end of range", "no information"]
)
def test_the_box_around_the_best_points_cuts_nothing_off(tmp_path, friction, error):
    base = put(BASE, {"contacts.plate.restitution": 0.65})
    told = searched(tmp_path, base, friction=friction, error=error, **ONE).estimates
    value, spread = told.parameters["friction"]
    assert abs(value - friction) < 3 * spread
    assert (spread < 0.01) if error < 1 else (abs(spread - 0.5 / 12**0.5) < 0.01)


@pytest.mark.parametrize("friction", [0.05, -0.2])
def test_a_truth_beyond_the_range_is_at_its_end(tmp_path, friction):
    told = search_text(searched(tmp_path, friction=friction, **ONE))
    assert "reaches an end of its range, 0.1 to 0.6" in told


def test_scatter_that_hides_whether_the_scene_fits_is_told(tmp_path):
    def rough(point):
        made = made_run(point)
        noise = default_rng(int(1e6 * point.scene.contacts.plate.friction))
        return made | {"c_x_cm_s": made["c_x_cm_s"] + noise.normal(0, 2)}

    told = searched(tmp_path, measure=rough, parameters=PARAMETERS[:1], rounds=1)
    assert "warning: no point fits the data" in search_text(told)


def test_draws_follow_a_ridge_and_leave_a_lesser_minimum():
    """A thin ridge in three dimensions, and a minimum of 200 beside it that holds most walkers."""
    across, widths = [[1, 1, 0], [1, -1, 0], [0, 0, 1]], [1e-3, 0.1, 0.1]

    def misfit(x):
        ridge = ((x @ across / widths) ** 2).sum(axis=1)
        return np.minimum(ridge, 200 + 10 * ((x - 0.7) ** 2).sum(axis=1))

    assert np.std(_draws(misfit, 3) @ across, axis=0) == pytest.approx(widths, rel=0.2)


def test_a_search_of_which_all_runs_fail_ends_in_one_line(tmp_path):
    """A warning beside it is an error."""
    fails = Mock(side_effect=InputError("rods.count is too large"))  # as the run alone can see
    with pytest.raises(RunError, match="no point has all results at the targets; 160 runs"):
        searched(tmp_path, measure=fails)


def test_a_search_goes_on_where_it_stopped(found, folder):
    again = search(found.search, folder / "runs.db", workers=1)
    assert (again.tally.computed, again.tally.there) == (0, found.tally.computed)
    assert np.array_equal(again.results, found.results)


FILE = """
scene = "quasi2d"
periods = 30
points = 4
seeds = [1]
[set]
"rods.count" = 2
"step.size" = 1.2e-4
"step.coarse" = true
[[parameters]]
keys = ["contacts.plate.tangential_ratio", "contacts.rods.tangential_ratio"]
from = 1
to = 9
log = true
[[data]]
file = "tilt_deg.csv"
result = "tilt_deg"
[[data]]
file = "drift.csv"
result = "c_x"
"""


def test_the_command_searches_a_file(tmp_path):
    """Of two files. A comment is no row; the value of a place without data is null in JSON."""
    (tmp_path / "fit.toml").write_text(FILE)
    (tmp_path / "drift.csv").write_text("\n # asked\nbox.length,c_x,error\n3.0,,\n")
    (tmp_path / "tilt_deg.csv").write_text("box.length,tilt_deg,error\n3.0,45,5\n")
    asked = "md search --workers 1", tmp_path / "fit.toml", "--store", tmp_path / "runs.db"
    told = json.loads(enter(*asked, "--json").out, parse_constant=pytest.fail)
    misfits = [point["misfit"] for point in told["points"]]
    assert len(misfits) == 4
    assert misfits == sorted(misfits)
    assert told["tally"]["computed"] == 4
    assert [target["value"] for target in told["targets"]] == [45, None]
    assert enter(*asked).out.splitlines()[-1].split()[:2] == ["3", "c_x"]  # and no value
