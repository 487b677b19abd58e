"""Decorators that mark kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

KERNELS: list[Callable[..., Any]] = []
"""All kernels of the modules that have been imported."""
APART: list[Callable[..., Any]] = []
"""Kernels that are compiled once, and not inlined in their callers."""
WIDE: list[Callable[..., Any]] = []
"""Kernels that compiled loops evaluate for four rows at once, in all branches."""
COMPILED: dict[Callable[..., Any], Callable[..., Any]] = {}
"""Function that replaces each kernel in compiled code."""
SUMS: list[Callable[..., Any]] = []
"""Kernels whose sums compiled code may compute in any order, and thus several terms at
a time.
"""


def kernel(function: Function) -> Function:
    """Mark a function as a kernel for compiled code. The function itself is unchanged."""
    KERNELS.append(function)
    return function


def kernel_apart(function: Function) -> Function:
    """Mark a kernel that is long, or called in many places."""
    APART.append(function)
    return kernel(function)


def kernel_wide(function: Function) -> Function:
    """Mark a kernel with unpredictable branches. Computing all branches for four rows
    at once is quicker than branching.
    """
    WIDE.append(function)
    return kernel(function)


def compiled_as(
    other: Callable[..., Any], *, sums: bool = False
) -> Callable[[Function], Function]:
    """Decorator for kernels that compiled code replaces by ``other``, which is equal to
    within round-off.

    With ``sums``, compiled code may add terms in any order.
    """

    def marked(function: Function) -> Function:
        """Register the function, and return it unchanged."""
        COMPILED[function] = other
        if sums:
            SUMS.append(function)
        return kernel(function)

    return marked
