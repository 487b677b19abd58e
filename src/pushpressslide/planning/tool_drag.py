"""Drag added by bodies that the object pushes, as a tool or along its path."""

from __future__ import annotations

import math

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.query import MotionQuery

TURN = 2.0 * math.pi


def tool_load(query: MotionQuery, heading: float) -> tuple[float, float]:
    """Drag [N] added by bodies that the object pushes, and the angle [rad] between
    ``heading`` [rad] in B and the normal of a tool's pushing face.

    All bodies that the object may push are counted, as if they were pushed at once.
    """
    drags = [body.friction * body.mass * GRAVITY for body in query.yielding]
    shape = query.body.shape
    tool = query.tool
    edge = None if tool is None else shape.edges[tool.face]
    if tool is None or edge is None:
        return sum(drags), 0.0
    (ax, ay), (bx, by) = edge
    body = next(
        obstacle for obstacle in query.scene.obstacles if obstacle.name == tool.body
    )
    outward = math.atan2(ax - bx, by - ay)
    skew = abs(math.remainder(heading - outward, TURN))
    drags.append(body.friction * body.mass * GRAVITY)
    return sum(drags), skew
