"""The extra ``fast``: whether numba, which compiles kernels, is installed and wanted."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from types import ModuleType

_unwanted: ContextVar[bool] = ContextVar("unwanted", default=False)


@contextmanager
def without_numba() -> Iterator[None]:
    """Run batches inside as if numba were not installed."""
    token = _unwanted.set(True)
    try:
        yield
    finally:
        _unwanted.reset(token)


def compiler() -> ModuleType | None:
    """Return numba; None where it is not installed or not wanted."""
    return None if _unwanted.get() else installed()


@cache
def installed() -> ModuleType | None:
    """Return numba; None where it is not installed."""
    try:
        importlib.import_module("numba.extending")
    except ImportError:
        return None
    return importlib.import_module("numba")


def loaded() -> bool:
    """Return whether numba has been imported, and is wanted."""
    return "numba" in sys.modules and compiler() is not None
