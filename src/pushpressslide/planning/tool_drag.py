"""What a body that the object pushes as a tool adds to its drag."""

from __future__ import annotations

import math

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.task import Task

TURN = 2.0 * math.pi


def tool_load(task: Task, heading: float) -> tuple[float, float]:
    """Return what a body pushed by the object adds to the drag [N], and how far
    ``heading`` [rad] in B is off the pushing face's normal [rad].
    """
    shape = task.object.shape
    tool = task.tool
    edge = None if tool is None else shape.edges[tool.face]
    if tool is None or edge is None:
        return 0.0, 0.0
    (ax, ay), (bx, by) = edge
    body = next(obstacle for obstacle in task.obstacles if obstacle.name == tool.body)
    outward = math.atan2(ax - bx, by - ay)
    skew = abs(math.remainder(heading - outward, TURN))
    return body.friction * body.mass * GRAVITY, skew
