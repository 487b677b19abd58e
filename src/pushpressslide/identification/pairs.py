"""Pairs of wrench and motion from recorded pushes, in the conventions of the logs.

Source: docs/uncertainty.md. Everything is in the body frame B: origin at the projected
centre of mass, axes of the tracked object.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, wrap_angle
from pushpressslide.identification.recordings import RecordedPush

# [m] length that makes rotation comparable with translation: a direction is the unit
# vector along (vx, vy, LENGTH w)
LENGTH = 0.05
FREE_SHARE = 0.3  # share of the samples in contact that are left out, from the first on
LEAST_FORCE = 0.2  # [N] smallest mean force; a push with less has not touched
# [m] smallest norm of (x, y, LENGTH yaw); a push with less has no direction
LEAST_MOTION = 1e-3
# From the force on the sensor, in its frame, to the force on the object, in the tool's
# frame.
TOOL_FROM_SENSOR = -math.sqrt(0.5) * np.array([[1.0, 1.0], [1.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Pairs:
    """Measurements of n pushes, one row for each."""

    # (n, 3) mean fx, fy [N], tau [N m] of the probe on the object about the CoM
    wrenches: Array
    # (n, 3) displacement x, y [m] of the CoM, yaw [rad], in the axes half-way
    twists: Array
    contacts: Array  # (n, 2) [m] mean position of the tip in B
    heights: Array  # (n,) [m] of the tip above the object's base

    def __len__(self) -> int:
        return len(self.wrenches)

    def __getitem__(self, rows: NDArray[np.intp]) -> Pairs:
        return Pairs(
            self.wrenches[rows],
            self.twists[rows],
            self.contacts[rows],
            self.heights[rows],
        )

    @property
    def directions(self) -> Array:
        """Unit directions (n, 3) of the measured motions: (vx, vy, LENGTH w)."""
        return unit(self.twists * (1.0, 1.0, LENGTH))


def unit(rows: Array) -> Array:
    """Rows (n, 3), each divided by its norm."""
    out: Array = rows / np.linalg.norm(rows, axis=1)[:, None]
    return out


def measured_pairs(
    pushes: Sequence[RecordedPush], center_of_mass: Point
) -> tuple[Pairs, list[str]]:
    """Pairs from all valid pushes, and for each other push the reason why it is
    invalid.

    ``center_of_mass`` [m] is in the object's tracked frame.
    """
    rows = []
    refused = []
    for number, push in enumerate(pushes, 1):
        row = _measured(push, center_of_mass)
        if isinstance(row, str):
            refused.append(f"push {number}: {row}")
        else:
            rows.append(row)
    table = np.array(rows).reshape(len(rows), 9)
    return Pairs(table[:, :3], table[:, 3:6], table[:, 6:8], table[:, 8]), refused


def _measured(push: RecordedPush, center_of_mass: Point) -> Array | str:
    """Figures (9,) of one push, or the reason why it is invalid.

    They are fx, fy, tau, dx, dy, yaw, contact x, y and height.
    """
    if not len(push.forces) or not len(push.probe):
        return "no force or probe samples"
    yaw = float(yaw_of(push.before[3:]))
    turn = wrap_angle(float(yaw_of(push.after[3:])) - yaw)
    com = np.array(center_of_mass)
    start = push.before[:2] + rotated(com, yaw)
    shift = push.after[:2] + rotated(com, yaw + turn) - start
    if math.hypot(shift[0], shift[1], LENGTH * turn) < LEAST_MOTION:
        return f"moved less than {1e3 * LEAST_MOTION:g} mm"
    force = push.forces[:, 1:] - push.forces[0, 1:]
    touching = np.flatnonzero((force**2).sum(1) > (force.mean(0) ** 2).sum())
    if not len(touching) or np.linalg.norm(force[touching].mean(0)) < LEAST_FORCE:
        return f"force below {LEAST_FORCE:g} N"
    first, last = push.forces[touching[[0, -1]], 0]
    late = touching[int(FREE_SHARE * len(touching)) :]
    time = push.forces[late, 0]
    # elapsed fraction of the object's motion
    done = (time - first) / max(last - first, 1e-9)
    tip, probe_yaw = _probe_at(push, time)
    object_yaw = yaw + done * turn
    contact = rotated(tip - start - done[:, None] * shift, -object_yaw)
    on_object = rotated(force[late] @ TOOL_FROM_SENSOR.T, probe_yaw - object_yaw)
    torque = contact[:, 0] * on_object[:, 1] - contact[:, 1] * on_object[:, 0]
    height = max(0.0, float(push.probe[:, 3].mean() - push.before[2]))
    wrench = [*on_object.mean(0), torque.mean()]
    motion = [*rotated(shift, -yaw - 0.5 * turn), turn]
    return np.array([*wrench, *motion, *contact.mean(0), height])


def _probe_at(push: RecordedPush, time: Array) -> tuple[Array, Array]:
    """Position (n, 2) [m] and yaw (n,) [rad] of the probe at times (n,) [s]."""
    clock = push.probe[:, 0]
    yaw = np.interp(time, clock, np.unwrap(yaw_of(push.probe[:, 4:])))
    place = [np.interp(time, clock, push.probe[:, i]) for i in (1, 2)]
    return np.stack(place, axis=1), yaw


def yaw_of(quaternion: Array) -> Array:
    """Yaws (n,) [rad] of quaternions (n, 4) w, x, y, z."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    out: Array = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y**2 + z**2))
    return out


def rotated(vectors: Array, angle: Array | float) -> Array:
    """Vectors (n, 2), each rotated by its ``angle`` [rad]."""
    c = np.cos(angle)
    s = np.sin(angle)
    x = vectors[..., 0]
    y = vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
