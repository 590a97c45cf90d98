"""Compiled kernels of the molecular dynamics: a row in a plane and an annulus in space alike.

From the bottom up: `vectors`, tuples of two numbers in the plane and of three in space; `contact`,
the forces of every contact, of rod on plate, rod on rod and rod on wall; `neighbours`, the closest
points of two rods and which rods may touch; `state`, the effects on rods and their arrays; `batch`,
contacts side by side, of rods in `pairs`; `surfaces`, the plate and walls; `touches`, the record of
their touches; `march`, the steps of many rods and their energy; `single`, the integrators of one
rod and the equations between switches; `codes`, stop codes, columns and phases. A kernel takes
named tuples whose fields name their units; a field that is `None` is an absent effect: Numba sees
the type and leaves its code out.

A new effect that acts on a rod, say the drag of air, takes one function, one key of the scene and
one line where it is called:

1. the function, in `state`: `air(constant, velocity)` gives a force, and `nothing(velocity)` `if
   constant is None`; what may be absent is an argument of its own, as Numba drops a branch by a
   test of an argument;
2. the key, in `md.scene`: a field of `Scene`, `None` by default, with its domain and unit;
   `Effects` in `state` has a field of that name, which `md.host.all_effects` fills;
3. the line, in `state.field`, where the forces by all but contacts are added up, for one rod
   (`single`), a row and an annulus (`march`). An effect that loses energy adds to the ledger as
   `march.accounted` does.

The effect gets its entry in `tests/test_effects.py`: the scene with it, the scene without it,
its place in the arguments.
"""
