"""The planar engine of one pusher, on arrays: quasi-static bodies on the ellipsoid,
each pushed on a face by a point with a given velocity.

The pusher sticks, slips along the face, leaves the body, or passes its edge.

Source: docs/mechanics.md, sections 2 to 4, as in ``batch.pushing``. Within a step the
twist is constant in the body frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import (
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.rows import (
    answers,
    columns_of,
    figures,
    figures_of,
    grouped,
    halves,
)
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.pushing import advance_push


class Pushes(NamedTuple):
    """Poses of bodies and positions of their pushers."""

    poses: Array  # (..., 3) X_WB: x, y [m] and yaw [rad]; B at the centre of pressure
    # (...) [m] position of the pusher along the face, to the left of its foot
    places: Array
    # (...) [m] between pusher and face; infinite once the pusher has passed an edge
    gaps: Array


class PushedBodies:
    """Bodies and their pushed faces. Their parameters are arrays of any leading shape."""

    def __init__(
        self,
        foot: ArrayLike,
        normal: ArrayLike,
        ends: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
    ) -> None:
        """Prepare the bodies.

        ``foot`` (..., 2) [m] is a point of the face and ``normal`` (..., 2) its unit
        inward normal, both in B. ``ends`` (..., 2) [m] are the positions along the
        face, from its foot, of its right end and its left end (right < left).
        ``friction`` (...) is that of the contact, ``rho`` (...) [m] that of the
        ellipsoid. Raises ValueError for other shapes, friction < 0 and rho <= 0.
        """
        p, n, e, mu, length = figures(foot, normal, ends, friction, rho)
        check_last(p, (2,), "foot")
        check_last(n, (2,), "normal")
        check_last(e, (2,), "ends")
        check_units(n)
        check_frictions(mu)
        check_positive(length, "rho", "m")
        self._face = figures_of((halves(p), halves(n), halves(e), mu, length))
        self.shape = self._face.shape
        """The leading shape of the bodies."""

    def initial_states(
        self, poses: ArrayLike, places: ArrayLike = 0.0, gaps: ArrayLike = 0.0
    ) -> Pushes:
        """Bodies at ``poses`` (..., 3) X_WB with their pushers at ``places`` (...) [m]
        along the face and ``gaps`` (...) [m] before it.
        """
        X, place, gap = figures(poses, places, gaps)
        check_last(X, (3,), "poses")
        shape = np.broadcast_shapes(X.shape[:-1], place.shape, gap.shape, self.shape)
        return Pushes(
            np.broadcast_to(X, (*shape, 3)),
            np.broadcast_to(place, shape),
            np.broadcast_to(gap, shape),
        )

    def advance(self, pushes: Pushes, velocities: ArrayLike, dt: float) -> Pushes:
        """Bodies and pushers after ``dt`` [s] with the pushers moving at ``velocities``
        (..., 2) [m/s] in the world.
        """
        (rows,) = figures(velocities)
        check_last(rows, (2,), "velocities")
        poses, places, gaps = pushes
        columns = columns_of(places, gaps, np.asarray(dt))
        row = (grouped(poses), grouped(rows), *columns)
        out = answers(advance_push, row, self._face, columns=5)
        return Pushes(out[..., :3], out[..., 3], out[..., 4])
