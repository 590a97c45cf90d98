"""The impact map in C and in JavaScript: the numbers of Python, for every function."""

import ctypes
import json
import re
import shutil
import subprocess
import textwrap
from time import perf_counter

import numpy as np
import pytest

import impact
from derivations import languages
from derivations.__main__ import main
from derivations.languages import FUNCTIONS, LAWS, RECORDS

from . import sampling, test_pairs

CC = shutil.which("cc")
STRICT = "-std=c99 -pedantic -Wall -Wextra -Wconversion -Wshadow -Wdouble-promotion -Werror -O2"
FUSING = (
    "-O3 -march=native -ffp-contract=off -DROD_IMPACT_UNCONTRACTED"  # fma where it is asked for
)


def flat(record, name):
    """Numbers of a record, and of the records in it, as both languages name them."""
    return list(languages.numbers_of(name, record))


def numbers(name):
    """Arguments of a function: each one's name, record, and numbers of an array `a`."""
    made, given = [], FUNCTIONS[name]["arguments"].replace("law, ", "").split(", ")
    for argument in given:
        part, _, record = argument.partition(": ")
        record = record or part if (record or part) in RECORDS else ""
        first = sum(len(values) for *_, values in made)
        made.append((part, record, [f"a[{first + i}]" for i in range(len(flat(record, "")))]))
    return made


def assigned(record, values):
    """Fields of a record by name, in JavaScript; in C without the names."""
    fields = {}
    for field in RECORDS[record]:
        own = len(flat(field, "")) if field in RECORDS else 1
        part, values = values[:own], values[own:]
        fields[field] = assigned(field, part) if field in RECORDS else part[0]
    return fields


def in_braces(fields):
    """An initializer in C."""
    parts = (in_braces(x) if isinstance(x, dict) else x for x in fields.values())
    return f"{{{', '.join(parts)}}}"


def in_c(name):
    """A loop over the rows of arrays."""
    made, record = numbers(name), FUNCTIONS[name].get("record", "")
    kinds = {part: f"rod_impact_{kind}" if kind else "double" for part, kind, _ in made}
    lines = [
        f"const {kinds[part]} {part} = {in_braces(assigned(kind, of)) if kind else of[0]};"
        for part, kind, of in made
    ]
    law = ["(rod_impact_law)law"] if "law" in FUNCTIONS[name]["arguments"] else []
    call = f"rod_impact_{name}({', '.join([*law, *kinds])})"
    found = flat(record, "found")
    stored = [f"r[{i}] = (double){path};" for i, path in enumerate(found)]
    return f"""
void {name}(int law, int n, const double *a, double *r) {{
    (void)law;
    for (int i = 0; i < n; i++, a += {sum(len(of) for *_, of in made)}, r += {len(found)}) {{
        {" ".join(lines)}
        const {f"rod_impact_{record}" if record else "double"} found = {call};
        {" ".join(stored)}
    }}
}}"""


def in_javascript(name):
    """A function of a row; numbers go back as text, as JSON knows no nan."""
    lines = []
    for part, record, values in numbers(name):
        fields = json.dumps(assigned(record, values)).replace('"', "") if record else values[0]
        lines.append(f"const {part} = {fields};")
    given = FUNCTIONS[name]["arguments"].replace(": body", "")
    found = ", ".join(flat(FUNCTIONS[name].get("record", ""), "found"))
    call = f"const found = rodImpact.{name}({given});"
    return f"((law, a) => {{ {' '.join(lines)} {call} return [{found}].join(' '); }})"


@pytest.fixture(scope="module")
def header(tmp_path_factory):
    """Folder with the header, written by the command."""
    if CC is None:
        pytest.skip("there is no C compiler")
    folder = tmp_path_factory.mktemp("c")
    assert main(["generate", "--language", "c", "--out", str(folder / "rod_impact.h")]) == 0
    return folder


def built(folder, name, text, flags):
    """Path of what is compiled from a text."""
    (folder / f"{name}.c").write_text(text)
    command = [CC, *flags.split(), "-o", folder / name, folder / f"{name}.c", "-lm"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return str(folder / name)


def c_runner(header, flags):
    """Calls of the functions of a library."""
    text = '#include "rod_impact.h"\n' + "\n".join(map(in_c, FUNCTIONS))
    library = ctypes.CDLL(built(header, f"loops{len(flags)}", text, f"{flags} -shared -fPIC"))

    def run(name, law, columns):
        given = np.stack(np.broadcast_arrays(*columns), axis=-1)
        found = np.empty((len(given), len(flat(FUNCTIONS[name].get("record", ""), ""))))
        pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (given, found)]
        times = [perf_counter()]
        for _ in range(5):
            getattr(library, name)(LAWS.index(law), len(given), *pointers)
            times.append(perf_counter())
        shortest = 1e9 * np.diff(times).min() / len(given)
        print(f"{name}, {law}: {shortest:.0f} ns a call in C")  # seen with -s
        return found.T

    return run


def javascript_runner():
    """Calls of the functions of the script, a tenth of the rows."""
    quickjs = pytest.importorskip("quickjs", reason="there is no JavaScript engine")
    engine = quickjs.Context()
    engine.eval(languages.source("javascript"))

    def run(name, law, columns):
        rows = np.stack(np.broadcast_arrays(*columns), axis=-1).tolist()
        call = f"{json.dumps(rows)}.map(row => {in_javascript(name)}({law!r}, row)).join('\\n')"
        return np.array([line.split() for line in engine.eval(call).split("\n")], dtype=float).T

    return run


@pytest.fixture(scope="module", params=["c", "fusing c", "javascript"])
def run(request):
    """Call a function of one of the languages for many rows, as `run.many` are quick."""
    if request.param == "javascript":
        return javascript_runner(), 10_000
    flags = STRICT if request.param == "c" else FUSING
    return c_runner(request.getfixturevalue("header"), flags), 100_000


def impacts(n, seed):
    """Impacts of all kinds, many of them on an edge; many in the Painleve region."""
    parts = zip(sampling.everyday(n // 2, seed), sampling.wide(n - n // 2, seed + 1), strict=True)
    i = sampling.Impacts(*map(np.concatenate, parts))
    rng = np.random.default_rng(seed)
    edges = {"friction": (0, np.inf), "restitution": (0, 1), "c_x": (0,), "omega": (0,), "X": (0,)}
    for name, values in edges.items():
        for value in values:
            getattr(i, name)[rng.uniform(size=n) < 0.03] = value
    slips = (i.c_x - i.omega * i.Z) * i.X * i.Z < 0
    assert np.mean((i.friction > impact.painleve_friction((i.X, i.Z, i.k))) & slips) > 0.1
    return i


def columns(i):
    """Numbers of impacts in the order of the record `given`."""
    names = ["c_x", "c_z", "omega", "plate_velocity", "X", "Z", "k", "friction", "restitution"]
    return [getattr(i, name) for name in names]


def same(found, wanted):
    """Every number to the last bit, but for what infinite friction leaves of zero."""
    for i, (got, want) in enumerate(zip(found, wanted, strict=True)):
        np.testing.assert_allclose(got, want, rtol=0, atol=1e-140, err_msg=f"number {i}")


@pytest.mark.parametrize("law", LAWS)
def test_an_impact_has_the_same_bits(run, law):
    call, n = run
    i = impacts(n, seed=71)
    want = i.collide(law)
    assert np.bincount(want.regime, minlength=4).min() > n / 100
    same(call("collide", law, columns(i)), want)


@pytest.mark.parametrize("law", LAWS)
def test_an_impact_of_two_bodies_has_the_same_bits(run, law):
    """Also where speeds, levers or responses cancel, against a wall, and of two walls."""
    call, n = run
    for alike in (0.0, 0.99):
        first, second, how = test_pairs.pairs(n // 2, seed=72, alike=alike)
        first.mass[:9] = second.mass[:9] = np.inf
        want = impact.collide_pair(first, second, **how, law=law)
        assert np.bincount(want.regime + 1, minlength=5).min() > 0
        same(
            call("collide_pair", law, [*first, *second, *how.values()]),
            [*want.first, *want.second, *want[2:]],
        )


def test_the_path_turns_where_forward_slip_ends(run):
    """Straight on in a slide; at no slip else, and as far as all laws go together."""
    call, n = run
    i = impacts(n, seed=73)
    u, v, P_x, P_z = call("path", LAWS[0], columns(i))
    hit, finite = i.collide(), np.isfinite(i.friction)
    slides, stops = (finite & (hit.regime == code) for code in (1, 2))
    np.testing.assert_array_equal(P_z[slides], hit.P_z[slides])
    np.testing.assert_array_equal(P_x[slides], hit.P_x[slides])
    A, B, C = call("mobilities", LAWS[0], [i.X, i.Z, i.k])
    scale = np.abs(u) + C * np.abs(P_x) + np.abs(B) * P_z
    assert np.all(np.abs(u + C * P_x - B * P_z)[stops] <= 1e-13 * scale[stops])
    v_f = v + A * hit.P_z - B * hit.P_x
    scale = np.abs(v) + A * hit.P_z + np.abs(B * hit.P_x)
    assert np.all(np.abs(v_f - hit.normal_velocity)[finite] <= 1e-13 * scale[finite])


def test_closed_forms_are_those_of_python(run):
    """Sines may differ in the last digit; where what is left of them cancels, by more."""
    call, _ = run
    rng = np.random.default_rng(74)
    n = 2_000
    tilt, length = rng.uniform(-np.pi / 2, np.pi / 2, n), 1 + 10 ** rng.uniform(-1, 1.5, n)
    mu, epsilon = rng.uniform(0, 1, n) * (np.arange(n) > 4), rng.uniform(0, 1, n)
    tilt[:20], epsilon[10:30], ratio = 0.0, 1.0, 10 ** rng.uniform(-1, 1, n)
    rods = {
        "thin_rod": (impact.thin_rod(tilt, length), (tilt, length)),
        "spherocylinder": (impact.spherocylinder(tilt, length, 0.7), (tilt, length, 0.7)),
        "flat_ended_rod": (impact.flat_ended_rod(tilt, length, 0.7), (tilt, length, 0.7)),
    }

    def near(name, wanted, *columns):
        for got, want in zip(call(name, LAWS[0], columns), wanted, strict=True):
            np.testing.assert_allclose(got, want, rtol=1e-13, err_msg=name)

    for name, (rod, columns) in rods.items():
        for got, want in zip(call(name, LAWS[0], columns), rod, strict=True):
            assert np.all(np.abs(got - want) <= 1e-15 * length), name
        near("critical_friction", [impact.critical_friction(rod)], *rod)
        near("painleve_friction", [impact.painleve_friction(rod)], *rod)
        approach = {"approach_ratio": ratio, "restitution": epsilon}
        near("slide_friction", [impact.slide_friction(rod, **approach)], *rod, ratio, epsilon)
        how = {"friction": mu, "restitution": epsilon, "plate_velocity": 1 + ratio}
        near("drift", impact.drift(rod, **how), *rod, *how.values())
    near("critical_tilts", impact.critical_tilts(mu), mu)
    best = impact.optimal_tilt(friction=mu, restitution=epsilon)
    near("optimal_tilt", best, mu, epsilon)


def test_the_example_of_the_header_prints_what_python_finds(header):
    text = (header / "rod_impact.h").read_text()
    example = re.search(r"( {4}#include <stdio.h>\n.*?\n {4}}\n)", text, re.DOTALL)[1]
    program = built(header, "example", textwrap.dedent(example), STRICT)
    printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    rod = impact.spherocylinder(0.35, 8.0)
    after = impact.collide(1.0, -2.0, geometry=rod, friction=0.3, restitution=0.65)
    ball, rest = (
        (1.0, 0.63, 0.0, Z, 0.0, c, w) for Z, c, w in ((1.0, -1.0, 2.0), (-1.0, 0.0, 0.0))
    )
    hit = impact.collide_pair(ball, rest, friction=0.3, restitution=1.0, law="stronge")
    assert printed == (
        f"plate: regime {after.regime:d}, velocity {after.c_x:.6f} {after.c_z:.6f}, "
        f"spin {after.omega:.6f}\n"
        f"balls: regime {hit.regime:d}, spins {hit.first.omega:.6f} {hit.second.omega:.6f}, "
        f"energy {hit.energy_change:+.6f}\n"
    )


@pytest.mark.parametrize("law", LAWS)
def test_what_is_out_of_its_domain_is_invalid_as_in_python(run, law):
    call, _ = run
    i = impacts(2_000, seed=75)
    odd = {"k": (0, -1, np.nan), "friction": (-1, np.nan), "restitution": (-0.1, 1.1, np.nan)}
    odd |= dict.fromkeys(("c_x", "c_z", "omega", "plate_velocity", "X", "Z"), (np.nan, np.inf))
    for n, (name, value) in enumerate((name, x) for name, values in odd.items() for x in values):
        getattr(i, name)[n::40] = value
    want = i.collide(law)
    assert np.mean(want.regime == impact.Regime.INVALID) > 0.4
    same(call("collide", law, columns(i)), want)
    first, second, how = test_pairs.pairs(2_000, seed=76)
    for n, name in enumerate(impact.Body._fields):
        getattr(first, name)[n::20] = np.nan
        getattr(second, name)[n + 7 :: 20] = -np.inf
    how["friction"][15::20], how["restitution"][16::20], second.k[17::20] = -1, 2, 0
    want = impact.collide_pair(first, second, **how, law=law)
    assert np.mean(want.regime == impact.Regime.INVALID) > 0.5
    found = call("collide_pair", law, [*first, *second, *how.values()])
    same(found, [*want.first, *want.second, *want[2:]])


FLAGS = "-O2 -march=haswell"  # which can fuse a product and a sum
CALL = '#include "rod_impact.h"\nint main(void) { return rod_impact_is_exact(); }\n'


@pytest.mark.parametrize(
    "flag",
    [
        *("-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-freciprocal-math"),
        *("-fassociative-math -fno-signed-zeros -fno-trapping-math", "-ffinite-math-only"),
        *("-mfpmath=387", FLAGS),
    ],
)
def test_flags_that_break_sums_are_refused(header, flag):
    (header / "call.c").write_text(CALL)
    command = [CC, *flag.split(), "-c", "-o", "/dev/null", "call.c"]
    done = subprocess.run(command, cwd=header, capture_output=True, text=True)
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
        names = re.findall(r"defined\((__[A-Z_]+__)\)", (header / "rod_impact.h").read_text())
        text = "".join(f"#undef {name}\n" for name in names if "GNUC" not in name) + CALL
    done = subprocess.run([built(header, "exact", text, flags)])
    assert done.returncode == exact


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
    done = subprocess.run(["node", "use.mjs"], cwd=tmp_path, capture_output=True, text=True)
    hit = impact.collide(1.0, -2.0, geometry=impact.thin_rod(0.4), friction=0.3, restitution=0.65)
    names = ",".join(["Regime", *FUNCTIONS])
    assert done.stdout == f"true {hit.regime:d} 2 {names}\n", done.stderr


def test_the_types_name_every_field_and_function():
    text = languages.source("typescript")
    for name, about in FUNCTIONS.items():
        assert len(re.findall(rf"^export function {name}\(", text, re.M)) == 1
        assert f"readonly {name}: typeof {name};" in text
        record = about.get("record", "").title().replace("_", "")
        assert re.search(rf"^export function {name}\(.*\): {record or 'number'};$", text, re.M)
    for record, fields in RECORDS.items():
        body = re.search(rf"interface {record.title().replace('_', '')} {{(.*?)\n}}", text, re.S)[1]
        assert re.findall(r"^    (\w+): ", body, re.M) == list(fields)


@pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler")
def test_the_header_is_cpp_as_well(header):
    (header / "all.cpp").write_text('#include "rod_impact.h"\n')
    command = ["c++", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "all.cpp"]
    subprocess.run(command, cwd=header, check=True)


def test_the_script_refuses_an_unknown_law():
    quickjs = pytest.importorskip("quickjs", reason="there is no JavaScript engine")
    engine = quickjs.Context()
    engine.eval(languages.source("javascript"))
    with pytest.raises(quickjs.JSException, match="law must be one of newton, poisson, stronge"):
        engine.eval("rodImpact.collide('hooke', {})")
    with pytest.raises(ValueError, match=r"one of c, javascript, .*, got 'fortran'"):
        languages.source("fortran")


def test_the_command_prints_a_text_and_no_other_file(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for language in languages.LANGUAGES:
        assert main(["generate", "--language", language]) == 0
        assert capsys.readouterr().out == languages.source(language)
    assert list(tmp_path.iterdir()) == []


def test_a_file_of_another_kind_is_not_replaced(tmp_path, capsys):
    mine = tmp_path / "mine.h"
    for text, code in (("my own", 2), (languages.source("c"), 0)):
        mine.write_text(text, encoding="utf-8")
        assert main(["generate", "--language", "c", "--out", str(mine)]) == code
        assert mine.read_text(encoding="utf-8") == text
    assert "--out must be a new file or a generated one" in capsys.readouterr().err
