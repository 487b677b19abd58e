"""The benchmark push-T, as the package gym-pusht plays it."""
