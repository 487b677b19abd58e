"""Random tasks and random variations of one task, all from one seed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    Cylinder,
    ObjectModel,
    Prism,
    Robot,
    Shape,
    Task,
)
from pushpressslide.mechanics.top import inside_top
from pushpressslide.modes import MODES

Range = tuple[float, float]
Poses = tuple[Pose2, Pose2]
"""X_WG at the start and at the goal."""

SUPPORT_FRICTION = (0.2, 0.5)
CONTACT_FRICTION = (0.4, 1.0)
DISTANCE = (0.12, 0.35)  # [m] from start to goal
# [rad] to the goal, either side of the push: of the object's x axis for one arm
BEARING = math.radians(25.0)
TRIES = 10_000

# [m] of the object's origin from the robot's base, for one arm
ONE_ARM_REACH = (0.35, 0.72)
AZIMUTH = math.radians(80.0)  # either side of the base's forward direction
ONE_ARM_TURN = math.radians(50.0)  # of the object, either side
TOP_CONTACT_SHARE = 0.25  # of the pressed tasks; else the mode chooses the contact
TOP_CONTACT_DISTANCE = (0.02, 0.1)  # [m] from the CoM
TOP_CONTACT_EDGE = 0.015  # [m] at least, to the edge of the object's top

# [m] of the object's CoM from both bases, for two arms
TWO_ARM_REACH = (0.5, 0.85)
AHEAD = 0.35  # [m] at least, before the line through the bases
FARTHEST_AHEAD = 0.8  # [m] of the start
ASIDE = 0.4  # [m] of the start, either side of the middle of the bases
HEADING = math.radians(30.0)  # of a push, either side of straight away from the robots
TWO_ARM_TURN = math.radians(35.0)  # of a pushed object, either side
PRESSED_TURN = math.radians(60.0)  # of an object that two arms press, either side


@dataclass(frozen=True, slots=True)
class ObjectRanges:
    """Ranges from which objects are drawn, evenly."""

    mass: Range  # [kg]
    side: Range  # [m] of a box
    triangle: Range  # [m] circumradius of a triangular prism
    triangle_phase: float  # [rad] of its first corner
    hexagon: Range  # [m] circumradius of a hexagonal prism
    cylinder: Range  # [m] radius
    pushed_height: Range  # [m]
    pressed_height: Range  # [m]


ONE_ARM = ObjectRanges(
    mass=(0.3, 3.0),
    side=(0.08, 0.25),
    triangle=(0.08, 0.14),
    triangle_phase=0.0,
    hexagon=(0.06, 0.13),
    cylinder=(0.06, 0.13),
    pushed_height=(0.08, 0.2),
    pressed_height=(0.08, 0.2),
)
TWO_ARMS = ObjectRanges(
    mass=(0.5, 4.0),
    side=(0.2, 0.42),
    triangle=(0.17, 0.26),
    triangle_phase=math.pi / 6.0,
    hexagon=(0.16, 0.24),
    cylinder=(0.1, 0.21),
    pushed_height=(0.1, 0.22),
    pressed_height=(0.05, 0.15),
)


def random_task(base: Task, index: int, seed: int) -> Task:
    """Return a new task for ``base``'s robots: other object, frictions, start and goal.

    Objects are boxes, and triangular and hexagonal prisms for a third; pressed ones are
    cylinders too. One arm: start and goal are within ``ONE_ARM_REACH`` and ``AZIMUTH``,
    the goal up to ``BEARING`` off the object's x axis. Some pressed objects have a
    given contact. Two arms: within ``TWO_ARM_REACH`` of both. One face, or two
    neighbours, look back at the robots within ``HEADING``; the goal is up to
    ``BEARING`` off the direction of the push. Pressed objects go in any direction.

    Raises TaskError if there are two arms and ``base`` does not name one mode that
    tasks are drawn for.
    """
    faces = _pushed_faces(base)
    rng = np.random.default_rng([seed, index])
    pressed = faces == 0
    single = len(base.robots) == 1
    body = _object(rng, ONE_ARM if single else TWO_ARMS, pressed)
    support = float(rng.uniform(*SUPPORT_FRICTION))
    contact = float(rng.uniform(*CONTACT_FRICTION))
    motion = replace(base.motion, face=None, contact_height=None, contacts=None)
    motion = replace(motion, press_force=None, vehicle=None)
    if single:
        start, goal = _one_arm_poses(rng, base.robots[0])
        if pressed and rng.random() < TOP_CONTACT_SHARE:
            motion = replace(motion, contacts=(_top_contact(rng, body),))
    else:
        start, goal = _two_arm_poses(rng, base.robots, body, faces)
    return replace(
        base,
        name=f"{base.name}-random-{seed}-{index:03d}",
        source="",
        object=body,
        start=_wrapped(start),
        goal=_wrapped(goal),
        support=replace(base.support, friction=support),
        contact_friction=contact,
        belief=Belief(support, contact, body.mass, None),
        motion=motion,
    )


def varied_task(base: Task, index: int, seed: int) -> Task:
    """Return ``base`` with a truth that differs from the belief.

    The start is off by up to 15 mm and 8 degrees, frictions by 15 %, the mass by 20 %;
    poses are measured with a noise of 0.5 mm and 0.2 degrees.
    """
    rng = np.random.default_rng([seed, index])
    e = rng.uniform(-1.0, 1.0, size=6)
    return replace(
        base,
        name=f"{base.name}-varied-{seed}-{index:03d}",
        belief=base.believed,
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


def _pushed_faces(base: Task) -> int:
    """Return how many faces are pushed, 0 if the object is pressed.

    One arm pushes one face unless ``base`` names a single mode that does otherwise.
    """
    drawn = {
        name: mode.pushed_faces
        for name, mode in MODES.items()
        if mode.arms == len(base.robots) and mode.pushed_faces is not None
    }
    names = base.modes or ()
    if len(names) == 1 and names[0] in drawn:
        return drawn[names[0]]
    if len(base.robots) == 1:
        return 1
    allowed = f"allowed where two arms' tasks are drawn: one of {', '.join(drawn)}"
    raise TaskError(base.source or base.name, "modes", list(names), allowed)


def _object(
    rng: np.random.Generator, ranges: ObjectRanges, pressed: bool
) -> ObjectModel:
    """Draw a shape and its mass."""
    shape = _shape(rng, ranges, pressed)
    mass = float(rng.uniform(*ranges.mass))
    return ObjectModel(shape, mass, _centroid(shape))


def _shape(rng: np.random.Generator, ranges: ObjectRanges, pressed: bool) -> Shape:
    """Draw a shape; two thirds are boxes, or slightly less with cylinders."""
    kinds = ["box"] * 4 + ["triangle", "hexagon"] + ["cylinder"] * pressed
    kind = rng.choice(kinds)
    heights = ranges.pressed_height if pressed else ranges.pushed_height
    height = float(rng.uniform(*heights))
    if kind == "box":
        length = float(rng.uniform(*ranges.side))
        return Box((length, float(rng.uniform(*ranges.side)), height))
    if kind == "cylinder":
        return Cylinder(float(rng.uniform(*ranges.cylinder)), height)
    if kind == "triangle":
        corners = _regular(3, rng.uniform(*ranges.triangle), ranges.triangle_phase)
    else:
        # a face looks along -x
        corners = _regular(6, rng.uniform(*ranges.hexagon), math.pi / 6.0)
    return Prism(corners, height)


def _regular(count: int, radius: float, phase: float) -> tuple[Point, ...]:
    """Corners [m] of a regular polygon; ``phase`` [rad] is that of the first."""
    angles = [phase + 2.0 * math.pi * i / count for i in range(count)]
    return tuple(
        (float(radius * math.cos(a)), float(radius * math.sin(a))) for a in angles
    )


def _centroid(shape: Shape) -> Point:
    """Centroid [m] of the footprint in G.

    Not ``shape.centroid``, which rounds otherwise: a seed keeps its task to the bit.
    """
    corners = shape.corners
    if not corners:
        return shape.centroid
    area = 0.0
    cx = 0.0
    cy = 0.0
    for (x0, y0), (x1, y1) in zip(corners, (*corners[1:], corners[0]), strict=True):
        a = x0 * y1 - x1 * y0
        area = area + a
        cx = cx + a * (x0 + x1)
        cy = cy + a * (y0 + y1)
    return cx / (3.0 * area), cy / (3.0 * area)


def _first_within(draw: Callable[[], Poses], within: Callable[[Pose2], bool]) -> Poses:
    """Draw until start and goal are within reach; give up after ``TRIES``."""
    for _ in range(TRIES):
        poses = draw()
        if all(map(within, poses)):
            break
    return poses


def _one_arm_poses(rng: np.random.Generator, robot: Robot) -> Poses:
    """Draw start and goal in an annular sector in front of the robot."""
    x, y, _ = robot.base

    def draw() -> Poses:
        """Draw start and goal, wherever they are."""
        r = rng.uniform(*ONE_ARM_REACH)
        azimuth = rng.uniform(-AZIMUTH, AZIMUTH) + robot.base_yaw
        yaw = rng.uniform(-math.pi, math.pi)
        start = Pose2(
            float(x + r * math.cos(azimuth)),
            float(y + r * math.sin(azimuth)),
            float(yaw),
        )
        distance = rng.uniform(*DISTANCE)
        ahead = _polar(distance, rng.uniform(-BEARING, BEARING))
        turn = rng.uniform(-ONE_ARM_TURN, ONE_ARM_TURN)
        return start, Pose2(*start.apply(ahead), float(yaw + turn))

    def within(pose: Pose2) -> bool:
        """Whether the robot reaches the object there."""
        dx = pose.x - x
        dy = pose.y - y
        azimuth = math.remainder(math.atan2(dy, dx) - robot.base_yaw, 2.0 * math.pi)
        near, far = ONE_ARM_REACH
        return near <= math.hypot(dx, dy) <= far and abs(azimuth) <= AZIMUTH

    return _first_within(draw, within)


def _top_contact(rng: np.random.Generator, body: ObjectModel) -> Point:
    """Draw a contact [m] in G on the object's top, near its CoM."""
    place = (math.inf, math.inf)
    while not inside_top(body, place, TOP_CONTACT_EDGE):
        r = rng.uniform(*TOP_CONTACT_DISTANCE)
        place = _polar(r, rng.uniform(-math.pi, math.pi))
    x, y = body.center_of_mass
    return (x + place[0], y + place[1])


def _two_arm_poses(
    rng: np.random.Generator, robots: Sequence[Robot], body: ObjectModel, faces: int
) -> Poses:
    """Draw start and goal in front of two robots.

    The push, if there is one, goes away from them. Its direction is free if pressed.
    """
    (lx, ly), (rx, ry) = (robot.base[:2] for robot in robots)
    # x away from the robots
    X_WM = Pose2(0.5 * (lx + rx), 0.5 * (ly + ry), math.atan2(rx - lx, ly - ry))
    heading, bearing, turn = HEADING, BEARING, TWO_ARM_TURN
    if faces == 0:
        heading, bearing, turn = math.pi, math.pi, PRESSED_TURN

    def draw() -> Poses:
        """Draw start and goal, wherever they are."""
        push = _push(rng, body.shape, faces)
        x = rng.uniform(AHEAD, FARTHEST_AHEAD)
        y = rng.uniform(-ASIDE, ASIDE)
        yaw = rng.uniform(-heading, heading) - push
        start = X_WM.compose(Pose2(float(x), float(y), float(yaw)))
        distance = rng.uniform(*DISTANCE)
        ahead = _polar(distance, push + rng.uniform(-bearing, bearing))
        return start, start.compose(Pose2(*ahead, float(rng.uniform(-turn, turn))))

    def within(X_WG: Pose2) -> bool:
        """Whether both robots reach the object there."""
        center = X_WG.apply(body.center_of_mass)
        near, far = TWO_ARM_REACH
        distances = [math.dist(center, robot.base[:2]) for robot in robots]
        ahead = X_WM.unapply(center)[0]
        return ahead >= AHEAD and all(near <= d <= far for d in distances)

    return _first_within(draw, within)


def _push(rng: np.random.Generator, shape: Shape, faces: int) -> float:
    """Draw the direction [rad] in G in which a face, or two neighbours, are pushed."""
    corners = shape.corners
    if not corners:
        return 0.0

    def normal(i: int) -> float:
        """Direction [rad] of the inward normal of a face."""
        ax, ay = corners[i % len(corners)]
        bx, by = corners[(i + 1) % len(corners)]
        return math.atan2(bx - ax, ay - by)

    i = int(rng.integers(len(corners)))
    if faces < 2:
        return normal(i)
    return normal(i) + 0.5 * math.remainder(normal(i + 1) - normal(i), 2.0 * math.pi)


def _polar(r: float, angle: float) -> Point:
    return (float(r * math.cos(angle)), float(r * math.sin(angle)))


def _wrapped(pose: Pose2) -> Pose2:
    """The same pose with a yaw in [-pi, pi]."""
    return Pose2(pose.x, pose.y, math.remainder(pose.yaw, 2.0 * math.pi))
