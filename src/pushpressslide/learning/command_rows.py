"""Measurements and tip commands as rows of numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Measurement, TipCommand, TipState
from pushpressslide.core.motion import Limits, Motion
from pushpressslide.core.pose import Pose2

YAW = 4.0 * math.pi  # [rad], whole turns included
# [N s/m] damping of which twice the amount is always within the bounds
LEAST_DAMPING = 500.0
FAST = 10.0  # [m/s] bound of an observed velocity
FAR = 20.0  # [m] bound of an observed position
STRONG = 1e5  # [N] bound of an observed force
SEEN = 7
"""Number of values at the beginning of an observation, before those of the tips: time,
pose, goal.
"""
TIP = 9
"""Number of values in an observation for each tip: position, velocity, force."""
WIDTH = 25
"""Number of values in one tip's command."""


COMMAND = (
    ("force", 3),
    ("position", 3),
    ("velocity", 3),
    ("stiffness", 3),
    ("damping", 3),
    ("normal_yaw", 1),
    ("tool_yaw", 1),
    ("tool_yaw_rate", 1),
    ("servo_cap", 1),
    ("progress", 1),
    ("acceleration", 3),
    ("tool_yaw_acceleration", 1),
    ("catches_up", 1),
)
"""Fields of a tip's command, with the number of values of each."""


def state_names(arms: int) -> tuple[str, ...]:
    """Names of an observation's values for ``arms`` arms."""
    names = ["time", "x", "y", "yaw", "goal_x", "goal_y", "goal_yaw"]
    for arm in range(arms):
        for what in ("", "v", "f"):
            names += [f"tip{arm}_{what}{axis}" for axis in "xyz"]
    return tuple(names)


def command_names(arms: int) -> tuple[str, ...]:
    """Names of an action's values for ``arms`` arms."""
    names = []
    for arm in range(arms):
        for field, count in COMMAND:
            ends = [""] if count == 1 else ["_x", "_y", "_z"]
            names += [f"tip{arm}_{field}{end}" for end in ends]
    return tuple(names)


class CommandScale:
    """Scaling of a tip's command to numbers in [-1, 1], from the smallest to the
    largest allowed value of each field.
    """

    def __init__(self, motion: Motion, limits: Limits) -> None:
        """Take the bounds of forces and damping from a task."""
        force = 2.0 * limits.normal_force
        damping = 2.0 * max(motion.servo_damping, LEAST_DAMPING)
        # smallest and largest value, in the units of TipCommand
        bounds = {
            "force": (-force, force),
            "position": (-5.0, 5.0),
            "velocity": (-0.5, 0.5),
            "stiffness": (0.0, 5000.0),
            "damping": (0.0, damping),
            "normal_yaw": (-YAW, YAW),
            "tool_yaw": (-YAW, YAW),
            "tool_yaw_rate": (-2.0, 2.0),
            "servo_cap": (0.0, 100.0),
            "progress": (-20.0, 20.0),
            "acceleration": (-5.0, 5.0),
            "tool_yaw_acceleration": (-10.0, 10.0),
            "catches_up": (0.0, 1.0),
        }
        low, high = (
            np.concatenate([np.full(n, bounds[name][end]) for name, n in COMMAND])
            for end in (0, 1)
        )
        self._middle = 0.5 * (low + high)
        self._half = 0.5 * (high - low)

    def row(self, command: TipCommand | None) -> Array:
        """Numbers (25,) of a command. Zeros for a tip without a contact."""
        if command is None:
            return np.zeros(WIDTH)
        values = [np.ravel(getattr(command, name)) for name, _ in COMMAND]
        scaled = (np.concatenate(values) - self._middle) / self._half
        return np.asarray(np.clip(scaled, -1.0, 1.0))

    def command(self, row: Array) -> TipCommand:
        """Command given by numbers (25,), each clipped to its bounds."""
        numbers = (self._middle + self._half * np.clip(row, -1.0, 1.0)).tolist()
        fields = dict(self._fields(numbers))
        fields["catches_up"] = fields["catches_up"] >= 0.5
        return TipCommand(**fields)

    def _fields(self, numbers: Sequence[float]) -> Iterator[tuple[str, Any]]:
        first = 0
        for name, count in COMMAND:
            values = tuple(numbers[first : first + count])
            first += count
            yield name, values if count > 1 else values[0]


def observation_row(measurement: Measurement, goal: Pose2) -> Array:
    """An observation as numbers (7 + 9 A,).

    It contains time [s], pose X_WG, goal and, for each tip, position [m], velocity
    [m/s] and force [N] on the object.
    """
    X = measurement.object_pose
    row = [measurement.time, X.x, X.y, X.yaw, goal.x, goal.y, goal.yaw]
    for tip in measurement.tips:
        row += [*tip.position, *tip.velocity, *tip.force]
    return np.nan_to_num(np.array(row, dtype=np.float64))


def row_measurement(row: Array) -> Measurement:
    """Measurement from an observation (7 + 9 A,)."""
    time, x, y, yaw, *_ = row[:SEEN].tolist()
    tips = []
    for numbers in row[SEEN:].reshape(-1, TIP).tolist():
        px, py, pz, vx, vy, vz, fx, fy, fz = numbers
        tips.append(TipState((px, py, pz), (vx, vy, vz), (fx, fy, fz)))
    return Measurement(time, Pose2(x, y, yaw), tuple(tips))
