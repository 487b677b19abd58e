"""Allocation to two pushes on one face, on arrays: the answers of
``allocation.parallel``.

Source: docs/mechanics.md, section 5. The friction force is shared in the ratio of the
normal forces; what the contacts cannot give so is left to ``two_contacts``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.allocations import (
    OK,
    Allocations,
    allocations,
    is_finite,
    wanted,
    wrench_table,
)
from pushpressslide.batch.checks import check_all
from pushpressslide.batch.contact_pair import Pair
from pushpressslide.batch.elementwise import columns_of, figures
from pushpressslide.batch.two_contacts import (
    OUTSIDE,
    STAGES,
    TwoContacts,
    inside_cones,
    wanted_forces,
)
from pushpressslide.batch.wrench_twist import WrenchColumns
from pushpressslide.core.formulas import Columns, least, where

UNSHARED = OUTSIDE + 1  # friction in the ratio of the normal forces does not do it
LEVEL = 1e-9  # cosine of the angle between the line of contacts and the normal


class ParallelPushes:
    """Two side contacts on one face; points, normal, friction, rho and caps of any
    leading shape.
    """

    def __init__(
        self,
        points: ArrayLike,
        normal: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        *,
        caps: ArrayLike = (math.inf, math.inf),
    ) -> None:
        """Prepare the contacts.

        ``points`` (..., 2, 2) [m] and unit inward ``normal`` (..., 2) in B, ``friction``
        (...), ``rho`` (...) [m], ``caps`` (..., 2) [N]. Raises ValueError as
        ``parallel_push_allocator``.
        """
        (n,) = figures(normal)
        both = np.stack([n, n], axis=-2)
        self._general = TwoContacts(points, both, friction, rho, caps=caps)
        pair = self._general.pair
        cosine = pair.ex * pair.n1x + pair.ey * pair.n1y
        level = np.abs(cosine) <= LEVEL
        check_all(level, cosine, "cosine of normal and line of contacts", "0")
        self.shape = self._general.shape
        """The leading shape of the contacts."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Return the allocations (...) of ``wrenches`` (..., 3) [N, N m] about B's
        origin, in B: those of ``parallel_push_allocator`` with projection "nearest".
        """
        rows = wanted(wrenches)
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        arguments = (wrench_table(rows, shape), columns_of(self._general.pair, shape))
        stages = ((UNSHARED, inside_cones), *STAGES)
        return allocations(arguments, shape, 2, shared, stages)


def shared(wrench: WrenchColumns, pair: Pair) -> Columns:
    """Return the allocation with friction in the ratio of the normal forces."""
    push = pair.n1x * wrench.fx + pair.n1y * wrench.fy
    slide = pair.n1x * wrench.fy - pair.n1y * wrench.fx
    f = wanted_forces(wrench, pair)
    f1n = pair.n1x * f.f1x + pair.n1y * f.f1y
    f2n = push - f1n
    margin = pair.friction * push - np.abs(slide)
    presses = (f1n >= 0.0) & (f2n >= 0.0) & (push > 0.0)
    kept = (f1n <= pair.cap_1) & (f2n <= pair.cap_2)
    status = where(presses & kept & (margin >= 0.0) & is_finite(wrench), OK, UNSHARED)
    share = f1n / push
    f1x = share * wrench.fx
    f1y = share * wrench.fy
    f2x = wrench.fx - f1x
    f2y = wrench.fy - f1y
    margin = least(share, 1.0 - share) * margin
    return f1x, f1y, f2x, f2y, f1n, f2n, margin, status, 0.0, 0.0, 0.0
