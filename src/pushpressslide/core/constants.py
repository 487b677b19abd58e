"""Physical constants."""

GRAVITY = 9.81
"""Gravitational acceleration [m/s^2]."""
