"""Decorators that mark kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

KERNELS: list[Callable[..., Any]] = []
"""All kernels of the modules that have been imported."""
APART: list[Callable[..., Any]] = []
"""Kernels that are compiled once, not in each of their callers."""
WIDE: list[Callable[..., Any]] = []
"""Kernels of which compiled loops take four rows at once, every branch of each."""
COMPILED: dict[Callable[..., Any], Callable[..., Any]] = {}
"""Function that compiled code runs in place of each kernel."""
SUMS: list[Callable[..., Any]] = []
"""Kernels that compiled code may add up in any order, and so several at a time."""


def kernel(function: Function) -> Function:
    """Mark a function as a kernel that compiled code may call. The function itself is
    unchanged.
    """
    KERNELS.append(function)
    return function


def kernel_apart(function: Function) -> Function:
    """Mark a kernel that is long, or called in many places."""
    APART.append(function)
    return kernel(function)


def kernel_wide(function: Function) -> Function:
    """Mark a kernel with unpredictable branches. Computing all of them for four rows at
    once is quicker than branching.
    """
    WIDE.append(function)
    return kernel(function)


def compiled_as(
    other: Callable[..., Any], *, sums: bool = False
) -> Callable[[Function], Function]:
    """Decorator for kernels that compiled code replaces by ``other``, which is equal to
    round-off.

    With ``sums``, compiled sums may run in any order.
    """

    def marked(function: Function) -> Function:
        """Mark the function and return it unchanged."""
        COMPILED[function] = other
        if sums:
            SUMS.append(function)
        return kernel(function)

    return marked
