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
from pushpressslide.planning.pressed_turns import STRAIGHT, PressedTurn, pressed_turns
from pushpressslide.planning.pressed_vehicle import SWING, TIPPING_ROOM, press_of

STEP = math.radians(5.0)  # between the force angles that are judged
EVERY = 3  # of them is one that turns are planned with
STEERING = math.radians(30.0)  # most that the force is turned from its planned angle
LEAST_STEERING = math.radians(9.0)  # either side of a planned angle, before the object tips
RUN_INS = (3.0, 2.0)  # look-aheads
PAUSE = 0.6  # [s] that a turn takes besides: it begins and ends at rest
SAFE_ROOM = 0.5
COUNT = 3  # words per placement that are handed on


@dataclass(frozen=True, slots=True)
class Stretch:
    """One turn of a manoeuvre."""

    turn: PressedTurn
    path: ArcPath  # of the turn's axle
    end: Pose2  # X_WB
    speed: float  # [m/s]
    right: float  # [rad] that the force may be turned to the right, < 0
    left: float  # [rad]
    look_ahead: float  # [m]


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """Stretches, and how long they take."""

    contact: Contact
    stretches: tuple[Stretch, ...]
    time: float  # [s]


def free_angles(press: Press) -> list[tuple[float, float, float, float]]:
    """Return force angles (with what they may be turned to the right and to the left, and the room) [rad]."""
    n = round(2.0 * math.pi / STEP)
    rooms = [press.room(i * STEP) for i in range(n)]
    most, out = round(STEERING / STEP), []
    for i in range(0, n, EVERY):
        if rooms[i] < TIPPING_ROOM:
            continue
        sides = []
        for sign in (-1, 1):
            k = 0
            while k < most and rooms[(i + sign * (k + 1)) % n] >= TIPPING_ROOM:
                k += 1
            sides.append(sign * k * STEP)
        if min(-sides[0], sides[1]) >= LEAST_STEERING:
            angle = math.remainder(i * STEP, 2.0 * math.pi)
            out.append((angle, sides[0], sides[1], rooms[i]))
    return out


def manoeuvres(
    task: Task, X_WB: Pose2, contacts: Sequence[Contact]
) -> list[Manoeuvre]:
    """Return the quickest manoeuvres from ``X_WB`` to the task's goal by presses at ``contacts``."""
    rows: list[tuple[int, Press, tuple[float, float, float, float]]] = []
    for index, contact in enumerate(contacts):
        try:
            press = press_of(task, contact)
        except ValueError:
            continue
        rows += [(index, press, free) for free in free_angles(press)]
    if not rows:
        return []
    angles = [free[0] for _, _, free in rows]
    turns = pressed_turns([press for _, press, _ in rows], angles)
    goal = task.goal.compose(task.object.X_GB)
    found: list[Manoeuvre] = []
    by_contact: dict[int, list[tuple[PressedTurn, tuple[float, float, float, float]]]] = {}
    for (index, _, free), turn in zip(rows, turns, strict=True):
        if turn is not None:
            by_contact.setdefault(index, []).append((turn, free))
    for index, choices in by_contact.items():
        found += _of_press(task, X_WB, goal, contacts[index], choices)
    return sorted(found, key=lambda m: m.time)


def _of_press(
    task: Task,
    X_WB: Pose2,
    goal: Pose2,
    contact: Contact,
    choices: list[tuple[PressedTurn, tuple[float, float, float, float]]],
) -> list[Manoeuvre]:
    speeds = [
        task.motion.speed * min(1.0, SWING / turn.pace) * min(1.0, free[3] / SAFE_ROOM) for turn, free in choices
    ]
    centers = np.array([complex(*turn.center) for turn, _ in choices])
    far = np.abs(centers) > 1.0 / STRAIGHT
    centers[far] *= 1.0 / STRAIGHT / np.abs(centers[far])
    senses = np.array([math.copysign(1.0, turn.curvature) for turn, _ in choices])
    radii = np.array([abs(complex(*turn.X_BV.position) - c) for (turn, _), c in zip(choices, centers, strict=True)])
    times = radii / np.array(speeds)
    out = []
    for (turn, free), speed in zip(choices, speeds, strict=True):
        if abs(math.remainder(turn.angle, math.pi)) > 1e-6 or min(-free[1], free[2]) < 2.0 * STEP:
            continue
        look_ahead = min(max(0.35 * abs(turn.gain + math.copysign(turn.press.lever, turn.gain)), 0.04), 0.10)
        for run_in in RUN_INS:
            length = run_in * look_ahead
            e = turn.X_BV.yaw
            staging = goal.compose(Pose2(-length * math.cos(e), -length * math.sin(e), 0.0))
            ahead = X_WB.inverse().compose(staging)
            ahead = Pose2(ahead.x, ahead.y, math.remainder(ahead.yaw, 2.0 * math.pi))
            for word in words(centers, senses, times, PAUSE, ahead, COUNT):
                stretches, X = [], X_WB
                for index, angle in zip(word.turns, word.angles, strict=True):
                    made, limits = choices[index]
                    stretches.append(_stretch(made, limits, speeds[index], X, angle, centers[index], look_ahead))
                    X = stretches[-1].end
                path = ArcPath(X.compose(turn.X_BV), ((0.0, length),))
                stretches.append(Stretch(turn, path, goal, speed, free[1], free[2], look_ahead))
                time = word.time + length / speed + PAUSE
                out.append(Manoeuvre(contact, tuple(stretches), time))
    return out


def _stretch(
    turn: PressedTurn, limits: tuple[float, float, float, float], speed: float, X_WB: Pose2, angle: float,
    center: complex, look_ahead: float,
) -> Stretch:  # fmt: skip
    X_BV = turn.X_BV
    curvature = math.copysign(1.0 / abs(complex(*X_BV.position) - center), turn.curvature)
    path = ArcPath(X_WB.compose(X_BV), ((curvature, angle / curvature),))
    return Stretch(turn, path, path.end.compose(X_BV.inverse()), speed, limits[1], limits[2], look_ahead)
