"""The extra ``fast``: whether numba, which compiles the kernels, is installed and
enabled.
"""

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
    """Run batches inside the block as if numba were not installed."""
    token = _unwanted.set(True)
    try:
        yield
    finally:
        _unwanted.reset(token)


def compiler() -> ModuleType | None:
    """The module numba. None if it is not installed or disabled."""
    return None if _unwanted.get() else installed()


@cache
def installed() -> ModuleType | None:
    """The module numba. None if it is not installed."""
    try:
        importlib.import_module("numba.extending")
    except ImportError:
        return None
    return importlib.import_module("numba")


def loaded() -> bool:
    """Whether numba has been imported and is enabled."""
    return "numba" in sys.modules and compiler() is not None


def note_compiled(seconds: float) -> None:
    """Add the compile time of a loop."""
    _compiled.append(seconds)


def compiling() -> str:
    """One line on the time this process spent on compiling kernels. Empty if it is
    negligible.
    """
    spent = sum(_compiled)
    if spent < SHOWN:
        return ""
    return f"{spent:.0f} s of it compiled kernels, once on this machine"
