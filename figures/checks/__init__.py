"""Figures that compare simulation and theory."""
