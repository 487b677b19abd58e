"""Random tasks for modes of two arms, all from one seed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    Cylinder,
    ObjectModel,
    Prism,
    Shape,
    Task,
)
from pushpressslide.jobs.sampling import drawn_centroid

MODES = ("parallel_push", "orthogonal_push", "bimanual_press_slide")

REACH = (0.5, 0.85)  # [m] of the object's centre from both bases, at start and goal
AHEAD = 0.35  # [m] at least, before the line through the bases
DISTANCE = (0.12, 0.35)  # [m]
HEADING = math.radians(30.0)  # either side of straight away from the robots, of a push
BEARING = math.radians(25.0)
TURN = math.radians(35.0)  # of the goal from the push; of the object on the way
SLIDE_TURN = math.radians(60.0)  # of an object that two arms press


def random_two_arm_task(base: Task, index: int, seed: int) -> Task:
    """Return a new task for ``base``'s two robots and its one mode, which is one of
    ``MODES``.

    Boxes of 20 to 42 cm a side, and triangle and hexagon prisms of like size (a third;
    pressed ones also cylinders), 0.5 to 4 kg, object/support friction 0.2 to 0.5, tip
    friction 0.4 to 1.0; start and goal within ``REACH`` of both robots, ``DISTANCE``
    apart. For pushes 10 to 22 cm high; one face, or two neighbours, look back at the
    robots within ``HEADING``; the goal is up to ``BEARING`` off the face's normal, or
    off the middle of two, and turned by up to ``TURN``. Pressed objects are 5 to 15 cm
    high, stand any way, and go any way, turned by up to ``SLIDE_TURN``. Raises
    TaskError for other modes.
    """
    if base.modes is None or len(base.modes) != 1 or base.modes[0] not in MODES:
        allowed = f"allowed where two arms' tasks are drawn: one of {', '.join(MODES)}"
        raise TaskError(
            base.source or base.name, "modes", list(base.modes or ()), allowed
        )
    rng = np.random.default_rng([seed, index])
    pressed = base.modes == ("bimanual_press_slide",)
    shape = _shape(rng, pressed)
    center = drawn_centroid(shape)
    bases = [robot.base[:2] for robot in base.robots]
    (lx, ly), (rx, ry) = bases
    # x away from the robots
    X_WM = Pose2(0.5 * (lx + rx), 0.5 * (ly + ry), math.atan2(rx - lx, ly - ry))

    def within(X_WG: Pose2) -> bool:
        at = X_WG.apply(center)
        return X_WM.unapply(at)[0] >= AHEAD and all(
            REACH[0] <= math.dist(at, b) <= REACH[1] for b in bases
        )

    mass = float(rng.uniform(0.5, 4.0))
    support = float(rng.uniform(0.2, 0.5))
    contact = float(rng.uniform(0.4, 1.0))
    heading, bearing, turn = (
        (math.pi, math.pi, SLIDE_TURN) if pressed else (HEADING, BEARING, TURN)
    )
    for _ in range(10_000):
        push = (
            0.0
            if not shape.corners
            else _push(rng, shape, base.modes == ("orthogonal_push",))
        )
        x = rng.uniform(AHEAD, 0.8)
        y = rng.uniform(-0.4, 0.4)
        yaw = rng.uniform(-heading, heading) - push
        start = X_WM.compose(Pose2(float(x), float(y), float(yaw)))
        distance = rng.uniform(*DISTANCE)
        angle = push + rng.uniform(-bearing, bearing)
        way = (float(distance * math.cos(angle)), float(distance * math.sin(angle)))
        goal = start.compose(Pose2(*way, float(rng.uniform(-turn, turn))))
        if within(start) and within(goal):
            break
    return replace(
        base,
        name=f"{base.name}-random-{seed}-{index:03d}",
        source="",
        object=ObjectModel(shape, mass, center),
        start=Pose2(start.x, start.y, math.remainder(start.yaw, 2.0 * math.pi)),
        goal=Pose2(goal.x, goal.y, math.remainder(goal.yaw, 2.0 * math.pi)),
        support=replace(base.support, friction=support),
        contact_friction=contact,
        belief=Belief(support, contact, mass, None),
        motion=replace(
            base.motion, face=None, contact_height=None, contacts=None, press_force=None
        ),
    )


def _push(rng: np.random.Generator, shape: Shape, two_faces: bool) -> float:
    """Return the direction [rad] in G in which a face, or two neighbours together, are
    pushed.
    """
    corners = shape.corners

    def normal(i: int) -> float:
        ax, ay = corners[i % len(corners)]
        bx, by = corners[(i + 1) % len(corners)]
        return math.atan2(bx - ax, ay - by)

    i = int(rng.integers(len(corners)))
    between = math.remainder(normal(i + 1) - normal(i), 2.0 * math.pi)
    return normal(i) + (0.5 * between if two_faces else 0.0)


def _shape(rng: np.random.Generator, pressed: bool) -> Shape:
    kinds = [
        "box",
        "box",
        "box",
        "box",
        "triangle",
        "hexagon",
        *(["cylinder"] if pressed else []),
    ]
    kind = rng.choice(kinds)
    height = float(rng.uniform(0.05, 0.15) if pressed else rng.uniform(0.1, 0.22))
    if kind == "box":
        return Box(
            (float(rng.uniform(0.2, 0.42)), float(rng.uniform(0.2, 0.42)), height)
        )
    if kind == "cylinder":
        return Cylinder(float(rng.uniform(0.1, 0.21)), height)
    count, radius = (
        (3, rng.uniform(0.17, 0.26))
        if kind == "triangle"
        else (6, rng.uniform(0.16, 0.24))
    )
    angles = [math.pi / 6.0 + 2.0 * math.pi * i / count for i in range(count)]
    return Prism(
        tuple(
            (float(radius * math.cos(a)), float(radius * math.sin(a))) for a in angles
        ),
        height,
    )
