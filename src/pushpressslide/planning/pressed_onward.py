"""The rest of a manoeuvre from where object and contact really are: the same turns, as they then are and as
long as they then have to be.

A turn about a point of the body does not end quite where it was planned to: the tip rolls and creeps, and the
pressure is not quite what it was believed to be. The turns that are left and the run-in have lengths to choose
that make up for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.planning.pressed_manoeuvre import Stretch, as_driven
from pushpressslide.planning.pressed_turns import pressed_turns
from pushpressslide.planning.pressed_vehicle import press_of

STEPS = 8  # of Gauss and Newton's method
YAW_ARM = 0.1  # [m] that an error of one radian counts for
LEAST_RUN_IN = 1.5  # look-aheads

Arc = tuple[Pose2, float]  # X_BV, curvature [1/m]


def pressed_at(plan: Plan, contact: Contact) -> Plan:
    """Return ``plan``, of a manoeuvre, and what follows it, with the same turns pressed at ``contact``: their
    paths as they were, but for the curvatures. A turn that is no longer one there stays as planned.
    """
    press = press_of(plan.task, contact)
    turns, following = {turn.angle: turn for turn in pressed_turns([press])[0]}, None
    for stretch in reversed(plan.stretches):
        planned, path = stretch.choice.parameters, stretch.path
        turn = turns.get(planned["turned_from_axis"])
        if turn is not None and isinstance(path, ArcPath):
            curvature, length = path.pieces[-1]
            curvature = as_driven(turn.curvature, curvature) if curvature else 0.0
            path = ArcPath(path.start, ((curvature, length),))
            now = Stretch(turn, path, Pose2(0.0, 0.0, 0.0), planned["speed"])
            parameters = {**planned, **now.parameters(planned["push_force"])}
            choice = replace(stretch.choice, contacts=(contact,), parameters=parameters, path=path)
            stretch = replace(stretch, choice=choice, path=path, X_BV=turn.X_BV)
        following = replace(stretch, following=following)
    assert following is not None
    return following


def onward(plan: Plan, X_WB: Pose2, contact: Contact) -> Plan:
    """Return ``plan``, what is left of a manoeuvre's turn, and what follows it, pressed at ``contact`` and with
    the lengths that lead from ``X_WB`` to the goal, or as near to it as they can; those next to the planned
    ones, where several do.
    """
    stretches, X_GB = pressed_at(plan, contact).stretches, plan.task.object.X_GB
    goal = stretches[-1].goal.compose(X_GB)
    arcs: list[Arc] = [(s.X_BV, s.path.pieces[-1][0]) for s in stretches if isinstance(s.path, ArcPath)]
    least = LEAST_RUN_IN * stretches[-1].choice.parameters["look_ahead"]
    lengths = _lengths(arcs, [stretch.path.length for stretch in stretches], least, X_WB, goal)
    poses, following = _poses(arcs, lengths, X_WB), None
    parts = zip(stretches, arcs, lengths, pairwise(poses), strict=True)
    for stretch, (X_BV, curvature), length, (begin, end) in reversed(list(parts)):
        start, target = begin.compose(X_BV), stretch.choice.goal
        if following is None:  # the run-in leads to the goal, from wherever the turns end
            start = advance(goal.compose(X_BV), 0.0, -length)
        elif target is not None:
            target = end.compose(X_GB.inverse())
        path = ArcPath(start, ((curvature, length),))
        following = replace(
            stretch,
            choice=replace(stretch.choice, path=path, path_length=length, goal=target),
            path=path,
            profile=SpeedProfile(length, stretch.profile.speed, stretch.profile.acceleration),
            following=following,
        )
    assert following is not None
    return following


def _lengths(
    arcs: Sequence[Arc], planned: Sequence[float], least_run_in: float, X_WB: Pose2, goal: Pose2
) -> list[float]:
    curvatures = np.array([curvature for _, curvature in arcs])
    ways = 1.0 + YAW_ARM * np.abs(curvatures)  # of all changes those of the least way and the least turn
    least = np.append(np.zeros(len(arcs) - 1), least_run_in)
    lengths, free = np.array(planned), np.ones(len(arcs), dtype=bool)
    for _ in range(STEPS):
        poses = _poses(arcs, lengths.tolist(), X_WB)
        end = poses[-1]
        off = (goal.x - end.x, goal.y - end.y, YAW_ARM * math.remainder(goal.yaw - end.yaw, math.tau))
        slopes = np.zeros((3, len(arcs)))  # of the end, by each length
        for i, ((X_BV, curvature), pose) in enumerate(zip(arcs, poses[1:], strict=True)):
            X_WV = pose.compose(X_BV)
            slopes[0, i] = math.cos(X_WV.yaw) - curvature * (end.y - X_WV.y)
            slopes[1, i] = math.sin(X_WV.yaw) + curvature * (end.x - X_WV.x)
            slopes[2, i] = YAW_ARM * curvature
        change = np.linalg.lstsq((slopes / ways)[:, free], np.array(off), rcond=None)[0]
        lengths[free] += change / ways[free]
        free &= lengths > least
        lengths = np.maximum(lengths, least)
    return [float(length) for length in lengths]


def _poses(arcs: Sequence[Arc], lengths: Sequence[float], X_WB: Pose2) -> list[Pose2]:
    """Return X_WB before the first arc and after each."""
    out = [X_WB]
    for (X_BV, curvature), length in zip(arcs, lengths, strict=True):
        out.append(advance(out[-1].compose(X_BV), curvature, length).compose(X_BV.inverse()))
    return out
