"""Means over touches, and over touches merged into landings."""

import numpy as np
import pytest

import md
from md.kernels import touches as columns
from md.measures import HOP, Tables, merged

from .rows import row


def touches(rod, steps, flights):
    """Rows of a record as `merged` reads them: a touch of 3 steps each."""
    table = np.zeros((len(steps), columns.WIDTH + 1))
    table[:, columns.ROD], table[:, columns.STEP] = rod, steps
    table[:, columns.FLIGHT], table[:, columns.DURATION] = flights, 3
    table[:, columns.PLATE] = np.arange(len(steps))
    for i in range(3):
        table[:, columns.BEFORE + i] = 10 * i + np.arange(len(steps))
        table[:, columns.AFTER + i] = 100 + 10 * i + np.arange(len(steps))
    table[:, -1] = 1
    return table


def test_short_hops_belong_to_the_landing_before():
    """Flights above 20 steps part landings; the last of each rod may go on."""
    one = touches(0, [50, 150, 160, 175, 400], [np.nan, 95, 5, 10, 220])
    two = touches(1, [60, 70, 300], [80, 5, 150])
    rows = np.concatenate([one, two])
    rows = rows[np.argsort(rows[:, columns.STEP], kind="stable")]
    over, open_ = merged(rows, 20)
    np.testing.assert_array_equal(over[:, columns.STEP], [50, 60, 150])  # as the next ones begin
    np.testing.assert_array_equal(over[:, columns.ROD], [0, 1, 0])
    np.testing.assert_array_equal(over[:, -1], [1, 2, 3])
    np.testing.assert_array_equal(over[:, columns.BEFORE], [0, 0, 1])  # of the first touch
    np.testing.assert_array_equal(over[:, columns.AFTER], [100, 101, 103])  # of the last
    np.testing.assert_array_equal(over[:, columns.PLATE], [0, 0, 1])
    np.testing.assert_array_equal(open_[:, columns.STEP], [400, 300])
    assert len(merged(rows, 0)[0]) == 6
    assert [len(part) for part in merged(rows[:0], 20)] == [0, 0]


@pytest.mark.parametrize("cuts", [[], [1], [3, 4], list(range(1, 60))])
def test_how_the_touches_come_in_does_not_matter(cuts):
    """Same landings, in the same order, whatever is handed over at once."""
    random = np.random.default_rng(2)
    rows = np.concatenate(
        [
            touches(rod, np.cumsum(5 + flight), flight)
            for rod in range(3)
            for flight in [random.choice([2, 10, 30, 60], 20)]
        ]
    )
    rows = rows[np.argsort(rows[:, columns.STEP], kind="stable")]
    whole, rest = merged(rows, 20)
    parts, open_ = [], rows[:0]
    for part in np.split(rows, cuts):
        over, open_ = merged(np.concatenate([open_, part]), 20)
        parts.append(over)
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    np.testing.assert_array_equal(open_, rest)
    assert whole[:, -1].sum() + rest[:, -1].sum() == 60


def by_hand(rows, per, speed):
    """Merged landings of a record, rod by rod, as dicts."""
    found = []
    for rod in np.unique(rows[:, columns.ROD]):
        mine, landing = rows[rows[:, columns.ROD] == rod], None
        for touch in mine:
            if landing is None or not touch[columns.FLIGHT] <= HOP * per:
                if landing is not None and np.isfinite(landing["flight"]):
                    found.append(landing)
                landing = {
                    "flight": touch[columns.FLIGHT] / per,
                    "plate": touch[columns.PLATE] / speed,
                    "before": touch[columns.BEFORE : columns.BEFORE + 3],
                    "touches": 0,
                }
            landing["touches"] += 1
            landing["after"] = touch[columns.AFTER : columns.AFTER + 3]
    return found


def test_means_of_a_run_are_those_of_its_record():
    kept = []
    result = md.run(row("plate.acceleration=5"), periods=30, observe=kept.append)
    rows, speed = np.concatenate(kept), result.scene.plate_speed
    tables = Tables(md.host.prepare(result.scene), 30)
    tables.add(rows)
    found = by_hand(rows, result.steps_per_period, speed)
    found_means = tables.results(0, 30)
    means, each = found_means["landings"], found_means["touches"]
    assert any(one["touches"] > 1 for one in found)
    expected = {
        "flight_periods": [one["flight"] for one in found],
        "plate_velocity": [one["plate"] for one in found],
        "falling": [one["plate"] < 0 for one in found],
        "touches": [one["touches"] for one in found],
        "c_x_before": [one["before"][0] for one in found],
        "c_z_after": [one["after"][1] for one in found],
        "omega_after": [one["after"][2] for one in found],
    }
    for name, values in expected.items():
        assert means[name]["mean"] == pytest.approx(np.mean(values), rel=1e-12)
    whole = rows[np.isfinite(rows[:, columns.FLIGHT])]
    assert each["falling"]["mean"] == pytest.approx((whole[:, columns.PLATE] < 0).mean())
    assert each["omega_after"]["mean"] == pytest.approx(whole[:, columns.AFTER + 2].mean())


def test_touches_of_one_phase_are_counted_whatever_their_number():
    tables, many = Tables(md.host.prepare(row()), 1), 2**16 + 1
    tables.add(touches(0, np.full(many, 1), 5)[:, :-1])
    assert max(tables.cycle(0, 1)) == many
