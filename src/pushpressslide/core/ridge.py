"""A low straight ridge on a support, as of a seam or of a cable under a cloth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.truth import refuse_truth

NAME = "support_ridge"
"""Name of a ridge among the geometries of a simulated world."""
WIDTH = 0.02
"""Width [m] of a ridge at its foot."""
LENGTH = 4.0
"""Length [m] of a ridge, half of it on each side of the line from start to goal."""


@dataclass(frozen=True, slots=True)
class Ridge:
    """A part of a cylinder that stands out of a support."""

    pose: Pose2  # in the support's plane; the ridge lies along x
    height: float  # [m] above the support

    @classmethod
    def of_task(cls, task: Task) -> Ridge | None:
        """The ridge that a task's ``truth`` has across the line from start to goal.

        Raises TaskError on a support with an edge or an opening, and for a ridge under
        a body at its start.
        """
        truth = task.truth
        if truth.ridge == 0.0:
            return None
        source = task.source or task.name
        if task.support.region is not None or task.support.opening is not None:
            flat = replace(truth, ridge=0.0)
            refuse_truth(truth, flat, source, "on a support with edges")
        start, goal = task.start, task.goal
        dx = goal.x - start.x
        dy = goal.y - start.y
        x = start.x + truth.ridge_place * dx
        y = start.y + truth.ridge_place * dy
        yaw = math.atan2(dy, dx) + 0.5 * math.pi + truth.ridge_angle
        ridge = cls(Pose2(x, y, yaw), truth.ridge)
        below = ridge._below(task)
        if below is not None:
            allowed = f"allowed: where the ridge is not under {below} at the start"
            raise TaskError(source, "truth.ridge_place", truth.ridge_place, allowed)
        return ridge

    def _below(self, task: Task) -> str | None:
        """The first body of a task that stands on the ridge. None if there is none."""
        import shapely

        ends = [self.pose.apply((x, 0.0)) for x in (-0.5 * LENGTH, 0.5 * LENGTH)]
        line = shapely.LineString(ends)
        bodies = [("the object", task.object.shape.placed(task.true_start))]
        bodies += [
            (repr(one.name), one.shape.placed(one.pose))
            for one in task.obstacles
            if one.movable
        ]
        near = (name for name, base in bodies if base.distance(line) < 0.5 * WIDTH)
        return next(near, None)

    @property
    def radius(self) -> float:
        """Radius [m] of the cylinder."""
        return 0.125 * WIDTH**2 / self.height + 0.5 * self.height

    def profile(self, parts: int) -> list[Point]:
        """Points (y, height) [m] along a cross-section in ``parts`` of the same angle,
        from one foot to the other.
        """
        r = self.radius
        half = math.asin(0.5 * WIDTH / r)
        angles = [half * (2.0 * i / parts - 1.0) for i in range(parts + 1)]
        top = self.height - r
        return [(r * math.sin(a), top + r * math.cos(a)) for a in angles]
