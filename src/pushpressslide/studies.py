"""The old name of ``pushpressslide_studies``, a package of its own.

Modules below it are those of the new name. It goes with version 0.4.
"""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec, spec_from_loader
from types import ModuleType
from typing import Any

from pushpressslide.core.errors import MissingPackageError

NEW = "pushpressslide_studies"

if find_spec(NEW) is None:
    raise MissingPackageError(
        f"{__name__} is {NEW} now, which is not installed; "
        "pip install pushpressslide-studies"
    )
warnings.warn(
    f"{__name__} is {NEW} now; the old name goes with version 0.4",
    DeprecationWarning,
    stacklevel=2,
)
__path__: list[str] = []


class _Forward(MetaPathFinder, Loader):
    """Finds the modules of the old name under the new one."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        """Return how a module of the old name is loaded; None for any other."""
        old = fullname.startswith(f"{__name__}.")
        return spec_from_loader(fullname, self) if old else None

    def exec_module(self, module: ModuleType) -> None:
        """Put the module of the new name in place of one that was made."""
        new = module.__name__.replace(__name__, NEW, 1)
        sys.modules[module.__name__] = importlib.import_module(new)


sys.meta_path.insert(0, _Forward())


def __getattr__(name: str) -> Any:
    return getattr(importlib.import_module(NEW), name)
