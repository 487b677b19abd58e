"""Manoeuvres of a pressed object: up to three turns, each by a force at one angle, and a straight run-in on
which what error there is decays. For goals that no path of one vehicle leads to.

Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.mechanics.pressing import Press
from pushpressslide.planning.manoeuvre import words
from pushpressslide.planning.pressed_turns import PressedTurn, pressed_turns
from pushpressslide.planning.pressed_vehicle import SWING, press_of

RUN_INS = (3.0, 2.0)  # look-aheads
PAUSE = 0.6  # [s] that a turn takes besides: it begins and ends at rest
SAFE_ROOM = 0.5
STRAIGHT = 0.05  # [1/m] of straight turns, that have a centre far away
ERROR = 0.01 # [m] 4 times the lateral error that all steering is used for
LONGEST = 0.75  # of limits.time: the rest is for another attempt
COUNT = 3  # words per placement that are handed on


@dataclass(frozen=True, slots=True)
class Stretch:
    """One turn of a manoeuvre."""

    turn: PressedTurn
    path: ArcPath  # of the turn's axle
    end: Pose2  # X_WB
    speed: float  # [m/s]
    look_ahead: float  # [m]


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """Stretches, and how long they take."""

    contact: Contact
    stretches: tuple[Stretch, ...]
    time: float  # [s]


def manoeuvres(task: Task, X_WB: Pose2, contacts: Sequence[Contact]) -> list[Manoeuvre]:
    """Return manoeuvres from ``X_WB`` to the task's goal, each by a press at one of ``contacts``, the quickest
    first.
    """
    pressed = [(contact, press_of(task, contact)) for contact in contacts if contact.point != (0.0, 0.0)]
    goal, out = task.goal.compose(task.object.X_GB), []
    turns = pressed_turns([press for _, press in pressed])
    for (contact, _), of_press in zip(pressed, turns, strict=True):
        if of_press:
            out += _of_press(task, X_WB, goal, contact, of_press)
    return sorted(out, key=lambda manoeuvre: manoeuvre.time)


def _of_press(
    task: Task, X_WB: Pose2, goal: Pose2, contact: Contact, turns: list[PressedTurn]
) -> list[Manoeuvre]:
    speeds = [
        task.motion.speed * min(1.0, SWING / turn.pace) * min(1.0, turn.room / SAFE_ROOM) for turn in turns
    ]
    bent = np.array([_bent(turn.curvature) for turn in turns])
    axles = np.array([complex(*turn.X_BV.position) for turn in turns])
    normals = 1j * np.exp(1j * np.array([turn.X_BV.yaw for turn in turns]))
    centers, times = axles + normals / bent, 1.0 / (np.abs(bent) * np.array(speeds))
    out = []
    for turn, speed in zip(turns, speeds, strict=True):
        if abs(math.remainder(turn.angle, math.pi)) > 1e-6:
            continue
        X_BV, look_ahead = turn.X_BV, _look_ahead(turn)
        for run_in in RUN_INS:
            length = run_in * look_ahead
            staging = goal.compose(Pose2(-length * math.cos(X_BV.yaw), -length * math.sin(X_BV.yaw), 0.0))
            ahead = X_WB.inverse().compose(staging)
            ahead = Pose2(ahead.x, ahead.y, math.remainder(ahead.yaw, 2.0 * math.pi))
            for word in words(centers, np.sign(bent), times, PAUSE, ahead, COUNT):
                stretches, X = [], X_WB
                for index, angle in zip(word.turns, word.angles, strict=True):
                    by = turns[index]
                    path = ArcPath(X.compose(by.X_BV), ((float(bent[index]), float(angle / bent[index])),))
                    X = path.end.compose(by.X_BV.inverse())
                    stretches.append(Stretch(by, path, X, speeds[index], _look_ahead(by)))
                path = ArcPath(X.compose(X_BV), ((0.0, length),))
                stretches.append(Stretch(turn, path, goal, speed, look_ahead))
                time = word.time + length / speed + PAUSE
                if time < LONGEST * task.limits.time:
                    out.append(Manoeuvre(contact, tuple(stretches), time))
    return out


def _bent(curvature: float) -> float:
    return math.copysign(max(abs(curvature), STRAIGHT), curvature)


def _look_ahead(turn: PressedTurn) -> float:
    """Return the look-ahead [m]: a third of the vehicle's length; more where little steering corrects little."""
    gain = abs(turn.gain)
    return min(max(0.35 * (gain + turn.press.lever), math.sqrt(ERROR * gain / math.tan(min(turn.left, -turn.right))), 0.04), 0.10)
