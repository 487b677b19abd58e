"""Paths for the reduced-order models. Knows nothing of modes, arms or engines."""
