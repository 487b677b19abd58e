"""Random tasks, and random variations of one task, all from one seed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from pushpressslide.core.errors import PushPressSlideError, TaskError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.sensing import Sensing
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
Draw = Literal["ahead", "any", "cluttered"]
"""Kind of drawn tasks. "ahead": goals roughly in the direction of the push, objects of
medium size. "any": goals in any direction, objects of any size, centres of mass off the
centroid. "cluttered": start and goal anywhere in reach, among obstacles
(``jobs/cluttered.py``).
"""
Poses = tuple[Pose2, Pose2]
"""X_WG at the start and at the goal."""

SUPPORT_FRICTION = (0.2, 0.5)
CONTACT_FRICTION = (0.4, 1.0)
DISTANCE = (0.12, 0.35)  # [m] from start to goal
# [rad] to the goal, either side of the push: of the object's x axis for one arm
BEARING = math.radians(25.0)
TRIES = 10_000
BASE_ROOM = 0.15  # [m] about the axis of a base, in which no object is drawn

# [m] of the object's origin from the robot's base, for one arm
ONE_ARM_REACH = (0.35, 0.72)
AZIMUTH = math.radians(80.0)  # either side of the base's forward direction
ONE_ARM_TURN = math.radians(50.0)  # of the object, either side
ANY_ONE_ARM_TURN = math.radians(90.0)  # of draw "any"
# share of the pressed tasks with a given contact; otherwise the mode chooses it
TOP_CONTACT_SHARE = 0.25
TOP_CONTACT_DISTANCE = (0.02, 0.1)  # [m] from the CoM
TOP_CONTACT_TRIES = 1_000
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
    """Ranges from which objects are drawn uniformly."""

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


# of draw "any"
ANY_SIZE: dict[int, Range] = {1: (0.02, 0.4), 2: (0.1, 1.0)}  # [m] by number of arms
ANY_HEIGHT = (0.3, 1.2)  # over the mean size of the footprint
ANY_HEIGHTS = (0.02, 0.3)  # [m]
ANY_DENSITY = (100.0, 800.0)  # [kg/m^3], hollow to wood
ANY_MASS: dict[int, Range] = {1: (0.05, 6.0), 2: (0.3, 10.0)}  # [kg]
OFF_CENTER = 0.2  # of the half width: the centre of mass, either side of the centroid

# of an uncertain world
FRICTION_ERROR = 0.2  # of both frictions and of the mass, either way
CENTER_ERROR = 0.01  # [m] of the centre of mass, in any direction
UNCERTAIN_SENSING = Sensing(
    position_noise=5e-4, yaw_noise=math.radians(0.2), force_noise=0.2, delay=0.02
)


class Aim(NamedTuple):
    """Directions of a push or a press, as largest angles to either side [rad]."""

    heading: float  # of the push, of straight away from two robots
    bearing: float  # of the goal, of the direction of the push
    turn: float  # of the object


def random_task(base: Task, index: int, seed: int, draw: Draw = "ahead") -> Task:
    """A new task for ``base``'s robots: other object, frictions, start and goal.

    Two thirds of the objects are boxes, one third triangular and hexagonal prisms;
    pressed objects may also be cylinders. With one arm, start and goal are within
    ``ONE_ARM_REACH`` and ``AZIMUTH``, and the goal is up to ``BEARING`` off the
    object's x axis. Some pressed objects have a prescribed contact. With two arms,
    start and goal are within ``TWO_ARM_REACH`` of both. The push, on one face or on two
    neighbouring faces, is directed away from the robots to within ``HEADING``, and the
    goal is up to ``BEARING`` off the direction of the push. Pressed objects move in any
    direction.

    In a cell with two arms, tasks are drawn for both arms together. If ``base`` names
    only one-arm modes, they are drawn for one of the arms, chosen at random.

    With ``draw`` "any", goals lie in any direction, and sizes, masses and centres of
    mass are drawn from ANY_SIZE, ANY_DENSITY and OFF_CENTER.

    Raises TaskError if ``base`` names a mode for which no tasks can be drawn, and
    PushPressSlideError if no start and goal are found.
    """
    rng = np.random.default_rng([seed, index])
    arms = _arms(base)
    faces = _pushed_faces(base, arms, rng)
    pressed = faces == 0
    single = arms == 1
    if draw == "any":
        body = _any_object(rng, arms, pressed)
    else:
        body = _object(rng, ONE_ARM if single else TWO_ARMS, pressed)
    aim = _aim(draw, arms, pressed)
    support = float(rng.uniform(*SUPPORT_FRICTION))
    contact = float(rng.uniform(*CONTACT_FRICTION))
    motion = replace(base.motion, face=None, contact_height=None, contacts=None)
    motion = replace(motion, press_force=None, vehicle=None)
    if single:
        start, goal = _one_arm_poses(rng, _drawn_robot(base, rng), body, aim)
        if pressed and rng.random() < TOP_CONTACT_SHARE:
            place = _top_contact(rng, body)
            motion = replace(motion, contacts=None if place is None else (place,))
    else:
        start, goal = _two_arm_poses(rng, base.robots, body, faces, aim)
    return replace(
        base,
        name=f"{base.name}-random-{seed}-{index:03d}",
        source="",
        object=body,
        start=start.wrapped,
        goal=goal.wrapped,
        support=replace(base.support, friction=support),
        contact_friction=contact,
        belief=Belief(support, contact, body.mass, None),
        motion=motion,
    )


def varied_task(base: Task, index: int, seed: int) -> Task:
    """The task ``base`` with a truth that differs from the belief.

    The start is off by up to 15 mm and 8 degrees, frictions by 15 %, the mass by 20 %;
    poses are measured with a noise of 0.5 mm and 0.2 degrees.
    """
    rng = np.random.default_rng([seed, index])
    e = rng.uniform(-1.0, 1.0, size=6)
    return replace(
        base,
        name=f"{base.name}-varied-{seed}-{index:03d}",
        belief=base.full_belief,
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


def uncertain_task(known: Task, index: int, seed: int) -> Task:
    """A task whose truth differs from the belief ``known``.

    Both frictions and the mass are off by up to FRICTION_ERROR, the centre of mass by
    up to CENTER_ERROR; all sensors are noisy and late.
    """
    rng = np.random.default_rng([seed, index, 1])
    support, contact, mass = 1.0 + FRICTION_ERROR * rng.uniform(-1.0, 1.0, size=3)
    body = known.object
    error = _polar(
        CENTER_ERROR * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
    )
    center = (body.center_of_mass[0] + error[0], body.center_of_mass[1] + error[1])
    if body.shape.depth(center) <= 0.0:
        center = body.center_of_mass
    return replace(
        known,
        belief=replace(
            known.full_belief,
            center_of_mass=body.center_of_mass,
            friction_error=FRICTION_ERROR,
            center_error=CENTER_ERROR,
            mass_error=FRICTION_ERROR,
        ),
        support=replace(
            known.support, friction=min(1.9, known.support.friction * float(support))
        ),
        contact_friction=min(1.9, known.contact_friction * float(contact)),
        object=replace(body, mass=body.mass * float(mass), center_of_mass=center),
        sensing=UNCERTAIN_SENSING,
    )


def _arms(base: Task) -> int:
    """Number of arms for which tasks are drawn: all arms that may touch the object, or
    fewer if the modes named by ``base`` need fewer.
    """
    most = len(base.scene.arms)
    return min(most, max((MODES[name].arms for name in base.modes or ()), default=most))


def _drawn_robot(base: Task, rng: np.random.Generator) -> Robot:
    """Draw one of the robots that may touch the object."""
    robots = base.scene.tips
    if len(robots) == 1:
        return robots[0]
    return robots[int(rng.integers(len(robots)))]


def _pushed_faces(base: Task, arms: int, rng: np.random.Generator) -> int:
    """Number of pushed faces, 0 if the object is pressed.

    It follows from the mode that ``base`` names. Without a prescribed mode, the number
    is drawn at random. With one arm, it is 1 for modes for which no tasks are drawn.
    """
    drawn = {
        name: mode.pushed_faces
        for name, mode in MODES.items()
        if mode.arms == arms and mode.pushed_faces is not None
    }
    names = base.modes or tuple(drawn)
    faces = sorted({drawn[name] for name in names if name in drawn})
    if not faces and arms == 1:
        return 1
    if not faces:
        allowed = f"allowed where tasks are drawn: {', '.join(drawn)}"
        raise TaskError(base.source or base.name, "modes", list(names), allowed)
    if len(faces) == 1:
        return faces[0]
    return faces[int(rng.integers(len(faces)))]


def _aim(draw: Draw, arms: int, pressed: bool) -> Aim:
    if draw == "any":
        turn = ANY_ONE_ARM_TURN if arms == 1 else PRESSED_TURN
        return Aim(math.pi, math.pi, turn)
    if arms == 1:
        return Aim(math.pi, BEARING, ONE_ARM_TURN)
    if pressed:
        return Aim(math.pi, math.pi, PRESSED_TURN)
    return Aim(HEADING, BEARING, TWO_ARM_TURN)


def _any_object(rng: np.random.Generator, arms: int, pressed: bool) -> ObjectModel:
    """Draw an object of any size, with a mass from its volume and a CoM off the
    centroid.
    """
    low, high = (math.log(size) for size in ANY_SIZE[arms])

    def size() -> float:
        """Draw a size [m], uniform in its logarithm."""
        return math.exp(float(rng.uniform(low, high)))

    kind = _kind(rng, pressed)
    length = size()
    width = size() if kind == "box" else length
    mean = math.sqrt(length * width)
    height = min(
        max(float(rng.uniform(*ANY_HEIGHT)) * mean, ANY_HEIGHTS[0]), ANY_HEIGHTS[1]
    )
    shape: Shape
    if kind == "box":
        shape = Box((length, width, height))
    elif kind == "cylinder":
        shape = Cylinder(0.5 * length, height)
    else:
        count = 3 if kind == "triangle" else 6
        shape = Prism(_regular(count, 0.5 * length, math.pi / 6.0), height)
    volume = mean * mean * height
    mass = volume * float(rng.uniform(*ANY_DENSITY))
    x, y = _centroid(shape)
    off = OFF_CENTER * shape.inner_radius * rng.uniform(-1.0, 1.0, size=2)
    center = (x + float(off[0]), y + float(off[1]))
    return ObjectModel(
        shape, min(max(mass, ANY_MASS[arms][0]), ANY_MASS[arms][1]), center
    )


def _object(
    rng: np.random.Generator, ranges: ObjectRanges, pressed: bool
) -> ObjectModel:
    """Draw a shape and its mass."""
    shape = _shape(rng, ranges, pressed)
    mass = float(rng.uniform(*ranges.mass))
    return ObjectModel(shape, mass, _centroid(shape))


def _shape(rng: np.random.Generator, ranges: ObjectRanges, pressed: bool) -> Shape:
    """Draw a shape. Two thirds are boxes, or slightly fewer if cylinders are drawn too."""
    kind = _kind(rng, pressed)
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


def _kind(rng: np.random.Generator, pressed: bool) -> str:
    """Draw a kind of shape; pressed objects may also be cylinders."""
    kinds = ["box"] * 4 + ["triangle", "hexagon"] + ["cylinder"] * pressed
    return str(rng.choice(kinds))


def _regular(count: int, radius: float, phase: float) -> tuple[Point, ...]:
    """Corners [m] of a regular polygon; ``phase`` [rad] is the direction of the first
    corner.
    """
    angles = [phase + 2.0 * math.pi * i / count for i in range(count)]
    return tuple(
        (float(radius * math.cos(a)), float(radius * math.sin(a))) for a in angles
    )


def _centroid(shape: Shape) -> Point:
    """Centroid [m] of the footprint in G.

    ``shape.centroid`` is not used, because it is rounded differently, and a seed must
    give the same task to the last bit.
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
    """Draw until start and goal are within reach. Raises PushPressSlideError after
    ``TRIES`` draws.
    """
    for _ in range(TRIES):
        poses = draw()
        if all(map(within, poses)):
            return poses
    raise PushPressSlideError(
        f"no start and goal within reach of the robots in {TRIES} draws: the object or "
        "the distance is too large for the cell"
    )


def _clear_of(robot: Robot, body: ObjectModel, X_WG: Pose2) -> bool:
    """Whether an object at a pose keeps BASE_ROOM from a robot's base."""
    return body.shape.distance(X_WG.unapply(robot.base[:2])) >= BASE_ROOM


def _one_arm_poses(
    rng: np.random.Generator, robot: Robot, body: ObjectModel, aim: Aim
) -> Poses:
    """Draw start and goal in an annular sector in front of the robot."""
    x, y, _ = robot.base

    def draw() -> Poses:
        """Draw start and goal without checking the reach."""
        r = rng.uniform(*ONE_ARM_REACH)
        azimuth = rng.uniform(-AZIMUTH, AZIMUTH) + robot.base_yaw
        yaw = rng.uniform(-math.pi, math.pi)
        start = Pose2(
            float(x + r * math.cos(azimuth)),
            float(y + r * math.sin(azimuth)),
            float(yaw),
        )
        distance = rng.uniform(*DISTANCE)
        ahead = _polar(distance, rng.uniform(-aim.bearing, aim.bearing))
        turn = rng.uniform(-aim.turn, aim.turn)
        return start, Pose2(*start.apply(ahead), float(yaw + turn))

    def within(pose: Pose2) -> bool:
        """Whether the robot reaches the object at a pose."""
        dx = pose.x - x
        dy = pose.y - y
        azimuth = math.remainder(math.atan2(dy, dx) - robot.base_yaw, 2.0 * math.pi)
        near, far = ONE_ARM_REACH
        reached = near <= math.hypot(dx, dy) <= far and abs(azimuth) <= AZIMUTH
        return reached and _clear_of(robot, body, pose)

    return _first_within(draw, within)


def _top_contact(rng: np.random.Generator, body: ObjectModel) -> Point | None:
    """Draw a contact [m] in G on the object's top, near its CoM. None if the top is too
    small.
    """
    x, y = body.center_of_mass
    for _ in range(TOP_CONTACT_TRIES):
        r = rng.uniform(*TOP_CONTACT_DISTANCE)
        place = _polar(r, rng.uniform(-math.pi, math.pi))
        if inside_top(body, place, TOP_CONTACT_EDGE):
            return (x + place[0], y + place[1])
    return None


def _two_arm_poses(
    rng: np.random.Generator,
    robots: Sequence[Robot],
    body: ObjectModel,
    faces: int,
    aim: Aim,
) -> Poses:
    """Draw start and goal in front of two robots.

    A push is directed away from the robots. A pressed object moves in any direction.
    """
    (lx, ly), (rx, ry) = (robot.base[:2] for robot in robots)
    # x away from the robots
    X_WM = Pose2(0.5 * (lx + rx), 0.5 * (ly + ry), math.atan2(rx - lx, ly - ry))

    def draw() -> Poses:
        """Draw start and goal without checking the reach."""
        push = _push(rng, body.shape, faces)
        x = rng.uniform(AHEAD, FARTHEST_AHEAD)
        y = rng.uniform(-ASIDE, ASIDE)
        yaw = rng.uniform(-aim.heading, aim.heading) - push
        start = X_WM.compose(Pose2(float(x), float(y), float(yaw)))
        distance = rng.uniform(*DISTANCE)
        ahead = _polar(distance, push + rng.uniform(-aim.bearing, aim.bearing))
        turn = float(rng.uniform(-aim.turn, aim.turn))
        return start, start.compose(Pose2(*ahead, turn))

    def within(X_WG: Pose2) -> bool:
        """Whether both robots reach the object at a pose."""
        center = X_WG.apply(body.center_of_mass)
        near, far = TWO_ARM_REACH
        distances = [math.dist(center, robot.base[:2]) for robot in robots]
        ahead = X_WM.unapply(center)[0]
        reached = ahead >= AHEAD and all(near <= d <= far for d in distances)
        return reached and all(_clear_of(robot, body, X_WG) for robot in robots)

    return _first_within(draw, within)


def _push(rng: np.random.Generator, shape: Shape, faces: int) -> float:
    """Draw the direction [rad] in G of a push on one face, or on two neighbouring
    faces.
    """
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
