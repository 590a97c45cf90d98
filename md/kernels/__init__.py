"""Compiled kernels of the molecular dynamics."""
