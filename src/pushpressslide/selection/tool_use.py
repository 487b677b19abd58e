"""A task with the goal of another body: the object is a tool that pushes this body
straight.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pushpressslide.core import margins
from pushpressslide.core.errors import TaskError
from pushpressslide.core.motion import ToolUse
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import ObjectModel, Obstacle
from pushpressslide.geometry.shapes import Shape

ON_HULL = 1e-6  # [m] distance inside the hull below which a face's point is on it
# backward direction in a box's frame, by the quarter turns from it to a push
BACK: tuple[Point, ...] = ((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0))


@dataclass(frozen=True, slots=True)
class StraightPush:
    """Straight push of a body by a tool's flat face."""

    body: Obstacle
    direction: float  # [rad] in W
    distance: float  # [m]

    def tool_goal(self, face: tuple[Point, Point]) -> Pose2:
        """Pose X_WG of the tool at the end of the push, with its face against the body.

        ``face`` [m] holds the ends of the tool's face in G.
        """
        pose = self.body.pose
        ahead = (math.cos(self.direction), math.sin(self.direction))
        end_x = pose.x + self.distance * ahead[0]
        end_y = pose.y + self.distance * ahead[1]
        quarters = round((self.direction - pose.yaw) / (0.5 * math.pi)) % 4
        half = self.body.shape.extent(BACK[quarters], (0.0, 0.0))
        (ax, ay), (bx, by) = face
        middle = (0.5 * (ax + bx), 0.5 * (ay + by))
        outward = math.atan2(ax - bx, by - ay)
        yaw = wrap_angle(self.direction - outward)
        X_WF = Pose2(end_x - half * ahead[0], end_y - half * ahead[1], yaw)
        x, y = X_WF.apply((-middle[0], -middle[1]))
        return Pose2(x, y, yaw)


def tool_use(
    d: Mapping[str, Any], tool: ObjectModel, obstacles: Sequence[Obstacle], source: str
) -> tuple[ToolUse | None, Pose2]:
    """Use of the object as a tool, and the goal X_WG of the object itself.

    If the goal names no other body, the result is None and the task's own goal.
    Otherwise a face of the tool pushes a side of the body straight from its initial
    pose to its goal, and the tool's goal is behind that of the body. Raises TaskError
    for a missing or fixed body, for a missing face, and for a goal with a yaw that the
    push cannot produce.
    """
    goal = d["goal"]
    name = goal["body"]
    target = Pose2(goal["x"], goal["y"], math.radians(goal["yaw_deg"]))
    if name in (None, "object"):
        return None, target
    body = _movable_body(name, obstacles, source)
    face = d["tool"]["face"]
    pushing = _outer_edges(tool)
    if not pushing:
        allowed = "allowed: object; a cylinder has no flat face to push with"
        raise TaskError(source, "goal.body", name, allowed)
    if face not in pushing:
        known = ", ".join(str(index) for index in pushing)
        raise TaskError(source, "tool.face", face, f"allowed: {known}")
    push = _straight_push(d, body, target, source)
    tool_goal = push.tool_goal(pushing[face])
    return ToolUse(name, target, face, push.distance), tool_goal


def _outer_edges(tool: ObjectModel) -> dict[int, tuple[Point, Point]]:
    """Ends in G, by index, of the flat faces beyond which no other part of the tool
    extends.
    """
    shape = tool.shape
    edges = {i: edge for i, edge in enumerate(shape.edges) if edge is not None}
    hull = shape.hull
    return {
        i: (a, b)
        for i, (a, b) in edges.items()
        if max(hull.depth(a), hull.depth(b)) < ON_HULL
        and hull.depth((0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]))) < ON_HULL
    }


def _movable_body(name: str, obstacles: Sequence[Obstacle], source: str) -> Obstacle:
    """The obstacle ``name``. Raises TaskError unless it is a movable box."""
    movable = {o.name: o for o in obstacles if o.movable}
    if name not in movable:
        allowed = ", ".join(["object", *movable])
        raise TaskError(
            source, "goal.body", name, f"allowed: a movable body: {allowed}"
        )
    body = movable[name]
    if not _is_rectangle(body.shape):
        allowed = f"{body.shape.description}; allowed: a box"
        raise TaskError(source, "goal.body", name, allowed)
    return body


def _is_rectangle(shape: Shape) -> bool:
    """Whether a footprint is a rectangle along G's axes about G's origin."""
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    about_origin = max(abs(x_min + x_max), abs(y_min + y_max)) < ON_HULL
    corners = {(x, y) for x in (x_min, x_max) for y in (y_min, y_max)}
    return about_origin and set(shape.corners) == corners


def _straight_push(
    d: Mapping[str, Any], body: Obstacle, target: Pose2, source: str
) -> StraightPush:
    """Push that brings ``body`` within tolerance of ``target`` X_WO.

    The pushing face aligns the body with the direction of the push. If the directions
    required by the goal's yaw and by its position differ, the push is a compromise.
    Raises TaskError if the push has no length, the yaw is out of tolerance, or the body
    stands askew to the push.
    """
    name = body.name
    distance = math.dist(body.pose.position, target.position)
    if distance == 0.0:
        allowed = f"allowed: away from where {name!r} stands"
        raise TaskError(source, "goal", [target.x, target.y], allowed)
    straight = math.atan2(target.y - body.pose.y, target.x - body.pose.x)
    skew = math.remainder(straight - target.yaw, 0.5 * math.pi)
    tolerance = d["tolerance"]["position"]
    turn = math.radians(d["tolerance"]["yaw_deg"])
    share = distance / tolerance / (distance / tolerance + 1.0 / turn)
    if share * abs(skew) > turn:
        raise TaskError(
            source,
            "goal.yaw_deg",
            d["goal"]["yaw_deg"],
            "a straight push there leaves the body at "
            f"{math.degrees(target.yaw + skew):.1f} deg; "
            f"allowed: up to {math.degrees(turn / share):.1f} deg from that",
        )
    direction = straight - (1.0 - share) * skew
    askew = abs(math.remainder(body.pose.yaw - direction, 0.5 * math.pi))
    if askew > margins.SQUARE:
        raise TaskError(
            source,
            "obstacles",
            name,
            f"it stands {math.degrees(askew):.1f} deg askew of the push; "
            f"allowed: up to {math.degrees(margins.SQUARE):g} deg",
        )
    return StraightPush(body, direction, distance * math.cos(straight - direction))


def tool_refusal(query: MotionQuery, poses: Sequence[Pose2]) -> Refusal | None:
    """Refusal of ``poses`` X_WG along a path, or None.

    They are refused if the tool does not push its body straight to the goal.
    """
    tool = query.tool
    goal = query.goal
    edge = None if tool is None else query.body.shape.edges[tool.face]
    if tool is None or edge is None:
        return None
    (ax, ay), (bx, by) = edge
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
        allowed = margins.TOOL_ASIDE * query.tolerance.position
        if off > allowed or turned > margins.ASKEW:
            text = (
                f"at ({X_WG.x:.3f}, {X_WG.y:.3f}) it is {{figure:mm.1f}} and "
                f"{math.degrees(turned):.1f} deg off the straight push by tool.face, "
                f"allowed {{allowed:mmg}} and {math.degrees(margins.ASKEW):g} deg"
            )
            return Refusal("tool_skew", text, off, allowed, "m")
    return None
