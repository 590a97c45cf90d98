"""Contact laws that are searched, and the claims judged under each of them.

Laws are drawn evenly from ranges of their parameters (`PARAMETERS`), simulated at seven tilts
(`search`), and scored by those numbers of the claims that claims.toml marks as fitted. A second
round lies closer around the best ones (`closer`). Of both the best are simulated again, at all
tilts of the figures (`confirming`).
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

from md.host import step_of
from md.laws import STIFFNESS
from md.scene import both, put
from md.search import Parameter, Search, Target
from md.sweep import Point, Sweep

from ..lib.runs import LENGTH, PARTS, PRINTED, RESOLVED, SIMPLE_ROW, boxes, computed, tilts
from ..lib.style import Data
from . import over_tilt
from .limits import claim_of, grade, read
from .uncertainty import varied

Values = dict[str, float | str]  # of the parameters of a law, by name
LAW_TILTS_DEG, QUICK_DEG = (9, 15, 22, 28, 34, 45, 60), (9, 28, 45)
NUMBERS = {"S1.mean": lambda d: d["restitution"].mean(), **over_tilt.NUMBERS}  # of touches
JUDGED = {  # numbers with limits that every law has
    name: row
    for claim in read()
    for row in claim["numbers"]
    if "holds" in row and (name := f"{claim['id']}.{row['key']}") in NUMBERS
}
HEADED = np.array(["head" in row for row in JUDGED.values()])  # numbers of the matrix
FITTED = HEADED & [claim_of(name)["fitted"] for name in JUDGED]  # and of the score
BEST, DRAWS = 10, 100  # laws between which a second round lies; draws of a score
CLOSER = {False: 64, True: 2}  # laws of the second round, in full and quick
KEPT_DEG = 2  # a row that keeps its tilt is as near to acos(dN/L), at every tilt
CONFIRMED: dict[bool, dict[str, Any]] = {  # runs of the best laws, in full and quick
    False: {"tilts": tilts(False), "periods": 300, "seeds": (3, 4, 5, 6), "best": 10},
    True: {"tilts": QUICK_DEG, "periods": 40, "seeds": (3, 4), "best": 2},
}
SIZE: dict[bool, dict[str, Any]] = {  # of the search: in full, and quick
    False: {"periods": 150, "seeds": (1,), "points": 256},
    True: {"periods": 40, "seeds": (1,), "points": 4},
}
CONSTANT, APPENDIX = "constant restitution", "Appendix A"
_FORMS = {
    CONSTANT: {},
    APPENDIX: PRINTED,
}
_FACTOR = {"with": both(overlap_factor=True), "without": both(overlap_factor=False)}
_SPHERE = 1 / (1 + 1.5 * (LENGTH - 1))  # mass of the tip's sphere in masses of the rod
_MASS = {
    "rod": {},
    "sphere": both(stiffness=STIFFNESS * _SPHERE, reduced_mass=_SPHERE / 2),
}
_RANGES = {  # name: option of a contact, where it has a meaning, ends, whether evenly in log
    "restitution": ("restitution", {"form": CONSTANT}, 0.4, 1.0, False),
    "tangential ratio": ("tangential_ratio", {"form": CONSTANT}, 0.3, 300.0, True),
    "tangential damping": ("tangential_damping", {"form": CONSTANT}, 0.0, 1.0, False),
    "damping": ("damping", {"form": APPENDIX, "overlap factor": "without"}, 5.0, 600.0, True),
    "damping by overlap": (
        "damping",
        {"form": APPENDIX, "overlap factor": "with"},
        400.0,
        4e5,
        True,
    ),
}


def _parameters() -> tuple[Parameter, ...]:
    """Form of the law, then options of both contacts under it."""
    found = [
        Parameter("form", choices=_FORMS),
        Parameter("overlap factor", choices=_FACTOR, when={"form": APPENDIX}),
        Parameter("mass", choices=_MASS, when={"form": APPENDIX}),
    ]
    for name, (option, when, low, high, log) in _RANGES.items():
        for part in PARTS:
            keys = (f"contacts.{part}.{option}",)
            found.append(Parameter(f"{name}, {part}", keys, low, high, log, None, when))
    return tuple(found)


PARAMETERS = _parameters()
KNOWN: dict[str, Values] = {  # laws that are confirmed besides, known without search
    "0.65, ratio 3": {
        "form": CONSTANT,
        **{f"restitution, {part}": 0.65 for part in PARTS},
        **{f"tangential ratio, {part}": 3.0 for part in PARTS},
        **{f"tangential damping, {part}": 1.0 for part in PARTS},
    },
    "App. A as printed": {
        "form": APPENDIX,
        "overlap factor": "with",
        "mass": "rod",
        **{f"damping by overlap, {part}": 400.0 for part in PARTS},
    },
}


def search(quick: bool = False) -> Search:
    """The search, without data of its own."""
    targets, base = _targets(QUICK_DEG if quick else LAW_TILTS_DEG), put(SIMPLE_ROW, RESOLVED)
    return Search(base, parameters=PARAMETERS, targets=targets, **SIZE[quick])


def _targets(tilt_deg: Iterable[float]) -> tuple[Target, ...]:
    """The drift in boxes that give these tilts."""
    return tuple(Target({"box.length": box}, "c_x", nan, nan) for box in boxes(tilt_deg))


def _by_law(whole: Sweep) -> list[Sweep]:
    """The runs of each law: over tilt, then over starts."""
    _, *axes = whole.axes
    each = math.prod(whole.shape[1:])
    starts = range(0, len(whole.points), each)
    return [Sweep(tuple(axes), whole.points[i : i + each]) for i in starts]


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Runs of the first round; what follows depends on them."""
    given = search(quick)
    return {"laws": given.sweep(given.draw())}


def closer(given: Search, parts: np.ndarray, score: np.ndarray) -> np.ndarray:
    """Laws between the best ones of the form of the best one, as many as a round of `given`."""
    forms = np.array([law["form"] for law in laws_of(parts)])
    best = parts[np.argmax(score)]
    same = np.flatnonzero(forms == forms[np.argmax(score)])
    near = parts[same[np.argsort(-score[same], kind="stable")[:BEST]]]
    box = np.array([near.min(axis=0), near.max(axis=0)])
    chosen = [p.choices is not None for p in PARAMETERS]
    box[:, chosen] = best[chosen]
    return given.draw(1, box)


def part_of(parameter: Parameter, value: float | str) -> float:
    """The part of a range at which a parameter has this value."""
    if parameter.choices is not None:
        return (list(parameter.choices).index(str(value)) + 0.5) / len(parameter.choices)
    low, high = parameter.low, parameter.high
    if parameter.log:
        return math.log(float(value) / low) / math.log(high / low)
    return (float(value) - low) / (high - low)


def rounded(values: Values) -> np.ndarray:
    """Parts of the ranges of a law, numbers rounded to two digits; what is not named: anything."""
    digits = {n: v if isinstance(v, str) else float(f"{v:.2g}") for n, v in values.items()}
    return np.array([part_of(p, digits[p.name]) if p.name in digits else 0.0 for p in PARAMETERS])


def confirming(parts: np.ndarray, quick: bool = False) -> Sweep:
    """Runs of laws from other starts, at more tilts, longer, with half the step."""
    given = CONFIRMED[quick]
    size = {"seeds": given["seeds"], "periods": given["periods"]}
    again = replace(search(quick), targets=_targets(given["tilts"]), **size)

    def halved(point: Point) -> Point:
        scene = point.scene
        half = replace(scene.step, size=step_of(scene)[0] / 2)
        return replace(point, scene=replace(scene, step=half))

    whole = again.sweep(parts)
    return replace(whole, points=tuple(map(halved, whole.points)))


def later() -> list[Point]:
    """As many runs as follow the first round, of any laws: which ones is not known before."""
    given, known = search(), CONFIRMED[False]["best"] + len(KNOWN)
    any_law = given.draw()
    return [*given.sweep(any_law[: CLOSER[False]]).points, *confirming(any_law[:known]).points]


def judged(whole: Sweep, tilt_deg: Iterable[int], prefix: str = "") -> Data:
    """Of each law: numbers, grades, score with its spread, drift over tilt."""
    nominal = np.array([*tilt_deg])
    tables = [over_tilt.table(sweep, nominal) for sweep in _by_law(computed(whole))]
    value = np.array([[NUMBERS[name](d) for name in JUDGED] for d in tables])
    grades = np.array([_grades(row) for row in value])
    random = np.random.default_rng(1)
    found = {
        "value": value,
        "grade": grades,
        "score": score_of(grades),
        "spread": np.array(
            [np.std([score_of(_varied(d, random)) for _ in range(DRAWS)]) for d in tables]
        ),
        "nominal": nominal,
        "theory": over_tilt.theory(nominal),
        "c_x": np.array([d["c_x"] for d in tables]),
        "c_x_error": np.array([d["c_x_error"] for d in tables]),
        "tilt_off": np.array([np.abs(d["tilt"] - nominal).max() for d in tables]),
    }
    return {prefix + name: values for name, values in found.items()}


def _grades(values: np.ndarray) -> np.ndarray:
    """Of each number; nan where it is not known."""
    return np.array([grade(v, c) for v, c in zip(values, JUDGED.values(), strict=True)], float)


def _varied(d: Data, random: np.random.Generator) -> np.ndarray:
    """Grades, if the measured means of one law vary within their errors."""
    moved = varied(d, [name for name in d if f"{name}_error" in d], random)
    return _grades(np.array([NUMBERS[name](moved) for name in JUDGED]))


def score_of(grades: np.ndarray) -> np.ndarray:
    """Numbers of the fitted claims that hold, those in part counted half; (..., numbers)."""
    return np.nan_to_num(grades)[..., FITTED].sum(axis=-1) / 2


def data(quick: bool = False) -> Data:
    """Of all laws, then of the best ones: parameters as parts of their ranges, and `judged`."""
    given, tilt_deg = search(quick), QUICK_DEG if quick else LAW_TILTS_DEG
    parts, found = given.draw(), judged(sweeps(quick)["laws"], tilt_deg)
    near = closer(replace(given, points=CLOSER[quick]), parts, found["score"])
    late = judged(given.sweep(near), tilt_deg)
    parts = np.concatenate([parts, near])
    same = {"nominal", "theory"}
    found = {n: v if n in same else np.concatenate([v, late[n]]) for n, v in found.items()}
    best = np.argsort(-found["score"], kind="stable")[: CONFIRMED[quick]["best"]]
    chosen = np.array([rounded(law) for law in (*laws_of(parts[best]), *KNOWN.values())])
    runs = confirming(chosen, quick)
    confirmed = judged(runs, CONFIRMED[quick]["tilts"], "best_")
    rounds = np.repeat([0, 1], [len(parts) - len(near), len(near)])
    return {
        "parts": parts,
        "round": rounds,
        **found,
        "best": best,
        "best_parts": chosen,
        "best_step": np.array([sweep.points[0].scene.step.size for sweep in _by_law(runs)]),
        **confirmed,
    }


def laws_of(parts: np.ndarray) -> list[Values]:
    """Values of the parameters that have a meaning in each law."""
    every = [{p.name: p.value(x) for p, x in zip(PARAMETERS, row, strict=True)} for row in parts]
    return [{p.name: v[p.name] for p in PARAMETERS if p.when.items() <= v.items()} for v in every]


def as_good(d: Data) -> np.ndarray:
    """Numbers of the confirmed laws whose score is within the spread of the best, cheapest first.

    Scores so near to each other do not differ, and the larger the step, the cheaper is a run.
    """
    score, best = d["best_score"], np.argmax(d["best_score"])
    near = np.flatnonzero(score >= score[best] - d["best_spread"][best])
    return near[np.argsort(-d["best_step"][near], kind="stable")]


def singled_out(d: Data) -> int:
    """Number of the confirmed law that the figures take."""
    return int(as_good(d)[0])


def outcome(d: Data) -> dict[str, Any]:
    """How many laws were searched; scores of the law singled out, the two best ones, `KNOWN`."""
    score, spread = d["best_score"], d["best_spread"]
    best, second = np.argsort(-score, kind="stable")[:2]
    known = score[len(score) - len(KNOWN) :]
    return {
        "laws": len(d["parts"]),
        "of": int(FITTED.sum()),
        "score": float(score[singled_out(d)]),
        "best": float(score[best]),
        "spread": float(spread[best]),
        "next": [float(score[second]), float(spread[second])],
        "as_good": len(as_good(d)),
        "known": dict(zip(KNOWN, known.tolist(), strict=True)),
    }
