"""Benchmark push-T, as played by the package gym-pusht."""
