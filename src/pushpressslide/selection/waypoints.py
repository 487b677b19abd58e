"""Poses by which an object may be led where no single motion leads to its goal.

First those that the modes' own geometry asks for: a push goes straight along a line
through the centre of mass, so that the object is first turned towards its goal, or
brought before its goal. Then those round obstacles. Then an even sample of the rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise, zip_longest

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Robot
from pushpressslide.core.task import Box, Task
from pushpressslide.planning.free_way import Bounds, FreeSpace, WaysTo, between
from pushpressslide.planning.side_contacts import pushable
from pushpressslide.robots.kinematics import arm_kinematics
from pushpressslide.robots.reach import reachable

STRAIGHTS = (0.12, 0.25)  # [m] of straight push that leads to the goal
SPREAD = 16  # poses of the even sample
FACES = 2  # by which a pose on the way is turned to be pushed along it
SIDES = 4  # faces by which a straight push to the goal is tried
ROOM = 0.3  # [m] about start and goal, within which the way may lead
# of the sample over x, y and yaw: the fractional parts of multiples of these fill the
# cube evenly (Roberts' sequence, from the root of x^4 = x + 1)
STRIDES = tuple(1.2207440846057596**-k for k in (1, 2, 3))


def free_space(task: Task) -> FreeSpace:
    """Return where the object may be on its way."""
    others = tuple(
        Box(obstacle.size).placed(obstacle.pose) for obstacle in task.obstacles
    )
    return FreeSpace(task.object.shape, others, task.motion.clearance, bounds(task))


def bounds(task: Task) -> Bounds:
    """Return the region in which the object's frame may be on its way [m]."""
    ends = (task.start, task.goal)
    xs = [X.x for X in ends]
    ys = [X.y for X in ends]
    room = ROOM + task.object.shape.circumradius
    region = (min(xs) - room, max(xs) + room, min(ys) - room, max(ys) + room)
    allowed = task.limits.workspace
    if allowed is None:
        return region
    return (
        max(region[0], allowed[0]),
        min(region[1], allowed[1]),
        max(region[2], allowed[2]),
        min(region[3], allowed[3]),
    )


def waypoints(task: Task, ways: WaysTo) -> list[Pose2]:
    """Return poses X_WG, those that are likely to be of use first; free, and where some
    arm reaches the object. None for an object that is shut in.

    ``ways`` lead to the goal of ``task``.
    """
    way = ways.way(task.start)
    if way is None:
        return []
    axes = push_axes(task)
    kinds = (way[1:-1], _before(task, axes), _gates(way, axes), _turned(task, axes))
    in_turn = [X for row in zip_longest(*kinds) for X in row if X is not None]
    space = ways.space
    return _usable(task, space, [*in_turn, *_sample(task, space.bounds)])


def push_axes(task: Task) -> list[float]:
    """Return the directions [rad] in G in which a push of one face goes straight."""
    scene = task.scene
    return [math.atan2(-y, -x) for face in pushable(scene) for x, y in [face.foot]]


def _gates(way: Sequence[Pose2], axes: Sequence[float]) -> list[Pose2]:
    """Return the places of a way, and the middles of its pieces, with the object turned
    so that it is pushed along the way there; turned as little as possible.
    """
    middles = [between(*ends, 0.5) for ends in pairwise(way)]
    out = []
    for (before, after), middle in zip(pairwise(way), middles, strict=True):
        out += _pushed_along(before, after, middle, axes)
    for before, here, after in zip(way, way[1:], way[2:], strict=False):
        out += _pushed_along(before, after, here, axes)
    return middles + out


def _pushed_along(
    before: Pose2, after: Pose2, here: Pose2, axes: Sequence[float]
) -> list[Pose2]:
    """Return the pose ``here`` turned to where a push leads from ``before`` to
    ``after``, by the faces for which it is turned least.
    """
    ahead = math.atan2(after.y - before.y, after.x - before.x)
    turns = [math.remainder(ahead - axis - here.yaw, 2.0 * math.pi) for axis in axes]
    least = sorted(turns, key=abs)[:FACES]
    return [Pose2(here.x, here.y, here.yaw + turn) for turn in least]


def _turned(task: Task, axes: Sequence[float]) -> list[Pose2]:
    """Return the start turned on the spot: as at the goal, and towards the goal."""
    start = task.start
    goal = task.goal
    turned = Pose2(start.x, start.y, goal.yaw)
    return [turned, *_pushed_along(start, goal, start, axes)]


def _before(task: Task, axes: Sequence[float]) -> list[Pose2]:
    """Return poses from which a straight push leads to the goal."""
    goal = task.goal
    out = []
    bearing = math.atan2(goal.y - task.start.y, goal.x - task.start.x) - goal.yaw
    for axis in _nearest(axes, bearing):
        c = math.cos(goal.yaw + axis)
        s = math.sin(goal.yaw + axis)
        out += [Pose2(goal.x - d * c, goal.y - d * s, goal.yaw) for d in STRAIGHTS]
    return out


def _nearest(axes: Sequence[float], bearing: float) -> list[float]:
    """Return the axes [rad] in the order of how far they are off a bearing [rad], as
    many as there are faces of a box.
    """
    off = [(abs(math.remainder(axis - bearing, 2.0 * math.pi)), axis) for axis in axes]
    return [axis for _, axis in sorted(off)[:SIDES]]


def _sample(task: Task, region: Bounds) -> list[Pose2]:
    """Return poses spread evenly over the region and all yaws."""
    x_min, x_max, y_min, y_max = region
    out = []
    for i in range(1, SPREAD + 1):
        u, v, w = ((i * stride) % 1.0 for stride in STRIDES)
        x = x_min + u * (x_max - x_min)
        y = y_min + v * (y_max - y_min)
        out.append(Pose2(x, y, task.goal.yaw + 2.0 * math.pi * w))
    return out


def _usable(task: Task, space: FreeSpace, poses: Sequence[Pose2]) -> list[Pose2]:
    """Return the poses that are free, in bounds and reached, each once."""
    x_min, x_max, y_min, y_max = space.bounds
    inside = [X for X in poses if x_min <= X.x <= x_max and y_min <= X.y <= y_max]
    if not inside:
        return []
    able = space.free(inside) & reached(task, inside)
    out: list[Pose2] = []
    for X, fit in zip(inside, able, strict=True):
        if fit and not any(_same(X, other) for other in (*out, task.start, task.goal)):
            out.append(X)
    return out


def _same(X: Pose2, Y: Pose2) -> bool:
    turn = math.remainder(Y.yaw - X.yaw, 2.0 * math.pi)
    return math.dist(X.position, Y.position) < 0.01 and abs(turn) < 0.05


def reached(task: Task, poses: Sequence[Pose2]) -> NDArray[np.bool_]:
    """Return whether some arm's tip reaches the middle of the object's top, (n,)."""
    shape = task.object.shape
    out = np.full(len(poses), False)
    for robot in task.robots:
        out |= _reached(robot, task, shape.height, poses)
    return out


def _reached(
    robot: Robot, task: Task, height: float, poses: Sequence[Pose2]
) -> NDArray[np.bool_]:
    frame = task.support.frame
    center = task.object.center_of_mass
    points = [frame.point((*X.apply(center), height + robot.tip_radius)) for X in poses]
    return reachable(arm_kinematics(robot), np.array(points), quick=True).ok
