"""What a task's fields must satisfy together: bodies apart, modes that fit the robots,
poses within reach.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pushpressslide.core.control import Vector3
from pushpressslide.core.errors import PushPressSlideError, Shown, TaskError
from pushpressslide.core.footprint import (
    around,
    carried,
    overlap_area,
)
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Obstacle, Robot, Shape, Task
from pushpressslide.taskfile.reader import nearest

if TYPE_CHECKING:
    from pushpressslide.robots.kinematics import ArmKinematics

MAX_OVERLAP = 1e-8
"""Area that two footprints may share and still count as touching [m^2]."""

BASE_RADIUS = 0.10
"""Radius of a robot's base that no body may enter [m]."""

PLACES = 24
"""Around an object, at which it is asked whether a tip gets there."""

REACH_SLACK = 0.02
"""Shortfall that is put down to the search [m]; beyond it a place is out of reach."""

MODELS = ("panda", "iiwa7", "hand")
"""Robot models that come with the package."""


def check(task: Task) -> None:
    """Check all that concerns more than one field, cheap checks first.

    Raises:
        TaskError: the first field that does not fit the others.
    """
    _check_motion(task)
    _check_modes(task)
    _check_goal(task)
    _check_workspace(task)
    check_reach(task)
    _check_bodies(task)


def mode_library() -> Mapping[str, Any]:
    """Return the modes of the library by name."""
    from pushpressslide.modes import MODES

    return MODES


def _check_motion(task: Task) -> None:
    shape = task.object.shape
    motion = task.motion
    if motion.time_step > motion.control_period:
        allowed = f"allowed: at most motion.control_period, {motion.control_period:g} s"
        raise TaskError(task.source, "motion.time_step", motion.time_step, allowed)
    if motion.face is not None:
        if not shape.corners:
            raise TaskError(
                task.source,
                "motion.face",
                motion.face,
                "a cylinder has no edges; allowed: null",
            )
        edges = len(shape.corners)
        if motion.face >= edges:
            raise TaskError(
                task.source,
                "motion.face",
                motion.face,
                f"allowed: null or 0 to {edges - 1}",
            )
    if motion.contact_height is not None and motion.contact_height >= shape.height:
        allowed = f"allowed: below the object's top at {shape.height:g} m"
        raise TaskError(
            task.source, "motion.contact_height", motion.contact_height, allowed
        )


def check_wall(task: Task) -> None:
    """Check what a wall asks of a task: an object lies on a ledge, a loose body falls
    off, what is in the opening stays there.

    Raises TaskError.
    """
    if task.support.kind == "table":
        return
    for i, obstacle in enumerate(task.obstacles):
        if obstacle.movable:
            raise TaskError(
                task.source,
                f"obstacles[{i}].movable",
                True,
                "on a wall it would fall; allowed: false",
            )
    if not carried(task, task.start):
        allowed = (
            "it would fall before the arms press it; allowed: on a ledge, a fixed "
            "obstacle right below it"
        )
        raise TaskError(task.source, "start", _at(task.start), allowed)
    opening = task.support.opening
    shape = task.object.shape
    if opening is None:
        return
    if opening.depth >= shape.height:
        allowed = f"allowed: less than the object's height of {shape.height:g} m"
        raise TaskError(task.source, "support.opening.depth", opening.depth, allowed)
    if opening.holds(task.start, shape):
        raise TaskError(
            task.source,
            "start",
            _at(task.start),
            "it lies in support.opening; allowed: outside",
        )
    off = [abs(a - b) for a, b in zip(task.goal.position, opening.center, strict=True)]
    if not task.enters and all(
        d < 0.5 * size for d, size in zip(off, opening.size, strict=True)
    ):
        allowed = "allowed: outside support.opening, or where the object's outline is within it"
        raise TaskError(task.source, "goal", _at(task.goal), allowed)


def _arms(count: int) -> str:
    return f"{count} robot" if count == 1 else f"{count} robots"


def _check_modes(task: Task) -> None:
    modes = mode_library()
    count = len(task.robots)
    if task.modes is None:
        if all(mode.arms != count for mode in modes.values()):
            needed = ", ".join(f"{name} {mode.arms}" for name, mode in modes.items())
            raise TaskError(
                task.source,
                "robots",
                Shown(_arms(count)),
                f"no mode uses that many; robots by mode: {needed}",
            )
        return
    for i, name in enumerate(task.modes):
        if name not in modes:
            raise TaskError(
                task.source,
                f"modes[{i}]",
                name,
                f"unknown mode; {nearest(name, modes)}",
            )
        if modes[name].arms != count:
            allowed = (
                f"allowed: {_arms(modes[name].arms)}, the number that mode {name} uses"
            )
            raise TaskError(task.source, "robots", Shown(_arms(count)), allowed)
        if name in task.modes[:i]:
            raise TaskError(
                task.source,
                f"modes[{i}]",
                name,
                "it is listed twice; allowed: each mode once",
            )


def _check_goal(task: Task) -> None:
    """Check that there is something to do."""
    off = task.start.inverse().compose(task.goal)
    way = math.hypot(off.x, off.y)
    turn = abs(math.remainder(off.yaw, math.tau))
    if (
        task.legs
        or task.tool is not None
        or way > task.tolerance.position
        or turn > task.tolerance.yaw
    ):
        return
    value = Shown(f"{way * 1e3:.1f} mm and {math.degrees(turn):.2f} deg from the start")
    allowed = (
        f"allowed: beyond tolerance, {task.tolerance.position * 1e3:g} mm or "
        f"{math.degrees(task.tolerance.yaw):g} deg; the object is there already"
    )
    raise TaskError(task.source, "goal", value, allowed)


def _check_workspace(task: Task) -> None:
    if task.limits.workspace is None:
        return
    x_min, x_max, y_min, y_max = task.limits.workspace
    for name, pose in (("start", task.start), ("goal", task.goal)):
        if not (x_min <= pose.x <= x_max and y_min <= pose.y <= y_max):
            allowed = f"allowed: x in [{x_min:g}, {x_max:g}], y in [{y_min:g}, {y_max:g}] (limits.workspace)"
            raise TaskError(
                task.source, name, Shown(f"x {pose.x:g}, y {pose.y:g}"), allowed
            )


def check_reach(task: Task) -> None:
    """Check that some robot brings its tip beside or onto the object at start and at
    goal.

    By kinematics alone, with the tool held any way that is tried, and with room for
    what is between the places tried: what it refuses no choice of contact could do.
    Raises TaskError for a robot that cannot be read, and for a start or goal that no
    robot reaches, by how much it stays short.
    """
    arms = [_kinematics(task, i) for i in range(len(task.robots))]
    for name, pose in (("start", task.start), ("goal", task.goal)):
        short = [
            shortfall(arm, robot, task, pose)
            for arm, robot in zip(arms, task.robots, strict=True)
        ]
        best = min(range(len(short)), key=short.__getitem__)
        if short[best] > 0.0:
            center = pose.apply(task.object.center_of_mass)
            far = math.dist(center, task.bases[best][:2])
            what = Shown(
                f"object's centre at x {center[0]:g}, y {center[1]:g}, {far:.3f} m "
                "from the base"
            )
            allowed = f"the tip of the {arms[best].facts.name} stays {short[best]:.3f} m short of the object"
            raise TaskError(
                task.source, name, what, f"allowed: within reach; {allowed}"
            )


def _kinematics(task: Task, i: int) -> ArmKinematics:
    from pushpressslide.robots.kinematics import arm_kinematics

    robot = task.robots[i]
    try:
        return arm_kinematics(robot)
    except PushPressSlideError as error:
        field = "model"
        value = robot.model
        if str(error).startswith("it has no frame"):
            field = "tip_frame"
            value = str(robot.tip_frame)
        raise TaskError(
            task.source, f"robots[{i}].{field}", value, str(error)
        ) from error


def shortfall(kin: ArmKinematics, robot: Robot, task: Task, X_WG: Pose2) -> float:
    """Return by how much [m] a tip stays short of every place where it could touch; 0
    if it reaches one.
    """
    import numpy as np

    from pushpressslide.robots.reach import reachable
    from pushpressslide.robots.tool import TOOL_TILTS, ToolAttitude

    places, spacing = around(task.object.shape, X_WG, robot.tip_radius, PLACES)
    low = robot.tip_radius
    top = task.object.shape.height + robot.tip_radius
    levels = np.linspace(low, top, min(max(2, math.ceil((top - low) / 0.08)), 8))
    frame = task.support.frame
    points = np.array(
        [frame.point((x, y, float(z))) for x, y in places for z in levels]
    )
    slack = 0.5 * math.hypot(spacing, float(levels[1] - levels[0])) + REACH_SLACK
    least = math.inf
    for tilt in TOOL_TILTS:
        for azimuth in (0.5 * math.pi * k for k in range(4 if tilt > 0.0 else 1)):
            found = reachable(kin, points, ToolAttitude(tilt, azimuth, frame.axes))
            least = min(least, float(found.miss.min()))
            if found.ok.any() or least <= slack:
                return 0.0
            if tilt == 0.0:
                points = points[np.argsort(found.miss)[:PLACES]]
    return least


def _box(obstacle: Obstacle) -> Box:
    return Box(obstacle.size)


def _check_bodies(task: Task) -> None:
    arms = [
        (f"robots[{i}].base", base)
        for i, (robot, base) in enumerate(zip(task.robots, task.bases, strict=True))
        if robot.model != "hand"
    ]
    if len(arms) == 2 and math.dist(arms[0][1], arms[1][1]) < 2.0 * BASE_RADIUS:
        where = Shown(f"{math.dist(arms[0][1], arms[1][1]):.3f} m from the other base")
        raise TaskError(
            task.source,
            "robots[1].base",
            where,
            f"allowed: bases {2.0 * BASE_RADIUS:g} m or more apart",
        )
    object_poses = [("start", task.start), ("goal", task.goal)]
    if task.true_start != task.start:
        object_poses.append(("start_error", task.true_start))
    for name, pose in object_poses:
        for field, base in arms:
            _check_base(task, name, task.object.shape, pose, field, base)
        pushed = task.tool.body if task.tool is not None and name == "goal" else None
        for obstacle in task.obstacles:
            if obstacle.name != pushed:
                _check_apart(task, name, task.object.shape, pose, obstacle)
    for i, obstacle in enumerate(task.obstacles):
        field = f"obstacles[{i}].pose"
        for base_field, base in arms:
            _check_base(task, field, _box(obstacle), obstacle.pose, base_field, base)
        for other in task.obstacles[:i]:
            _check_apart(task, field, _box(obstacle), obstacle.pose, other)
        for other in task.obstacles:
            if task.tool is not None and obstacle.name == task.tool.body != other.name:
                _check_apart(task, "goal", _box(obstacle), task.tool.goal, other)


def _at(pose: Pose2) -> Shown:
    return Shown(f"x {pose.x:g}, y {pose.y:g}, yaw {math.degrees(pose.yaw):g} deg")


def _check_base(
    task: Task, name: str, shape: Shape, X_WG: Pose2, base_field: str, base: Vector3
) -> None:
    if base[2] >= shape.height:
        return
    gap = shape.distance(X_WG.unapply((base[0], base[1])))
    if gap < BASE_RADIUS:
        allowed = (
            f"allowed: {BASE_RADIUS:g} m or more from {base_field}, here {gap:.3f} m"
        )
        raise TaskError(task.source, name, _at(X_WG), allowed)


def _check_apart(
    task: Task, name: str, shape: Shape, X_WG: Pose2, obstacle: Obstacle
) -> None:
    area = overlap_area(shape, X_WG, _box(obstacle), obstacle.pose)
    if area > MAX_OVERLAP:
        allowed = f"allowed: no overlap with obstacle {obstacle.name!r}, here {area * 1e4:.2f} cm^2"
        raise TaskError(task.source, name, _at(X_WG), allowed)
