"""A task whose goal is another body's: the object is the tool that pushes it there,
straight.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.task import ObjectModel, Obstacle, Task, ToolUse

ASIDE = 0.002
# [m], [rad] of a tool's way from the straight push, while it pushes
ASKEW = math.radians(2.0)
# the body's sides turn by up to this much against the tool's face
SQUARE = math.radians(20.0)


def tool_use(
    d: Mapping[str, Any], tool: ObjectModel, obstacles: Sequence[Obstacle], source: str
) -> tuple[ToolUse | None, Pose2]:
    """Return how the object is used as a tool, and the goal X_WG of the object itself.

    None and the task's own goal where the goal names no other body. Else the tool
    pushes the body from where it stands straight to its goal, face against side: its
    goal is behind the body's. Raises TaskError for a body that is not there or fixed, a
    face that is not there, and a body's goal at another yaw than the face leaves it
    with.
    """
    goal = d["goal"]
    name = d["goal"]["body"]
    target = Pose2(goal["x"], goal["y"], math.radians(goal["yaw_deg"]))
    if name in (None, "object"):
        return None, target
    body = next((o for o in obstacles if o.name == name), None)
    if body is None or not body.movable:
        movable = ", ".join(["object", *(o.name for o in obstacles if o.movable)])
        raise TaskError(
            source, "goal.body", name, f"allowed: a movable body: {movable}"
        )
    shape = tool.shape
    face = d["tool"]["face"]
    if not shape.corners:
        raise TaskError(
            source,
            "goal.body",
            name,
            "allowed: object; a cylinder has no flat face to push with",
        )
    if face >= len(shape.corners):
        raise TaskError(
            source, "tool.face", face, f"allowed: 0 to {len(shape.corners) - 1}"
        )
    way = math.dist(body.pose.position, target.position)
    if way == 0.0:
        raise TaskError(
            source,
            "goal",
            [target.x, target.y],
            f"allowed: away from where {name!r} stands",
        )
    straight = math.atan2(target.y - body.pose.y, target.x - body.pose.x)
    skew = math.remainder(straight - target.yaw, 0.5 * math.pi)
    # the face leaves the body square to the push: what the goal's yaw and its place ask
    # for is shared out
    tolerance = d["tolerance"]["position"]
    turn = math.radians(d["tolerance"]["yaw_deg"])
    share = way / tolerance / (way / tolerance + 1.0 / turn)
    if share * abs(skew) > turn:
        raise TaskError(
            source,
            "goal.yaw_deg",
            goal["yaw_deg"],
            "a straight push there leaves the body at "
            f"{math.degrees(target.yaw + skew):.1f} deg; "
            f"allowed: up to {math.degrees(turn / share):.1f} deg from that",
        )
    push = straight - (1.0 - share) * skew
    way *= math.cos(straight - push)
    end = (body.pose.x + way * math.cos(push), body.pose.y + way * math.sin(push))
    turned = math.remainder(body.pose.yaw - push, 0.5 * math.pi)
    if abs(turned) > SQUARE:
        raise TaskError(
            source,
            "obstacles",
            name,
            f"it stands {math.degrees(abs(turned)):.1f} deg askew of the push; "
            "allowed: up to "
            f"{math.degrees(SQUARE):g} deg",
        )
    corners = shape.corners
    ax, ay = corners[face]
    bx, by = corners[(face + 1) % len(corners)]
    middle = (0.5 * (ax + bx), 0.5 * (ay + by))
    outward = math.atan2(ax - bx, by - ay)
    half = 0.5 * body.size[round((body.pose.yaw - push) / (0.5 * math.pi)) % 2]
    yaw = wrap_angle(push - outward)
    at = Pose2(end[0] - half * math.cos(push), end[1] - half * math.sin(push), yaw)
    x, y = at.apply((-middle[0], -middle[1]))
    return ToolUse(name, target, face, way), Pose2(x, y, yaw)


def tool_refusal(task: Task, poses: Sequence[Pose2]) -> Refusal | None:
    """Return where the tool would not push its body straight to the body's goal, or
    None.

    ``poses``: X_WG along a choice's path.
    """
    tool = task.tool
    goal = task.goal
    if tool is None or not task.object.shape.corners:
        return None
    corners = task.object.shape.corners
    ax, ay = corners[tool.face]
    bx, by = corners[(tool.face + 1) % len(corners)]
    nx, ny = goal.rotate((by - ay, ax - bx))
    size = math.hypot(nx, ny)
    for X_WG in reversed(poses):
        dx = goal.x - X_WG.x
        dy = goal.y - X_WG.y
        left = (dx * nx + dy * ny) / size
        aside = abs(dy * nx - dx * ny) / size
        turned = abs(wrap_angle(goal.yaw - X_WG.yaw))
        if left > tool.straight:
            return None
        off = math.hypot(aside, min(left, 0.0))
        if off > ASIDE or turned > ASKEW:
            text = (
                f"at ({X_WG.x:.3f}, {X_WG.y:.3f}) it is {{figure:mm.1f}} and "
                f"{math.degrees(turned):.1f} deg off the straight push by tool.face, "
                f"allowed {{allowed:mmg}} and {math.degrees(ASKEW):g} deg"
            )
            return Refusal("tool_skew", text, off, ASIDE, "m")
    return None
