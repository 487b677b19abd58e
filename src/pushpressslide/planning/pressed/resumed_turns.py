"""Continuation of a manoeuvre from the measured object pose and contact: the same turns
with new curvatures and lengths.

A turn about a point of the body does not end exactly where it was planned to end: the
tip rolls and creeps, and the pressure differs from the believed pressure. The lengths
of the remaining turns and of the run-in are adapted to this.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.plan import Contact, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Scene
from pushpressslide.planning.pressed.manoeuvre import (
    DrivenTurn,
    as_driven,
    straightest,
)
from pushpressslide.planning.pressed.turns import pressed_turns
from pushpressslide.planning.pressed.vehicle import press_of
from pushpressslide.rom.drives import TurnDrive

STEPS = 5  # of Gauss and Newton's method
# share of the strongest effect of a change below which changes are not used
WEAK = 0.03
SMALL = 1e-6  # [m], [rad] of a difference quotient

Arc = tuple[Pose2, float]  # X_BV, curvature [1/m]


def pressed_at(
    scene: Scene, speed: float, segments: Sequence[Segment], contact: Contact
) -> list[Segment]:
    """Segments of a manoeuvre with the same turns by a press at ``contact``, which have
    new curvatures.

    A turn that does not exist at the new contact stays as planned.
    """
    found = pressed_turns(press_of(scene, contact), speed)
    straight = straightest(scene.body)
    turns = {turn.angle: turn for turn in found}
    out = []
    for segment in segments:
        planned = segment.drive
        path = segment.path
        assert isinstance(planned, TurnDrive)
        turn = turns.get(planned.axis_angle)
        if turn is not None and isinstance(path, ArcPath):
            curvature, length = path.sections[-1]
            if curvature:
                curvature = as_driven(turn.curvature, curvature, straight)
            path = ArcPath(path.start, ((curvature, length),))
            now = DrivenTurn(turn, path, segment.goal, segment.profile.speed, speed)
            drive = now.drive(planned.max_friction, planned.last)
            segment = replace(segment, contacts=(contact,), drive=drive, path=path)
        out.append(segment)
    return out


def resume_turns(
    scene: Scene,
    speed: float,
    segments: Sequence[Segment],
    X_WB: Pose2,
    contact: Contact,
) -> tuple[Segment, ...]:
    """The remaining ``segments`` pressed at ``contact``, with lengths that lead from
    ``X_WB`` as near to the goal as possible.

    Of several solutions, the one nearest to the planned lengths is taken. The last turn
    is also steered, because too few lengths are then left to adapt.
    """
    now = pressed_at(scene, speed, segments, contact)
    X_GB = scene.body.X_GB
    goal = now[-1].goal.compose(X_GB)
    arcs, lengths = _arcs(now, X_WB, goal, scene)
    poses = _poses(arcs, lengths, X_WB)
    out = []
    parts = zip(now, arcs, lengths, pairwise(poses), strict=True)
    for segment, (X_BV, curvature), length, (first, end) in parts:
        start = first.compose(X_BV)
        if segment is now[-1]:
            # the run-in leads to the goal, from wherever the turns end
            start = advance(goal.compose(X_BV), 0.0, -length)
        else:
            segment = replace(segment, goal=end.compose(X_GB.inverse()))
        out.append(segment.follows(ArcPath(start, ((curvature, length),))))
    return tuple(out)


def run_in_missed(segments: Sequence[Segment], X_WB: Pose2, radius: float) -> float:
    """Distance [m] between the end of the turns from ``X_WB`` and the start of the
    run-in. An error of one radian counts as ``radius`` [m].
    """
    *turns, run_in = segments
    end = X_WB
    if turns:
        end = turns[-1].path.end.compose(turns[-1].X_BV.inverse())
    start = run_in.path.pose(0.0).compose(run_in.X_BV.inverse())
    yaw = math.remainder(start.yaw - end.yaw, math.tau)
    return math.hypot(math.dist(end.position, start.position), radius * yaw)


@dataclass(frozen=True, slots=True)
class _ArcMotion:
    """Arcs from ``start`` with free lengths. The first arc is also steered.

    x (n + 1,) holds the lengths [m] of n arcs and the steering [rad].
    """

    arcs: list[Arc]
    effective_wheelbase: float  # [m] of the first arc
    start: Pose2  # X_WB
    goal: Pose2
    radius: float  # [m] weight of an error of one radian

    def steered(self, x: Array) -> list[Arc]:
        """The arcs with the steering applied."""
        (X_BV, curvature), *others = self.arcs
        return [(X_BV, curvature + math.tan(x[-1]) / self.effective_wheelbase), *others]

    def short(self, x: Array) -> Array:
        """Remaining displacement (3,) [m] from the end of the arcs to the goal."""
        goal = self.goal
        end = _poses(self.steered(x), x[:-1].tolist(), self.start)[-1]
        yaw = math.remainder(goal.yaw - end.yaw, math.tau)
        return np.array([goal.x - end.x, goal.y - end.y, self.radius * yaw])

    def solved(self, x: Array, low: Array, high: Array, measure: Array) -> Array:
        """Solution ``x`` within bounds that leads to the goal with the smallest change,
        by Gauss-Newton steps.

        ``measure`` (n + 1,) weights the changes.
        """
        for _ in range(STEPS):
            off = self.short(x)
            slopes = np.array(
                [
                    (off - self.short(x + step)) / SMALL
                    for step in SMALL * np.eye(len(x))
                ]
            ).T
            step = _step(
                slopes / measure, off, (low - x) * measure, (high - x) * measure
            )
            x = x + step / measure
        return x


def _arcs(
    segments: Sequence[Segment], X_WB: Pose2, goal: Pose2, scene: Scene
) -> tuple[list[Arc], list[float]]:
    """Arcs of ``segments`` that lead from ``X_WB`` to ``goal``, and their lengths [m].

    No length changes by more than the object's ``radius`` [m].
    """
    radius = scene.body.radius
    arcs: list[Arc] = [
        (s.X_BV, s.path.sections[-1][0])
        for s in segments
        if isinstance(s.path, ArcPath)
    ]
    turn = segments[0].drive
    run_in = segments[-1].drive
    assert isinstance(turn, TurnDrive)
    assert isinstance(run_in, TurnDrive)
    curvatures = np.array([curvature for _, curvature in arcs])
    # of all changes those of the least way and the least turn
    measure = np.append(1.0 + radius * np.abs(curvatures), 1.0)
    x = np.array([*(segment.path.length for segment in segments), 0.0])
    planned = margins.PLANNED_STEERING
    lower = margins.LEAST_RUN_IN * scene.run_ins[-1] * run_in.look_ahead
    shortest = [0.0] * (len(arcs) - 1) + [lower]
    low = np.maximum([*shortest, planned * turn.right], x - radius / measure)
    longest = [math.inf] * len(arcs)
    high = np.minimum([*longest, planned * turn.left], x + radius / measure)
    if len(arcs) > 2:
        low[-1] = high[-1] = 0.0
    motion = _ArcMotion(arcs, turn.effective_wheelbase, X_WB, goal, radius)
    x = motion.solved(x, low, high, measure)
    return motion.steered(x), [float(length) for length in x[:-1]]


def _step(slopes: Array, off: Array, low: Array, high: Array) -> Array:
    """Smallest step (n,) within bounds that reduces ``off`` (3,) as much as the bounds
    allow.
    """
    step = np.zeros(len(low))
    free = np.ones(len(low), dtype=bool)
    while free.any():
        step[free] = np.linalg.lstsq(
            slopes[:, free], off - slopes[:, ~free] @ step[~free], rcond=WEAK
        )[0]
        beyond = free & ((step < low) | (step > high))
        step = np.clip(step, low, high)
        if not beyond.any():
            break
        free &= ~beyond
    return step


def _poses(arcs: Sequence[Arc], lengths: Sequence[float], X_WB: Pose2) -> list[Pose2]:
    """Poses X_WB before the first arc and after each."""
    out = [X_WB]
    for (X_BV, curvature), length in zip(arcs, lengths, strict=True):
        out.append(
            advance(out[-1].compose(X_BV), curvature, length).compose(X_BV.inverse())
        )
    return out
