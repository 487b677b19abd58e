"""Results of the allocators on arrays: contact forces, their margins and statuses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import Flags, check_last
from pushpressslide.batch.rows import Figures, Kernel, answers
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.allocation import INFEASIBLE as INFEASIBLE
from pushpressslide.kernels.allocation import OK as OK
from pushpressslide.kernels.allocation import PROJECTED as PROJECTED

Statuses = NDArray[np.int8]


class Allocations(NamedTuple):
    """Forces of k contacts that realise wrenches: ``core.allocation`` on arrays."""

    forces: Array  # (..., k, 2) [N] of each contact ON the object, in B
    normals: Array  # (..., k) [N] normal magnitude of each contact, >= 0
    margin: Array  # (...) [N] least distance of a force to its cone; negative: outside
    status: Statuses  # (...) OK, PROJECTED or INFEASIBLE
    residual: Array  # (..., 3) [N, N m] wanted minus realised

    @property
    def ok(self) -> Flags:
        """Mask (...) of the wrenches that are realised unchanged."""
        out: Flags = self.status == OK
        return out


def answered(
    kernel: Kernel,
    row: Figures | Sequence[Figures],
    figures: Figures,
    contacts: int,
) -> Allocations:
    """Allocations made from the output of an allocator's kernel."""
    across = 2 * contacts
    margin = across + contacts
    out = answers(kernel, row, figures, columns=margin + 5)
    return Allocations(
        out[..., :across].reshape(*out.shape[:-1], contacts, 2),
        out[..., across:margin],
        out[..., margin],
        out[..., margin + 1].astype(np.int8),
        out[..., margin + 2 :],
    )


def wanted(wrenches: ArrayLike) -> Array:
    """``wrenches`` (..., 3) as an array. Raises ValueError for other shapes."""
    out = np.asarray(wrenches, dtype=np.float64)
    check_last(out, (3,), "wrenches")
    return out
