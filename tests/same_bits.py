"""Compare two source trees bit for bit: run the same scenes in both and compare all numbers.

    python tests/same_bits.py TREE_A TREE_B [--only NAME ...]

Each tree runs in a process of its own, with TREE/.venv/bin/python where there is one. A scene is
`same` if every number has the same bits in both trees, nan included; otherwise its first
difference is printed. Only public names of `md` and `impact` are used.

Exit status: 0 if all scenes are the same, 1 if any differs or fails, 2 for bad input.
"""

import argparse
import dataclasses
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Mapping
from functools import partial
from math import radians
from pathlib import Path

import numpy as np

NOT_COMPARED = {"run_seconds", "compile_seconds", "seconds", "needed_seconds", "scene", "versions"}
NOT_COMPARED |= {"next_digit_seconds", "unwritten"}

TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
RUNS = {f"{base}: {run}": more for base in TABLES for run, more in TABLES[base]["runs"].items()}
IMPACTS = ("leapfrog", "verlet", "gear", "dop853")


def load(name):
    """The scene of a run."""
    import md  # of the tree under test

    base, changes = TABLES[name.partition(":")[0]], []
    for text in f"{base['changes']} {RUNS.get(name, '')}".split():
        changes += [text.replace("*", contact) for contact in base["contacts"].split()]
    return md.load(base["scene"], changes)


def run(name, **options):
    """A short run, or one until its drift is known to a half."""
    import md

    length = {"tolerance": 0.5} if name.startswith("tolerance") else {"periods": 6}
    return md.run(load(name), **length, **options)


def impacts(integrator):
    """One impact under each law, without and with vibration and gravity."""
    import md

    moving = {"vibration": (0.05, 2.0, 0.4), "gravity": (0.0, -1.0)}
    return {
        f"{name}, {'vibrated' if effects else 'at rest'}": md.impact(
            radians(35),
            0.5,
            -1.0,
            0.1,
            **effects,
            friction=0.3,
            law=law(stiffness=1e5),
            integrator=integrator,
        )
        for name, law in md.LAWS.items()
        for effects in ({}, moving)
    }


def resumed(name):
    """A run of seven periods with a stop after three, and the bytes of its trajectory."""
    import md

    scene, files = load(name), {"checkpoint": "run.npz", "trajectory": "run.xyz"}
    md.run(scene, periods=3, frames=2, **files)
    result = md.run(scene, periods=7, frames=2, **files)
    return {"result": result, "trajectory": np.frombuffer(Path("run.xyz").read_bytes(), np.uint8)}


def theory():
    """The impact map under each law, plain and compiled, and what follows from it."""
    import impact
    import impact.compiled

    random = np.random.default_rng(1)
    tilt, mu, c_x, spin = random.uniform([[0], [0], [-2], [-1]], [[1.5], [2], [2], [1]], (4, 500))
    setting = {"friction": mu, "restitution": 0.65, "geometry": impact.spherocylinder(tilt, 8.0)}
    found = {
        f"{module.__name__}, {law}": module.collide(c_x, -1.0, spin, law=law, **setting)
        for module in (impact, impact.compiled)
        for law in ("newton", "poisson", "stronge")
    }
    found["drift"] = impact.drift(impact.thin_rod(tilt), friction=mu, restitution=0.65)
    return found | {"critical": impact.critical_tilts(mu)}


def bouncing():
    """Rods at fixed tilt and rods let go."""
    import impact.bouncing
    import impact.falling

    setting = {"gamma": 3.3, "friction": 0.3, "restitution": 0.65, "rods": 3, "seed": 4}
    rod = impact.thin_rod(radians(30))
    return {
        "bounce": impact.bouncing.bounce(rod, landings=300, **setting),
        "record": impact.bouncing.record(rod, landings=50, law="stronge", **setting),
        "fall": impact.falling.fall(0.2, length=30.0, diameter=3.0, landings=50, **setting),
    }


SCENES = {
    **{name: partial(run, name) for name in RUNS},
    "row: no ledger": partial(run, "row", ledger=False),
    "row: resumed, trajectory": partial(resumed, "row"),
    "annulus: resumed, trajectory": partial(resumed, "annulus"),
    **{f"impact: {name}": partial(impacts, name) for name in IMPACTS},
    "theory: impact map": theory,
    "theory: bouncing and falling": bouncing,
}


def quantities(value, path=""):
    """All numbers of a result as arrays, by path; texts and None are left out."""
    if dataclasses.is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    elif hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping):
        parts = {name: part for name, part in value.items() if name not in NOT_COMPARED}
    elif isinstance(value, list | tuple) and not all(isinstance(v, int | float) for v in value):
        parts = dict(enumerate(value))
    else:
        array = np.asarray(value)
        return {path: array} if array.dtype.kind in "biuf" and array.size else {}
    return {
        key: array
        for name, part in parts.items()
        for key, array in quantities(part, f"{path}.{name}" if path else str(name)).items()
    }


def compute(tree, names):
    """Run scenes of the tree under test; save numbers or error of each in this folder."""
    import impact
    import md

    for module in (md, impact):
        if not Path(module.__file__).is_relative_to(tree):
            sys.exit(f"{module.__name__} is from {module.__file__}, not from {tree}")
    here = Path.cwd()
    for number, name in enumerate(names):
        (here / str(number)).mkdir()
        os.chdir(here / str(number))
        print(f"\r\033[K{tree}: {name}" * sys.stderr.isatty(), end="", file=sys.stderr, flush=True)
        try:
            np.savez("numbers.npz", **quantities(SCENES[name]()))
        except Exception as error:  # one scene that fails does not end the comparison
            Path("error").write_text(f"{type(error).__name__}: {error}")
    print("\r\033[K" * sys.stderr.isatty(), end="", file=sys.stderr)


def difference(a, b):
    """First difference of two arrays, in words; empty if all bits are the same."""
    if (a.dtype, a.shape) != (b.dtype, b.shape):
        return f"{a.dtype}{list(a.shape)} against {b.dtype}{list(b.shape)}"
    if a.tobytes() == b.tobytes():
        return ""
    pairs = enumerate(zip(a.ravel(), b.ravel(), strict=True))
    index, (x, y) = next((i, p) for i, p in pairs if p[0].tobytes() != p[1].tobytes())
    where = f"[{', '.join(str(i) for i in np.unravel_index(index, a.shape))}] " if a.shape else ""
    return f"{where}{x} against {y}"


def compared(a, b):
    """Whether two trees give the same numbers for a scene, and a line that says so."""
    for side, folder in (("A", a), ("B", b)):
        if (folder / "error").exists():
            return False, f"fails in {side}: {(folder / 'error').read_text()}"
    with np.load(a / "numbers.npz") as first, np.load(b / "numbers.npz") as second:
        a, b = dict(first), dict(second)
    if a.keys() != b.keys():
        return False, f"differs: only one tree has {', '.join(sorted(a.keys() ^ b.keys()))}"
    for name in a:
        if found := difference(a[name], b[name]):
            return False, f"differs in {name}: {found}"
    return True, f"same, {sum(array.size for array in a.values())} numbers"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tree_a", type=Path)
    parser.add_argument("tree_b", type=Path)
    parser.add_argument("--only", nargs="+", metavar="NAME", help="scenes whose names begin so")
    options = parser.parse_args()
    names = [n for n in SCENES if n.startswith(tuple(options.only or ("",)))]
    if not names:
        parser.error(f"--only {options.only}: no such scene; there are {', '.join(SCENES)}")
    with tempfile.TemporaryDirectory() as temporary:
        folders = []
        for side, tree in (("A", options.tree_a.resolve()), ("B", options.tree_b.resolve())):
            if not (tree / "md" / "__init__.py").exists():
                parser.error(f"{tree} has no md/__init__.py")
            python = tree / ".venv" / "bin" / "python"
            folders.append(Path(temporary) / side)
            folders[-1].mkdir()
            command = [str(python if python.exists() else sys.executable), "-P", __file__]
            command += ["--compute", str(tree), *names]
            environment = {**os.environ, "PYTHONPATH": str(tree)}
            if subprocess.run(command, cwd=folders[-1], env=environment).returncode:
                parser.error(f"{tree} cannot be run")
        equal = True
        for number, name in enumerate(names):
            same, words = compared(*(folder / str(number) for folder in folders))
            equal &= same
            print(f"{name:40} {words}")
    sys.exit(not equal)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--compute"]:
        compute(Path(sys.argv[2]), sys.argv[3:])
    else:
        main()
