"""Shell completion of task and mode names."""

from __future__ import annotations

from collections.abc import Iterable
from glob import escape, glob
from importlib import resources
from pathlib import Path


def mode_names() -> list[str]:
    """Names of the contact modes, taken from the names of their files."""
    return [name for name in _stems("modes", ".py") if name not in ("__init__", "base")]


def tasks(incomplete: str) -> list[str]:
    """Shipped tasks, YAML files and folders whose names begin with ``incomplete``."""
    paths = sorted(map(Path, glob(escape(incomplete) + "*")))
    files = [str(path) for path in paths if path.suffix in (".yaml", ".yml")]
    folders = [f"{path}/" for path in paths if path.is_dir()]
    return begun(_stems("tasks", ".yaml"), incomplete) + files + folders


def modes(incomplete: str) -> list[str]:
    """Modes whose names begin with ``incomplete``."""
    return begun(mode_names(), incomplete)


def _stems(folder: str, suffix: str) -> list[str]:
    """Stems of the package's files with a ``suffix``, found without importing anything."""
    files = resources.files("pushpressslide").joinpath(folder).iterdir()
    return sorted(f.name.removesuffix(suffix) for f in files if f.name.endswith(suffix))


def begun(names: Iterable[str], incomplete: str) -> list[str]:
    """The names that begin with ``incomplete``."""
    return [name for name in names if name.startswith(incomplete)]
