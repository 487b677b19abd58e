"""Random tasks and random variations of one task, all from one seed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    Cylinder,
    ObjectModel,
    Prism,
    Shape,
    Task,
)
from pushpressslide.mechanics.top import inside_top

# [m] of the object's centre from the first robot's base, where new tasks are drawn
REACH = (0.35, 0.72)
AZIMUTH = math.radians(80.0)  # either side of the base's forward direction

CONTACT_EDGE = 0.015  # [m] that a drawn top contact is inside the object's top


def drawn_centroid(shape: Shape) -> Point:
    """Return the centroid [m] of a drawn shape in its frame G.

    Not ``shape.centroid``, which rounds otherwise: a seed keeps its task to the bit.
    """
    if not shape.corners:
        return shape.centroid
    area = cx = cy = 0.0
    following = (*shape.corners[1:], shape.corners[0])
    for (x0, y0), (x1, y1) in zip(shape.corners, following, strict=True):
        a = x0 * y1 - x1 * y0
        area = area + a
        cx = cx + a * (x0 + x1)
        cy = cy + a * (y0 + y1)
    return cx / (3.0 * area), cy / (3.0 * area)


def random_shape(rng: np.random.Generator, round_too: bool = False) -> Shape:
    """Return a box of 8 to 25 cm a side, or a triangle or hexagon prism of like size
    (``round_too``: or a cylinder); more than half are boxes.
    """
    kinds = [
        "box",
        "box",
        "box",
        "box",
        "triangle",
        "hexagon",
        *(["cylinder"] if round_too else []),
    ]
    kind = rng.choice(kinds)
    height = float(rng.uniform(0.08, 0.2))
    if kind == "cylinder":
        return Cylinder(float(rng.uniform(0.06, 0.13)), height)
    if kind == "box":
        return Box(
            (float(rng.uniform(0.08, 0.25)), float(rng.uniform(0.08, 0.25)), height)
        )
    count, radius = (
        (3, rng.uniform(0.08, 0.14))
        if kind == "triangle"
        else (6, rng.uniform(0.06, 0.13))
    )
    first = 0.0 if kind == "triangle" else math.pi / 6.0  # a face looks along -x
    angles = [first + 2.0 * math.pi * i / count for i in range(count)]
    return Prism(
        tuple(
            (float(radius * math.cos(a)), float(radius * math.sin(a))) for a in angles
        ),
        height,
    )


def random_task(base: Task, index: int, seed: int) -> Task:
    """Return a new task for ``base``'s robots: other object, mass, frictions, start and
    goal.

    Boxes of 8 to 25 cm and prisms, 0.3 to 3 kg, object/support friction 0.2 to 0.5, tip
    friction 0.4 to 1.0, goal ahead of the start by 0.12 to 0.35 m, up to 25 degrees off
    its x axis, and turned by up to 50 degrees, start and goal within the annulus
    ``REACH`` in front of the robot. For ``press_slide`` alone also cylinders, and in a
    quarter of the tasks a contact drawn within 2 to 10 cm of the centroid.
    """
    rng = np.random.default_rng([seed, index])
    pressed = base.modes == ("press_slide",)
    shape = random_shape(rng, round_too=pressed)
    center = drawn_centroid(shape)
    robot = base.robots[0]

    def within(pose: Pose2) -> bool:
        dx = pose.x - robot.base[0]
        dy = pose.y - robot.base[1]
        azimuth = math.remainder(math.atan2(dy, dx) - robot.base_yaw, 2.0 * math.pi)
        return REACH[0] <= math.hypot(dx, dy) <= REACH[1] and abs(azimuth) <= AZIMUTH

    mass = float(rng.uniform(0.3, 3.0))
    support = float(rng.uniform(0.2, 0.5))
    contact = float(rng.uniform(0.4, 1.0))
    for _ in range(10_000):
        r = rng.uniform(*REACH)
        azimuth = rng.uniform(-AZIMUTH, AZIMUTH) + robot.base_yaw
        yaw = rng.uniform(-math.pi, math.pi)
        start = Pose2(
            float(robot.base[0] + r * math.cos(azimuth)),
            float(robot.base[1] + r * math.sin(azimuth)),
            float(yaw),
        )
        distance = rng.uniform(0.12, 0.35)
        bearing = rng.uniform(-math.radians(25.0), math.radians(25.0))
        turn = rng.uniform(-math.radians(50.0), math.radians(50.0))
        x, y = start.apply(
            (float(distance * math.cos(bearing)), float(distance * math.sin(bearing)))
        )
        goal = Pose2(x, y, math.remainder(float(yaw + turn), 2.0 * math.pi))
        if within(start) and within(goal):
            break
    contacts = None
    if pressed and rng.random() < 0.25:  # else the mode chooses
        body = ObjectModel(shape, mass, center)
        place = (math.inf, math.inf)
        while not inside_top(body, place, CONTACT_EDGE):
            r = rng.uniform(0.02, 0.1)
            angle = rng.uniform(-math.pi, math.pi)
            place = (float(r * math.cos(angle)), float(r * math.sin(angle)))
        contacts = ((center[0] + place[0], center[1] + place[1]),)
    motion = replace(
        base.motion,
        face=None,
        contact_height=None,
        contacts=contacts,
        press_force=None,
        vehicle=None,
    )
    return replace(
        base,
        name=f"{base.name}-random-{seed}-{index:03d}",
        source="",
        object=ObjectModel(shape, mass, center),
        start=start,
        goal=goal,
        support=replace(base.support, friction=support),
        contact_friction=contact,
        belief=Belief(support, contact, mass, None),
        motion=motion,
    )


def varied_task(base: Task, index: int, seed: int) -> Task:
    """Return ``base`` with a truth that differs from what is believed: start, friction,
    mass, and measurement noise.

    Start off by up to 15 mm and 8 degrees, frictions by 15 %, mass by 20 %, pose noise
    0.5 mm and 0.2 degrees.
    """
    rng = np.random.default_rng([seed, index])
    believed = base.believed
    e = rng.uniform(-1.0, 1.0, size=6)
    return replace(
        base,
        name=f"{base.name}-varied-{seed}-{index:03d}",
        belief=believed,
        support=replace(
            base.support,
            friction=min(1.9, base.support.friction * (1.0 + 0.15 * float(e[0]))),
        ),
        contact_friction=min(1.9, base.contact_friction * (1.0 + 0.15 * float(e[1]))),
        object=replace(base.object, mass=base.object.mass * (1.0 + 0.2 * float(e[2]))),
        start_error=Pose2(
            0.015 * float(e[3]), 0.015 * float(e[4]), math.radians(8.0) * float(e[5])
        ),
        sensing=replace(base.sensing, position_noise=5e-4, yaw_noise=math.radians(0.2)),
    )
