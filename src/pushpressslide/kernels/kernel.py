"""The mark of a kernel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

KERNELS: list[Callable[..., Any]] = []
"""All kernels of the modules that have been imported."""
APART: list[Callable[..., Any]] = []
"""Those of them that are compiled once, not in each of their callers."""


def kernel(function: Function) -> Function:
    """Return the function as it is, and note that compiled code may call it."""
    KERNELS.append(function)
    return function


def kernel_apart(function: Function) -> Function:
    """Mark a kernel that is long, or called in many places."""
    APART.append(function)
    return kernel(function)
