"""Checks of a task's arms: whether they are readable, strong enough, and within reach
of the object.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from pushpressslide.core.errors import (
    MissingFrameError,
    PushPressSlideError,
    RobotFileError,
    Shown,
    TaskError,
    path_value,
)
from pushpressslide.core.footprint import around
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import MODELS, ObjectModel, Robot, Scene
from pushpressslide.taskfile.place import Fault, refuse

if TYPE_CHECKING:
    from pushpressslide.robots.kinematics import ArmKinematics

BASE_RADIUS = 0.10
"""Radius [m] of a robot's base, which no body may enter."""

PLACES = 24
"""Number of points around an object that are checked for a tip's reach."""

REACH_SLACK = 0.02
"""Shortfall [m] that is attributed to the search. A point with a larger shortfall is
out of reach.
"""

FURTHER = (0.05, 0.1, 0.2)
"""Distances [m] beyond the shortfall by which a base is moved to look for a remedy."""

CLEAR = 2.0 * BASE_RADIUS
"""Smallest distance [m] of a moved base from the object."""


def check_reach(query: MotionQuery, body: ObjectModel) -> None:
    """Check that some robot brings its tip next to or onto the object at start and at
    goal.

    The check uses only kinematics. It tries all tool attitudes, with a tolerance for
    points between the tried ones. A refused pose is therefore impossible for every
    choice of contact. Raises TaskError for a robot that cannot be read, and for a start
    or goal that no robot reaches, with the shortfall.
    """
    scene = query.scene
    source = query.source
    arms = [_kinematics(robot, i, source) for i, robot in enumerate(scene.robots)]
    for i, (kin, robot) in enumerate(zip(arms, scene.robots, strict=True)):
        if robot.model not in MODELS:
            refuse(source, _limit_faults(kin, f"robots[{i}].limits"))
            refuse(source, _weight_faults(kin, f"robots[{i}].limits"))
    for name, pose in (("start", query.start), ("goal", query.goal)):
        short: list[float] = []
        for arm, robot in zip(arms, scene.robots, strict=True):
            short.append(shortfall(arm, robot, scene, pose))
            if short[-1] <= 0.0:
                break
        best = min(range(len(short)), key=short.__getitem__)
        if short[best] > 0.0:
            center = pose.apply(body.center_of_mass)
            far = math.dist(center, scene.bases[best][:2])
            what = Shown(
                f"object's centre at x {center[0]:g}, y {center[1]:g}, {far:.3f} m "
                "from the base"
            )
            allowed = (
                f"allowed: within reach; the tip of the {arms[best].facts.name} stays "
                f"{short[best]:.3f} m short of the object"
            )
            base = _reaching_base(query, best, pose, short[best])
            if base is not None:
                x, y = base
                allowed += f"; with robots.{best}.base at x {x:g}, y {y:g} it reaches"
            raise TaskError(source, name, what, allowed)


def _reaching_base(
    query: MotionQuery, arm: int, X_WG: Pose2, short: float
) -> Point | None:
    """Position [m] of an arm's base from which the arm reaches start and goal, or None.

    A few positions, moved towards the object at ``X_WG``, are tried.
    """
    import shapely

    scene = query.scene
    robot = scene.robots[arm]
    shape = scene.body.shape
    places = [shape.placed(pose) for pose in (query.start, query.goal)]
    x, y, z = robot.base
    to_x, to_y = X_WG.apply(scene.body.center_of_mass)
    angle = math.atan2(to_y - y, to_x - x)
    for further in FURTHER:
        step = short + further
        moved = (
            round(x + step * math.cos(angle), 2),
            round(y + step * math.sin(angle), 2),
        )
        if min(place.distance(shapely.Point(moved)) for place in places) < CLEAR:
            continue
        placed = replace(robot, base=(*moved, z))
        kin = _kinematics(placed, arm, query.source)
        poses = (query.start, query.goal)
        if all(shortfall(kin, placed, scene, pose) <= 0.0 for pose in poses):
            return moved
    return None


def _limit_faults(kin: ArmKinematics, field: str) -> Iterator[Fault]:
    """Yield a fault for the field of the joints' limits, if a file lacks some of them."""
    from pushpressslide.robots.sheet import limits_to_fill

    lines = limits_to_fill(kin.facts)
    if lines:
        missing = "it is missing, and the file lacks limits of some joints"
        yield field, None, f"{missing}; allowed: the maker's, as {lines}"


def _weight_faults(kin: ArmKinematics, field: str) -> Iterator[Fault]:
    """Yield a fault for the torque limit of a joint that cannot hold the arm's own
    weight.
    """
    from pushpressslide.robots.sheet import too_weak

    weak = too_weak(kin)
    if weak is not None:
        joint, needed, limit = weak
        value = Shown(f"torque {limit:.4g} of joint {joint!r}")
        holds = f"{needed:.3g} or more, which holds the arm's own weight in home_deg"
        yield field, value, f"allowed: {holds}; check masses and effort in its file"


def _kinematics(robot: Robot, i: int, source: str) -> ArmKinematics:
    from pushpressslide.robots.arm_files import arm_kinematics

    field = f"robots[{i}]"
    try:
        return arm_kinematics(robot)
    except MissingFrameError as error:
        key, name = "tip_frame", robot.tip_frame
        if robot.tip is not None:
            key, name = "tip.link", robot.tip.link
        raise TaskError(source, f"{field}.{key}", str(name), str(error)) from error
    except RobotFileError:
        raise  # names the file itself
    except PushPressSlideError as error:
        raise TaskError(
            source, f"{field}.model", path_value(robot.model), str(error)
        ) from error


def shortfall(kin: ArmKinematics, robot: Robot, scene: Scene, X_WG: Pose2) -> float:
    """Distance [m] by which a tip misses the nearest point at which it could touch the
    object. 0 if it reaches one.
    """
    import numpy as np

    from pushpressslide.robots.reach import first_look, reachable
    from pushpressslide.robots.tool import TOOL_TILTS, ToolAttitude

    places, spacing = around(scene.body.shape, X_WG, robot.tip_radius, PLACES)
    low = robot.tip_radius
    top = scene.body.shape.height + robot.tip_radius
    levels = np.linspace(low, top, min(max(2, math.ceil((top - low) / 0.08)), 8))
    frame = scene.support.frame
    points = np.array(
        [frame.point((x, y, float(z))) for x, y in places for z in levels]
    )
    slack = 0.5 * math.hypot(spacing, float(levels[1] - levels[0])) + REACH_SLACK
    least = math.inf
    for tilt in TOOL_TILTS:
        for azimuth in (0.5 * math.pi * k for k in range(4 if tilt > 0.0 else 1)):
            hold = ToolAttitude(tilt, azimuth, frame.axes)
            found = first_look(kin, points, hold, joint_margin=0.0)
            if not found.ok.any():
                found = reachable(kin, points, hold)
            least = min(least, float(found.miss.min()))
            if found.ok.any() or least <= slack:
                return 0.0
            if tilt == 0.0:
                points = points[np.argsort(found.miss)[:PLACES]]
    return least
