"""Consistency checks of a task's fields: separated bodies, modes that fit the robots,
poses within reach.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from pushpressslide.core import margins
from pushpressslide.core.control import Vector3
from pushpressslide.core.errors import (
    Shown,
)
from pushpressslide.core.footprint import (
    edge_depths,
    overlap_area,
)
from pushpressslide.core.motion import Limits, Motion, ToolUse
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import (
    ARM_NAMES,
    ObjectModel,
    Obstacle,
    Opening,
    Scene,
)
from pushpressslide.geometry.shapes import Shape
from pushpressslide.taskfile.arm_checks import BASE_RADIUS, check_reach
from pushpressslide.taskfile.place import Fault, nearest, refuse

MAX_OVERLAP = 1e-8
"""Area [m^2] that two footprints may share and still count as touching."""

ROUNDING = 1e-6
"""Tolerance [m] of a contact's distance from the edge, for round-off."""


def check(
    query: MotionQuery, body: ObjectModel, true_start: Pose2, *, may_rest: bool = False
) -> None:
    """Check the consistency of a motion's fields, cheap checks first.

    ``body`` and ``true_start``, X_WG, are the true object. With ``may_rest`` the goal
    may be equal to the start.

    Raises:
        TaskError: the first field that does not fit the others.
    """
    scene = query.scene
    source = query.source
    refuse(source, _motion_faults(scene, query.motion))
    refuse(source, _arm_faults(query.motion, len(scene.robots)))
    refuse(source, _mode_faults(query))
    refuse(source, _vehicle_faults(query))
    if not may_rest:
        refuse(source, _goal_faults(query))
    check_places(query, body, true_start)
    refuse(source, _obstacle_faults(scene, query.tool))


def check_places(query: MotionQuery, body: ObjectModel, true_start: Pose2) -> None:
    """Check that start and goal are in the workspace, on the support, within reach and
    clear of bases and obstacles.

    Raises TaskError as ``check`` does.
    """
    scene = query.scene
    source = query.source
    refuse(source, _workspace_faults(query.limits, query.start, query.goal))
    refuse(source, _edge_faults(query, body, true_start))
    check_reach(query, body)
    refuse(source, _base_faults(scene))
    refuse(source, _object_faults(query, true_start))


def _motion_faults(scene: Scene, motion: Motion) -> Iterator[Fault]:
    shape = scene.body.shape
    face = motion.face
    height = motion.contact_height
    if motion.time_step > motion.control_period:
        allowed = f"allowed: at most motion.control_period, {motion.control_period:g} s"
        yield "motion.time_step", motion.time_step, allowed
    if face is not None:
        yield from _face_faults(scene, face)
    if height is not None and height >= shape.height:
        allowed = f"allowed: below the object's top at {shape.height:g} m"
        yield "motion.contact_height", height, allowed
    radius = max(robot.tip_radius for robot in scene.robots)
    if height is not None and height < radius:
        allowed = f"allowed: {radius:g} m or more, where the tip is above the support"
        yield "motion.contact_height", height, allowed
    yield from _contact_faults(scene, motion.contacts or ())


def _contact_faults(scene: Scene, points: Sequence[Point]) -> Iterator[Fault]:
    """Yield a fault for a contact on the object's top that no tip can make: off the
    top, in a notch, or too near to an edge.
    """
    inset = min(margins.inset(robot.tip_radius) for robot in scene.robots)
    for i, point in enumerate(points):
        if not scene.body.shape.holds(point, inset - ROUNDING, (0.0, 0.0)):
            reason = (
                f"allowed: a point on the object's top, {inset * 1e3:g} mm or more "
                "inside its edge"
            )
            yield f"motion.contacts[{i}]", list(point), reason


def _face_faults(scene: Scene, face: int) -> Iterator[Fault]:
    """Yield a fault for a missing face, or for a face that no tip can touch."""
    from pushpressslide.mechanics.faces import faces

    edges = scene.body.shape.edges
    if not edges:
        yield "motion.face", face, "a cylinder has no edges; allowed: null"
        return
    if face >= len(edges):
        yield "motion.face", face, f"allowed: null or 0 to {len(edges) - 1}"
        return
    touched = {f.index for f in faces(scene.body, scene.inset, scene.tip_radius)}
    if face not in touched:
        allowed = ", ".join(["null", *(str(index) for index in sorted(touched))])
        reason = (
            f"a tip of radius {scene.tip_radius * 1e3:g} mm cannot reach it, or it is "
            f"too narrow; allowed: {allowed}"
        )
        yield "motion.face", face, reason


def wall_faults(scene: Scene, start: Pose2, goal: Pose2) -> Iterator[Fault]:
    """Yield faults against the rules for walls: a body that would fall, or a start or
    goal that does not suit the opening.
    """
    if not any(scene.weight_along):
        return
    for i, obstacle in enumerate(scene.obstacles):
        if obstacle.movable:
            reason = f"on {scene.support.name} it would fall; allowed: false"
            yield f"obstacles[{i}].movable", True, reason
    if not scene.carried(start):
        reason = (
            "it would fall before the arms press it; allowed: on a ledge, a fixed "
            "obstacle right below it"
        )
        yield "start", pose_text(start), reason
    if scene.support.opening is not None:
        yield from _opening_faults(scene, scene.support.opening, start, goal)


def _opening_faults(
    scene: Scene, opening: Opening, start: Pose2, goal: Pose2
) -> Iterator[Fault]:
    shape = scene.body.shape
    if opening.depth >= shape.height:
        allowed = f"allowed: less than the object's height of {shape.height:g} m"
        yield "support.opening.depth", opening.depth, allowed
    if opening.holds(start, shape):
        reason = "it lies in support.opening; allowed: outside"
        yield "start", pose_text(start), reason
    off = [abs(a - b) for a, b in zip(goal.position, opening.center, strict=True)]
    within = all(d < 0.5 * size for d, size in zip(off, opening.size, strict=True))
    if within and not scene.enters(goal):
        allowed = "outside support.opening, or where the object's outline is within it"
        yield "goal", pose_text(goal), f"allowed: {allowed}"


def _count(arms: int) -> str:
    if arms == 1:
        return "1 robot"
    return f"{arms} robots"


def _mode_faults(query: MotionQuery) -> Iterator[Fault]:
    from pushpressslide.modes import MODES

    count = len(query.scene.robots)
    robots = Shown(_count(count))
    arm = query.motion.arm
    names = query.modes or ()
    for i, name in enumerate(names):
        field = f"modes[{i}]"
        if name not in MODES:
            yield field, name, f"unknown mode; {nearest(name, MODES)}"
        elif MODES[name].arms > count:
            allowed = f"{_count(MODES[name].arms)}, the number that mode {name} uses"
            yield "robots", robots, f"allowed: {allowed}"
        elif MODES[name].arms > 1 and arm is not None:
            yield "motion.arm", arm, f"mode {name} uses both arms; allowed: null"
        elif name in names[:i]:
            yield field, name, "it is listed twice; allowed: each mode once"


def _arm_faults(motion: Motion, count: int) -> Iterator[Fault]:
    """Yield a fault for a field that names an arm beyond the ``count`` arms of a task."""
    arm = motion.arm
    names = ARM_NAMES[:count]
    if arm is not None and arm not in names:
        allowed = ", ".join(["null", *names])
        reason = f"the task has {_count(count)}; allowed: {allowed}"
        yield "motion.arm", arm, reason


def _vehicle_faults(query: MotionQuery) -> Iterator[Fault]:
    """Yield a fault for a vehicle that no mode of the task offers."""
    from pushpressslide.modes import MODES

    vehicle = query.motion.vehicle
    arms = len(query.scene.arms)
    names = query.modes or [name for name, mode in MODES.items() if mode.arms <= arms]
    known = [known for name in names for known in MODES[name].vehicles]
    if vehicle is not None and vehicle not in known:
        allowed = ", ".join(["null", *known])
        reason = f"allowed with {', '.join(names)}: {allowed}"
        yield "motion.vehicle", vehicle, reason


def _goal_faults(query: MotionQuery) -> Iterator[Fault]:
    """Yield a fault for a goal that the object has already reached: by belief but not
    in truth, or at the start of a leg.
    """
    if query.tool is not None or not query.tolerance.holds(query.start, query.goal):
        return
    distance = math.dist(query.start.position, query.goal.position)
    turn = abs(math.remainder(query.goal.yaw - query.start.yaw, math.tau))
    tolerance = query.tolerance
    moved = f"{distance * 1e3:.1f} mm and {math.degrees(turn):.2f} deg"
    allowed = (
        f"allowed: beyond tolerance, {tolerance.position * 1e3:g} mm or "
        f"{math.degrees(tolerance.yaw):g} deg; the object is there already"
    )
    yield "goal", Shown(f"{moved} from the start"), allowed


def _workspace_faults(limits: Limits, start: Pose2, goal: Pose2) -> Iterator[Fault]:
    """Yield a fault for a start or goal outside ``limits.workspace``."""
    if limits.workspace is None:
        return
    x_min, x_max, y_min, y_max = limits.workspace
    allowed = f"x in [{x_min:g}, {x_max:g}], y in [{y_min:g}, {y_max:g}]"
    for name, pose in (("start", start), ("goal", goal)):
        if not (x_min <= pose.x <= x_max and y_min <= pose.y <= y_max):
            value = Shown(f"x {pose.x:g}, y {pose.y:g}")
            yield name, value, f"allowed: {allowed} (limits.workspace)"


def _edge_faults(
    query: MotionQuery, body: ObjectModel, true_start: Pose2
) -> Iterator[Fault]:
    """Yield a fault for each pose at which a body tips over the edge of
    ``support.region``. At the goal a margin is also required.
    """
    region = query.scene.support.region
    if region is None:
        return
    center = body.center_of_mass
    shape = body.shape
    margin = margins.EDGE_MARGIN * shape.half_width
    poses = {"start": query.start, "start_error": true_start, "goal": query.goal}
    for name, pose in poses.items():
        least = margin if name == "goal" else 0.0
        yield from _near_edge(name, shape, pose, center, least, region)
    for i, obstacle in enumerate(query.scene.obstacles):
        if obstacle.movable:
            name = f"obstacles[{i}].pose"
            middle = obstacle.shape.centroid
            pose = obstacle.pose
            yield from _near_edge(name, obstacle.shape, pose, middle, 0.0, region)


def _near_edge(
    name: str,
    shape: Shape,
    X_WG: Pose2,
    center: Point,
    min_margin: float,
    region: tuple[Point, ...],
) -> Iterator[Fault]:
    """Yield a fault for a pose at which a body's ``center`` [m], in G, is less than
    ``min_margin`` [m] inside a region.
    """
    import numpy as np
    from shapely import Polygon

    place = np.array([X_WG.apply(center)])
    depth = float(edge_depths(shape, [X_WG], place, Polygon(region))[0])
    if depth > 0.0 and depth >= min_margin:
        return
    inside = f"{1e3 * min_margin:.1f} mm or more inside the edge of support.region"
    if min_margin == 0.0:
        inside = "over the part of the base on support.region"
    where = f"{1e3 * abs(depth):.1f} mm {'inside' if depth > 0.0 else 'beyond'}"
    yield name, pose_text(X_WG), f"allowed: centre of mass {inside}, here {where}"


def _bases(scene: Scene) -> list[tuple[str, Vector3]]:
    """Fields and positions of the bases, which no body may enter."""
    return [
        (f"robots[{i}].base", base)
        for i, (robot, base) in enumerate(zip(scene.robots, scene.bases, strict=True))
        if robot.model != "hand"
    ]


def _base_faults(scene: Scene) -> Iterator[Fault]:
    bases = [base[:2] for _, base in _bases(scene)]
    apart = 2.0 * BASE_RADIUS
    if len(bases) == 2 and math.dist(*bases) < apart:
        value = Shown(f"{math.dist(*bases):.3f} m from the other base")
        yield "robots[1].base", value, f"allowed: bases {apart:g} m or more apart"


def _object_faults(query: MotionQuery, true_start: Pose2) -> Iterator[Fault]:
    """Yield a fault for a start or goal at which the object is too near to a base, or
    overlaps an obstacle.
    """
    scene = query.scene
    tool = query.tool
    shape = scene.body.shape
    poses = {"start": query.start, "goal": query.goal}
    if true_start != query.start:
        poses["start_error"] = true_start
    for name, pose in poses.items():
        yield from _near_bases(scene, name, shape, pose)
        for obstacle in scene.obstacles:
            pushed = tool is not None and obstacle.name == tool.body
            if name != "goal" or not (pushed or obstacle.may_move):
                yield from _overlap(name, shape, pose, obstacle)


def _obstacle_faults(scene: Scene, tool: ToolUse | None) -> Iterator[Fault]:
    for i, obstacle in enumerate(scene.obstacles):
        field = f"obstacles[{i}].pose"
        shape = obstacle.shape
        if obstacle.may_move and not obstacle.movable:
            reason = "it cannot move; allowed: false, or movable: true"
            yield f"obstacles[{i}].may_move", True, reason
        yield from _near_bases(scene, field, shape, obstacle.pose)
        for other in scene.obstacles[:i]:
            yield from _overlap(field, shape, obstacle.pose, other)
        if tool is None or tool.body != obstacle.name:
            continue
        for other in scene.obstacles:
            if other is not obstacle:
                yield from _overlap("goal", shape, tool.goal, other)


def pose_text(pose: Pose2) -> Shown:
    """Pose for a message, in metres and degrees."""
    return Shown(f"x {pose.x:g}, y {pose.y:g}, yaw {math.degrees(pose.yaw):g} deg")


def _near_bases(scene: Scene, name: str, shape: Shape, X_WG: Pose2) -> Iterator[Fault]:
    for field, (x, y, height) in _bases(scene):
        gap = shape.distance(X_WG.unapply((x, y)))
        if height < shape.height and gap < BASE_RADIUS:
            allowed = f"{BASE_RADIUS:g} m or more from {field}, here {gap:.3f} m"
            yield name, pose_text(X_WG), f"allowed: {allowed}"


def _overlap(
    name: str, shape: Shape, X_WG: Pose2, obstacle: Obstacle
) -> Iterator[Fault]:
    area = overlap_area(shape, X_WG, obstacle.shape, obstacle.pose)
    if area > MAX_OVERLAP:
        there = f"overlap with obstacle {obstacle.name!r}, here {area * 1e4:.2f} cm^2"
        yield name, pose_text(X_WG), f"allowed: no {there}"
