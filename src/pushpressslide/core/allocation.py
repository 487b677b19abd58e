"""The result of an allocator: contact forces, their margin and a status.

An allocator never raises when it is called.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from pushpressslide.core.pose import Point
from pushpressslide.kernels.allocation import EXACT as EXACT

AllocationStatus = Literal["ok", "projected", "infeasible"]
STATUSES: tuple[AllocationStatus, ...] = ("ok", "projected", "infeasible")
"""Status words, in the order of the status numbers in ``kernels.allocation``."""
new = tuple.__new__  # at half the cost of a NamedTuple's own constructor


class Allocation(NamedTuple):
    """Forces that realise a wanted wrench."""

    forces: tuple[Point, ...]  # [N] of each contact ON the object, in B
    normals: tuple[float, ...]  # [N] normal magnitude of each contact, >= 0
    # [N] least distance of a force to its cone (mu f_n - |f_t|); negative: outside
    margin: float
    # "projected": the nearest wrench that the contacts can give was realised instead
    status: AllocationStatus
    # wanted minus realised: fx, fy [N], tau [N m]
    residual: tuple[float, float, float] = (0.0, 0.0, 0.0)


def nothing(
    normals: tuple[float, ...], wrench: tuple[float, float, float]
) -> Allocation:
    """Allocation with zero forces and status "infeasible", for a ``wrench`` that cannot
    be realised at all.

    ``normals`` [N] are zero for pushes, and the present normal forces for presses.
    """
    zeros = tuple((0.0, 0.0) for _ in normals)
    return Allocation(zeros, normals, 0.0, "infeasible", wrench)
