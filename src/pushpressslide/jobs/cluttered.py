"""Random tasks among obstacles, for any mode. Start and goal are anywhere in reach, at
any yaw.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.footprint import gaps, middle_room
from pushpressslide.core.motion import Motion
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    Cylinder,
    ObjectModel,
    Obstacle,
    Prism,
    Robot,
    Shape,
    Task,
)
from pushpressslide.planning.free_space import FreeSpace, between
from pushpressslide.robots.reach_map import each_reached

Range = tuple[float, float]

TRIES = 2_000
MASS = (0.3, 5.0)  # [kg]
SUPPORT_FRICTION = (0.15, 0.5)
CONTACT_FRICTION = (0.4, 1.0)
WIDTH: dict[int, Range] = {1: (0.06, 0.3), 2: (0.12, 0.5)}  # [m] by number of arms
HEIGHTS: dict[int, Range] = {1: (0.04, 0.2), 2: (0.06, 0.25)}  # [m]
LEG = (0.25, 0.45)  # width of the parts of a T or an L, as a share of its own
KINDS = ("box", "box", "triangle", "hexagon", "cylinder", "tee", "ell")
OBSTACLES = 3  # at most
OBSTACLE_SIZE = (0.05, 0.2)  # [m]
IN_THE_WAY = 0.5  # share of the tasks with obstacles that have one on the direct path
MIDST = (0.3, 0.7)  # position of that obstacle, as a share of the direct path
APART = 0.01  # [m] between bodies at least, where they stand
REACH: dict[int, Range] = {1: (0.35, 0.72), 2: (0.45, 0.85)}  # [m] from a base
AZIMUTH = math.radians(80.0)  # either side of a base's forward direction
BASE_ROOM = 0.15  # [m] about the axis of a base
LEAST_WAY = 0.1  # [m], or LEAST_TURN: nearer goals are drawn again
LEAST_TURN = math.radians(30.0)
FREE = 0.002  # [m] clearance of a free path


def cluttered_task(base: Task, index: int, seed: int) -> Task:
    """A new task for ``base``'s robots: another object, frictions, start, goal and up
    to OBSTACLES obstacles.

    The draw is repeated if start, goal and obstacles overlap each other or a base, if
    no arm reaches the middle of the top at start and goal, or if the footprint has no
    free path on a grid over position and yaw. Raises PushPressSlideError after TRIES
    failed draws.
    """
    rng = np.random.default_rng([seed, index])
    arms = len(base.robots)
    body = _object(rng, arms)
    support = float(rng.uniform(*SUPPORT_FRICTION))
    contact = float(rng.uniform(*CONTACT_FRICTION))
    count = int(rng.integers(OBSTACLES + 1))
    blocked = count > 0 and bool(rng.random() < IN_THE_WAY)
    for _ in range(TRIES):
        start = _pose(rng, base.robots, arms)
        goal = _pose(rng, base.robots, arms)
        obstacles = _obstacles(rng, base.robots, (start, goal), count, blocked)
        ends = (start, goal)
        reachable = _in_reach(base.robots, body.shape, ends) and _are_separated(
            obstacles
        )
        if reachable and _fits(base, body, ends, obstacles):
            break
    else:
        raise PushPressSlideError(
            f"no start, goal and obstacles with a free path between them in {TRIES} draws"
        )
    return replace(
        base,
        name=f"{base.name}-cluttered-{seed}-{index:03d}",
        source="",
        object=body,
        start=start,
        goal=goal,
        support=replace(base.support, friction=support),
        contact_friction=contact,
        obstacles=obstacles,
        modes=None,
        legs=(),
        tool=None,
        belief=Belief(),
        motion=Motion(),
    )


def started_task(base: Task, index: int, seed: int) -> Task:
    """The task ``base`` with another start.

    The start is anywhere in reach, at any yaw, clear of all obstacles and bases, and
    with a free path to the goal. Raises PushPressSlideError after TRIES failed draws.
    """
    rng = np.random.default_rng([seed, index])
    arms = len(base.robots)
    for _ in range(TRIES):
        start = _pose(rng, base.robots, arms)
        if _fits(base, base.object, (start, base.goal), base.obstacles):
            name = f"{base.name}-from-{seed}-{index:03d}"
            return replace(base, name=name, source="", start=start)
    raise PushPressSlideError(f"no start with a free path to the goal in {TRIES} draws")


def _object(rng: np.random.Generator, arms: int) -> ObjectModel:
    """Draw an object: a shape whose width and depth are log-uniform, and its mass."""
    low, high = (math.log(size) for size in WIDTH[arms])
    width = math.exp(float(rng.uniform(low, high)))
    depth = math.exp(float(rng.uniform(low, high)))
    height = float(rng.uniform(*HEIGHTS[arms]))
    leg = width * float(rng.uniform(*LEG))
    shape = _shape(str(rng.choice(KINDS)), width, depth, height, leg)
    return ObjectModel(shape, float(rng.uniform(*MASS)), shape.centroid)


def _shape(kind: str, width: float, depth: float, height: float, leg: float) -> Shape:
    """A shape of a given kind. ``leg`` [m] is the width of the bars of a T or an L."""
    if kind == "box":
        return Box((width, depth, height))
    if kind == "cylinder":
        return Cylinder(0.5 * width, height)
    if kind in ("triangle", "hexagon"):
        count = 3 if kind == "triangle" else 6
        angles = [2.0 * math.pi * i / count for i in range(count)]
        corners = tuple(
            (0.5 * width * math.cos(a), 0.5 * width * math.sin(a)) for a in angles
        )
        return Prism(corners, height)
    half = 0.5 * width
    if kind == "tee":
        return Prism(_tee(half, leg), height)
    low = -half
    return Prism(
        (
            (low, low),
            (half, low),
            (half, low + leg),
            (low + leg, low + leg),
            (low + leg, half),
            (low, half),
        ),
        height,
    )


def _tee(half: float, leg: float) -> tuple[Point, ...]:
    """Corners [m] of a T whose width equals its length, with the bar on top."""
    stem = 0.5 * leg
    return (
        (-stem, -half),
        (stem, -half),
        (stem, half - leg),
        (half, half - leg),
        (half, half),
        (-half, half),
        (-half, half - leg),
        (-stem, half - leg),
    )


def _pose(rng: np.random.Generator, robots: Sequence[Robot], arms: int) -> Pose2:
    """Draw a pose in reach of one of the robots. With two robots, one is chosen at
    random.
    """
    robot = robots[int(rng.integers(len(robots)))]
    x, y, _ = robot.base
    r = float(rng.uniform(*REACH[arms]))
    azimuth = float(rng.uniform(-AZIMUTH, AZIMUTH)) + robot.base_yaw
    yaw = float(rng.uniform(-math.pi, math.pi))
    return Pose2(x + r * math.cos(azimuth), y + r * math.sin(azimuth), yaw)


def _in_reach(robots: Sequence[Robot], shape: Shape, ends: tuple[Pose2, Pose2]) -> bool:
    """Whether some robot's tip reaches the middle of the object's top at both ends."""
    places = np.array([X.apply(shape.centroid) for X in ends])
    reachable = np.full(len(ends), False)
    for robot in robots:
        height = np.full((len(ends), 1), shape.height + robot.tip_radius)
        away = places - robot.base[:2]
        outward = np.arctan2(away[:, 1], away[:, 0])
        azimuths = np.column_stack([outward, outward + math.pi])
        reachable |= each_reached(robot, np.hstack([places, height]), azimuths)
    return bool(reachable.all())


def _obstacles(
    rng: np.random.Generator,
    robots: Sequence[Robot],
    ends: tuple[Pose2, Pose2],
    count: int,
    blocked: bool,
) -> tuple[Obstacle, ...]:
    """Draw obstacles. With ``blocked``, the first one stands on the straight path."""
    out = []
    for i in range(count):
        sizes = [float(size) for size in rng.uniform(*OBSTACLE_SIZE, size=3)]
        pose = _pose(rng, robots, len(robots))
        if blocked and i == 0:
            midst = between(*ends, float(rng.uniform(*MIDST)))
            pose = Pose2(midst.x, midst.y, pose.yaw)
        size = (sizes[0], sizes[1], sizes[2])
        out.append(Obstacle(f"obstacle-{i}", Box(size), pose))
    return tuple(out)


def _are_separated(obstacles: Sequence[Obstacle]) -> bool:
    """Whether obstacles keep their distance from each other."""
    others = [obstacle.footprint for obstacle in obstacles]
    for i, obstacle in enumerate(obstacles[1:], start=1):
        if gaps(obstacle.shape, [obstacle.pose], others[:i]).min() < APART:
            return False
    return True


def _fits(
    base: Task,
    body: ObjectModel,
    ends: tuple[Pose2, Pose2],
    obstacles: Sequence[Obstacle],
) -> bool:
    """Whether nothing overlaps, the table carries the object at both ends, and the
    footprint has a free path.
    """
    start, goal = ends
    far = math.dist(start.position, goal.position)
    turn = abs(math.remainder(goal.yaw - start.yaw, 2.0 * math.pi))
    if far < LEAST_WAY and turn < LEAST_TURN:
        return False
    bodies = [(body.shape, start), (body.shape, goal)]
    placed = [(obstacle.shape, obstacle.pose) for obstacle in obstacles]
    for shape, X in (*bodies, *placed):
        for robot in base.robots:
            if shape.distance(X.unapply(robot.base[:2])) < BASE_ROOM:
                return False
    others = tuple(obstacle.footprint for obstacle in obstacles)
    if others and gaps(body.shape, ends, others).min() < APART:
        return False
    margin = 0.3 + body.shape.circumradius
    xs = [X.x for X in ends]
    ys = [X.y for X in ends]
    region = (min(xs) - margin, max(xs) + margin, min(ys) - margin, max(ys) + margin)
    on = middle_room(base.support, body.shape)
    space = FreeSpace(body.shape, others, FREE, region, on, body.center_of_mass)
    if on is not None and not space.free(ends).all():
        return False
    return space.paths_to(goal).via_poses(start) is not None
