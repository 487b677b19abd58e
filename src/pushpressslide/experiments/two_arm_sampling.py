"""Random tasks for modes in which two arms push from the sides, all from one seed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Belief, Box, ObjectModel, Prism, Task
from pushpressslide.experiments.sampling import polygon_centroid

REACH = (0.5, 0.85)  # [m] of the object's centre from both bases, at start and goal
AHEAD = 0.35  # [m] at least, before the line through the bases
HEADING = math.radians(30.0)  # either side of straight away from the robots, of the motion
BEARING, TURN = math.radians(25.0), math.radians(35.0)  # of the goal from the push; of the object on the way
DISTANCE = (0.12, 0.35)  # [m]


def random_push_task(base: Task, index: int, seed: int) -> Task:
    """Return a new task for ``base``'s two robots, for ``parallel_push`` or ``orthogonal_push`` (base.modes).

    Boxes of 20 to 42 cm a side, and triangle and hexagon prisms of like size (a third), 0.5 to 4 kg, object/
    support friction 0.2 to 0.5, tip friction 0.4 to 1.0. One face, or two neighbours, look back at the robots
    within ``HEADING``; the goal is ``DISTANCE`` away, up to ``BEARING`` off the face's normal, or off the
    middle of two, and turned by up to ``TURN``.
    """
    rng = np.random.default_rng([seed, index])
    shape = _shape(rng)
    corners = shape.footprint
    center = polygon_centroid(corners) if isinstance(shape, Prism) else (0.0, 0.0)
    bases = [robot.base[:2] for robot in base.robots]
    (lx, ly), (rx, ry) = bases
    X_WM = Pose2(0.5 * (lx + rx), 0.5 * (ly + ry), math.atan2(rx - lx, ly - ry))  # x away from the robots

    def normal(i: int) -> float:
        (ax, ay), (bx, by) = corners[i % len(corners)], corners[(i + 1) % len(corners)]
        return math.atan2(bx - ax, ay - by)

    def within(X_WG: Pose2) -> bool:
        at = X_WG.apply(center)
        return X_WM.unapply(at)[0] >= AHEAD and all(REACH[0] <= math.dist(at, b) <= REACH[1] for b in bases)

    mass, support = float(rng.uniform(0.5, 4.0)), float(rng.uniform(0.2, 0.5))
    contact = float(rng.uniform(0.4, 1.0))
    for _ in range(10_000):
        i = int(rng.integers(len(corners)))
        push = normal(i)
        if base.modes == ("orthogonal_push",):
            push += 0.5 * math.remainder(normal(i + 1) - push, 2.0 * math.pi)
        x, y, heading = rng.uniform(AHEAD, 0.8), rng.uniform(-0.4, 0.4), rng.uniform(-HEADING, HEADING)
        distance, bearing = rng.uniform(*DISTANCE), push + rng.uniform(-BEARING, BEARING)
        turn = rng.uniform(-TURN, TURN)
        start = X_WM.compose(Pose2(float(x), float(y), float(heading) - push))
        way = (float(distance * math.cos(bearing)), float(distance * math.sin(bearing)))
        goal = start.compose(Pose2(*way, float(turn)))
        if within(start) and within(goal):
            break
    return replace(
        base,
        name=f"{base.name}-random-{seed}-{index:03d}",
        object=ObjectModel(shape, mass, center),
        start=Pose2(start.x, start.y, math.remainder(start.yaw, 2.0 * math.pi)),
        goal=Pose2(goal.x, goal.y, math.remainder(goal.yaw, 2.0 * math.pi)),
        support=replace(base.support, friction=support),
        contact_friction=contact,
        belief=Belief(support, contact, mass, None),
        motion=replace(base.motion, face=None, contact_height=None),
    )


def _shape(rng: np.random.Generator) -> Box | Prism:
    kind = rng.choice(["box", "box", "box", "box", "triangle", "hexagon"])
    height = float(rng.uniform(0.1, 0.22))
    if kind == "box":
        return Box((float(rng.uniform(0.2, 0.42)), float(rng.uniform(0.2, 0.42)), height))
    count, radius = (3, rng.uniform(0.17, 0.26)) if kind == "triangle" else (6, rng.uniform(0.16, 0.24))
    angles = [math.pi / 6.0 + 2.0 * math.pi * i / count for i in range(count)]
    return Prism(tuple((float(radius * math.cos(a)), float(radius * math.sin(a))) for a in angles), height)
