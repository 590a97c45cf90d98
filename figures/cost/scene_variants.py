"""Every effect of a scene, switched on alone and switched off alone: the scenes to compare.

A variant is a change of the full scene, the row of the other figures with all that a scene can
have. An effect *alone* stands on the barest scene in which it makes sense; *within*, the full scene
is compared with itself without the effect and without what needs it (no plate: no vibration,
friction or landings either; no contacts of rods: no box; and in an open box no contact of the last
rod with the first).
"""

from collections.abc import Iterable
from copy import deepcopy
from itertools import chain
from math import degrees
from typing import NamedTuple

from md.host import Engine, prepare, step_of
from md.scene import Scene, from_tables, put

from ..lib.runs import FRICTION, GAMMA, RESTITUTION, SIMPLE_ROW, Changes

DIAGNOSTICS = frozenset(("ledger", "touches", "series"))
STEP_SIZE = step_of(from_tables(SIMPLE_ROW))[0]  # of all variants
TILT_DEG = degrees(from_tables(SIMPLE_ROW).tilt)


class Variant(NamedTuple):
    """Changes of the full scene, and the diagnostics that run with it."""

    changes: Changes
    diagnostics: frozenset[str] = DIAGNOSTICS

    @property
    def scene(self) -> Scene:
        """Scene of this variant: the full one with its changes."""
        return from_tables(put(SIMPLE_ROW, deepcopy({"step.size": STEP_SIZE, **self.changes})))

    def engine(self) -> Engine:
        """Engine of the scene, at its start."""
        named = self.diagnostics
        return prepare(self.scene, ledger="ledger" in named, touches="touches" in named)


class Effect(NamedTuple):
    """Pairs of variants, with the effect and without it; its price is the difference."""

    alone: tuple[Variant, Variant]
    within: tuple[Variant, Variant]
    drifts: bool = False  # whether the changed scene has a drift to compare

    @property
    def changed(self) -> Variant:
        """Variant of `within` that is not the full scene."""
        with_it, without = self.within
        return without if with_it == FULL else with_it


FULL = Variant({})


def _bare(changes: Changes, *diagnostics: str) -> Variant:
    """Variant with only the named diagnostics."""
    return Variant(changes, frozenset(diagnostics))


def _effect(changes: Changes, base: Changes, without: Changes, drifts: bool = True) -> Effect:
    """An effect that the full scene has."""
    return Effect((_bare(changes), _bare(base)), (FULL, Variant(without)), drifts)


def _diagnostic(name: str, base: Changes) -> Effect:
    """A diagnostic of the full scene."""
    return Effect((_bare(base, name), _bare(base)), (FULL, Variant({}, DIAGNOSTICS - {name})))


def _instead(change: Changes, usual: Changes, everywhere: Changes | None = None) -> Effect:
    """An alternative to what the full scene has; there it is `everywhere`."""
    alone = _bare(PLATE_SCENE | change), _bare(usual)
    return Effect(alone, (Variant(everywhere or change), FULL), True)


def _zero(key: str, base: Changes) -> Effect:
    """An effect of the size zero against a scene that does not name it."""
    zero, unnamed = {key: 0.0}, {key: "none"}
    alone = _bare(base | zero), _bare(base | unnamed)
    return Effect(alone, (Variant(zero), Variant(unnamed)))


OPEN = {"box": "none", "start.tilt_deg": TILT_DEG}  # which the box gives otherwise
NOTHING = dict.fromkeys(("gravity", "plate", "contacts.plate", "contacts.rods"), "none") | OPEN
BARE = _bare(NOTHING)
SMOOTH = {"law": "coulomb", "restitution": 1.0}
LOSSY = {"law": "coulomb", "restitution": RESTITUTION}
SPRING = {
    "law": "constant_restitution",
    "restitution": 1.0,
    "friction": FRICTION,
    "tangential_ratio": 3,
    "tangential_damping": 0.0,
}
DAMPED = SPRING | {"tangential_damping": 1.0}
PRINTED = {"contacts.plate": {"law": "appendix_a", "friction": FRICTION}}  # Appendix A
EVERYWHERE = PRINTED | {"contacts.rods": PRINTED["contacts.plate"]}
CONSTRAINT = {"contacts.plate": LOSSY | {"friction": FRICTION}}
SOLID = {"rods.inertia": "solid"}

FALLING = NOTHING | {"gravity": {}}
PLATE_SCENE = FALLING | {"plate": {}, "contacts.plate": SMOOTH}  # at rest
RODS_SCENE = NOTHING | {"contacts.rods": SMOOTH}


def _contacts(part: str, base: Changes) -> dict[str, Effect]:
    """Losses and friction of the plate, or between rods."""
    name = f"contacts.{part}"
    lossy, spring, damped = (base | {name: law} for law in (LOSSY, SPRING, DAMPED))
    undamped = {f"{name}.tangential_damping": 0.0}
    return {
        f"{part}: dashpot": _effect(lossy, base, {f"{name}.restitution": 1.0}),
        f"{part}: friction, a spring": _effect(spring, base, {f"{name}.friction": 0.0}),
        f"{part}: dashpot of friction": _effect(damped, spring, undamped),
    }


NO_PLATE = {"plate": "none", "contacts.plate": "none"}
VIBRATED = PLATE_SCENE | {"plate.acceleration": GAMMA}
BOXED = RODS_SCENE | {"box": SIMPLE_ROW["box"]}
ROUGH = PLATE_SCENE | {"contacts.plate": DAMPED | {"restitution": RESTITUTION}}
EFFECTS = {
    "gravity": _effect(FALLING, NOTHING, {"gravity": "none"}, drifts=False),
    "plate": _effect(PLATE_SCENE, FALLING, NO_PLATE, drifts=False),
    "plate: vibration": _effect(VIBRATED, PLATE_SCENE, {"plate.acceleration": "none"}),
    **_contacts("plate", PLATE_SCENE),
    "rods": _effect(RODS_SCENE, NOTHING, {"contacts.rods": "none"}, drifts=False),
    **_contacts("rods", RODS_SCENE),
    # A row that is open falls over.
    "periodic box": _effect(BOXED, RODS_SCENE, OPEN, drifts=False),
    "energy ledger": _diagnostic("ledger", RODS_SCENE),
    "record of landings": _diagnostic("touches", PLATE_SCENE),
    "series of means": _diagnostic("series", NOTHING),
}
INSTEAD = {
    "friction of the plate: constraint": _instead(CONSTRAINT, ROUGH),
    "contact law: Appendix A": _instead(PRINTED, ROUGH, EVERYWHERE),
    "inertia: solid": _instead(SOLID, PLATE_SCENE),
}
OFF = {
    "off: friction of the plate": _zero("contacts.plate.friction", PLATE_SCENE),
    "off: friction of rods": _zero("contacts.rods.friction", RODS_SCENE),
    "off: acceleration of the plate": _zero("plate.acceleration", PLATE_SCENE),
}
GROUPS = {"effect": EFFECTS, "instead": INSTEAD, "off": OFF}


def variants(effects: Iterable[Effect]) -> list[Variant]:
    """The full scene, the bare one, and other variants that effects name, each once."""
    found = [FULL, BARE]
    for effect in effects:
        found += [one for one in chain(effect.alone, effect.within) if one not in found]
    return found
