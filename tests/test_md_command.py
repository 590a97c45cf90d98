"""`python -m md impact`: what it prints."""

import json
from math import radians

import pytest

import md

from .command_line import enter


def found(options):
    """What the command finds, a line of JSON."""
    out, err = enter(f"md impact --json --tilt-deg=20 --friction=0.4 --c-x=0.5 --c-z=-1 {options}")
    assert (err, out.count("\n")) == ("", 1)
    return json.loads(out)


@pytest.mark.parametrize(
    ("options", "law", "given", "regime"),
    [
        (
            "--restitution=0.65 --omega=0.1 --length=8 --inertia=thin --ends=flat --stiffness=1e7"
            " --dt=1e-5",
            md.coulomb(0.65, 1e7),
            {"omega": 0.1, "rod": md.Rod(8.0, "thin", "flat"), "dt": 1e-5},
            "slip-stick",
        ),
        (
            "--restitution=0.65 --law=constant_restitution --tangential-ratio=100"
            " --integrator=dop853",
            md.constant_restitution(0.65, tangential_ratio=100.0),
            {"integrator": "dop853"},
            "slip-stick",
        ),
        ("--law=appendix_a", md.appendix_a(), {}, "slip-reversal"),
    ],
    ids=["rod", "law", "appendix_a"],
)
def test_json_holds_all_that_happened(options, law, given, regime):
    """The undamped spring of Appendix A gives its energy back, and the rod slips back with it."""
    told = found(options)
    assert told["regime"] == regime
    hit = md.impact(radians(20), 0.5, -1.0, friction=0.4, law=law, **given)
    assert {*told} == {*hit._fields, "stiffness", "arguments"}
    whole = {name: None if x != x else x for name, x in hit._asdict().items()}  # nan is null
    assert told | whole | {"seconds": told["seconds"]} == told
    assert told["stiffness"] == law.normal.stiffness
    assert sum(told["phases"].values()) == pytest.approx(told["contact_time"], rel=1e-12)
    assert told["arguments"]["tilt_deg"] == 20
