"""The planar engine on arrays: bodies on their supports and one or two compliant tips
at flat sides of each, tick by tick.

Source: docs/mechanics.md, sections 1 to 3. The origin of a body's frame B is its centre
of pressure, which stays fixed because the tips push low. One tick is one call of
``kernels.tip_step``, parts of which ``planar.world`` calls for a single body.
"""

from __future__ import annotations

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
from pushpressslide.batch.pushing import SEPARATE
from pushpressslide.batch.rows import Figures, answers, figures, grouped
from pushpressslide.batch.support import Support
from pushpressslide.core.arrays import Array

NO_FACE = (1.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0)
"""A face that no tip can touch: its right end is to the left of its left end."""
LED = ((0.0, 0.0), (0.0, 0.0), (0.0, 0.0))
FACE = ((0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
BODY = ((0.0, 0.0), 0.0, 0.0, 0.0)


class Faces(NamedTuple):
    """Faces of a body that its tips push, in B. The number k of tips is 1 or 2."""

    foot: ArrayLike  # (..., k, 2) [m] a point of the face
    normal: ArrayLike  # (..., k, 2) unit inward normal
    # (..., k, 2) [m] ends of the face, to the right (< left) and left of its foot
    ends: ArrayLike


class Tips(NamedTuple):
    """Parameters of the tips, (..., k) or one number for all."""

    radius: ArrayLike  # [m] >= 0
    friction: ArrayLike  # >= 0 of the pair tip/body
    damping: ArrayLike  # [N s/m] > 0


class WorldStates(NamedTuple):
    """States of bodies and tips, and their motion in the previous tick."""

    poses: Array  # (..., 3) X_WB: x, y [m] and yaw [rad]
    tips: Array  # (..., k, 2) [m] their centres, in the world
    twists: Array  # (..., 3) [m/s], [rad/s] in B
    forces: Array  # (..., k, 2) [N] on the bodies, in the world
    # (..., k) ``pushing``'s STICK, SLIP_LEFT, SLIP_RIGHT or SEPARATE
    kinds: NDArray[np.int8]


class PlanarWorld:
    """Bodies with the same number of tips each. Their parameters are arrays of any
    leading shape.
    """

    def __init__(self, support: Support, faces: Faces, tips: Tips, dt: float) -> None:
        """Prepare bodies and tips, in ticks of ``dt`` [s].

        Raises ValueError for other shapes, more than two tips, and invalid figures.
        """
        vectors = figures(*faces)
        numbers = figures(*tips)
        _check_faces(Faces(*vectors))
        _check_tips(Tips(*numbers))
        check_positive(np.array(dt), "dt", "s")
        shapes = [array.shape[:-1] for array in vectors]
        shapes += [array.shape for array in numbers]
        *shape, count = np.broadcast_shapes(*shapes)
        if count not in (1, 2):
            raise ValueError(f"tips {count}; must be 1 or 2")
        own = (support.rho.shape, support.max_force.shape)
        self.shape = np.broadcast_shapes(tuple(shape), *own)
        """The leading shape of the bodies."""
        self.count = count
        """Number of tips per body."""
        self._support = support
        faces_of_kernel = _faces(vectors, numbers, (*shape, count))
        self._figures = _figures(support, faces_of_kernel, dt)

    def initial_states(self, poses: ArrayLike, tips: ArrayLike) -> WorldStates:
        """Bodies at rest at ``poses`` (..., 3) X_WB with their tips at ``tips`` (...,
        k, 2) [m] in the world.
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
        """States after one tick. A non-finite command moves nothing.

        A tip's force is ``forces`` (..., k, 2) [N] plus its damping times the lag of
        its own velocity behind ``velocities`` (..., k, 2) [m/s], all in the world. To
        model a spring k [N/m] to a point x, pass k (x - tip) as the force and add k dt
        to the damping.
        """
        u, f = figures(velocities, forces)
        check_last(u, (2,), "velocities")
        lead = np.broadcast_shapes(states.tips.shape[:-1], u.shape[:-1], f.shape[:-1])
        shape = np.broadcast_shapes(lead[:-1], self.shape)
        led = np.zeros((*shape, 2, 6))
        led[..., : self.count, :2] = states.tips
        led[..., : self.count, 2:4] = u
        led[..., : self.count, 4:] = f
        leds = Figures(led.reshape(*shape, 12), ((LED, LED),))
        row = (grouped(states.poses), grouped(states.twists), leds)
        support = self._support
        out = answers(support.step, row, self._figures, support.arrays, columns=16)
        tips = out[..., 6:].reshape(*shape, 2, 5)[..., : self.count, :]
        kinds = tips[..., 4].astype(np.int8)
        return WorldStates(
            out[..., :3], tips[..., :2], out[..., 3:6], tips[..., 2:4], kinds
        )


def _faces(
    vectors: tuple[Array, ...], numbers: tuple[Array, ...], shape: tuple[int, ...]
) -> Array:
    """Faces (..., k, 8) of all tips, as rows of ``kernels.tip_step.Face``."""
    foot, normal, ends = vectors
    nx, ny = np.moveaxis(normal, -1, 0)
    fx, fy = np.moveaxis(foot, -1, 0)
    aside = nx * fy - ny * fx
    columns = (nx, ny, nx * fx + ny * fy, aside + ends[..., 0], aside + ends[..., 1])
    whole = [np.broadcast_to(column, shape) for column in (*columns, *numbers)]
    return np.stack(whole, axis=-1)


def _figures(support: Support, faces: Array, dt: float) -> Figures:
    """Parameters of bodies with the faces (..., k, 8) of their tips."""
    shape = np.broadcast_shapes(
        faces.shape[:-2], support.rho.shape, support.max_force.shape
    )
    both = np.empty((*shape, 2, 8))
    both[...] = NO_FACE
    both[..., : faces.shape[-2], :] = faces
    table = np.empty((*shape, 21))
    table[..., :16] = both.reshape(*shape, 16)
    table[..., 16:18] = 0.0
    table[..., 18] = support.max_force
    table[..., 19] = support.rho
    table[..., 20] = dt
    return Figures(table, (((FACE, FACE), BODY),))


def _check_faces(faces: Faces) -> None:
    """Raise ValueError for arrays that do not describe faces."""
    for name, array in zip(Faces._fields, faces, strict=True):
        rows = np.asarray(array)
        check_last(rows, (2,), name)
        if rows.ndim < 2:
            raise ValueError(f"{name} {rows.shape}; must be (..., k, 2)")
    check_units(np.asarray(faces.normal))


def _check_tips(tips: Tips) -> None:
    """Raise ValueError for invalid parameters of tips."""
    radius = np.asarray(tips.radius)
    holds = np.isfinite(radius) & (radius >= 0.0)
    check_all(holds, radius, "radius", "finite and >= 0", "m")
    check_frictions(np.asarray(tips.friction))
    check_positive(np.asarray(tips.damping), "damping", "N s/m")
