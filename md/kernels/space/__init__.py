"""Rods in space, compiled: on a plate, between cylindrical walls.

`pairs` has the forces between rods, `forces` those of plate and walls and all friction, `geometry`
the closest points, `march` the steps and the samples.
"""
