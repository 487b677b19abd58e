"""The body of every footprint, whatever its base."""

MASS = 1.0
"""Mass [kg]."""
FRICTION = 0.3
"""Friction of the base."""
