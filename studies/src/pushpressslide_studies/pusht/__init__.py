"""Benchmark push-T, in the version of the package gym-pusht."""
