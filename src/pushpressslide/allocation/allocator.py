"""Allocators made from kernels and the parameters of their contacts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pushpressslide.core.allocation import STATUSES, Allocation, new

Allocator = Callable[[float, float, float], Allocation]


def allocator_of(
    kernel: Callable[..., tuple[Any, ...]], first: Any, second: Any
) -> Allocator:
    """Function ``allocate(fx, fy, tau)`` [N, N m] that calls ``kernel`` with ``first``
    and ``second`` as its constant arguments.
    """

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Allocation of a wrench [N, N m]."""
        forces, normals, margin, status, residual = kernel(fx, fy, tau, first, second)
        words = (forces, normals, margin, STATUSES[status], residual)
        return new(Allocation, words)

    return allocate
