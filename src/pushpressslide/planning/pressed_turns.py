"""How a pressed object turns under a force at one angle from its heading axis: as a unicycle whose axle is
where a small change of the angle moves nothing across.

The drag's height, and the pressure that it moves, put the virtual axle elsewhere for each angle. With v and w
at that angle and v', w' by the angle, a point q of the heading axis has no change across its motion where
v_q x v_q' = 0; along the axis that is linear in q. A path of q is then followed like a unicycle's.
Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.pressing import Press

NEAR = math.radians(5.0)  # either side of an angle, for the change with it
STRAIGHT = 0.05  # [1/m] of the turns that stand for straight ones
SHORT = 0.2  # of the contact's speed: axles that move more slowly are no use


@dataclass(frozen=True, slots=True)
class PressedTurn:
    """One force angle of one press."""

    press: Press
    angle: float  # [rad] of the force from the heading axis
    X_BV: Pose2  # at the axle, x along its motion
    curvature: float  # [1/m] of its path
    gain: float  # [m] tan(change of the force angle) per change of curvature
    share: float  # of mu_s N that the force takes
    center: Point  # [m] in B, of the turn
    pace: float  # speed of the contact per speed of the axle


def pressed_turns(presses: Sequence[Press], angles: Sequence[float]) -> list[PressedTurn | None]:
    """Return the turn of each press of one object by a force at each of its angles [rad]; None where the axle
    hardly moves: about its own place.

    One press per angle.
    """
    base = DraggedBase(presses[0].body, presses[0].shift)
    rows = [(press, angle + side) for press, angle in zip(presses, angles, strict=True) for side in (-NEAR, NEAR)]
    cops = np.array([press.cop for press, _ in rows])
    contacts = np.array([press.contact for press, _ in rows])
    forces = np.array([press.along(angle) for press, angle in rows])
    dragged = base.slide(cops, contacts, forces)
    twists, shares = dragged.twists.tolist(), dragged.shares.tolist()
    return [
        _turn(press, angle, twists[2 * i], twists[2 * i + 1], 0.5 * (shares[2 * i] + shares[2 * i + 1]))
        for i, (press, angle) in enumerate(zip(presses, angles, strict=True))
    ]


def _turn(
    press: Press, angle: float, before: Sequence[float], after: Sequence[float], share: float
) -> PressedTurn | None:
    (ex, ey), (cx, cy) = press.axis, press.cop
    vx, vy, w = (0.5 * (p + q) for p, q in zip(before, after, strict=True))
    dx, dy, dw = (0.5 * (q - p) / NEAR for p, q in zip(before, after, strict=True))
    w = w or 1e-12  # a straight one turns about a point far away
    center = (-vy / w, vx / w)
    # at the centre of pressure, along the axis and across it
    vx, vy, dx, dy = vx - w * cy, vy + w * cx, dx - dw * cy, dy + dw * cx
    a, b = vx * ex + vy * ey, ex * vy - ey * vx
    da, db = dx * ex + dy * ey, ex * dy - ey * dx
    x = (b * da - a * db) / (dw * a - w * da)
    across, change = b + w * x, db + dw * x
    speed = math.hypot(a, across)
    pace = math.hypot(a, b + w * press.lever) / speed
    if pace > 1.0 / SHORT:
        return None
    curvature = w / speed
    slope = (dw - curvature * (a * da + across * change) / speed) / speed
    yaw = math.atan2(ey, ex) + math.atan2(across, a)
    return PressedTurn(
        press, angle, Pose2(cx + x * ex, cy + x * ey, yaw), curvature, 1.0 / slope, share, center, pace
    )
