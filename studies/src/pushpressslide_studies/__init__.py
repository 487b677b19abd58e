"""The paper's experiments, the benchmarks, and push-T as the package gym-pusht plays it.

All are built on ``pushpressslide``, which never imports them.
"""
