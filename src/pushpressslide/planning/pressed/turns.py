"""Unicycle model of a pressed object that turns under a force at one angle from its
heading axis.

The axle is the point that does not move sideways when the angle changes slightly.

The position of the virtual axle depends on the angle, because the drag acts at a height
and shifts the pressure. Let v and w be the velocity and the turn rate at an angle, and
v' and w' their derivatives with respect to the angle. A point q of the heading axis is
not moved sideways if v_q x v_q' = 0, which is linear in q along the axis. A path of q
can be followed like that of a unicycle under two conditions: forces at angles farther
from this one must not make q slip sideways, and the contact's motion must turn with the
force. The second condition fails if the drag shifts the axle beyond the contact. The
motion of the tip then no longer determines the turn of the object. Source:
docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.mechanics.dragging import (
    RESOLUTION,
    DraggedBase,
    DraggedEllipsoid,
)
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.mechanics.top import rooms_inside

COUNT = 48  # number of force angles evaluated, all round
STEP = 2.0 * math.pi / COUNT
EVERY = 2  # every second angle is used for planned turns
STEERING = 4  # steps that a force may be turned from its planned angle
LEAST = 1  # steps that it must be free to
FORWARD = 1.4  # [rad] from the motion of a contact, within which its force is


@dataclass(frozen=True, slots=True)
class PressedTurn:
    """A turn by one press with a force at one angle."""

    press: Press
    angle: float  # [rad] of the force from the heading axis
    right: float  # [rad] < 0, that the force may be turned from there
    left: float  # [rad] > 0
    # [half widths] distance of the centre of pressure inside the base at that angle
    tipping_margin: float
    X_BV: Pose2  # at the axle, x along its motion
    curvature: float  # [1/m] of its path
    # [m] tan(change of the force's angle) per change of curvature; > 0 where it leads
    effective_wheelbase: float
    share: float  # force as a share of mu_s N
    pace: float  # speed of the contact per speed of the axle


@dataclass(frozen=True, slots=True)
class TurnTable:
    """Motions of an object under m presses, each with forces at all angles STEP i, in
    arrays (m, COUNT).

    The quantities are those of PressedTurn.
    """

    steerable: NDArray[np.bool_]  # as one unicycle's turn
    ahead: Array  # [m] of the axle from the centre of pressure, along the heading axis
    heading: Array  # [rad] of its motion from that axis
    curvature: Array
    effective_wheelbase: Array
    share: Array
    pace: Array
    right: Array  # [rad] > 0
    left: Array
    tipping_margin: Array


def dragged_along(presses: Sequence[Press], directions: Array) -> tuple[Array, Array]:
    """Motion of one object under m ``presses`` whose contacts travel in ``directions``
    (m,) [rad] in B: turns (m,) [rad/m] per travel, and forces (m,) as shares of mu_s N.
    NaN where every force near that direction would tip the object.
    """
    ex, ey = np.array([press.axis for press in presses]).T
    ahead = directions - np.arctan2(ey, ex)
    near = np.abs(_wrapped(STEP * np.arange(COUNT) - ahead[:, None])) < FORWARD
    near &= np.arange(COUNT) % EVERY == 0
    slides = _slides(presses, RESOLUTION, near)
    a, b, w = slides.motion
    levers = np.array([[press.lever] for press in presses])
    across = b + w * levers
    off = _wrapped(np.arctan2(across, a) - ahead[:, None])
    turns = w / np.hypot(a, across)
    out = np.full((2, len(presses)), np.nan)
    for i, known in enumerate(np.isfinite(turns)):
        at = off[i, known]
        if known.any():
            order = np.argsort(at)
            for row, values in enumerate((turns, slides.shares)):
                out[row, i] = np.interp(0.0, at[order], values[i, known][order])
    return out[0], out[1]


@dataclass(frozen=True, slots=True)
class _Slides:
    """Sliding motions under forces at all angles STEP i, for m presses.

    Values are NaN if the object tips.
    """

    # (3, m, COUNT) of the centre of pressure, along the axis and to its left, and w
    motion: Array
    shares: Array  # (m, COUNT) force as a share of mu_s N
    depths: Array  # (m, COUNT) [half widths] inside the base


@lru_cache(maxsize=64)
def turn_table(
    presses: tuple[Press, ...], speed: float, resolution: int = RESOLUTION
) -> TurnTable:
    """Motions of one object under presses with forces at all angles, at ``speed``
    [m/s].

    ``resolution`` sets the mesh of the base (mechanics/dragging.py).
    """
    slides = _slides(presses, resolution)
    motion = slides.motion
    levers = np.array([[p.lever] for p in presses])
    # each motion, and how it changes with the force's angle
    before = np.roll(motion, 1, axis=-1)
    after = np.roll(motion, -1, axis=-1)
    a, b, w = 0.5 * (before + after)
    da, db, dw = 0.5 / STEP * (after - before)
    x = (b * da - a * db) / (dw * a - w * da)
    along = np.hypot(a, b + w * x)
    curvature = w / along
    wheelbase = along / (
        dw - curvature * (a * da + (b + w * x) * (db + dw * x)) / along
    )
    pace = np.hypot(a, b + w * levers) / along
    heading = np.arctan2(b + w * x, a)
    # neither way at a right angle
    leads = np.round(np.cos(STEP * np.arange(COUNT)), 9)
    farthest = margins.FARTHEST_AXLE * presses[0].body.radius
    slowest, quickest = margins.PACE
    usable = (
        (np.abs(x) < farthest)
        & (np.abs(curvature) * margins.ARM.shortest(speed) < 1.0)
        & (pace > slowest)
        & (pace < quickest)
        & (wheelbase * leads >= 0.0)
    )
    firm = _firm(motion, levers)
    right = _free(motion, x, heading, usable, np.roll(firm, 1, axis=-1), -1)
    left = _free(motion, x, heading, usable, firm, 1)
    usable = usable & (np.minimum(right, left) >= LEAST * STEP)
    shares = slides.shares
    spaces = slides.depths
    return TurnTable(
        usable, x, heading, curvature, wheelbase, shares, pace, right, left, spaces
    )


def _slides(
    presses: Sequence[Press],
    resolution: int,
    wanted: NDArray[np.bool_] | bool = True,
) -> _Slides:
    """Sliding motion of the object under all forces that do not tip it."""
    m = len(presses)
    body = presses[0].body
    shift = presses[0].shift
    axes = np.array([p.axis for p in presses])
    cops = np.array([p.cop for p in presses])
    contacts = np.array([p.contact for p in presses])
    angles = STEP * np.arange(COUNT)
    c = np.cos(angles)[None, :, None]
    s = np.sin(angles)[None, :, None]
    across = np.stack([-axes[:, 1], axes[:, 0]], axis=-1)
    forces = c * axes[:, None] + s * across[:, None]
    moved = cops[:, None] + shift * forces
    spaces = rooms_inside(body, moved.reshape(-1, 2)).reshape(m, COUNT)
    rows, columns = np.nonzero(wanted & (spaces >= margins.TIPPING_MARGIN))
    rho = presses[0].rho
    base: DraggedBase | DraggedEllipsoid = DraggedBase(body, shift, resolution)
    if rho is not None:
        base = DraggedEllipsoid(rho, shift)
    slid = base.slide(cops[rows], contacts[rows], forces[rows, columns])
    vx, vy, w = slid.twists.T
    vx = vx - w * cops[rows, 1]
    vy = vy + w * cops[rows, 0]
    ex, ey = axes[rows].T
    tx, ty = across[rows].T
    motion = np.full((3, m, COUNT), np.nan)
    motion[:, rows, columns] = vx * ex + vy * ey, vx * tx + vy * ty, w
    shares = np.full((m, COUNT), np.nan)
    shares[rows, columns] = slid.shares
    return _Slides(motion, shares, spaces)


def _firm(motion: Array, levers: Array) -> NDArray[np.bool_]:
    """Whether the contact's direction of motion turns with the force, for each step
    from one angle to the next.

    ``levers`` are (m, 1) [m].
    """
    along = np.arctan2(motion[1] + motion[2] * levers, motion[0])
    firm: NDArray[np.bool_] = (
        _wrapped(np.roll(along, -1, axis=-1) - along) > margins.FIRM * STEP
    )
    return firm


def _free(
    motion: Array,
    axle: Array,
    heading: Array,
    steerable: NDArray[np.bool_],
    firm: NDArray[np.bool_],
    side: int,
) -> Array:
    """Angle [rad] by which the force may be turned to one ``side`` (1 left, -1 right)
    before the axle slips sideways or the contact's motion no longer follows.

    ``firm`` says for each angle whether the contact's motion turns with the force on
    the step to the next angle on this side.
    """
    steps = np.zeros(steerable.shape)
    free = steerable
    for k in range(1, STEERING + 1):
        va, vb, vw = np.roll(motion, -side * k, axis=-1)
        slip = _wrapped(np.arctan2(vb + vw * axle, va) - heading)
        follows = np.roll(firm, -side * (k - 1), axis=-1)
        free = free & (np.abs(slip) < margins.AXLE_SLIP) & follows
        steps += free
    return STEP * steps


@lru_cache(maxsize=1024)
def pressed_turns(press: Press, speed: float) -> tuple[PressedTurn, ...]:
    """Turns that a press can drive at ``speed`` [m/s]."""
    table = turn_table((press,), speed)
    columns = np.flatnonzero(table.steerable[0, ::EVERY])
    return tuple(_turn(table, int(column) * EVERY, press) for column in columns)


def _turn(table: TurnTable, column: int, press: Press) -> PressedTurn:
    """Turn under a force at one angle, from a table with a single press.

    ``column`` is the index of the angle.
    """

    def of_this_turn(quantity: Array) -> float:
        """Value of a table's column for this turn."""
        return float(quantity[0, column])

    ex, ey = press.axis
    cx, cy = press.cop
    ahead = of_this_turn(table.ahead)
    yaw = math.atan2(ey, ex) + of_this_turn(table.heading)
    return PressedTurn(
        press=press,
        angle=math.remainder(column * STEP, 2.0 * math.pi),
        right=-of_this_turn(table.right),
        left=of_this_turn(table.left),
        tipping_margin=of_this_turn(table.tipping_margin),
        X_BV=Pose2(cx + ahead * ex, cy + ahead * ey, yaw),
        curvature=of_this_turn(table.curvature),
        effective_wheelbase=of_this_turn(table.effective_wheelbase),
        share=of_this_turn(table.share),
        pace=of_this_turn(table.pace),
    )


def steering_of(press: Press, backward: bool, speed: float) -> float:
    """Largest force angle [rad], from that of straight motion, up to which a pressed
    object moves like one unicycle at ``speed`` [m/s].
    """
    turns = [
        t
        for t in pressed_turns(press, speed)
        if abs(t.angle) == (math.pi if backward else 0.0)
    ]
    return min((min(-turn.right, turn.left) for turn in turns), default=0.0)


def _wrapped(angles: Array) -> Array:
    wrapped: Array = np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi
    return wrapped
