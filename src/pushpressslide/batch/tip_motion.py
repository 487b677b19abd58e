"""A compliant tip at a flat side of a body in a tick, on arrays: what it may do there, and
where it is in the end.

Source: docs/mechanics.md, section 3; ``planar.world`` for one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pushpressslide.batch.angles import cos, sin
from pushpressslide.batch.pushed_bodies import PoseColumns, moved
from pushpressslide.batch.pushing import SEPARATE, SLIP_LEFT, SLIP_RIGHT, STICK
from pushpressslide.batch.side_contact import SideTip, tip_force
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.formulas import Column, Columns, where
from pushpressslide.mechanics.balance import PASSED


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
    slips = where(force.left, SLIP_LEFT, SLIP_RIGHT)
    return (
        where(touches, after.x + e * x - f * y, led.x + period.dt * (c * ux - s * uy)),
        where(touches, after.y + f * x + e * y, led.y + period.dt * (s * ux + c * uy)),
        where(touches, c * fx - s * fy, 0.0),
        where(touches, s * fx + c * fy, 0.0),
        where(touches, where(force.sticks, STICK, slips), SEPARATE),
    )
