"""What the shell completes: names of tasks and modes."""

from __future__ import annotations

from collections.abc import Iterable
from glob import escape, glob
from importlib import resources
from pathlib import Path


def mode_names() -> list[str]:
    """Return the names of the contact modes: those of their files."""
    return [name for name in _stems("modes", ".py") if name not in ("__init__", "base")]


def tasks(incomplete: str) -> list[str]:
    """Return the shipped tasks, and the YAML files and folders, that begin so."""
    paths = sorted(map(Path, glob(escape(incomplete) + "*")))
    files = [str(path) for path in paths if path.suffix in (".yaml", ".yml")]
    folders = [f"{path}/" for path in paths if path.is_dir()]
    return begun(_stems("tasks", ".yaml"), incomplete) + files + folders


def modes(incomplete: str) -> list[str]:
    """Return the modes that begin so."""
    return begun(mode_names(), incomplete)


def _stems(folder: str, suffix: str) -> list[str]:
    """Return the names of the package's files of a kind, without importing anything."""
    files = resources.files("pushpressslide").joinpath(folder).iterdir()
    return sorted(f.name.removesuffix(suffix) for f in files if f.name.endswith(suffix))


def begun(names: Iterable[str], incomplete: str) -> list[str]:
    """Return those of some names that begin so."""
    return [name for name in names if name.startswith(incomplete)]
