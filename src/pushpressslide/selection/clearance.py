"""Whether a planned path is free: of obstacles, of openings, straight with a tool."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core import margins
from pushpressslide.core.footprint import gap, overlap_area
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal, literal
from pushpressslide.core.task import Box, ObjectModel, Obstacle, Shape, Task
from pushpressslide.selection.opening_path import opening_refusal
from pushpressslide.selection.tool_use import tool_refusal

# of the square of the clearance, shared with an obstacle: the object is in it from
# there on, not beside it
ENTERED = 0.1
SWEEP_STEP = 0.5  # clearances of path between the places where the gap is looked at


def path_refusal(task: Task, segments: Sequence[Segment]) -> Refusal | None:
    """Return where the object's path comes too near to an obstacle, where it tips into
    an opening, or where as a tool it does not push straight; None if nowhere.
    """
    if not (task.obstacles or task.support.opening or task.tool):
        return None
    poses = swept(task.object, segments)
    return (
        obstacle_refusal(task, poses)
        or opening_refusal(task, segments[0], poses)
        or tool_refusal(task, poses)
    )


def obstacle_refusal(task: Task, poses: Sequence[Pose2]) -> Refusal | None:
    """Return where the object would come too near to an obstacle, or None; ``poses``:
    X_WG along a path.

    A movable one counts where it stands at first, so that it is not pushed along. What
    the object is to push as a tool may be touched by it, and keeps clear of the others.
    """
    tool = task.tool
    pushed = None
    others = []
    for obstacle in task.obstacles:
        if tool is not None and obstacle.name == tool.body:
            pushed = obstacle
        else:
            others.append(obstacle)
    ends = (task.start, task.goal)
    refusal = _too_near("the object", task.object.shape, poses, ends, others)
    if refusal is not None or pushed is None or tool is None:
        return refusal
    ends = (pushed.pose, tool.goal)
    distance = math.dist(pushed.pose.position, tool.goal.position)
    steps = max(1, math.ceil(distance / _step()))
    poses = [_between(*ends, i / steps) for i in range(steps + 1)]
    return _too_near(f"{pushed.name!r}", Box(pushed.size), poses, ends, others)


def swept(body: ObjectModel, segments: Sequence[Segment]) -> list[Pose2]:
    """Return the poses X_WG along planned segments, a few millimetres apart."""
    poses = []
    X_BG = body.X_GB.inverse()
    for segment in segments:
        path = segment.path
        X_VG = segment.X_BV.inverse().compose(X_BG)
        steps = max(1, math.ceil(path.length / _step()))
        poses += [
            path.pose(path.length * i / steps).compose(X_VG) for i in range(steps + 1)
        ]
    return poses


def _step() -> float:
    """Return the way [m] between the places of a path where the gap is looked at."""
    return SWEEP_STEP * margins.ARM.clearance


def _between(a: Pose2, b: Pose2, u: float) -> Pose2:
    turn = math.remainder(b.yaw - a.yaw, 0.5 * math.pi)  # whichever side is pushed
    return Pose2(a.x + u * (b.x - a.x), a.y + u * (b.y - a.y), a.yaw + u * turn)


def _too_near(
    what: str,
    shape: Shape,
    poses: Sequence[Pose2],
    ends: tuple[Pose2, Pose2],
    obstacles: Sequence[Obstacle],
) -> Refusal | None:
    """Say where ``what`` comes nearer to an obstacle than it may; at its ``ends`` it
    may be where it is.
    """
    for obstacle in obstacles:
        box = Box(obstacle.size)

        def apart(X_WG: Pose2, box: Box = box, X_WO: Pose2 = obstacle.pose) -> float:
            """Return the gap [m] to the obstacle at a pose."""
            return gap(shape, X_WG, box, X_WO)

        def inside(X_WG: Pose2, box: Box = box, X_WO: Pose2 = obstacle.pose) -> float:
            """Return the area [m^2] shared with the obstacle at a pose."""
            return overlap_area(shape, X_WG, box, X_WO)

        allowed = min(margins.ARM.clearance, *(apart(X) for X in ends)) - 1e-6
        least, nearest = min(((apart(X), X) for X in poses), key=lambda found: found[0])
        if least == 0.0 and allowed <= 0.0:  # it touches at an end, and may on the way
            nearest = max(poses, key=inside)
            place = f"({nearest.x:.3f}, {nearest.y:.3f})"
            if inside(nearest) > ENTERED * margins.ARM.clearance**2:
                text = literal(
                    f"{what} runs into obstacle {obstacle.name!r} at {place}"
                )
                return Refusal("obstacle", text)
        place = f"({nearest.x:.3f}, {nearest.y:.3f})"
        if least < allowed:
            text = (
                f"{literal(what)} comes within {{figure:mm.0f}} of obstacle "
                f"{literal(repr(obstacle.name))} at {place}, allowed from "
                "{allowed:mm.0f}"
            )
            return Refusal("obstacle", text, least, allowed, "m")
    return None
