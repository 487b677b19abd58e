"""Effect of one action on the T, computed with the limit surface in each of the
action's ten periods.

The pusher's path is exact. In each period the T makes the smallest motion that prevents
penetration at all contacts, in the metric |v|^2 + rho^2 w^2 of the limit surface. This
is its motion under a frictionless push. Constants and order of operations are those of
the engine pymunk, which first moves bodies by the velocities of the previous period,
and then separates overlapping bodies by a share of the overlap.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.servo import PERIOD, Pusher
from pushpressslide_studies.pusht.tee import CENTER, PUSHER_RADIUS, RHO

SLOP = 0.1  # [px] of an overlap that is left
PUSHED_APART = 1.0 - 0.9**0.6  # of the rest of an overlap in one period
PASSES = 10  # over all contacts
BAR = (-60.0, 0.0, 60.0, 30.0)  # [px] x, y of two opposite corners in T
STEM = (-15.0, 30.0, 15.0, 120.0)


class Touch(NamedTuple):
    """A contact of the pusher with the T, in B."""

    normal: Point  # into the T
    arm: float  # [px] of a force along the normal about the centre of mass
    overlap: float  # [px]


class Motion(NamedTuple):
    """A twist of B, in B's axes, times a period: [px], [px], [rad]."""

    x: float
    y: float
    turn: float


REST = Motion(0.0, 0.0, 0.0)


def predicted(X_WB: Pose2, pusher: Pusher, action: Point) -> Pose2:
    """X_WB at the end of an action, without walls."""
    motion = _motion(X_WB, pusher)
    for moved in pusher.periods(action):
        X_WB = _displaced(X_WB, motion)
        motion = _motion(X_WB, moved)
    return X_WB


def _displaced(X_WB: Pose2, motion: Motion) -> Pose2:
    x, y = X_WB.rotate((motion.x, motion.y))
    return Pose2(X_WB.x + x, X_WB.y + y, X_WB.yaw + motion.turn)


def _motion(X_WB: Pose2, pusher: Pusher) -> Motion:
    """Motion of the T in the next period."""
    center = X_WB.unapply(pusher.position)
    touches = _contacts_at(center)
    if not touches:
        return REST
    vx, vy = X_WB.unrotate(pusher.velocity)
    advances = [
        PERIOD * (vx * touch.normal[0] + vy * touch.normal[1]) for touch in touches
    ]
    apart = [PUSHED_APART * max(touch.overlap - SLOP, 0.0) for touch in touches]
    driven = _least_motion(touches, advances)
    corrected = _least_motion(touches, apart)
    return Motion(*(a + b for a, b in zip(driven, corrected, strict=True)))


def _least_motion(contacts: list[Touch], advances: list[float]) -> Motion:
    """Smallest motion that advances each contact by at least ``advances`` [px].

    It is found by repeated passes over the contacts.
    """
    impulses = [0.0] * len(contacts)
    x = 0.0
    y = 0.0
    turn = 0.0
    for _ in range(PASSES if len(contacts) > 1 else 1):
        for index, (touch, advance) in enumerate(zip(contacts, advances, strict=True)):
            nx, ny = touch.normal
            mobility = 1.0 + (touch.arm / RHO) ** 2
            missing = advance - (x * nx + y * ny + turn * touch.arm)
            impulse = max(0.0, impulses[index] + missing / mobility)
            change = impulse - impulses[index]
            impulses[index] = impulse
            x += change * nx
            y += change * ny
            turn += change * touch.arm / RHO**2
    return Motion(x, y, turn)


def _contacts_at(center: Point) -> list[Touch]:
    """Contacts of a pusher with its centre at a point [px] in B."""
    out = []
    for box in (BAR, STEM):
        touch = _touch(center, box)
        if touch is not None:
            out.append(touch)
    return out


def _touch(center: Point, box: tuple[float, float, float, float]) -> Touch | None:
    """Contact of the pusher with one rectangle of the T."""
    low_x, low_y, high_x, high_y = box
    x = center[0] + CENTER[0]
    y = center[1] + CENTER[1]
    px = min(max(x, low_x), high_x)
    py = min(max(y, low_y), high_y)
    distance = math.hypot(x - px, y - py)
    if distance > PUSHER_RADIUS:
        return None
    if distance == 0.0:
        return _deep((x, y), box)
    normal = ((px - x) / distance, (py - y) / distance)
    return _contact((px, py), normal, PUSHER_RADIUS - distance)


def _deep(place: Point, box: tuple[float, float, float, float]) -> Touch:
    """Contact of a pusher with its centre inside a rectangle."""
    x, y = place
    low_x, low_y, high_x, high_y = box
    depth, normal, point = min(
        (x - low_x, (1.0, 0.0), (low_x, y)),
        (high_x - x, (-1.0, 0.0), (high_x, y)),
        (y - low_y, (0.0, 1.0), (x, low_y)),
        (high_y - y, (0.0, -1.0), (x, high_y)),
    )
    return _contact(point, normal, PUSHER_RADIUS + depth)


def _contact(point: Point, normal: Point, overlap: float) -> Touch:
    """A contact at a point [px] in T."""
    arm = (point[0] - CENTER[0]) * normal[1] - (point[1] - CENTER[1]) * normal[0]
    return Touch(normal, arm, overlap)
