"""Results as they show themselves: short where they stand alone, else as the command prints."""

import numpy as np

import impact
import md
from md.__main__ import main

from .rows import ROW, row


def test_many_impacts_are_a_line():
    rod = impact.thin_rod(np.linspace(0, 1, 200))
    found = repr(impact.collide(1.0, -2.0, geometry=rod, friction=0.3, restitution=0.65))
    assert found.startswith("Collision(c_x=array([")
    assert len(found) < 1000
    body = impact.Body(1.0, 0.3, 0.1, np.linspace(0.1, 0.5, 200), 0.0, 0.0)
    plate = impact.Body(np.inf, 1.0, 0.0, 0.0, 0.0, 1.0)
    pair = impact.collide_pair(body, plate, friction=0.3, restitution=0.65)
    assert len(repr(pair)) < 2000
    assert "Body(mass=" in repr(pair)


def test_a_sweep_is_a_line():
    axes = [{"plate.acceleration": [2, 3]}, {"start.seed": [1, 2, 3]}]
    sweep = md.sweep.expand({"scene": "single_rod", "axes": axes})
    assert repr(sweep) == "<Sweep: 2 x 3 points over plate.acceleration, start.seed>"


def test_a_run_is_a_line_and_as_text_what_the_command_prints(capsys):
    result = md.run(row(), periods=2)
    assert repr(result) == f"<Result: {result.c_x_cm_s:.4g} +- nan cm/s at " + (
        f"{result.tilt_deg:.3g} degrees, 2 periods>"
    )
    changes = [part for change in ROW for part in ("--set", change)]
    assert main(["run", "quasi2d", *changes, "--periods", "2"]) == 0
    printed = capsys.readouterr().out.splitlines()
    shown = str(result).splitlines()
    assert printed[:-1] == shown[:-1]  # the last one has the time it took
    assert printed[-1].split(" in ")[0] == shown[-1].split(" in ")[0]
    assert result._repr_html_().startswith("<pre>rods")
    assert result.as_dict()["c_x_stderr_cm_s"] is None
