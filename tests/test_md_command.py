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
    ("options", "law", "given"),
    [
        (
            "--omega=0.1 --length=8 --inertia=thin --ends=flat --stiffness=1e7 --dt=1e-5",
            md.coulomb(0.65, 1e7),
            {"omega": 0.1, "rod": md.Rod(8.0, "thin", "flat"), "dt": 1e-5},
        ),
        (
            "--law=constant_restitution --tangential-ratio=100",
            md.constant_restitution(0.65, tangential_ratio=100.0),
            {},
        ),
    ],
    ids=["rod", "law"],
)
def test_json_holds_all_that_happened(options, law, given):
    told = found(f"--restitution=0.65 {options}")
    hit = md.impact(radians(20), 0.5, -1.0, friction=0.4, law=law, **given)
    assert {*told} == {*hit._fields, "stiffness", "arguments"}
    assert told | hit._asdict() | {"seconds": told["seconds"]} == told
    assert told["stiffness"] == law.normal.stiffness
    assert sum(told["phases"].values()) == pytest.approx(told["contact_time"], rel=1e-12)
    assert told["arguments"]["tilt_deg"] == 20


@pytest.mark.parametrize(
    ("law", "integrator"),
    [*((law, "verlet") for law in md.LAWS), ("coulomb", "dop853")],
)
def test_every_law_and_integrator(law, integrator):
    """The undamped spring of Appendix A gives its energy back, and the rod slips back with it."""
    printed = law == "appendix_a"
    restitution = "" if printed else "--restitution=0.65"
    told = found(f"{restitution} --law={law} --integrator={integrator}")
    assert told["regime"] == ("slip-reversal" if printed else "slip-stick")
    assert (told["dt"] is None) == (integrator == "dop853")
