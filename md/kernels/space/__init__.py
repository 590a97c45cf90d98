"""Rods in space, compiled: on a plate, between cylindrical walls.

`pairs` has the forces between rods, `forces` those of the walls and all friction, `plate` the
plate's, `touches` its record, `energy` what elastic forces derive from, `geometry` the closest
points, `march` the steps and the samples.
"""
