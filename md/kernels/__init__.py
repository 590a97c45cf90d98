"""Compiled kernels of the molecular dynamics: a row in a plane and an annulus in space alike.

From the bottom up: `vectors`, tuples of two numbers in the plane and of three in space; `contact`,
the forces of every contact, of rod on plate, rod on rod and rod on wall; `neighbours`, the closest
points of two rods and which rods may touch; `state`, the effects on rods and their arrays; `batch`,
contacts side by side, of rods in `pairs`; `surfaces`, the plate and walls; `touches`, the record of
their touches; `march`, the steps of all rods and their energy. Below stand the constants that these
share with their host and the tests: stop codes, columns, phases and limits. A kernel takes named
tuples whose fields name their units; a field that is `None` is an absent effect: Numba sees the
type and leaves its code out.

A new effect that acts on a rod, say the drag of air, takes one function, one key of the scene and
one line where it is called:

1. the function, in `state`: `air(constant, velocity)` gives a force, and `nothing(velocity)` `if
   constant is None`; what may be absent is an argument of its own, as Numba drops a branch by a
   test of an argument;
2. the key, in `md.scene`: a field of `Scene`, `None` by default, with its domain and unit;
   `Effects` in `state` has a field of that name, which `md.host.all_effects` fills;
3. the line, in `state.field`, where the forces by all but contacts are added up for the rods of a
   row, of an annulus, or one alone. An effect that loses energy adds to the ledger as
   `march.accounted` does.

The effect gets its entry in `tests/test_effects.py`: the scene with it, the scene without it,
its place in the arguments.
"""

DEEP = 0.5  # d; deepest overlap: there a cap's centre reaches the plate, or another rod's axis
SKIN = 0.4  # d; a list of pairs holds all axes closer than 1 + SKIN
SAMPLES_A_PERIOD = 32  # samples of tilt and place in each period

# Why a run of a kernel ended.
DONE = 0  # all steps are made
NOT_FINITE = 2  # the state of a rod is not finite
TOO_DEEP = 3  # a rod overlaps with the plate by more than DEEP
FULL_LIST = 4  # more pairs than the list can hold
PAIR_TOO_DEEP = 5  # two rods overlap by more than DEEP
FULL_RECORD = 6  # more touches than the record might hold after another step
TOO_FAST = 7  # a rod moved so far that it may have passed through another one unseen
WALL_TOO_DEEP = 8  # a rod overlaps with a wall of an annulus by more than DEEP

# State of a rod of a row: place and direction at a step, velocities half a step before.
X, Z, SINE, COSINE, C_X, C_Z, OMEGA = range(7)
ROW_COLUMNS = 7

# State of a rod in space, first columns of four vectors: centre and director at a step, velocity
# and the vector about which the director turns (see `state`) half a step before.
PLACE, DIRECTOR, VELOCITY, TURN = 0, 3, 6, 9
SPACE_COLUMNS = 12

# Slots of the contacts of a rod: caps on the plate 0-1; in space caps on the inner wall 2-3,
# between them 4, caps on the outer wall 5-6.
INNER, OUTER = 2, 5
SLOTS = 7
CROSSING = 4  # slots of two rods: ends of the first 0-1, of the second 2-3, between their ends 4

# Columns of the energy ledger, m g d; the first is the work of the plate and of shaken walls.
# Friction stands behind the normal dashpot of the same contact (`batch.acted`).
PLATE_WORK, PLATE_NORMAL, PLATE_FRICTION, PAIR_NORMAL, PAIR_FRICTION = range(5)
LEDGER_COLUMNS = 5
WALL_NORMAL = 5  # and friction behind it, in an annulus alone
ANNULUS_LEDGER = 7

# Columns of the series of a row, one row per period.
TILT_SINE, TILT_COSINE = 0, 1  # sums over rods and samples of sin and cos of twice the tilt
MEAN_X, FELL = 2, 3  # mean x at the start; times that a rod fell past the horizontal
ROW_SERIES = 4
# The same of an annulus.
TILT_SUM, SAMPLED = 0, 1  # sum over samples of the mean tilt, rad; number of samples
ADVANCE = 2  # sum over samples of mean advance about the axis, rad
ANNULUS_SERIES = 3

# Phases of a contact: before its slip first stopped, while it stuck, while it slipped after that.
SLIDE, STUCK, TURNED = 0, 1, 2
PHASES = ("slide", "stick", "reversal")
# Columns of a watched contact: duration of each phase, normal impulse of each phase, and these.
IMPULSE = 3  # column of the normal impulse of phase 0
WATCH_DEEPEST, WATCH_SIDE, WATCH_STOPPED, WATCH_TOUCHED = 6, 7, 8, 9
WATCHED = 10

# Modes of friction between two switches: slip forward, none, backward; FREE: no friction yet.
FORWARD, STICK, BACK, FREE = 1, 0, -1, 2

# Regimes of a contact.
SLIDING, SLIP_STICK, SLIP_REVERSAL = 1, 2, 3
REGIMES = {SLIDING: "slide", SLIP_STICK: "slip-stick", SLIP_REVERSAL: "slip-reversal"}
