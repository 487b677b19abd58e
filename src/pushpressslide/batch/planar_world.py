"""The planar engine on arrays: bodies on their supports and one or two compliant tips at
flat sides of each, tick by tick.

Source: docs/mechanics.md, sections 1 to 3; ``planar.world`` for one. Frame B of a body
is at its centre of pressure, which stays where it is: tips push low.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.angles import cos, sin
from pushpressslide.batch.checks import (
    check_all,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.elementwise import figures, table, values
from pushpressslide.batch.formulas import Column, Columns, where
from pushpressslide.batch.pushed_bodies import PoseColumns, moved
from pushpressslide.batch.pushing import SEPARATE, SLIP_LEFT, SLIP_RIGHT, STICK
from pushpressslide.batch.side_contact import SideTip, tip_force
from pushpressslide.batch.sliding import slide
from pushpressslide.batch.support import Support
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array
from pushpressslide.mechanics.balance import PASSED


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


class TipColumns(NamedTuple):
    """One tip and its face, as columns."""

    fx: Column  # [m] foot of the face
    fy: Column
    nx: Column  # unit inward normal
    ny: Column
    right: Column  # [m] the face's ends from its foot
    left: Column
    radius: Column  # [m]
    friction: Column
    damping: Column  # [N s/m]
    rho: Column  # [m] of the body


class Led(NamedTuple):
    """Where a tip is, and what it is commanded, in the world."""

    x: Column  # [m]
    y: Column
    vx: Column  # [m/s]
    vy: Column
    fx: Column  # [N]
    fy: Column


class Before(NamedTuple):
    """A tip's place in B, and its force at rest."""

    x: Column  # [m]
    y: Column
    fn: Column  # [N] f_0 along the face's normal
    ft: Column  # [N] to its left


class Period(NamedTuple):
    """How long a tick is."""

    dt: Column  # [s]


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
            table(PoseColumns, states.poses[..., None, :], lead),
            table(Led, np.concatenate(pairs, axis=-1), lead),
            table(TipColumns, self._tips, lead),
            self._period,
        )
        sides, before = values(reached, tips, lead, (10, 4))
        twists = self._twists(sides, states.twists, shape)
        bodies = (
            table(PoseColumns, states.poses, shape),
            table(TwistColumns, twists, shape),
            self._period,
        )
        (poses,) = values(carried, bodies, shape, (3,))
        moves = (
            table(PoseColumns, poses[..., None, :], lead),
            table(TwistColumns, twists[..., None, :], lead),
            table(SideTip, sides, lead),
            table(Before, before, lead),
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


def reached(pose: PoseColumns, led: Led, tip: TipColumns, period: Period) -> Columns:
    """Return what a tip may do at its face in a tick, ``SideTip``, and ``Before``."""
    c = cos(pose.yaw)
    s = sin(pose.yaw)
    dx = led.x - pose.x
    dy = led.y - pose.y
    x = c * dx + s * dy
    y = c * dy - s * dx
    gx = led.fx + tip.damping * led.vx
    gy = led.fy + tip.damping * led.vy
    # f_0 in the face's axes
    nx = c * tip.nx - s * tip.ny
    ny = s * tip.nx + c * tip.ny
    fn = nx * gx + ny * gy
    ft = nx * gy - ny * gx
    arm_n = x * tip.ny - y * tip.nx
    arm_t = x * tip.nx + y * tip.ny
    place = (y - tip.fy) * tip.nx - (x - tip.fx) * tip.ny
    gap = tip.fx * tip.nx + tip.fy * tip.ny - tip.radius - arm_t
    before = (place >= tip.right) & (place <= tip.left) & (gap > -PASSED)
    finite = np.abs(fn) + np.abs(ft) + np.abs(arm_n) + np.abs(arm_t) < math.inf
    near = before & finite
    return (
        tip.nx,
        tip.ny,
        where(near, fn - tip.damping * gap / period.dt, -1.0),
        where(near, ft, 0.0),
        tip.damping,
        tip.damping,
        tip.friction,
        where(near, arm_n / tip.rho, 0.0),
        where(near, (arm_t + gap + tip.radius) / tip.rho, 0.0),
        where(near, (arm_t + gap) / tip.rho, 0.0),
        x,
        y,
        fn,
        ft,
    )


def carried(pose: PoseColumns, twist: TwistColumns, period: Period) -> Columns:
    """Return the pose of a body after the tick."""
    return moved(pose, twist, period.dt)


def followed(
    pose: PoseColumns,
    led: Led,
    tip: TipColumns,
    period: Period,
    after: PoseColumns,
    twist: TwistColumns,
    side: SideTip,
    before: Before,
) -> Columns:
    """Return where a tip is after the tick, its force on the body, and what it did."""
    force = tip_force(TwistColumns(twist.vx, twist.vy, tip.rho * twist.w), side)
    un = (before.fn - force.fn) / tip.damping
    ut = (before.ft - force.ft) / tip.damping
    ux = tip.nx * un - tip.ny * ut
    uy = tip.ny * un + tip.nx * ut
    # with the body, but for its slip
    x = before.x + period.dt * (ux - twist.vx + twist.w * before.y)
    y = before.y + period.dt * (uy - twist.vy - twist.w * before.x)
    fx = tip.nx * force.fn - tip.ny * force.ft
    fy = tip.ny * force.fn + tip.nx * force.ft
    c = cos(pose.yaw)
    s = sin(pose.yaw)
    e = cos(after.yaw)
    f = sin(after.yaw)
    touches = force.touches
    slips = where(force.ft > 0.0, SLIP_LEFT, SLIP_RIGHT)
    return (
        where(touches, after.x + e * x - f * y, led.x + period.dt * (c * ux - s * uy)),
        where(touches, after.y + f * x + e * y, led.y + period.dt * (s * ux + c * uy)),
        c * fx - s * fy,
        s * fx + c * fy,
        where(touches, where(force.sticks, STICK, slips), SEPARATE),
    )
