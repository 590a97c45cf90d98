"""Compiled kernels of the molecular dynamics.

From below: `vectors` in the plane and in space; `contact`, the forces of every contact, of rod on
plate, rod on rod and rod on wall; `joints`, two ends that meet; `plate`, a rod over the plate in
the plane, and `single`, its integrators; `neighbours`, which rods may touch, `batch`, their
contacts side by side, `plane`, the steps of a row, and `touches`, its record; `space`, an annulus;
`rates`, the equations of `md.reference`; `codes`, stop codes, columns and phases. A kernel takes
named tuples whose fields name their units; a field that is `None` is an absent effect: Numba sees
the type and leaves its code out.

A new effect that acts on a rod, say the drag of air, takes one function, one key of the scene and
one line where it is called:

1. the function, in `plate`: `air(constant, velocity)` gives accelerations (x, z, angular), and
   zeros `if constant is None`; what may be absent is an argument of its own, which is tested;
2. the key, in `md.scene`: a field of `Scene`, `None` by default, with its domain and unit;
   `Effects` in `contact` has a field of that name, which `md.rod.effects_of` fills;
3. the line, in `plate.field`, where the accelerations by all but contacts are added up, for one
   rod (`single`) and for a row (`plane`). An effect that loses energy adds to the ledger as
   `plane.plate_accounted` does.

In an annulus the line is in `space.march`, beside gravity. The effect gets its entry in
`tests/test_row_effects.py`: the scene with it, the scene without it, its place in the arguments.
"""
