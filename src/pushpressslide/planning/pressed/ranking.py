"""Ranking of many presses by their estimated time to a goal, computed at once on a
coarse base.

The estimates only determine the order in which presses are tried.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter, itemgetter

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.motion import Motion
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import ObjectModel
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.pressed.manoeuvre import (
    Manoeuvre,
    narrow,
    pause,
    pressed_manoeuvres,
    straightest,
)
from pushpressslide.planning.pressed.three_turns import least_times
from pushpressslide.planning.pressed.turns import COUNT, EVERY, TurnTable, turn_table
from pushpressslide.planning.pressed.vehicle import press_of

# resolution of the base: the best press is nearly always among the first three
RESOLUTION = 2
AT_ONCE = 2  # contacts that manoeuvres are planned for
TRIED = 40  # manoeuvres, besides the quickest of each contact
MANY = 12  # number of turns of one press above which every other one is left out


def by_time(
    query: MotionQuery, X_WB: Pose2, contacts: Sequence[Contact]
) -> dict[Contact, float]:
    """Contacts sorted by the estimated time [s] of their manoeuvres from ``X_WB`` to
    the goal of ``query``.

    Contacts without a manoeuvre are omitted. A short list keeps its order.
    """
    if len(contacts) <= AT_ONCE:
        return dict.fromkeys(contacts, 0.0)
    times = manoeuvre_times(
        query, X_WB, [press_of(query.scene, contact) for contact in contacts]
    ).tolist()
    ranked = sorted(zip(contacts, times, strict=True), key=itemgetter(1))
    return {contact: time for contact, time in ranked if time < math.inf}


def soonest(
    query: MotionQuery, X_WB: Pose2, contacts: Sequence[Contact]
) -> Iterator[Manoeuvre]:
    """Yield manoeuvres, planned on demand.

    Batch by batch, the quickest manoeuvre of each contact comes first, then the others.
    """
    later: list[Manoeuvre] = []
    for i in range(0, len(contacts), AT_ONCE):
        manoeuvres = pressed_manoeuvres(query, X_WB, contacts[i : i + AT_ONCE])
        first = {manoeuvre.contact: manoeuvre for manoeuvre in reversed(manoeuvres)}
        yield from sorted(first.values(), key=attrgetter("time"))
        later += [
            manoeuvre
            for manoeuvre in manoeuvres
            if manoeuvre is not first[manoeuvre.contact]
        ]
    yield from sorted(later, key=attrgetter("time"))[:TRIED]


def manoeuvre_times(
    query: MotionQuery, X_WB: Pose2, presses: Sequence[Press]
) -> NDArray[np.float64]:
    """Estimated times (m,) [s] of the quickest manoeuvre from ``X_WB`` to the goal of
    ``query`` by each of m presses. Infinite if there is none.
    """
    speed = query.motion.speed
    table = turn_table(tuple(presses), speed, RESOLUTION)
    paces = _paces(query.motion, query.body, table)
    axes = np.array([p.axis for p in presses]).view(np.complex128)
    cops = np.array([p.cop for p in presses]).view(np.complex128)
    headings = axes * np.exp(1j * table.heading)
    straight = straightest(query.body)
    axles = cops + table.ahead * axes
    turns = _planned_turns(table, paces, axles, headings, straight)
    aside = margins.CORRECTED * query.body.radius
    shortest = margins.ARM.look_ahead(0.0, speed)
    longest = margins.ARM.look_ahead(math.inf, speed)
    levers = np.array([p.lever for p in presses])
    ahead = X_WB.inverse().compose(query.body_ends[1])
    turn = np.full(len(presses), math.remainder(ahead.yaw, 2.0 * math.pi))
    out = np.full(len(presses), math.inf)
    for end in (0, COUNT // 2):  # run-ins pulled and pushed
        wheelbase = np.abs(table.effective_wheelbase[:, end])
        free = paces.steering[:, end]
        feasible = table.steerable[:, end] & (free >= margins.CORRECTING)
        needed = np.sqrt(
            4.0 * aside * wheelbase / np.tan(np.where(feasible, free, 1.0))
        )
        wanted = np.maximum(margins.LOOK_AHEAD * (wheelbase + levers), needed)
        length = query.scene.run_ins[-1] * np.clip(wanted, shortest, longest)
        direction = headings[:, end]
        staging = complex(ahead.x, ahead.y) - length * direction * np.exp(
            1j * ahead.yaw
        )
        staging = np.where(feasible, staging, np.nan)
        turning = least_times(
            turns.centers, turns.sides, turns.times, turns.pauses, staging, turn
        )
        time = turning + length / paces.speed[:, end] + pause(query.motion)
        out = np.minimum(out, np.where(feasible, time, math.inf))
    return out


@dataclass(frozen=True, slots=True)
class _Paces:
    """Costs of a turn at each of COUNT force angles, in arrays (m, COUNT)."""

    steering: Array  # [rad] angle by which the force can be turned to either side
    speed: Array  # [m/s]
    pauses: Array  # [s]


@dataclass(frozen=True, slots=True)
class _Turns:
    """Turns considered for each press, in arrays (m, k) padded with NaN."""

    centers: NDArray[np.complex128]  # [m] in B
    sides: Array  # 1 to the left, -1 to the right
    times: Array  # [s/rad]
    pauses: Array  # [s]


def _paces(motion: Motion, body: ObjectModel, table: TurnTable) -> _Paces:
    steering = np.minimum(table.right, table.left)
    swing = np.minimum(1.0, margins.SWING / table.pace)
    slower = swing * np.minimum(1.0, table.tipping_margin / margins.SAFE_MARGIN)
    lower = pause(motion)
    careful = lower + narrow(body, motion.speed)
    pauses = np.where(steering < margins.CORRECTING, careful, lower)
    return _Paces(steering, motion.speed * slower, pauses)


def _planned_turns(
    table: TurnTable,
    paces: _Paces,
    axles: NDArray[np.complex128],
    headings: NDArray[np.complex128],
    straight: float,
) -> _Turns:
    """Turns of each press about their centres, at every second force angle of the
    table, or at every fourth if there are many.

    A turn with a curvature below ``straight`` [1/m] is replaced by two turns about
    distant centres, one on either side.
    """
    many = table.steerable[:, ::EVERY].sum(1, keepdims=True) > MANY
    stride = np.where(many, 2 * EVERY, EVERY)
    planned = table.steerable & (np.arange(COUNT) % stride == 0)
    bent = np.copysign(np.maximum(np.abs(table.curvature), straight), table.curvature)
    bent = np.where(planned, bent, np.nan)
    back = np.where(np.abs(table.curvature) < straight, -bent, np.nan)
    bent = np.concatenate([bent[:, ::EVERY], back[:, ::EVERY]], axis=1)
    upper = int(np.isfinite(bent).sum(1).max())
    order = np.argsort(np.isnan(bent), axis=1, kind="stable")[:, :upper]
    bent = np.take_along_axis(bent, order, axis=1)
    axle, heading, speed, pauses = (
        np.take_along_axis(
            np.concatenate([each[:, ::EVERY]] * 2, axis=1), order, axis=1
        )
        for each in (axles, headings, paces.speed, paces.pauses)
    )
    centers = axle + 1j * heading * (1.0 / bent)
    return _Turns(centers, np.sign(bent), 1.0 / (np.abs(bent) * speed), pauses)
