"""Sweeps: axes become points, points are computed once, and nothing that was finished is lost."""

import os
import signal
import time
import tomllib
import warnings
from dataclasses import replace
from unittest.mock import MagicMock

import numpy as np
import pytest
from numpy.random import default_rng

import md
from md.scene import read_tables
from md.soft_impact import RunError
from md.store import Store, StoreError, table
from md.sweep import Measure, Point, execute, expand, load_sweep

from .command_line import each_signal, ended, enter, left

SCENE = """
[rods]
length = 3.0
[plate]
acceleration = 2.0
[gravity]
[contacts.plate]
law = "coulomb"
friction = 0.3
[start]
tilt_deg = 10
"""
BASE = tomllib.loads(SCENE)  # one rod, coarse and short: a run takes a few milliseconds
SWEEP = """
scene = "base.toml"
periods = 20
[[axes]]
"plate.acceleration" = [1.5, 2.0, 2.5]
[[axes]]
"start.seed" = [1, 2]
"""


def written(folder, sweep=SWEEP):
    """Path of the sweep in a folder, its scene beside it."""
    (folder / "base.toml").write_text(SCENE)
    (folder / "sweep.toml").write_text(sweep)
    return folder / "sweep.toml"


def gathered(sweep, store):
    """Bytes of what the sweep measured."""
    found = sweep.gather(store, "c_x", "touches.flight_periods.mean", "phases")
    return [array.tobytes() for array in found]


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The sweep of `SWEEP` and its store, computed in this process."""
    folder = tmp_path_factory.mktemp("sweep")
    sweep = load_sweep(written(folder))
    execute(sweep, folder / "a.db", workers=1)
    return sweep, folder / "a.db"


# Axes


def axes(*tables):
    return expand({"axes": list(tables)}, BASE)


def test_axes_multiply_and_keys_of_one_axis_go_together():
    sweep = axes(
        {"rods.length": [2.0, 3.0], "start.tilt_deg": [10, 20]},
        {"plate.acceleration": {"from": 1, "to": 4, "count": 3, "log": True}},
    )
    counts = axes({"rods.count": {"from": 5, "to": 40, "count": 4, "log": True}})
    assert [*map(str, counts.values("rods.count"))] == ["5", "10", "20", "40"]  # whole numbers
    late = 17 * 10**14 + np.arange(1, 9)  # as the time of the day in microseconds
    seeds = axes({"start.seed": {"from": int(late[0]), "to": int(late[-1]), "count": 8}})
    assert seeds.values("start.seed").tolist() == late.tolist()
    assert sweep.shape == (2, 3)
    scenes = [point.scene for point in sweep.points]
    found = [(s.rods.length, s.start.tilt_deg, s.plate.acceleration) for s in scenes]
    assert found == [(x, y, z) for x, y in ((2, 10), (3, 20)) for z in (1, 2, pytest.approx(4))]
    assert sweep.values("plate.acceleration") == pytest.approx([1, 2, 4])
    assert (axes().shape, len(axes().points)) == ((), 1)


@pytest.mark.parametrize("values", [(2, 3), range(2, 4), np.array([2, 3], np.int8)], ids=repr)
def test_numbers_of_numpy_are_numbers(values):
    """As axes, counts and texts, with the keys that plain ones have in a store."""
    found, wanted = axes({"rods.count": values}), axes({"rods.count": [2, 3]})
    assert found == wanted
    assert [point.key for point in found.points] == [point.key for point in wanted.points]


# Runs


def test_what_is_there_is_not_computed_again(path):
    """Not a thousand identical points, and not those of an earlier sweep; longer runs are."""
    for periods, there in ((5, 0), (5, 1), (6, 0)):
        sweep = expand({"periods": periods, "axes": [{"start.tilt_deg": [10] * 1000}]}, BASE)
        tally = execute(sweep, path, workers=1)
        assert (tally.points, tally.distinct, tally.there) == (1000, 1, there)
        assert tally.computed == 1 - there
    (c_x,) = sweep.gather(path, "c_x")
    assert np.array_equal(c_x, np.full(1000, c_x[0]))


def test_results_come_back_with_their_coordinates(reference):
    """As a Dataset of xarray."""
    axis = {"start.tilt_deg": [10, 20, 30], "contacts.plate.law": ["coulomb", "appendix_a", "x"]}
    sweep, store = reference
    found = replace(sweep, axes=(axis, sweep.axes[1])).to_xarray(store, "c_x", "phases")
    c_x, phases = sweep.gather(store, "c_x", "phases")
    dims = "start_tilt_deg", "start_seed"
    shapes = {"c_x": dims, "phases": (*dims, "phases_0"), "c_x_stderr": dims}
    assert {name: found[name].dims for name in found} == shapes
    assert {*found.to_dataframe()} == {*found, "contacts_plate_law"}
    assert found["c_x"].attrs == {"units": "sqrt(g d)", "long_name": "drift"}
    assert np.array_equal(found["c_x"].data, c_x)
    assert np.array_equal(found["phases"].data, phases)
    for key, values in (axis | sweep.axes[1]).items():
        label = key.replace(".", "_")
        assert found[label].dims == (dims[key == "start.seed"],)
        assert list(found[label].data) == values


def plain(scene, periods):
    """Results of one's own, as NumPy gives them, without standard errors."""
    known = {"c_x": np.float32(scene.start.seed), "periods": np.int64(periods)}
    return known | {"places": np.arange(periods)}


def test_a_measure_of_ones_own_is_stored(path):
    sweep = axes({"start.seed": [1, 2]})
    measured = replace(
        sweep, points=tuple(replace(p, periods=3, measure=Measure(plain, "")) for p in sweep.points)
    )
    execute(measured, path, workers=1)
    found = measured.to_xarray(path, "c_x", "places")
    assert found["c_x"].data.tolist() == [1.0, 2.0]
    assert found["places"].data.tolist() == [[0, 1, 2]] * 2
    assert {*found} == {"c_x", "places"}
    assert [row["periods"] for row in table(path)[1]] == [3, 3]
    failing = replace(sweep.points[0], measure=Measure(lambda *_: {"c_x": print}, "other"))
    with pytest.raises(StoreError, match="cannot be written"):
        execute(replace(sweep, points=(failing,)), path, workers=1)


def test_errors_come_along_without_a_run(reference):
    with pytest.warns(RuntimeWarning, match="1 of 1 runs are missing"):
        found = axes({"start.tilt_deg": [33]}).to_xarray(reference[1], "c_x_cm_s")
    assert {*found} == {"c_x_cm_s", "c_x_stderr_cm_s"}


def test_a_result_that_cannot_be_gathered_is_named(reference):
    """What the message offers is there."""
    sweep, store = reference
    for name in ("c_xx", "c_x.mean", "touches"):
        with pytest.raises(ValueError, match=f"^{name} is not in the results: c_x, ") as error:
            sweep.gather(store, name)
    offered = str(error.value).partition(": ")[2].split(", ")
    found = sweep.to_xarray(store, *offered)
    assert set(found["law"].data.flat) == {"coulomb"}
    assert set(found) == {name.replace(".", "_") for name in offered}


def viscous(stiffness=5e6, dashpot=300.0):
    """A law that md has not, of which the kernel is that of the others here."""
    return md.Law("viscous", md.Normal(stiffness, quarter=dashpot), None)


def test_a_law_of_ones_own_runs_in_processes_that_do_not_know_it(path, monkeypatch):
    """A store knows it by its numbers: a function changed under the same name runs again."""
    tables = {"periods": 5, "axes": [{"contacts.plate.dashpot": [100.0, 300.0]}]}
    base = BASE | {"contacts": {"plate": {"law": "mine", "friction": 0.3}}}
    monkeypatch.setitem(md.LAWS, "mine", viscous)
    own = expand(tables, base)
    assert execute(own, path, workers=2).computed == 2
    plate = md.Contact(viscous(dashpot=300.0), 0.3)
    scene = replace(own.points[1].scene, contacts=md.Contacts(plate=plate))
    assert own.points[1].key == Point(scene, 5).key
    assert own.gather(path, "c_x")[0][1] == md.run(scene, periods=5).c_x
    monkeypatch.setitem(md.LAWS, "mine", lambda dashpot: viscous(2e6, dashpot))
    assert execute(expand(tables, base), path, workers=1).there == 0
    monkeypatch.delitem(md.LAWS, "mine")
    enter("md results", path)


def test_a_dask_cluster_gives_the_same_bits(path, reference, monkeypatch):
    """Once it has workers."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr("md.sweep.PATIENCE", 0.5)
    sweep, _ = reference
    with distributed.LocalCluster(
        n_workers=0, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        address = cluster.scheduler_address
        with pytest.raises(RunError, match=r"^the scheduler \S+ failed .Only 0/1 workers arrived"):
            execute(sweep, path, scheduler=address)
        cluster.scale(2)
        cluster.wait_for_workers(2)
        assert execute(sweep, path, scheduler=address).computed == 6
    assert gathered(sweep, path) == gathered(*reference)


def test_a_run_that_fails_is_recorded_and_stops_no_other(tmp_path, path):
    """A plate that is stiff enough for the impacts to expect, and too soft for thirty times g.

    And more rods than an annulus takes, which the run alone sees.
    """
    crowd = expand({"axes": [{"rods.count": [2001]}]}, read_tables("annulus"))
    assert execute(crowd, tmp_path / "b.db", workers=1).failed == 1
    soft = {"plate": {"law": "coulomb", "friction": 0.3, "stiffness": 20.0}}
    sweep = expand({"periods": 10, "axes": [{"gravity.z": [-30, -1]}]}, BASE | {"contacts": soft})
    for retry, done in ((False, (1, 1)), (False, (0, 0)), (True, (0, 1))):
        tally = execute(sweep, path, workers=1, retry=retry)
        assert (tally.computed, tally.failed) == done
    (error,) = (row["error"] for row in table(path)[1] if row["error"])
    assert "deep in the plate" in error
    assert list(np.isnan(sweep.gather(path, "c_x")[0])) == [True, False]
    with pytest.warns(RuntimeWarning, match="^1 of 2 runs are missing in .*a.db, or have failed$"):
        sweep.to_xarray(path, "c_x")


def test_a_dead_worker_ends_the_sweep_and_the_next_one_goes_on(path, reference):
    """To the bits of one process."""
    me, sweep = os.getpid(), reference[0]

    class Deadly(Point):
        """Its run kills the worker."""

        @property
        def length(self):
            if os.getpid() != me:
                os.kill(os.getpid(), signal.SIGKILL)
            return super().length

    deadly = Deadly(sweep.points[-1].scene, sweep.points[-1].periods)
    with pytest.raises(RunError, match=r"a worker process died, .* the same command goes on$"):
        execute(replace(sweep, points=(*sweep.points[:-1], deadly)), path, workers=2)
    execute(sweep, path, workers=2)
    assert gathered(sweep, path) == gathered(*reference)


def test_a_sweep_leaves_warnings_and_environment_as_they_were(path, monkeypatch):
    monkeypatch.delenv("PYTHONWARNINGS", raising=False)
    before = warnings.filters.copy(), os.environ.copy()
    assert execute(expand({"periods": 5}, BASE), path, workers=1).computed == 1
    assert (warnings.filters, os.environ.copy()) == before


# The command


def killed(folder, how, seconds):
    """Start the sweep, end it a while after there is a store; exit code, rows, last words."""
    command = "md sweep sweep.toml --store a.db --workers 2"
    code, _, error = ended(how, folder, command, begun=folder / "a.db", seconds=seconds)
    with Store(folder / "a.db", write=False) as store:
        assert store.database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        return code, len(list(store.rows())), error


LONG = SWEEP.replace("20", "400").replace("[1, 2]", "{ from = 1, to = N, count = N }")


@pytest.mark.parametrize(
    ("starts", "kills", "latest"),
    [
        ("5", [signal.SIGKILL], 1.2),
        ("20", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT] * 7, 4.0),
    ],
)
def test_kills_at_random_times_lose_nothing(tmp_path, path, starts, kills, latest):
    sweep = load_sweep(written(tmp_path, LONG.replace("N", starts)))
    before, random = 0, default_rng(7)
    for how in kills:
        _, rows, _ = killed(tmp_path, how, random.uniform(0.2, latest))
        assert rows >= before
        before = rows
    assert execute(sweep, path, workers=2).there == before
    execute(sweep, tmp_path / "b.db", workers=2)
    assert gathered(sweep, path) == gathered(sweep, tmp_path / "b.db")


@each_signal
def test_ctrl_c_ends_in_order(tmp_path, number):
    """And so does SIGTERM: one line, and no worker is left."""
    written(tmp_path, LONG.replace("400", "4000").replace("N", "20"))
    code, _, error = killed(tmp_path, number, 1.5)
    assert code == 130
    assert "runs done and stored" in error
    assert "Traceback" not in error
    assert not left(tmp_path)


def test_a_key_says_what_is_computed(monkeypatch):
    """Scene, length, sources."""
    scenes = axes({"start.tilt_deg": [10, 11]}).points

    def keys():
        chosen = {"tolerance": 0.1}, {"tolerance": 0.2}, {"tolerance": 0.1, "max_seconds": 7.0}
        lengths = (5,), (6,), *((0, how) for how in chosen)
        return {Point(one.scene, *length).key for one in scenes for length in lengths}

    before = keys()
    assert len(before) == 10
    monkeypatch.setattr("md.cache.digest", lambda: "other sources")
    assert not keys() & before


def test_a_scheduler_that_dies_ends_the_sweep_in_one_line(path, monkeypatch):
    """Whatever it waits for."""

    def waits(*_, **__):
        for _ in range(90):  # a signal that Python sends itself ends no sleep
            time.sleep(0.1)
        pytest.fail("it waits on")

    client = MagicMock(status="closed", wait_for_workers=waits)
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed, "Client", lambda *_, **__: client)
    with pytest.raises(RunError, match=r"^the scheduler a:1 is gone; what was finished is kept$"):
        execute(axes(), path, scheduler="a:1")
