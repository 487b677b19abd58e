"""Shell completion of benchmark and experiment names."""

from __future__ import annotations

from pushpressslide.cli.complete import begun

BENCHMARKS = (
    "pushes",
    "presses",
    "tick",
    "agreement",
    "coverage",
    "turning",
    "sticking",
    "select",
    "batches",
    "dubins",
    "planners",
    "engines",
    "mpc",
    "runs",
    "memory",
    "truths",
    "start",
    "scaling",
)
"""Names of the benchmarks in ``bench.bench.BENCHMARKS``, which is slow to import."""

EXPERIMENTS = (
    "rear-push",
    "joint-tracking",
    "press-slide",
    "identified-rho",
    "tool-use",
    "two-arms",
    "pivot-and-move",
    "press-fit",
    "virtual-axle",
)
"""Names of the experiments in ``paper.experiments``, which is slow to import."""


def benchmarks(incomplete: str) -> list[str]:
    """Benchmarks whose names begin with ``incomplete``."""
    return begun(BENCHMARKS, incomplete)


def experiments(incomplete: str) -> list[str]:
    """Experiments of the paper whose names begin with ``incomplete``."""
    return begun(EXPERIMENTS, incomplete)
