"""Bodies that block others, and poses where they may be put aside."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.core.bodies import (
    Stage,
    body_shape,
    stage_task,
)
from pushpressslide.core.motion import Limits
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Scene
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import Task
from pushpressslide.selection.waypoints import free_space, reached

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry

RINGS = (2.5, 4.0, 6.0)  # distances about the body, in its circumradii
AROUND = 12  # places on a ring
PER_RING = 2  # places of each ring that are kept
BASE_ROOM = 0.12  # [m] to a robot's base

Goals = Mapping[str, tuple[Pose2, ...]]
"""Remaining goals of each body, X_WG in order, by the body's name."""


@dataclass(frozen=True, slots=True)
class Moment:
    """The state between two stages, and the remaining goals of the bodies."""

    task: Task
    state: WorldState
    goals: Goals

    def outline(self, body: str) -> Polygon:
        """Footprint of a body at its present pose."""
        return body_shape(self.task, body).placed(self.state.poses[body])

    def goal_outlines(self, body: str) -> list[Polygon]:
        """Footprints of a body at its remaining goals."""
        shape = body_shape(self.task, body)
        return [shape.placed(goal) for goal in self.goals.get(body, ())]

    def swept_area(self, body: str) -> BaseGeometry:
        """Region that a body sweeps on straight paths through its remaining goals."""
        from shapely import union_all

        stations = [self.outline(body), *self.goal_outlines(body)]
        return union_all([a.union(b).convex_hull for a, b in pairwise(stations)])


def in_the_way(moment: Moment) -> list[str]:
    """Bodies with goals that block another body, in the order of the task.

    They stand in the other body's goal, or within a tip's width of its straight path.
    """
    task = moment.task
    margin = 2.0 * max(robot.tip_radius for robot in task.robots)
    paths = {
        body: moment.swept_area(body).buffer(margin + task.motion.clearance)
        for body, goals in moment.goals.items()
        if goals
    }
    return [
        body
        for body in moment.goals
        if any(
            moment.outline(body).intersects(path)
            for other, path in paths.items()
            if other != body
        )
    ]


def spots(moment: Moment, body: str) -> list[Pose2]:
    """Poses X_WG to which ``body`` may be put aside, the best first.

    They are on rings about the body, within the workspace and reach, and clear of all
    other bodies and of those bodies' remaining goals. Poses that are also clear of the
    other bodies' straight paths come first; among equal poses, nearer ones come first.
    """
    here = moment.state.poses[body]
    stage = stage_task(moment.task, Stage(body, here), moment.state).query
    shape = stage.scene.body.shape
    others = [other for other in moment.goals if other != body]
    paths = [moment.swept_area(other) for other in others if moment.goals[other]]
    kept = []
    for number, ring in enumerate(RINGS):
        ranked = []
        for X in _free(stage, moment, body, ring * shape.circumradius):
            outline = shape.placed(X).buffer(stage.motion.clearance)
            blocked = sum(bool(outline.intersects(path)) for path in paths)
            onward = sum(math.dist(X.position, g.position) for g in moment.goals[body])
            ranked.append((blocked, number, round(onward, 6), X.x, X.y, X))
        kept += sorted(ranked, key=lambda rank: rank[:-1])[:PER_RING]
    return [rank[-1] for rank in sorted(kept, key=lambda rank: rank[:-1])]


def _free(
    stage: MotionQuery, moment: Moment, body: str, distance: float
) -> list[Pose2]:
    """Free, reachable poses on a ring about the body of a ``stage``."""
    here = stage.start
    angles = [2.0 * math.pi * i / AROUND for i in range(AROUND)]
    ring = [
        Pose2(
            here.x + distance * math.cos(a), here.y + distance * math.sin(a), here.yaw
        )
        for a in angles
    ]
    ring = [X for X in ring if _within(stage.scene, stage.limits, X)]
    if not ring:
        return []
    space = free_space(stage)
    goals = [
        outline
        for other in moment.goals
        if other != body
        for outline in moment.goal_outlines(other)
    ]
    space = replace(space, others=(*space.others, *goals))
    reachable = np.asarray(space.free(ring)) & reached(stage.scene, ring)
    return [X for X, fit in zip(ring, reachable, strict=True) if fit]


def _within(scene: Scene, limits: Limits, X: Pose2) -> bool:
    """Whether a pose is in the workspace and clear of the robots' bases."""
    shape = scene.body.shape
    for x, y, height in scene.bases:
        gap = shape.distance(X.unapply((x, y)))
        if height < shape.height and gap < BASE_ROOM:
            return False
    if limits.workspace is None:
        return True
    x_min, x_max, y_min, y_max = limits.workspace
    return x_min <= X.x <= x_max and y_min <= X.y <= y_max
