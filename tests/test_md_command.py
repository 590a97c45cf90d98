"""`python -m md impact`: what it prints, and what it says to nonsense."""

import json
from inspect import signature
from math import radians
from unittest.mock import Mock

import pytest

import md
from md.__main__ import main
from md.kernels.contact import Normal

GIVEN = {"tilt-deg": "20", "friction": "0.4", "restitution": "0.65", "c-x": "0.5", "c-z": "-1"}


def arguments(*flags, **changed):
    """Those of an impact, some of them changed; None leaves one out."""
    given = {**GIVEN, **{name.replace("_", "-"): value for name, value in changed.items()}}
    options = [f"--{name}={value}" for name, value in given.items() if value is not None]
    return ["impact", *options, *flags]


def run(capsys, *flags, **changed):
    """Exit code, standard output and standard error."""
    return main(arguments(*flags, **changed)), *capsys.readouterr()


ALL_OPTIONS = {
    "omega": "0.1",
    "length": "8",
    "inertia": "thin",
    "ends": "flat",
    "law": "constant_restitution",
    "stiffness": "1e7",
    "tangential_ratio": "100",
    "dt": "1e-5",
}


@pytest.mark.parametrize("options", [{}, ALL_OPTIONS], ids=["few", "all"])
def test_json_holds_all_that_happened(capsys, options):
    code, out, err = run(capsys, "--json", **options)
    assert (code, err, out.count("\n")) == (0, "", 1)
    found = json.loads(out)
    omega, given, law = 0.0, {}, md.coulomb(0.65)
    if options:
        law = md.constant_restitution(0.65, 1e7, tangential_ratio=100.0)
        omega, given = 0.1, {"rod": md.Rod(8.0, "thin", "flat"), "dt": 1e-5}
    hit = md.impact(radians(20), 0.5, -1.0, omega, friction=0.4, law=law, **given)
    assert {*found} == {*hit._fields, "stiffness", "arguments"}
    assert found | hit._asdict() | {"seconds": found["seconds"]} == found
    assert found["stiffness"] == law.normal.stiffness
    assert sum(found["phases"].values()) == pytest.approx(found["contact_time"], rel=1e-12)
    assert found["arguments"]["tilt_deg"] == 20


@pytest.mark.parametrize(
    ("law", "integrator"),
    [*((law, "leapfrog") for law in md.LAWS), *(("coulomb", name) for name in md.INTEGRATORS)],
)
def test_every_law_and_integrator(capsys, law, integrator):
    """The undamped spring of Appendix A gives its energy back, and the rod slips back with it."""
    restitution = "0.65" if "restitution" in signature(md.LAWS[law]).parameters else None
    code, out, err = run(capsys, "--json", law=law, integrator=integrator, restitution=restitution)
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["regime"] == ("slip-reversal" if law == "appendix_a" else "slip-stick")
    assert (found["dt"] is None) == (integrator == "dop853")


def test_a_law_of_ones_own():
    assert md.impact(0.1, 0.0, -1.0, friction=0.0, law=md.Law("mine", Normal(5e6), None)).c_z > 0


def test_a_run_that_ends_early_costs_one_line(capsys, monkeypatch):
    error = md.RunError("the contact has not ended", (0.0,) * 6)
    monkeypatch.setattr("md.soft_impact.impact", Mock(side_effect=error))
    assert run(capsys) == (1, "", f"python -m md impact: {error}\n")
