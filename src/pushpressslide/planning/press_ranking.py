"""Which of many presses leads to a goal soonest: all of them at once, on a base of few cells. What it takes
for their order, not for a plan.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from operator import attrgetter, itemgetter

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.manoeuvre import least_times
from pushpressslide.planning.pressed_manoeuvre import (
    CORRECTED,
    CORRECTING,
    LOOK_AHEAD,
    NARROW,
    PAUSE,
    RUN_INS,
    SAFE_ROOM,
    STRAIGHT,
    Manoeuvre,
    pressed_manoeuvres,
)
from pushpressslide.planning.pressed_turns import COUNT, EVERY, turn_table
from pushpressslide.planning.pressed_vehicle import SWING, press_of

RESOLUTION = 2  # of the base: the best press is nearly always among the first three
AT_ONCE = 2  # contacts that manoeuvres are planned for
TRIED = 40  # manoeuvres, besides the quickest of each contact
MANY = 12  # turns of one press, from which on every other one is left out


def by_time(task: Task, X_WB: Pose2, contacts: Sequence[Contact]) -> dict[Contact, float]:
    """Return contacts in the order of how long [s] manoeuvres by them may take from ``X_WB`` to the task's
    goal, without those by which nothing leads there; as they are where there are few.
    """
    if len(contacts) <= AT_ONCE:
        return dict.fromkeys(contacts, 0.0)
    times = manoeuvre_times(task, X_WB, [press_of(task, contact) for contact in contacts]).tolist()
    ranked = sorted(zip(contacts, times, strict=True), key=itemgetter(1))
    return {contact: time for contact, time in ranked if time < math.inf}


def soonest(task: Task, X_WB: Pose2, contacts: Sequence[Contact]) -> Iterator[Manoeuvre]:
    """Yield manoeuvres, planned when asked for: of some contacts at a time the quickest of each, then the
    others.
    """
    later: list[Manoeuvre] = []
    for i in range(0, len(contacts), AT_ONCE):
        found = pressed_manoeuvres(task, X_WB, contacts[i : i + AT_ONCE])
        first = {manoeuvre.contact: manoeuvre for manoeuvre in reversed(found)}
        yield from sorted(first.values(), key=attrgetter("time"))
        later += [manoeuvre for manoeuvre in found if manoeuvre is not first[manoeuvre.contact]]
    yield from sorted(later, key=attrgetter("time"))[:TRIED]


def manoeuvre_times(task: Task, X_WB: Pose2, presses: Sequence[Press]) -> NDArray[np.float64]:
    """Return about how long (m,) [s] the quickest manoeuvre from ``X_WB`` to the task's goal takes by each of
    m presses of its object; infinite where there is none.
    """
    table = turn_table(presses, RESOLUTION)
    levers = np.array([[p.lever] for p in presses])
    axes, cops = (
        np.array(of).view(np.complex128) for of in ([p.axis for p in presses], [p.cop for p in presses])
    )
    steering = np.minimum(table.right, table.left)
    with np.errstate(invalid="ignore"):
        speed = (
            task.motion.speed * np.minimum(1.0, SWING / table.pace) * np.minimum(1.0, table.room / SAFE_ROOM)
        )
    pauses = PAUSE + NARROW * (steering < CORRECTING)
    bent = np.copysign(np.maximum(np.abs(table.curvature), STRAIGHT), table.curvature)
    axles, ways = cops + table.ahead * axes, axes * np.exp(1j * table.heading)
    stride = np.where(table.usable[:, ::EVERY].sum(1, keepdims=True) > MANY, 2 * EVERY, EVERY)
    bent = np.where(table.usable & (np.arange(COUNT) % stride == 0), bent, np.nan)
    back = np.where(np.abs(table.curvature) < STRAIGHT, -bent, np.nan)  # straight turns go with either centre
    turns = [np.concatenate([v[:, ::EVERY]] * 2, axis=1) for v in (axles, ways, speed, pauses)]
    bent = np.concatenate([bent[:, ::EVERY], back[:, ::EVERY]], axis=1)
    order = np.argsort(np.isnan(bent), axis=1, kind="stable")[
        :, : int(np.isfinite(bent).sum(1).max(initial=0))
    ]
    bent, a, u, v, pauses_ = (np.take_along_axis(of, order, axis=1) for of in (bent, *turns))
    centers, times = a + 1j * u * (1.0 / bent), 1.0 / (np.abs(bent) * v)
    goal = task.goal.compose(task.object.X_GB)
    ahead = X_WB.inverse().compose(goal)
    turn, out = math.remainder(ahead.yaw, 2.0 * math.pi), np.full(len(presses), math.inf)
    for end in (0, COUNT // 2):
        gain, most = np.abs(table.gain[:, end]), steering[:, end]
        able = table.usable[:, end] & (most >= CORRECTING)
        needed = np.sqrt(4.0 * CORRECTED * gain / np.tan(np.where(able, most, 1.0)))
        length = RUN_INS[-1] * np.clip(np.maximum(0.35 * (gain + levers[:, 0]), needed), *LOOK_AHEAD)
        staging = complex(ahead.x, ahead.y) - length * ways[:, end] * np.exp(1j * ahead.yaw)
        staging = np.where(able, staging, np.nan)
        found = least_times(centers, np.sign(bent), times, pauses_, staging, np.full(len(presses), turn))
        out = np.minimum(out, np.where(able, found + length / speed[:, end] + PAUSE, math.inf))
    return out
