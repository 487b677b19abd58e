"""How a pressed object turns under a force at one angle from its heading axis: as a unicycle, whose axle is
where a small change of the angle moves nothing across.

The drag's height, and the pressure that it moves, put the virtual axle elsewhere for each angle. With v and
w at an angle, and v' and w' their change with it, a point q of the heading axis has no change across its
motion where v_q x v_q' = 0; along the axis that is linear in q. A path of q can then be followed like a
unicycle's, as far as q does not slip sideways under forces farther off that angle, and as the contact's
motion turns with the force: where the drag moves the axle beyond the contact it does not, and a tip whose
motion is controlled leaves the object's turn to chance.
Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.pose import Pose2
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.pressing import Press
from pushpressslide.mechanics.top import rooms_inside

Array = NDArray[np.float64]

TIPPING_ROOM = 0.2  # half widths that the centre of pressure stays inside the base's edge
COUNT = 48  # force angles that are looked at, all round
STEP = 2.0 * math.pi / COUNT
EVERY = 2  # of them is one that turns are planned with
STEERING = 4  # steps that a force may be turned from its planned angle
STEERED = STEERING * STEP - 1e-6  # [rad]
LEAST = 1  # steps that it must be free to
SLIP = math.radians(6.0)  # of the axle, sideways: more is not followed like a unicycle
FIRM = 0.5  # least change of the contact's direction per change of the force's
FAR = 0.35  # [m] of the axle from the centre of pressure
TIGHTEST = 25.0  # [1/m] of the axle's path
PACE = (0.6, 5.0)  # speed of the contact per speed of the axle


@dataclass(frozen=True, slots=True)
class PressedTurn:
    """One force angle of one press."""

    press: Press
    angle: float  # [rad] of the force from the heading axis
    right: float  # [rad] < 0, that the force may be turned from there
    left: float  # [rad] > 0
    room: float  # [half widths] that the centre of pressure stays inside the base at that angle
    X_BV: Pose2  # at the axle, x along its motion
    curvature: float  # [1/m] of its path
    gain: float  # [m] tan(change of the force's angle) per change of curvature; > 0 where it leads
    share: float  # of mu_s N that the force takes
    pace: float  # speed of the contact per speed of the axle


def pressed_turns(presses: Sequence[Press], least_room: float = TIPPING_ROOM) -> list[list[PressedTurn]]:
    """Return the turns that each press of one object can be driven with.

    ``least_room`` [half widths] is what the centre of pressure keeps from the base's edge.
    """
    if not presses:
        return []
    m, body, shift = len(presses), presses[0].body, presses[0].shift
    axes, cops = np.array([p.axis for p in presses]), np.array([p.cop for p in presses])
    angles = STEP * np.arange(COUNT)
    c, s = np.cos(angles)[None, :, None], np.sin(angles)[None, :, None]
    across = np.stack([-axes[:, 1], axes[:, 0]], axis=-1)
    forces = c * axes[:, None] + s * across[:, None]
    rooms = rooms_inside(body, (cops[:, None] + shift * forces).reshape(-1, 2)).reshape(m, COUNT)
    free = rooms >= least_room
    rows, columns = np.nonzero(free)
    contacts = np.array([p.contact for p in presses])
    slid = DraggedBase(body, shift).slide(cops[rows], contacts[rows], forces[rows, columns])
    # of the centre of pressure, along the axis and to its left
    motion, shares = np.full((m, COUNT, 3), np.nan), np.full((m, COUNT), np.nan)
    vx, vy, w = slid.twists.T
    vx, vy = vx - w * cops[rows, 1], vy + w * cops[rows, 0]
    (ex, ey), (tx, ty) = axes[rows].T, across[rows].T
    motion[rows, columns] = np.stack([vx * ex + vy * ey, vx * tx + vy * ty, w], axis=-1)
    shares[rows, columns] = slid.shares
    return [_turns(*of_press) for of_press in zip(presses, rooms, motion, shares, strict=True)]


def steering_of(press: Press, backward: bool) -> float:
    """Return up to which force angle [rad] from straight motion a press is driven like one unicycle."""
    turns = [t for t in pressed_turns([press])[0] if abs(t.angle) == (math.pi if backward else 0.0)]
    return min((min(-turn.right, turn.left) for turn in turns), default=0.0)


def _turns(press: Press, rooms: Array, motion: Array, shares: Array) -> list[PressedTurn]:
    before, after = np.roll(motion, 1, axis=0), np.roll(motion, -1, axis=0)
    a, b, w = (0.5 * (before + after)).T
    da, db, dw = (0.5 / STEP * (after - before)).T
    x = (b * da - a * db) / (dw * a - w * da)
    speed = np.hypot(a, b + w * x)
    curvature = w / speed
    gain = speed / (dw - curvature * (a * da + (b + w * x) * (db + dw * x)) / speed)
    pace = np.hypot(a, b + w * press.lever) / speed
    heading = np.arctan2(b + w * x, a)
    along = np.arctan2(motion[:, 1] + motion[:, 2] * press.lever, motion[:, 0])  # of the contact
    firm = _wrapped(np.roll(along, -1) - along) > FIRM * STEP  # between an angle and the next
    leads = np.round(np.cos(STEP * np.arange(COUNT)), 9)  # neither way at a right angle
    usable = (
        (np.abs(x) < FAR) & (np.abs(curvature) < TIGHTEST) & (pace > PACE[0]) & (pace < PACE[1])
        & (gain * leads >= 0.0)
    )  # fmt: skip
    (ex, ey), (cx, cy) = press.axis, press.cop
    out = []
    for i in np.flatnonzero(usable[::EVERY]) * EVERY:
        slip = _wrapped(np.arctan2(motion[:, 1] + motion[:, 2] * x[i], motion[:, 0]) - heading[i])
        straight = np.abs(slip) < SLIP
        right = _steps(straight & firm, int(i), -1)
        left = _steps(straight & np.roll(firm, 1), int(i), 1)
        if min(right, left) < LEAST:
            continue
        axle = Pose2(float(cx + x[i] * ex), float(cy + x[i] * ey), float(math.atan2(ey, ex) + heading[i]))
        angle, sides = math.remainder(i * STEP, 2.0 * math.pi), (-right * STEP, left * STEP)
        figures = (float(curvature[i]), float(gain[i]), float(shares[i]), float(pace[i]))
        out.append(PressedTurn(press, angle, *sides, float(rooms[i]), axle, *figures))
    return out


def _wrapped(angles: Array) -> Array:
    wrapped: Array = np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi
    return wrapped


def _steps(good: NDArray[np.bool_], at: int, sign: int) -> int:
    k = 0
    while k < STEERING and good[(at + sign * (k + 1)) % COUNT]:
        k += 1
    return k
