"""The planar engine on arrays: bodies on their supports and one or two compliant tips at
flat sides of each, tick by tick.

Source: docs/mechanics.md, sections 1 to 3; ``planar.world`` for one. Frame B of a body
is at its centre of pressure, which stays where it is: tips push low. A tick is three
formulas, of tips, bodies and tips again, and between them the search for balance.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import (
    check_all,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.elementwise import figures, table_or_columns, values
from pushpressslide.batch.pushed_bodies import PoseColumns
from pushpressslide.batch.pushing import SEPARATE
from pushpressslide.batch.side_contact import SideTip
from pushpressslide.batch.sliding import slide
from pushpressslide.batch.support import Support
from pushpressslide.batch.tip_motion import (
    Before,
    Led,
    Period,
    TipColumns,
    carried,
    followed,
    reached,
)
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array


class Faces(NamedTuple):
    """The faces that the tips of a body push; k is 1 or 2, figures of B."""

    foot: ArrayLike  # (..., k, 2) [m] a point of the face
    normal: ArrayLike  # (..., k, 2) unit inward normal
    # (..., k, 2) [m] of the face to the right (< left) and to the left of its foot
    ends: ArrayLike


class Tips(NamedTuple):
    """The tips; (..., k), or one number for all."""

    radius: ArrayLike  # [m] >= 0
    friction: ArrayLike  # >= 0 of the pair tip/body
    damping: ArrayLike  # [N s/m] > 0


class WorldStates(NamedTuple):
    """Where bodies and tips are, and what led there in the tick before."""

    poses: Array  # (..., 3) X_WB: x, y [m] and yaw [rad]
    tips: Array  # (..., k, 2) [m] their centres, in the world
    twists: Array  # (..., 3) [m/s], [rad/s] in B
    forces: Array  # (..., k, 2) [N] on the bodies, in the world
    # (..., k) ``pushing``'s STICK, SLIP_LEFT, SLIP_RIGHT or SEPARATE
    kinds: NDArray[np.int8]


class PlanarWorld:
    """Bodies, each with the same number of tips; figures of any leading shape."""

    def __init__(self, support: Support, faces: Faces, tips: Tips, dt: float) -> None:
        """Prepare bodies and tips, in ticks of ``dt`` [s].

        Raises ValueError for other shapes, more than two tips, and figures that are not
        allowed.
        """
        vectors = figures(*faces)
        numbers = figures(*tips)
        _check_faces(Faces(*vectors))
        _check_tips(Tips(*numbers))
        check_positive(np.array(dt), "dt", "s")
        rho = support.rho[..., None]
        force = support.max_force[..., None]
        shapes = [array.shape[:-1] for array in vectors]
        shapes += [array.shape for array in (*numbers, rho, force)]
        *shape, count = np.broadcast_shapes(*shapes)
        if count not in (1, 2):
            raise ValueError(f"tips {count}; must be 1 or 2")
        self.shape = tuple(shape)
        """The leading shape of the bodies."""
        self.count = count
        """How many tips a body has."""
        self._support = support
        self._period = Period(np.float64(dt))
        columns = [array[..., i] for array in vectors for i in (0, 1)]
        columns += [*numbers, rho]
        whole = (*self.shape, count)
        self._tips = np.stack([np.broadcast_to(c, whole) for c in columns], axis=-1)

    def begin(self, poses: ArrayLike, tips: ArrayLike) -> WorldStates:
        """Return bodies at rest at ``poses`` (..., 3) X_WB with their tips at ``tips``
        (..., k, 2) [m] in the world.
        """
        X, place = figures(poses, tips)
        check_last(X, (3,), "poses")
        check_last(place, (self.count, 2), "tips")
        shape = np.broadcast_shapes(X.shape[:-1], place.shape[:-2], self.shape)
        return WorldStates(
            np.broadcast_to(X, (*shape, 3)),
            np.broadcast_to(place, (*shape, self.count, 2)),
            np.zeros((*shape, 3)),
            np.zeros((*shape, self.count, 2)),
            np.full((*shape, self.count), SEPARATE, dtype=np.int8),
        )

    def step(
        self, states: WorldStates, velocities: ArrayLike, forces: ArrayLike = 0.0
    ) -> WorldStates:
        """Return the states one tick on; what is not finite moves nothing.

        A tip's force is ``forces`` (..., k, 2) [N] plus its damping times the lag of its
        own velocity behind ``velocities`` (..., k, 2) [m/s], all in the world. A spring
        k [N/m] is a force k (x - tip), and k dt more of damping.
        """
        u, f = figures(velocities, forces)
        check_last(u, (2,), "velocities")
        lead = np.broadcast_shapes(states.tips.shape[:-1], u.shape[:-1], f.shape[:-1])
        shape = lead[:-1]
        pairs = [np.broadcast_to(array, (*lead, 2)) for array in (states.tips, u, f)]
        tips = (
            table_or_columns(PoseColumns, states.poses[..., None, :], lead),
            table_or_columns(Led, np.concatenate(pairs, axis=-1), lead),
            table_or_columns(TipColumns, self._tips, lead),
            self._period,
        )
        sides, before = values(reached, tips, lead, (10, 4))
        twists = self._twists(sides, states.twists, shape)
        bodies = (
            table_or_columns(PoseColumns, states.poses, shape),
            table_or_columns(TwistColumns, twists, shape),
            self._period,
        )
        (poses,) = values(carried, bodies, shape, (3,))
        moves = (
            table_or_columns(PoseColumns, poses[..., None, :], lead),
            table_or_columns(TwistColumns, twists[..., None, :], lead),
            table_or_columns(SideTip, sides, lead),
            table_or_columns(Before, before, lead),
        )
        places, felt, kinds = values(followed, (*tips, *moves), lead, (2, 2, 0))
        return WorldStates(poses, places, twists, felt, kinds.astype(np.int8))

    def _twists(self, sides: Array, guesses: Array, shape: tuple[int, ...]) -> Array:
        """Return the twists (..., 3) at which bodies and tips balance."""
        support = self._support
        rho, force = (
            np.broadcast_to(array, shape).reshape(-1)
            for array in (support.rho, support.max_force)
        )
        scale = np.stack([np.ones_like(rho), np.ones_like(rho), rho], axis=1)
        flat = replace(support, rho=rho, max_force=force)
        tips = [
            np.ascontiguousarray(sides[..., i, :]).reshape(-1, 10)
            for i in range(self.count)
        ]
        start = np.broadcast_to(guesses, (*shape, 3)).reshape(-1, 3) * scale
        out: Array = (slide(flat, tips, start) / scale).reshape(*shape, 3)
        return out


def _check_faces(faces: Faces) -> None:
    """Raise ValueError for arrays that are no faces."""
    for name, array in zip(Faces._fields, faces, strict=True):
        rows = np.asarray(array)
        check_last(rows, (2,), name)
        if rows.ndim < 2:
            raise ValueError(f"{name} {rows.shape}; must be (..., k, 2)")
    check_units(np.asarray(faces.normal))


def _check_tips(tips: Tips) -> None:
    """Raise ValueError for figures that are not allowed."""
    radius = np.asarray(tips.radius)
    holds = np.isfinite(radius) & (radius >= 0.0)
    check_all(holds, radius, "radius", "finite and >= 0", "m")
    check_frictions(np.asarray(tips.friction))
    check_positive(np.asarray(tips.damping), "damping", "N s/m")
