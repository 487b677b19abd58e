"""Waypoints of an object for sequences of motions, if no single motion leads to its
goal.

Poses that suit the geometry of the modes come first: a push is straight along a line
through the centre of mass, so the object is first turned towards its goal, or brought
before its goal. Poses around obstacles follow, then an even sample of all other poses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise, zip_longest

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.footprint import middle_room
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Robot, Scene
from pushpressslide.geometry.shapes import Shape
from pushpressslide.modes import MODES
from pushpressslide.planning.free_space import (
    Bounds,
    FreeSpace,
    PathsTo,
    between,
    same_pose,
)
from pushpressslide.planning.side_contacts import lone_contact_height, pushable
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.reach import reachable
from pushpressslide.selection.clearance import base_discs
from pushpressslide.selection.reach_screen import touching

STRAIGHTS = (0.12, 0.25)  # [m] of straight push that leads to the goal
ONWARD = (0.15, 0.3, 0.5)  # [m] of straight push from a via pose
ARC = 2.0  # radii of the object: of the arcs from there
TURNS = tuple(math.radians(a) for a in (-90.0, -45.0, 45.0, 90.0))  # on them
SPREAD = 16  # poses of the even sample
FACES = 2  # number of faces to which a via pose is turned for a push along the path
SIDES = 4  # faces by which a straight push to the goal is tried
ROOM = 0.3  # [m] around start and goal, within which the path may lead
HAND_OVER = 0.06  # [m] between the places at which an arm may take an object over
HANDED_OVER = 8  # such poses
FOLLOWED = 3  # number of via poses from which paths to the goal are evaluated
HANDED_OVER_BY = ("press_slide", "rear_push")  # both before and after
# of the sample over x, y and yaw: the fractional parts of multiples of these fill the
# cube evenly (Roberts' sequence, from the root of x^4 = x + 1)
STRIDES = tuple(1.2207440846057596**-k for k in (1, 2, 3))


def free_space(query: MotionQuery) -> FreeSpace:
    """Free space of the object between start and goal."""
    others = tuple(obstacle.footprint for obstacle in query.scene.obstacles)
    body = query.body
    return FreeSpace(
        body.shape,
        (*others, *base_discs(query.scene)),
        query.motion.clearance,
        bounds(query),
        middle_room(query.scene.support, body.shape),
        body.center_of_mass,
    )


def bounds(query: MotionQuery) -> Bounds:
    """Region [m] in which the object's frame may be."""
    ends = (query.start, query.goal)
    xs: Sequence[float] = [X.x for X in ends]
    ys: Sequence[float] = [X.y for X in ends]
    margin = ROOM + query.body.shape.circumradius
    region = (min(xs) - margin, max(xs) + margin, min(ys) - margin, max(ys) + margin)
    if query.scene.support.region is not None:
        xs, ys = zip(*query.scene.support.region, strict=True)
        out = math.hypot(*query.body.center_of_mass)
        table = (min(xs) - out, max(xs) + out, min(ys) - out, max(ys) + out)
        region = _within(region, table)
    allowed = query.limits.workspace
    return region if allowed is None else _within(region, allowed)


def _within(region: Bounds, allowed: Bounds) -> Bounds:
    return (
        max(region[0], allowed[0]),
        min(region[1], allowed[1]),
        max(region[2], allowed[2]),
        min(region[3], allowed[3]),
    )


def waypoints(query: MotionQuery, free_paths: PathsTo) -> list[Pose2]:
    """Free poses X_WG at which an arm reaches the object, the most useful first. Empty
    if the object is enclosed.

    ``free_paths`` lead to the goal of ``query``.
    """
    path = free_paths.via_poses(query.start)
    if path is None:
        return []
    axes = push_axes(query)
    handed_over = _handed_over(query, free_paths.space)
    kinds = (
        handed_over,
        _poses_along(free_paths, handed_over[:FOLLOWED]),
        path[1:-1],
        _before(query.start, query.goal, axes),
        _gates(path, axes),
        _turned(query.start, query.goal, axes),
    )
    in_turn = [X for row in zip_longest(*kinds) for X in row if X is not None]
    space = free_paths.space
    return _usable(query, space, [*in_turn, *_sample(query.goal.yaw, space.bounds)])


def push_successors(query: MotionQuery, free_paths: PathsTo, X: Pose2) -> list[Pose2]:
    """Free poses X_WG that one push by each face can reach from ``X``, straight or on
    an arc, and at which an arm reaches the object.
    """
    goal = free_paths.goal
    radius = ARC * query.body.radius
    out = []
    bearing = math.atan2(goal.y - X.y, goal.x - X.x) - X.yaw
    for axis in _nearest(push_axes(query), bearing):
        heading = X.yaw + axis
        c = math.cos(heading)
        s = math.sin(heading)
        abreast = (goal.x - X.x) * c + (goal.y - X.y) * s
        lengths = [*ONWARD, abreast] if abreast > ONWARD[0] else ONWARD
        out += [Pose2(X.x + d * c, X.y + d * s, X.yaw) for d in lengths]
        out += [_on_arc(X, heading, radius, turn) for turn in TURNS]
    return _usable(query, free_paths.space, out)


def _on_arc(X: Pose2, heading: float, radius: float, turn: float) -> Pose2:
    """End pose of an arc that starts along ``heading`` [rad]."""
    side = math.copysign(radius, turn)
    x = X.x + side * (math.sin(heading + turn) - math.sin(heading))
    y = X.y - side * (math.cos(heading + turn) - math.cos(heading))
    return Pose2(x, y, X.yaw + turn)


def push_axes(query: MotionQuery) -> list[float]:
    """Directions [rad] in G in which a push on one face moves the object straight."""
    height = lone_contact_height(query.scene, query.motion)
    pushed = pushable(query.scene, height)
    return [math.atan2(-face.foot[1], -face.foot[0]) for face in pushed]


def _gates(path: Sequence[Pose2], axes: Sequence[float]) -> list[Pose2]:
    """Via points of a path and the midpoints between them.

    At each, the object is turned as little as needed to be pushed along the path.
    """
    middles = [between(*ends, 0.5) for ends in pairwise(path)]
    out = []
    for (before, after), middle in zip(pairwise(path), middles, strict=True):
        out += _pushed_along(before, after, middle, axes)
    for before, here, after in zip(path, path[1:], path[2:], strict=False):
        out += _pushed_along(before, after, here, axes)
    return middles + out


def _pushed_along(
    before: Pose2, after: Pose2, here: Pose2, axes: Sequence[float]
) -> list[Pose2]:
    """Poses at the position of ``here``, with yaws at which a push leads from
    ``before`` towards ``after``.

    Only the faces that need the smallest turns are used.
    """
    ahead = math.atan2(after.y - before.y, after.x - before.x)
    turns = [math.remainder(ahead - axis - here.yaw, 2.0 * math.pi) for axis in axes]
    least = sorted(turns, key=abs)[:FACES]
    return [Pose2(here.x, here.y, here.yaw + turn) for turn in least]


def _turned(start: Pose2, goal: Pose2, axes: Sequence[float]) -> list[Pose2]:
    """The start pose after a turn on the spot: to the goal's yaw, and towards the goal."""
    turned = Pose2(start.x, start.y, goal.yaw)
    return [turned, *_pushed_along(start, goal, start, axes)]


def _before(start: Pose2, goal: Pose2, axes: Sequence[float]) -> list[Pose2]:
    """Poses from which a straight push leads to the goal: some close to the goal, and
    one at the same distance from the goal as the start, along the push.
    """
    out = []
    bearing = math.atan2(goal.y - start.y, goal.x - start.x) - goal.yaw
    for axis in _nearest(axes, bearing):
        c = math.cos(goal.yaw + axis)
        s = math.sin(goal.yaw + axis)
        abreast = (goal.x - start.x) * c + (goal.y - start.y) * s
        paths = [*STRAIGHTS, abreast] if abreast > STRAIGHTS[0] else STRAIGHTS
        out += [Pose2(goal.x - d * c, goal.y - d * s, goal.yaw) for d in paths]
    return out


def _nearest(axes: Sequence[float], bearing: float) -> list[float]:
    """Axes [rad] nearest to a bearing [rad], sorted by their angle to it. There are at
    most as many as a box has faces.
    """
    off = [(abs(math.remainder(axis - bearing, 2.0 * math.pi)), axis) for axis in axes]
    return [axis for _, axis in sorted(off)[:SIDES]]


def _handed_over(query: MotionQuery, space: FreeSpace) -> list[Pose2]:
    """Poses at which one arm hands the object over to another, those with the shortest
    path first.

    The first arm reaches the start, the second the goal. Empty if a single arm reaches
    both, or if there is only one arm.
    """
    ends = [query.start, query.goal]
    mode = next(
        (name for name in HANDED_OVER_BY if MODES[name].candidate_contacts(query)), None
    )
    if mode is None:
        return []
    gives, takes = np.any(touching(query, mode, ends), axis=2)
    if (gives & takes).any() or not (gives.any() and takes.any()):
        return []
    x_min, x_max, y_min, y_max = space.bounds
    xs = np.arange(x_min, x_max, HAND_OVER).tolist()
    ys = np.arange(y_min, y_max, HAND_OVER).tolist()
    yaws = dict.fromkeys(X.yaw for X in ends)
    found = []
    for yaw in yaws:
        grid = [Pose2(x, y, yaw) for y in ys for x in xs]
        there = np.any(touching(query, mode, grid), axis=2)
        both = np.any(there[:, gives], axis=1) & np.any(there[:, takes], axis=1)
        found += [X for X, reachable in zip(grid, both, strict=True) if reachable]
    if not found:
        return []
    found = [X for X, free in zip(found, space.free(found), strict=True) if free]
    found.sort(key=lambda X: sum(math.dist(X.position, end.position) for end in ends))
    return _without_near_duplicates(found)


def _poses_along(free_paths: PathsTo, poses: Sequence[Pose2]) -> list[Pose2]:
    """Via poses of the paths from ``poses`` to the goal: the first of each path, then
    the second of each path, and so on.
    """
    found = [free_paths.via_poses(X) for X in poses]
    each = [path[1:-1] for path in found if path is not None]
    return [X for row in zip_longest(*each) for X in row if X is not None]


def _without_near_duplicates(poses: Sequence[Pose2]) -> list[Pose2]:
    """The first poses that keep a minimum distance from each other."""
    out: list[Pose2] = []
    for X in poses:
        near = (
            math.dist(X.position, other.position) < 2.0 * HAND_OVER
            for other in out
            if other.yaw == X.yaw
        )
        if not any(near):
            out.append(X)
        if len(out) == HANDED_OVER:
            break
    return out


def _sample(yaw: float, region: Bounds) -> list[Pose2]:
    """Poses spread evenly over the region and all yaws, starting at ``yaw``."""
    x_min, x_max, y_min, y_max = region
    out = []
    for i in range(1, SPREAD + 1):
        u, v, w = ((i * stride) % 1.0 for stride in STRIDES)
        x = x_min + u * (x_max - x_min)
        y = y_min + v * (y_max - y_min)
        out.append(Pose2(x, y, yaw + 2.0 * math.pi * w))
    return out


def _usable(
    query: MotionQuery, space: FreeSpace, poses: Sequence[Pose2]
) -> list[Pose2]:
    """The free, reachable poses within bounds, without duplicates."""
    x_min, x_max, y_min, y_max = space.bounds
    inside = [X for X in poses if x_min <= X.x <= x_max and y_min <= X.y <= y_max]
    if not inside:
        return []
    reachable = space.free(inside) & reached(query.scene, inside)
    out: list[Pose2] = []
    for X, fit in zip(inside, reachable, strict=True):
        if fit and not any(
            same_pose(X, other) for other in (*out, query.start, query.goal)
        ):
            out.append(X)
    return out


def reached(scene: Scene, poses: Sequence[Pose2]) -> NDArray[np.bool_]:
    """Mask (n,) of the poses at which an arm's tip reaches the top, at the centre of
    mass or above the middle of a side.
    """
    out = np.full(len(poses), False)
    for robot in scene.robots:
        out |= _reached(robot, scene, poses)
    return out


def _reached(robot: Robot, scene: Scene, poses: Sequence[Pose2]) -> NDArray[np.bool_]:
    frame = scene.support.frame
    shape = scene.body.shape
    height = shape.height + robot.tip_radius
    places = [scene.body.center_of_mass, *_side_middles(shape)]
    points = [frame.point((*X.apply(place), height)) for X in poses for place in places]
    in_reach = reachable(arm_kinematics(robot), np.array(points), quick=True).ok
    return np.asarray(in_reach.reshape(len(poses), len(places)).any(axis=1))


def _side_middles(shape: Shape) -> list[Point]:
    """Midpoints [m] in G of the sides of the hull's bounding box."""
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    x = 0.5 * (x_min + x_max)
    y = 0.5 * (y_min + y_max)
    return [(x_min, y), (x_max, y), (x, y_min), (x, y_max)]
