"""Paths for the reduced-order models, independent of modes, arms and engines."""
