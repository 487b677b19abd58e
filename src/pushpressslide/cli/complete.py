"""What the shell completes: names of tasks, modes, benchmarks and experiments."""

from __future__ import annotations

from collections.abc import Iterable
from glob import escape, glob
from importlib import resources
from pathlib import Path

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
"""Names of ``studies.bench.bench.BENCHMARKS``, which is slow to import."""

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
"""Names of ``studies.paper.experiments``, which is slow to import."""


def mode_names() -> list[str]:
    """Return the names of the contact modes: those of their files."""
    return [name for name in _stems("modes", ".py") if name not in ("__init__", "base")]


def tasks(incomplete: str) -> list[str]:
    """Return the shipped tasks, and the YAML files and folders, that begin so."""
    paths = sorted(map(Path, glob(escape(incomplete) + "*")))
    files = [str(path) for path in paths if path.suffix in (".yaml", ".yml")]
    folders = [f"{path}/" for path in paths if path.is_dir()]
    return _begun(_stems("tasks", ".yaml"), incomplete) + files + folders


def modes(incomplete: str) -> list[str]:
    """Return the modes that begin so."""
    return _begun(mode_names(), incomplete)


def benchmarks(incomplete: str) -> list[str]:
    """Return the benchmarks that begin so."""
    return _begun(BENCHMARKS, incomplete)


def experiments(incomplete: str) -> list[str]:
    """Return the experiments of the paper that begin so."""
    return _begun(EXPERIMENTS, incomplete)


def _stems(folder: str, suffix: str) -> list[str]:
    """Return the names of the package's files of a kind, without importing anything."""
    files = resources.files("pushpressslide").joinpath(folder).iterdir()
    return sorted(f.name.removesuffix(suffix) for f in files if f.name.endswith(suffix))


def _begun(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
