"""The extra ``fast``: whether numba, which compiles kernels, is installed and wanted."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from types import ModuleType

SHOWN = 1.0  # [s] of compiling above which a user is informed

_compiled: list[float] = []  # [s] of each loop that this process has compiled
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


def note_compiled(seconds: float) -> None:
    """Add what a loop took to compile."""
    _compiled.append(seconds)


def compiling() -> str:
    """Return one line on what this process spent on compiling kernels; empty where that
    is nothing that one would notice.
    """
    spent = sum(_compiled)
    if spent < SHOWN:
        return ""
    return f"{spent:.0f} s of it compiled kernels, once on this machine"
