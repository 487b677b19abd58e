"""The planar engine of one pusher, on arrays: quasi-static bodies on the ellipsoid, each
pushed on a face by a point with a given velocity. It sticks, slips along the face,
leaves the body, or passes its edge.

Source: docs/mechanics.md, sections 2 to 4, as ``batch.pushing``. Within a step the twist
is constant in the body's own frame.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.angles import cos, sin
from pushpressslide.batch.checks import (
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.elementwise import (
    column,
    columns_of,
    figures,
    leading_shape,
    table_or_columns,
    values,
)
from pushpressslide.batch.pushing import Contact, Vector, pushed
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, where

SIXTH = 1.0 / 6.0  # a product takes less than a quotient
SMALL = 1e-4  # [rad] turns below which the chord is taken from its series


class Pushes(NamedTuple):
    """Where bodies and their pushers are."""

    poses: Array  # (..., 3) X_WB: x, y [m] and yaw [rad]; B at the centre of pressure
    places: Array  # (...) [m] of the pusher along the face, to the left of its foot
    # (...) [m] between pusher and face; infinite once it has passed an edge
    gaps: Array


class FaceColumns(NamedTuple):
    """One face and its contact, as columns; in B."""

    fx: Column  # [m] foot: the point of the face at place 0
    fy: Column
    nx: Column  # unit inward normal
    ny: Column
    right: Column  # [m] the face's ends, along the face from its foot
    left: Column
    friction: Column
    rho: Column  # [m]


class PoseColumns(NamedTuple):
    """A pose."""

    x: Column
    y: Column
    yaw: Column


class PusherColumns(NamedTuple):
    """Where a pusher is, and for how long it moves."""

    place: Column  # [m]
    gap: Column  # [m]
    dt: Column  # [s]


class PushedBodies:
    """Bodies and the faces that they are pushed on; figures of any leading shape."""

    def __init__(
        self,
        foot: ArrayLike,
        normal: ArrayLike,
        ends: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
    ) -> None:
        """Prepare the bodies.

        ``foot`` (..., 2) [m] in B, a point of the face, unit inward ``normal`` (..., 2)
        in B, ``ends`` (..., 2) [m] of the face to the right (< left) and to the left of
        its foot, ``friction`` (...), ``rho`` (...) [m]. Raises ValueError for other
        shapes, friction < 0 and rho <= 0.
        """
        p, n, e, mu, length = figures(foot, normal, ends, friction, rho)
        check_last(p, (2,), "foot")
        check_last(n, (2,), "normal")
        check_last(e, (2,), "ends")
        check_units(n)
        check_frictions(mu)
        check_positive(length, "rho", "m")
        self._face = FaceColumns(
            p[..., 0], p[..., 1], n[..., 0], n[..., 1], e[..., 0], e[..., 1], mu, length
        )
        self.shape = leading_shape(self._face)
        """The leading shape of the bodies."""

    def begin(
        self, poses: ArrayLike, places: ArrayLike = 0.0, gaps: ArrayLike = 0.0
    ) -> Pushes:
        """Return bodies at ``poses`` (..., 3) X_WB with their pushers at ``places``
        (...) [m] along the face and ``gaps`` (...) [m] before it.
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
        """Return bodies and pushers after ``dt`` [s] in which the pushers move at
        ``velocities`` (..., 2) [m/s], in the world.
        """
        rows, period = figures(velocities, dt)
        check_last(rows, (2,), "velocities")
        shape = np.broadcast_shapes(rows.shape[:-1], pushes.places.shape)
        pusher = PusherColumns(
            column(pushes.places, shape), column(pushes.gaps, shape), period
        )
        arguments = (
            table_or_columns(PoseColumns, pushes.poses, shape),
            table_or_columns(Vector, rows, shape),
            pusher,
            columns_of(self._face, shape),
        )
        poses, places, gaps = values(advanced, arguments, shape, (3, 0, 0))
        return Pushes(poses, places, gaps)


def advanced(
    pose: PoseColumns, v: Vector, pusher: PusherColumns, f: FaceColumns
) -> Columns:
    """Return pose, place and gap after the pusher's time."""
    c = cos(pose.yaw)
    s = sin(pose.yaw)
    vx = c * v.x + s * v.y
    vy = c * v.y - s * v.x
    into = vx * f.nx + vy * f.ny
    along = vy * f.nx - vx * f.ny
    until = where(into > 0.0, pusher.gap / where(into > 0.0, into, 1.0), math.inf)
    until = where(pusher.gap > 0.0, until, 0.0)
    free = where(until < pusher.dt, until, pusher.dt)
    time = pusher.dt - free
    place = pusher.place + along * free
    on = (time > 0.0) & (place >= f.right) & (place <= f.left)
    contact = Contact(
        f.fx - f.ny * place, f.fy + f.nx * place, f.nx, f.ny, f.friction, f.rho, 1.0
    )
    _, _, _, ux, uy, w, slip = pushed(Vector(vx, vy), contact)
    time = where(on, time, 0.0)
    after = moved(pose, TwistColumns(ux, uy, w), time)
    rest = where(on, slip * time, along * (pusher.dt - free))
    gap = pusher.gap - into * pusher.dt
    passed = (time <= 0.0) & (until < pusher.dt)  # beside the face, at its level
    gap = where(passed, math.inf, gap)
    gap = where(on & (into > 0.0), 0.0, gap)
    return after.x, after.y, after.yaw, place + rest, gap


def moved(pose: PoseColumns, twist: TwistColumns, time: Column) -> PoseColumns:
    """Return the pose after a time [s] of a constant twist of the body's origin, in the
    body's own frame.
    """
    turn = twist.w * time
    half = 0.5 * turn
    small = np.abs(half) < SMALL
    # along the chord, which is turned by half of the turn
    sine = sin(half)
    cosine = cos(half)
    series = 1.0 - SIXTH * half * half
    chord = where(small, series, sine / where(small, 1.0, half)) * time
    c = cos(pose.yaw)
    s = sin(pose.yaw)
    ahead = chord * (c * cosine - s * sine)
    aside = chord * (s * cosine + c * sine)
    return PoseColumns(
        pose.x + ahead * twist.vx - aside * twist.vy,
        pose.y + aside * twist.vx + ahead * twist.vy,
        pose.yaw + turn,
    )
