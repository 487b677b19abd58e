"""Old names of modules: each imports the new one, with a warning."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

STUDIES = "pushpressslide_studies"
GEOMETRY = (
    "border",
    "outlined",
    "pieces",
    "polygon",
    "quadrature",
    "shape",
    "shapes",
    "sides",
    "touchable",
    "united",
)
MOVED = {
    "pushpressslide.planar.replay": "pushpressslide.view.planar.replay",
    "pushpressslide.planar.video": "pushpressslide.view.planar.video",
    "pushpressslide.replay": "pushpressslide.view",
    "pushpressslide.sim.view": "pushpressslide.view.drake",
    "pushpressslide.studies": STUDIES,
    **{f"pushpressslide.core.{m}": f"pushpressslide.geometry.{m}" for m in GEOMETRY},
}
"""New names of modules and packages, by their old ones. They go with version 0.4."""


def new_name(name: str) -> str | None:
    """The new name of a module, or of one in a package that has moved."""
    for old, new in MOVED.items():
        if name == old or name.startswith(f"{old}."):
            return new + name.removeprefix(old)
    return None


class Forward:
    """A finder of modules by their old names."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """How a module of an old name is loaded; None for any other."""
        if new_name(fullname) is None:
            return None
        return ModuleSpec(fullname, Forward())  # type: ignore[arg-type]

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """None: a module is made as usual."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Put the module of the new name in place of one that was made."""
        old = module.__name__
        new = str(new_name(old))
        sys.modules[old] = _imported(old, new)
        if old in MOVED:
            warnings.warn(
                f"{old} is {new} now; the old name goes with version 0.4",
                DeprecationWarning,
                stacklevel=2,
            )


def _imported(old: str, new: str) -> ModuleType:
    """The module of the new name; raises MissingPackageError without the studies."""
    try:
        return importlib.import_module(new)
    except ModuleNotFoundError as error:
        if error.name != STUDIES:
            raise
    from pushpressslide.core.errors import MissingPackageError

    raise MissingPackageError(
        f"{old} is {new} now, which is not installed; "
        "pip install pushpressslide-studies"
    )


def install() -> None:
    """Let Python find modules by their old names."""
    if Forward not in sys.meta_path:
        sys.meta_path.insert(0, Forward)
