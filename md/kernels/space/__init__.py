"""Rods in space, compiled: on a plate, between cylindrical walls.

`pairs` has the forces between rods, `walls` those of the walls, `batch` what both compute side by
side, `forces` effects, state and the motion of points, `plate` the plate's forces, `touches` its
record, `energy` what elastic forces derive from, `geometry` the closest points, `march` the steps
and the samples.
"""
