"""The answers of the allocators on arrays: contact forces, their margins and statuses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import check_last
from pushpressslide.batch.elementwise import Argument, Stage, Table, run, table
from pushpressslide.batch.rows import Figures, Kernel, answers
from pushpressslide.batch.wrench_twist import WrenchColumns
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Flag, Formula
from pushpressslide.kernels.allocation import INFEASIBLE as INFEASIBLE
from pushpressslide.kernels.allocation import OK as OK
from pushpressslide.kernels.allocation import PROJECTED as PROJECTED

Statuses = NDArray[np.int8]
OPEN = 3  # between two formulas: the first has not settled the row


class Allocations(NamedTuple):
    """Forces that realise wanted wrenches, of k contacts; as ``core.allocation`` for one."""

    forces: Array  # (..., k, 2) [N] of each contact ON the object, in B
    normals: Array  # (..., k) [N] normal magnitude of each contact, >= 0
    margin: Array  # (...) [N] least distance of a force to its cone; negative: outside
    status: Statuses  # (...) OK, PROJECTED or INFEASIBLE
    residual: Array  # (..., 3) [N, N m] wanted minus realised

    @property
    def ok(self) -> Flag:
        """Where nothing had to be changed (...)."""
        return self.status == OK


class AllocationColumns(NamedTuple):
    """An ``Allocations`` of n rows that is still to be filled, a column each."""

    forces: Array  # (2 k, n)
    normals: Array  # (k, n)
    margin: Array  # (n,)
    status: Statuses  # (n,)
    residual: Array  # (3, n)

    @classmethod
    def empty(cls, n: int, contacts: int) -> AllocationColumns:
        """Return room for ``n`` rows, in one piece."""
        block = np.empty((3 * contacts + 4, n))
        across = 2 * contacts
        margin = across + contacts
        return cls(
            block[:across],
            block[across:margin],
            block[margin],
            np.empty(n, dtype=np.int8),
            block[margin + 1 :],
        )

    def shaped(self, shape: tuple[int, ...]) -> Allocations:
        """Return the answer with a leading ``shape``."""
        contacts = len(self.normals)
        return Allocations(
            self.forces.T.reshape(*shape, contacts, 2),
            self.normals.T.reshape(*shape, contacts),
            self.margin.reshape(shape),
            self.status.reshape(shape),
            self.residual.T.reshape(*shape, 3),
        )


def wrench_table(wrenches: Array, shape: tuple[int, ...]) -> Table:
    """Return ``wrenches`` (..., 3) as a table of the leading ``shape``."""
    return table(WrenchColumns, wrenches, shape)


def is_finite(wrench: WrenchColumns) -> Flag:
    """Return where a wrench is a number."""
    return np.abs(wrench.fx) + np.abs(wrench.fy) + np.abs(wrench.tau) < math.inf


def answered(
    kernel: Kernel, row: Figures, figures: Figures, contacts: int
) -> Allocations:
    """Return the allocations that the kernel of an allocator answers."""
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


def allocations(
    arguments: Sequence[Argument],
    shape: tuple[int, ...],
    contacts: int,
    first: Formula,
    stages: Sequence[Stage],
) -> Allocations:
    """Return the answers of ``first`` for all rows, and of each stage for those that
    have its status then.
    """
    out = AllocationColumns.empty(math.prod(shape), contacts)
    run(first, arguments, out, stages, AllocationColumns._fields.index("status"))
    return out.shaped(shape)


def wanted(wrenches: ArrayLike) -> Array:
    """Return ``wrenches`` (..., 3) as an array; raises ValueError for other shapes."""
    out = np.asarray(wrenches, dtype=np.float64)
    check_last(out, (3,), "wrenches")
    return out
