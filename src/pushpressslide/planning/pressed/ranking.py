"""Which of many presses leads to a goal soonest: all of them at once, on a base of few
cells. What it takes for their order, not for a plan.
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
from pushpressslide.planning.pressed.manoeuvre import (
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
from pushpressslide.planning.pressed.three_turns import least_times
from pushpressslide.planning.pressed.turns import COUNT, EVERY, turn_table
from pushpressslide.planning.pressed.vehicle import SWING, press_of

RESOLUTION = 2  # of the base: the best press is nearly always among the first three
AT_ONCE = 2  # contacts that manoeuvres are planned for
TRIED = 40  # manoeuvres, besides the quickest of each contact
MANY = 12  # turns of one press, from which on every other one is left out


def by_time(
    task: Task, X_WB: Pose2, contacts: Sequence[Contact]
) -> dict[Contact, float]:
    """Return contacts in the order of how long [s] manoeuvres by them may take from
    ``X_WB`` to the task's goal, without those by which nothing leads there; as they are
    where there are few.
    """
    if len(contacts) <= AT_ONCE:
        return dict.fromkeys(contacts, 0.0)
    times = manoeuvre_times(
        task, X_WB, [press_of(task, contact) for contact in contacts]
    ).tolist()
    ranked = sorted(zip(contacts, times, strict=True), key=itemgetter(1))
    return {contact: time for contact, time in ranked if time < math.inf}


def soonest(
    task: Task, X_WB: Pose2, contacts: Sequence[Contact]
) -> Iterator[Manoeuvre]:
    """Yield manoeuvres, planned when asked for: of some contacts at a time the quickest
    of each, then the others.
    """
    later: list[Manoeuvre] = []
    for i in range(0, len(contacts), AT_ONCE):
        found = pressed_manoeuvres(task, X_WB, contacts[i : i + AT_ONCE])
        first = {manoeuvre.contact: manoeuvre for manoeuvre in reversed(found)}
        yield from sorted(first.values(), key=attrgetter("time"))
        later += [
            manoeuvre
            for manoeuvre in found
            if manoeuvre is not first[manoeuvre.contact]
        ]
    yield from sorted(later, key=attrgetter("time"))[:TRIED]


def manoeuvre_times(
    task: Task, X_WB: Pose2, presses: Sequence[Press]
) -> NDArray[np.float64]:
    """Return about how long (m,) [s] the quickest manoeuvre from ``X_WB`` to the task's
    goal takes by each of m presses of its object; infinite where there is none.
    """
    table = turn_table(presses, RESOLUTION)
    levers = np.array([p.lever for p in presses])
    axes, cops = (
        np.array(of).view(np.complex128)
        for of in ([p.axis for p in presses], [p.cop for p in presses])
    )
    steering = np.minimum(table.right, table.left)
    slower = np.minimum(1.0, SWING / table.pace) * np.minimum(
        1.0, table.room / SAFE_ROOM
    )
    speed = task.motion.speed * slower
    pauses = PAUSE + NARROW * (steering < CORRECTING)
    axles = cops + table.ahead * axes
    ways = axes * np.exp(1j * table.heading)
    stride = np.where(
        table.usable[:, ::EVERY].sum(1, keepdims=True) > MANY, 2 * EVERY, EVERY
    )
    planned = table.usable & (np.arange(COUNT) % stride == 0)
    bent = np.copysign(np.maximum(np.abs(table.curvature), STRAIGHT), table.curvature)
    bent = np.where(planned, bent, np.nan)
    # straight turns go with either centre
    back = np.where(np.abs(table.curvature) < STRAIGHT, -bent, np.nan)
    # of each press its turns, and NaN after them
    bent = np.concatenate([bent[:, ::EVERY], back[:, ::EVERY]], axis=1)
    most = int(np.isfinite(bent).sum(1).max())
    order = np.argsort(np.isnan(bent), axis=1, kind="stable")[:, :most]
    bent = np.take_along_axis(bent, order, axis=1)
    axle, way, pace, pause = (
        np.take_along_axis(np.concatenate([of[:, ::EVERY]] * 2, axis=1), order, axis=1)
        for of in (axles, ways, speed, pauses)
    )
    centers = axle + 1j * way * (1.0 / bent)
    times = 1.0 / (np.abs(bent) * pace)
    ahead = X_WB.inverse().compose(task.goal.compose(task.object.X_GB))
    turn = np.full(len(presses), math.remainder(ahead.yaw, 2.0 * math.pi))
    out = np.full(len(presses), math.inf)
    for end in (0, COUNT // 2):  # run-ins pulled and pushed
        gain = np.abs(table.gain[:, end])
        free = steering[:, end]
        able = table.usable[:, end] & (free >= CORRECTING)
        needed = np.sqrt(4.0 * CORRECTED * gain / np.tan(np.where(able, free, 1.0)))
        length = RUN_INS[-1] * np.clip(
            np.maximum(0.35 * (gain + levers), needed), *LOOK_AHEAD
        )
        staging = complex(ahead.x, ahead.y) - length * ways[:, end] * np.exp(
            1j * ahead.yaw
        )
        staging = np.where(able, staging, np.nan)
        found = least_times(centers, np.sign(bent), times, pause, staging, turn)
        out = np.minimum(
            out, np.where(able, found + length / speed[:, end] + PAUSE, math.inf)
        )
    return out
