"""A package whose modules are listed by ``dir`` and imported on first use."""

from __future__ import annotations

import importlib
import pkgutil
import sys
from collections.abc import Callable
from types import ModuleType


def explorable(
    package: str,
) -> tuple[Callable[[str], ModuleType], Callable[[], list[str]]]:
    """The functions ``__getattr__`` and ``__dir__`` of a package, given its full name."""

    def modules() -> list[str]:
        path = sys.modules[package].__path__
        return sorted(info.name for info in pkgutil.iter_modules(path))

    def find(name: str) -> ModuleType:
        """Module of the package."""
        if name not in modules():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return importlib.import_module(f"{package}.{name}")

    return find, modules
