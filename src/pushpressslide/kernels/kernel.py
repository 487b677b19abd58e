"""The mark of a kernel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

KERNELS: list[Callable[..., Any]] = []
"""All kernels of the modules that have been imported."""
APART: list[Callable[..., Any]] = []
"""Those of them that are compiled once, not in each of their callers."""
WIDE: list[Callable[..., Any]] = []
"""Kernels of which compiled loops take four rows at once, every branch of each."""
COMPILED: dict[Callable[..., Any], Callable[..., Any]] = {}
"""What compiled code runs in the place of a kernel."""
SUMS: list[Callable[..., Any]] = []
"""Kernels that compiled code may add up in any order, and so several at a time."""


def kernel(function: Function) -> Function:
    """Return the function as it is, and note that compiled code may call it."""
    KERNELS.append(function)
    return function


def kernel_apart(function: Function) -> Function:
    """Mark a kernel that is long, or called in many places."""
    APART.append(function)
    return kernel(function)


def kernel_wide(function: Function) -> Function:
    """Mark a kernel whose branches no processor foresees: to work out all of them, for
    four rows at once, takes less than to guess.
    """
    WIDE.append(function)
    return kernel(function)


def compiled_as(
    other: Callable[..., Any], *, sums: bool = False
) -> Callable[[Function], Function]:
    """Return a mark of kernels in whose place compiled code runs ``other``, as it gives
    the same but for rounding; with ``sums`` in any order.
    """

    def marked(function: Function) -> Function:
        """Return the function as it is."""
        COMPILED[function] = other
        if sums:
            SUMS.append(function)
        return kernel(function)

    return marked
