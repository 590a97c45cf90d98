"""Rods in space: on a plate, between cylindrical walls."""
