"""The impact map in C and in JavaScript: the numbers of Python, for every function."""

import ctypes
import json
import re
import shutil
import textwrap

import numpy as np
import pytest
import quickjs
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

import impact
from derivations import languages
from derivations.languages import FUNCTIONS, LAWS, RECORDS

from . import sampling, test_pairs, test_public_api
from .command_line import called, enter
from .sampling import each_law

CC = shutil.which("cc")
STRICT = "-std=c99 -pedantic -Wall -Wextra -Wconversion -Wshadow -Wdouble-promotion -Werror -O2"
FUSING = (
    "-O3 -march=native -ffp-contract=off -DROD_IMPACT_UNCONTRACTED"  # fma where it is asked for
)


def arguments(name):
    """Each argument of a function and its kind: a record, the law, or of a number its own name."""
    parts = (part.partition(": ") for part in FUNCTIONS[name]["arguments"].split(", "))
    return {part: kind or part for part, _, kind in parts}


def found(name):
    """Numbers of what a function returns, as both languages name them."""
    return list(languages.numbers_of("found", FUNCTIONS[name].get("record", "")))


def in_c(name):
    """A loop over the rows of an array; a record is as many numbers one after the other."""
    kinds = {
        x: f"rod_impact_{kind}" if kind in RECORDS else "double"
        for x, kind in arguments(name).items()
    }
    lines = [
        f"{kind} {part}; memcpy(&{part}, a, sizeof {part}); a += sizeof {part} / sizeof *a;"
        for part, kind in kinds.items()
        if part != "law"
    ]
    given = ", ".join("(rod_impact_law)law" if part == "law" else part for part in kinds)
    record = FUNCTIONS[name].get("record")
    return f"""
void {name}(int law, int n, const double *a, double *r) {{
    (void)law;
    for (int i = 0; i < n; i++) {{
        {" ".join(lines)}
        const {f"rod_impact_{record}" if record else "double"} found = rod_impact_{name}({given});
        {" ".join(f"*r++ = (double){number};" for number in found(name))}
    }}
}}"""


# A function of rows: records are made of their numbers, what is returned goes back as text.
IN_JAVASCRIPT = """
const made = (kind, a) => kind in records ? Object.fromEntries(
    Object.keys(records[kind]).map(field => [field, made(kinds[field] || field, a)])) : a.shift();
const flat = x => typeof x === "object" ? Object.values(x).flatMap(flat) : [x];
const run = (name, given, law, rows) => rows.map(a => flat(rodImpact[name](
    ...given.map(kind => kind === "law" ? law : made(kind, a)))).join(" ")).join("\\n");
"""


@pytest.fixture(scope="module")
def header(tmp_path_factory):
    """Folder with the header, written by the command."""
    if CC is None:
        pytest.skip("there is no C compiler")
    folder = tmp_path_factory.mktemp("c")
    for _ in range(2):  # the second header takes the place of the first
        enter("derivations generate --language c --out", folder / "rod_impact.h")
    return folder


def built(folder, name, text, flags):
    """Path of what is compiled from a text."""
    (folder / f"{name}.c").write_text(text)
    command = [CC, *flags.split(), "-o", folder / name, folder / f"{name}.c", "-lm"]
    called(*command, check=True)
    return str(folder / name)


def c_runner(header, flags):
    """Calls of the functions of a library."""
    text = '#include <string.h>\n#include "rod_impact.h"\n' + "\n".join(map(in_c, FUNCTIONS))
    library = ctypes.CDLL(built(header, f"loops{len(flags)}", text, f"{flags} -shared -fPIC"))

    def run(name, law, columns):
        given = np.stack(np.broadcast_arrays(*columns), axis=-1)
        returned = np.empty((len(given), len(found(name))))
        getattr(library, name)(LAWS.index(law), len(given), given.ctypes, returned.ctypes)
        return returned.T

    return run


def javascript_runner():
    """Calls of the functions of the script."""
    engine = quickjs.Context()
    records, kinds = map(json.dumps, (RECORDS, languages._RECORD_OF))
    constants = f"const records = {records}, kinds = {kinds};"
    engine.eval(languages.source("javascript") + constants + IN_JAVASCRIPT)

    def run(name, law, columns):
        rows = np.stack(np.broadcast_arrays(*columns), axis=-1).tolist()
        given = json.dumps([name, list(arguments(name).values()), law, rows])
        text = engine.eval(f"run(...{given})")
        return np.array([line.split() for line in text.split("\n")], dtype=float).T

    return run


@pytest.fixture(scope="module", params=["c", "fusing c", "javascript"])
def run(request):
    """A call of a function in one of the languages, for many rows; so many of them are quick."""
    if request.param == "javascript":
        return javascript_runner(), 5_000
    flags = STRICT if request.param == "c" else FUSING
    return c_runner(request.getfixturevalue("header"), flags), 100_000


def impacts(n, seed):
    """Impacts of all kinds, many of them on an edge; many in the Painleve region."""
    parts = zip(sampling.everyday(n // 2, seed), sampling.wide(n // 2, seed + 1), strict=True)
    i = sampling.Impacts(*map(np.concatenate, parts))
    rng = default_rng(seed)
    for name, value in (
        ("friction", 0),
        ("friction", np.inf),
        ("restitution", 0),
        ("restitution", 1),
        ("c_x", 0),
        ("omega", 0),
        ("X", 0),
    ):
        getattr(i, name)[rng.uniform(size=n) < 0.03] = value
    slips = (i.c_x - i.omega * i.Z) * i.X * i.Z < 0
    assert np.mean((i.friction > impact.painleve_friction((i.X, i.Z, i.k))) & slips) > 0.1
    return i


def same(found, wanted):
    """Every number to the last bit, but for what infinite friction leaves of zero."""
    assert_allclose(found, wanted, rtol=0, atol=1e-140)


@each_law
def test_an_impact_has_the_same_bits(run, law):
    call, n = run
    i = impacts(n, seed=71)
    want = i.collide(law)
    assert np.bincount(want.regime, minlength=4).min() > n / 100
    same(call("collide", law, i), want)


def same_pairs(call, law, first, second, how):
    """Compare impacts of two bodies with Python's; the regimes."""
    want = impact.collide_pair(first, second, **how, law=law)
    numbers = call("collide_pair", law, [*first, *second, *how.values()])
    same(numbers, [*want.first, *want.second, *want[2:]])
    return want.regime


@each_law
def test_an_impact_of_two_bodies_has_the_same_bits(run, law):
    """It has where speeds, levers or responses cancel, against a wall, and of two walls."""
    call, n = run
    for alike in (0.0, 0.99):
        first, second, how = test_pairs.pairs(n // 2, seed=72, alike=alike)
        first.mass[:9] = second.mass[:9] = np.inf
        regimes = same_pairs(call, law, first, second, how)
        assert np.bincount(regimes + 1, minlength=5).min() > 0


def test_the_path_turns_where_forward_slip_ends(run):
    """It goes straight on in a slide, else turns at no slip, as far as all laws go together."""
    call, n = run
    i = impacts(n, seed=73)
    u, v, P_x, P_z = call("path", LAWS[0], i)
    hit, finite = i.collide(), np.isfinite(i.friction)
    slides, stops = (finite & (hit.regime == code) for code in (1, 2))
    assert_array_equal(P_z[slides], hit.P_z[slides])
    assert_array_equal(P_x[slides], hit.P_x[slides])
    A, B, C = call("mobilities", LAWS[0], [i.X, i.Z, i.k])
    scale = np.abs(u) + C * np.abs(P_x) + np.abs(B) * P_z
    assert np.all(np.abs(u + C * P_x - B * P_z)[stops] <= 1e-13 * scale[stops])
    v_f = v + A * hit.P_z - B * hit.P_x
    scale = np.abs(v) + A * hit.P_z + np.abs(B * hit.P_x)
    assert np.all(np.abs(v_f - hit.normal_velocity)[finite] <= 1e-13 * scale[finite])


SOLIDS = "thin_rod", "spherocylinder", "flat_ended_rod"


@pytest.mark.parametrize(
    "name",
    [
        *SOLIDS,
        "critical_friction",
        "painleve_friction",
        "slide_friction",
        "drift",
        "critical_tilts",
        "optimal_tilt",
    ],
)
def test_closed_forms_are_those_of_python(run, name):
    """Sines may differ in the last digit; where what is left of them cancels, by more."""
    rng = default_rng(74)
    n = 6_000
    values = {
        "tilt": rng.uniform(-np.pi / 2, np.pi / 2, n),
        "diameter": np.full(n, 0.7),
        "length": 1 + 10 ** rng.uniform(-1, 1.5, n),
        "geometry": impact.ContactGeometry(*sampling.geometries(rng, n)),
        "friction": rng.uniform(0, 1, n),
        "restitution": rng.uniform(0, 1, n),
        "approach_ratio": 10 ** rng.uniform(-1, 1, n),
        "plate_velocity": 10 ** rng.uniform(-1, 1, n),
    }
    values["tilt"][:20] = values["geometry"].X[:20] = values["friction"][:5] = 0
    values["tilt"][:9] = -0.0
    values["restitution"][10:30] = 1
    values["approach_ratio"][15] = 1.7e308  # upright and lossless: 0 times a number that overflows
    given = {key: values[key] for key in arguments(name)}
    wanted = np.atleast_2d(getattr(impact, name)(**given))
    flat = [x for value in given.values() for x in np.atleast_2d(value)]
    returned = run[0](name, LAWS[0], flat)
    if name in SOLIDS:
        assert np.all(np.abs(returned - wanted) <= 1e-15 * values["length"])
    else:
        assert_allclose(returned, wanted, rtol=1e-13)


def test_the_example_of_the_header_prints_what_python_finds(header):
    (example,) = re.findall(
        r"(?s) {4}#include <stdio.h>\n.*?\n {4}}\n", (header / "rod_impact.h").read_text()
    )
    done = called(built(header, "example", textwrap.dedent(example), STRICT), check=True)
    rod = impact.spherocylinder(0.35, 8.0)
    after = impact.collide(1.0, -2.0, geometry=rod, friction=0.3, restitution=0.65)
    ball, rest = (1.0, 0.63, 0.0, 1.0, 0.0, -1.0, 2.0), (1.0, 0.63, 0.0, -1.0, 0.0, 0.0, 0.0)
    hit = impact.collide_pair(ball, rest, friction=0.3, restitution=1.0, law="stronge")
    assert done.stdout == (
        f"plate: regime {after.regime:d}, velocity {after.c_x:.6f} {after.c_z:.6f}, "
        f"spin {after.omega:.6f}\n"
        f"balls: regime {hit.regime:d}, spins {hit.first.omega:.6f} {hit.second.omega:.6f}, "
        f"energy {hit.energy_change:+.6f}\n"
    )


@each_law
def test_what_is_out_of_its_domain_is_invalid_as_in_python(run, law):
    """Where one number in ten is odd, results are invalid as in Python or have its bits."""
    call, _ = run
    rng = default_rng(75)

    def spoiled(column):
        odd = rng.choice([np.nan, np.inf, -np.inf, -1.0, 0.0, 2.0], 4_000)
        return np.where(rng.uniform(size=4_000) < 0.1, odd, column)

    i = sampling.Impacts(*map(spoiled, sampling.everyday(4_000, seed=76)))
    want = i.collide(law)
    assert 0.3 < np.mean(want.regime == impact.Regime.INVALID) < 0.7
    same(call("collide", law, i), want)
    *bodies, how = test_pairs.pairs(4_000, seed=77)
    bodies = (body._make(map(spoiled, body)) for body in bodies)
    how = {name: spoiled(column) for name, column in how.items()}
    regimes = same_pairs(call, law, *bodies, how)
    assert 0.3 < np.mean(regimes == impact.Regime.INVALID) < 0.9


FLAGS = "-O2 -march=haswell"  # which can fuse a product and a sum
CALL = '#include "rod_impact.h"\nint main(void) { return rod_impact_is_exact(); }\n'


@pytest.mark.parametrize(
    "flag",
    [
        "-ffast-math",
        "-funsafe-math-optimizations",
        "-freciprocal-math",
        "-fassociative-math -fno-signed-zeros -fno-trapping-math",
        "-ffinite-math-only",
        "-mfpmath=387",
        FLAGS,
    ],
)
def test_flags_that_break_sums_are_refused(header, flag):
    done = called(CC, *flag.split(), "-fsyntax-only", "-xc", "-", input=CALL, cwd=header)
    assert done.returncode != 0
    assert "#error" in done.stderr


@pytest.mark.parametrize(
    ("flags", "exact"),
    [
        ("-std=c99", 1),
        (f"{FLAGS} -std=c99", 1),
        (f"{FLAGS} -DROD_IMPACT_UNCONTRACTED -ffp-contract=off", 1),
        (f"{FLAGS} -DROD_IMPACT_UNCONTRACTED -ffp-contract=fast", 0),  # what only a run can tell
        ("-ffast-math -U__FAST_MATH__", 0),
    ],
)
def test_a_run_tells_whether_sums_are_exact(header, flags, exact):
    text = CALL
    if "-U" in flags:  # a compiler that does not tell
        names = re.findall(
            r"defined\((__(?!GNUC)[A-Z_]+__)\)", (header / "rod_impact.h").read_text()
        )
        text = "".join(map("#undef {}\n".format, names)) + CALL
    assert called(built(header, "exact", text, flags)).returncode == exact


@pytest.mark.skipif(shutil.which("node") is None, reason="there is no Node")
def test_the_module_exports_what_the_script_holds(tmp_path):
    (tmp_path / "rod_impact.mjs").write_text(languages.source("module"))
    (tmp_path / "use.mjs").write_text(
        'import rodImpact, { collide, Regime, thin_rod } from "./rod_impact.mjs";\n'
        "const before = { c_x: 1, c_z: -2, omega: 0, plate_velocity: 0, "
        "geometry: thin_rod(0.4, 1), friction: 0.3, restitution: 0.65 };\n"
        'const hit = collide("newton", before);\n'
        "console.log(hit.c_x === rodImpact.collide('newton', before).c_x, hit.regime, "
        "Regime.SLIP_STICK, Object.keys(rodImpact).join());\n"
    )
    done = called("node", "use.mjs", cwd=tmp_path)
    hit = test_public_api.call("collide")
    names = ",".join(["Regime", *FUNCTIONS])
    assert done.stdout == f"true {hit.regime:d} 2 {names}\n"


def test_the_script_refuses_an_unknown_law():
    engine = quickjs.Context()
    engine.eval(languages.source("javascript"))
    with pytest.raises(quickjs.JSException, match="law must be one of newton, poisson, stronge"):
        engine.eval("rodImpact.collide('hooke', {})")


def test_the_types_name_every_function_and_field():
    text = languages.source("typescript")
    assert re.findall(r"^export function (\w+)\(", text, re.M) == [*FUNCTIONS]
    bodies = dict(re.findall(r"interface (\w+) {(.*?)\n}", text, re.S))
    for record, fields in RECORDS.items():
        body = bodies[record.title().replace("_", "")]
        assert re.findall(r"^    (\w+): ", body, re.M) == [*fields]


def test_the_command_prints_a_text():
    for language in languages.LANGUAGES:
        printed = enter("derivations generate --language", language)
        assert printed.out == languages.source(language)


@pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler")
def test_the_header_is_cpp_as_well(header):
    flags = "-Wall -Wextra -pedantic -Werror -fsyntax-only -xc++ -"
    called("c++", *flags.split(), input=CALL, cwd=header, check=True)
