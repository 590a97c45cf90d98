"""Figures of what accuracy, effects and size cost in time."""
