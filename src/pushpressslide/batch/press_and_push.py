"""Allocation to a press and a push, on arrays: the results of
``allocation.press_and_push``.

Source: docs/mechanics.md, section 7.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.allocation.press_and_push import LEAST_LEVER
from pushpressslide.batch.allocations import Allocations, answered, wanted
from pushpressslide.batch.checks import (
    check_all,
    check_finite,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.rows import figures, halves, prepared, spread
from pushpressslide.kernels.press_and_push import (
    press_and_push,
    press_and_push_figures,
)


class PressAndPush:
    """A press and a push, with parameters of any leading shape."""

    def __init__(
        self,
        press: ArrayLike,
        load: ArrayLike,
        push: ArrayLike,
        normal: ArrayLike,
        friction: ArrayLike,
        cop: ArrayLike = (0.0, 0.0),
    ) -> None:
        """Prepare the contacts.

        ``press``, ``push`` and ``cop`` (..., 2) [m] and ``normal`` (..., 2), the unit
        inward normal, are in B. ``load`` (...) [N] and ``friction`` (...) are as in
        ``press_and_push_allocator``, and so are the errors.
        """
        p, n, q, normals, mu, center = figures(press, load, push, normal, friction, cop)
        for array, name in ((p, "press"), (q, "push"), (normals, "normal")):
            check_last(array, (2,), name)
        check_last(center, (2,), "cop")
        check_finite(center, "cop")
        check_positive(n, "load", "N")
        check_frictions(mu)
        check_units(normals)
        dx, dy = (q[..., k] - p[..., k] for k in range(2))
        length = np.hypot(dx, dy)
        distinct = (length > 0.0) & np.isfinite(length)
        check_all(distinct, length, "distance of the contacts", "finite and > 0", "m")
        nx, ny = (normals[..., k] for k in range(2))
        lever = dx * ny - dy * nx
        check_all(np.abs(lever) > LEAST_LEVER, lever, "lever of the push", "not 0", "m")
        self._figures = prepared(
            press_and_push_figures,
            *(halves(p), n, halves(q), halves(normals), mu, halves(center)),
        )
        self.shape = self._figures.shape
        """The leading shape of the contacts."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Allocations (...) of ``wrenches`` (..., 3) [N, N m] about the centre of
        pressure, in B.

        They are those of ``press_and_push_allocator``.
        """
        return answered(press_and_push, spread(wanted(wrenches)), self._figures, 2)
