"""Drawings of plan and run in the plane of the support.

A table is seen from above, a wall from the front.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.bodies import OBJECT, goal_places
from pushpressslide.core.plan import MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.scene import arm_title
from pushpressslide.core.task import Obstacle, Robot, Scene, Shape, Task
from pushpressslide.report import series, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Indices = NDArray[np.intp]

BASE_RADIUS = 0.09  # [m] radius of a drawn robot base
STATIONS = 6  # number of footprints between start and end
LETTER = 0.016  # [m] width of a letter in a body's name, at the scale of most figures
ROOM = 0.05  # [m] free height for a name
ARROW = 0.08  # [m] length of the largest force arrow
LEAST_MOVE = 1e-3  # [m] displacement above which a body's final pose is drawn
MARGIN = 0.05  # [m] around the drawn scene
EDGE = "#6B7280"  # colour of obstacles, bases and openings


def outline(shape: Shape, pose: Pose2) -> list[Point]:
    """Corners [m] in the world of the object's footprint at ``pose`` X_WG."""
    return [pose.apply(point) for point in shape.outline()]


def plan_figure(plan: Plan) -> Figure:
    """Figure of a plan: paths of the tracking point, footprints, contacts and
    obstacles, without replans.
    """
    plan = replace(plan, later=())
    made, axes = style.figure(height=5.6)
    ax = axes[0]
    task = plan.task
    segments = plan.segments
    goal = plan.goal
    shape = task.object.shape
    each = max(2, STATIONS // max(1, len(segments)))
    shares = np.linspace(0.0, 1.0, each + 2)
    poses = [
        plan.object_pose(segment, u * segment.path.length)
        for segment in segments
        for u in shares
    ]
    surroundings(ax, task.scene)
    footprints(ax, shape, poses[1:-1], style.SKY, "planned poses")
    footprint(ax, shape, task.start, style.BLACK, "start", fill=True)
    footprint(ax, shape, goal, style.GREEN, "goal", fill=True)
    others = other_goals(ax, task)
    planned_paths(ax, [segment.path for segment in segments])
    center = task.start.apply(task.X_GB.position)
    cross: dict[str, Any] = {"color": style.BLACK, "ms": 9, "mew": 1.5}
    ax.plot(*center, "+", label="centre of mass", **cross)
    others += contacts(
        ax,
        [
            (placement, placement.query.start.compose(placement.task.X_GB))
            for placement in plan.by_placement
        ],
    )
    corners = [c for pose in [*poses, task.start, goal] for c in outline(shape, pose)]
    corners += others
    frame(ax, task.scene, corners)
    style.title(ax, _plan_title(plan))
    style.legend(ax)
    return made


def _plan_title(plan: Plan) -> str:
    """Title of a plan's figure: modes, length of the paths, and time."""
    segments = plan.segments
    length = sum(segment.path.distance for segment in segments)
    seconds = sum(segment.profile.duration for segment in segments)
    modes = ", ".join(placement.segments[0].mode for placement in plan.by_placement)
    title = f"Plan: {modes}, {length:.3f} m in {seconds:.1f} s"
    if len(segments) > 1:
        title += f", {len(segments)} segments"
    return title


def planned_paths(ax: Axes, paths: Sequence[MotionPath]) -> None:
    """Draw the paths of the tracking point, one after the other."""
    for i, path in enumerate(paths):
        poses = [path.pose(s) for s in np.linspace(0.0, path.length, 200)]
        label = None if i else "path of the tracking point"
        xs = [pose.x for pose in poses]
        ys = [pose.y for pose in poses]
        ax.plot(xs, ys, color=style.BLUE, label=label, lw=1.8)
        ax.plot(xs[0], ys[0], "o", color=style.BLUE, ms=5)


def path_figure(plan: Plan, record: Record) -> Figure:
    """Figure of a run: paths, footprints, goal and measured contact forces."""
    made, axes = style.figure(height=5.6)
    ax = axes[0]
    task = plan.task
    shape = task.object.shape
    (ticks,) = np.nonzero(series.contact_phase(record))
    if not len(ticks):
        ticks = np.arange(series.ticks(record))
    stations = np.linspace(0, len(ticks) - 1, STATIONS + 2).round().astype(int)
    picks = ticks[stations]
    poses = [_pose_at(record, i) for i in picks]
    last = _pose_at(record, -1)
    surroundings(ax, task.scene)
    footprint(ax, shape, task.goal, style.GREEN, "goal", fill=True)
    footprints(ax, shape, poses[1:-1], style.GREY, "object in between")
    footprint(ax, shape, poses[0], style.BLACK, "start", dashed=True)
    footprint(ax, shape, last, style.ORANGE, "end")
    others = _other_bodies(ax, task.scene, record) + other_goals(ax, task)
    tracked = series.tracked_poses(task.scene.body, record)[:, :2]
    _tracked_paths(ax, record, tracked, ticks)
    largest = _forces(ax, plan, record, picks[1:-1])
    placements = [
        (placement, _first_pose(part).compose(placement.task.X_GB))
        for placement, part in series.by_placement(plan, record)
    ]
    others += contacts(ax, placements)
    _force_key(ax, plan, largest)
    corners = [c for p in [*poses, last, task.goal] for c in outline(shape, p)]
    corners += [(float(x), float(y)) for x, y in tracked[ticks][::50]] + others
    view = "from above" if task.support.frame.faces_up else "from the front"
    frame(ax, task.scene, corners)
    style.title(ax, f"The run, seen {view}")
    style.legend(ax)
    return made


def _pose_at(record: Record, tick: int) -> Pose2:
    """X_WG of the object at a tick."""
    return Pose2(*map(float, record.arrays["object_pose"][tick]))


def _other_bodies(ax: Axes, scene: Scene, record: Record) -> list[Point]:
    """Draw all other bodies that moved, at their final poses. Return their corners [m].

    On a wall or a slope no other body moves, since it would fall.
    """
    label = "moved body, end"
    corners: list[Point] = []
    for obstacle in scene.obstacles:
        values = record.arrays.get(f"body_{obstacle.name}")
        if values is None:
            continue
        last = Pose2(*map(float, series.planar_poses(values)[-1]))
        if math.dist(last.position, obstacle.pose.position) < LEAST_MOVE:
            continue
        own = outline(obstacle.shape, last)
        _polygon(ax, own, fill=False, edgecolor=style.PURPLE, lw=1.6, label=label)
        corners += own
        label = ""
    return corners


def other_goals(ax: Axes, task: Task) -> list[Point]:
    """Draw the goals of the bodies other than the object. Return their corners [m]."""
    corners: list[Point] = []
    for name, shape, X_WG in goal_places(task):
        if name == OBJECT:
            continue
        label = f"goal of {name}"
        footprint(ax, shape, X_WG, style.GREEN, label, dashed=True)
        corners += outline(shape, X_WG)
    return corners


def _tracked_paths(ax: Axes, record: Record, tracked: Array, ticks: Indices) -> None:
    """Draw the tracking points ``tracked`` (N, 2) [m] at the given ticks, and their
    reference paths.
    """
    labels: tuple[str | None, str | None] = ("tracking point", "reference path")
    look: dict[str, Any] = {"color": style.BLUE, "lw": 2.4, "ms": 5}
    for i, reference in enumerate(series.segment_paths(record)):
        points = tracked[ticks[record.arrays["stretch"][ticks] == i]]
        first = [0] if len(points) else None
        ax.plot(*points.T, "-o", markevery=first, label=labels[0], **look)
        line = reference[:, :2].T
        ax.plot(*line, "--", color=style.BLACK, lw=1.0, label=labels[1])
        labels = (None, None)


def _force_key(ax: Axes, plan: Plan, largest: float) -> None:
    """Add the largest force [N] to the legend. For a press only the shear is shown."""
    if not largest > 0.0:
        return
    kinds = {c.kind for placement in plan.by_placement for c in placement.contacts}
    plane = "in the plane, " if "top" in kinds else ""
    label = f"contact force, {plane}largest {largest:.1f} N"
    ax.plot([], [], color=style.AMBER, marker=">", ms=6, label=label)


def _forces(ax: Axes, plan: Plan, record: Record, picks: Sequence[int]) -> float:
    """Draw the measured forces at the selected ticks. Return the largest [N]."""
    force = record.arrays["measured_force"][:, :, :2]
    placements = plan.by_placement
    number = record.arrays["placement"].astype(int)
    sizes = np.linalg.norm(force[picks], axis=2)
    largest = float(np.nanmax(sizes)) if sizes.size else 0.0
    if not largest > series.CONTACT_FORCE:
        return 0.0
    for tick in picks:
        placement = placements[number[tick]]
        X_WB = _pose_at(record, tick).compose(placement.task.X_GB)
        for contact in placement.contacts:
            x, y = X_WB.apply(contact.point)
            fx, fy = (float(v) * ARROW / largest for v in force[tick, contact.arm])
            if contact.kind == "top":
                ax.plot(x, y, "o", color=style.AMBER, ms=4, zorder=4)
            # a push ends where it acts, a press's shear begins there
            if math.hypot(fx, fy) > 0.05 * ARROW:
                tail = (x, y)
                head = (x + fx, y + fy)
                if contact.kind == "side":
                    tail, head = (x - fx, y - fy), tail
                _arrow(ax, tail, head, style.AMBER)
    return largest


def _first_pose(record: Record) -> Pose2:
    """Pose of the object at the start of a placement's motion."""
    return _pose_at(record, int(np.argmax(series.in_phase(record, "move"))))


def contacts(ax: Axes, placements: Sequence[tuple[Plan, Pose2]]) -> list[Point]:
    """Draw the contact points of each placement's tips on the object at its X_WB.
    Return the ends of the drawn marks [m].

    A press is a dot, a push a short arrow into the side.
    """
    ends: list[Point] = []
    touched = [
        (contact, X_WB)
        for placement, X_WB in placements
        for contact in placement.contacts
    ]
    kinds = {contact.kind for contact, _ in touched}
    for contact, X_WB in touched:
        x, y = X_WB.apply(contact.point)
        if contact.kind == "top":
            ax.plot(x, y, "o", color=style.ORANGE, ms=8, zorder=6)
        else:
            n = X_WB.rotate(contact.normal)
            tail = (x - ARROW * n[0], y - ARROW * n[1])
            _arrow(ax, tail, (x, y), style.ORANGE)
            ends.append(tail)
    for kind, label, marker in (
        ("top", "press on top", "o"),
        ("side", "push on a side", ">"),
    ):
        if kind in kinds:
            ax.plot([], [], marker, color=style.ORANGE, ms=7, label=label)
    return ends


def _arrow(ax: Axes, tail: Point, head: Point, color: str) -> None:
    options: dict[str, Any] = {
        "arrowstyle": "-|>",
        "color": color,
        "lw": 1.8,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    ax.annotate("", xy=head, xytext=tail, arrowprops=options, zorder=5)


def _polygon(ax: Axes, corners: Sequence[Point], **look: Any) -> None:
    from matplotlib.patches import Polygon

    ax.add_patch(Polygon(corners, closed=True, **look))


def footprint(
    ax: Axes,
    shape: Shape,
    pose: Pose2,
    color: str,
    label: str,
    *,
    fill: bool = False,
    dashed: bool = False,
) -> None:
    """Draw the object at ``pose`` X_WG, with a line from its origin to its front."""
    corners = outline(shape, pose)
    if fill:
        _polygon(ax, corners, facecolor=color, alpha=0.13, edgecolor="none")
    dash = "--" if dashed else "-"
    _polygon(ax, corners, fill=False, edgecolor=color, lw=1.5, ls=dash, label=label)
    front = pose.rotate((1.0, 0.0))
    length = 0.35 * max(math.dist(corner, pose.position) for corner in corners)
    tip = (pose.x + length * front[0], pose.y + length * front[1])
    _line(ax, pose.position, tip, color=color, lw=1.3)


def _line(ax: Axes, start: Point, end: Point, **look: Any) -> None:
    ax.plot(*zip(start, end, strict=True), **look)


def footprints(
    ax: Axes, shape: Shape, poses: Sequence[Pose2], color: str, label: str
) -> None:
    """Draw thin footprints of the object at ``poses`` X_WG. The first one carries the
    label.
    """
    look = {"fill": False, "edgecolor": color, "lw": 0.9, "alpha": 0.75}
    for i, pose in enumerate(poses):
        _polygon(ax, outline(shape, pose), label=None if i else label, **look)


def _rectangle(length: float, width: float) -> list[Point]:
    """Corners [m] of a rectangle about the origin, counter-clockwise."""
    a = 0.5 * length
    b = 0.5 * width
    return [(-a, -b), (a, -b), (a, b), (-a, b)]


def surroundings(ax: Axes, scene: Scene) -> None:
    """Draw the support's opening and edge, the obstacles and the robots' bases."""
    region = scene.support.region
    if region is not None:
        _polygon(
            ax, region, fill=False, edgecolor=EDGE, lw=1.2, label="edge of the table"
        )
    opening = scene.support.opening
    if opening is not None:
        x, y = opening.center
        corners = [(x + dx, y + dy) for dx, dy in _rectangle(*opening.size)]
        _polygon(ax, corners, fill=False, edgecolor=EDGE, ls=":", label="opening")
    for i, obstacle in enumerate(scene.obstacles):
        _obstacle(ax, obstacle, "" if i else "obstacle")
    for i, robot in enumerate(scene.robots):
        if robot.model == "hand" or not scene.support.frame.faces_up:
            continue
        _base(ax, robot, "" if i else "robot base")
        if len(scene.robots) > 1:
            x, y, _ = robot.base
            below = (x - BASE_RADIUS, y - 1.1 * BASE_RADIUS)
            words = {"ha": "left", "va": "top", "color": style.BLACK}
            ax.annotate(arm_title(i), below, fontsize=7.5, **words)


def _obstacle(ax: Axes, obstacle: Obstacle, label: str) -> None:
    corners = outline(obstacle.shape, obstacle.pose)
    look = {"facecolor": "#B9BEC6", "edgecolor": EDGE, "hatch": "///"}
    _polygon(ax, corners, label=label, **look)
    box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8}
    place = obstacle.pose.apply(obstacle.shape.centroid)
    xs, ys = zip(*corners, strict=True)
    words: dict[str, Any] = {"fontsize": 8, "bbox": box, "annotation_clip": True}
    if max(xs) - min(xs) > LETTER * len(obstacle.name) and max(ys) - min(ys) > ROOM:
        _name(ax, obstacle.name, place, **words)
        return
    below = (0.5 * (min(xs) + max(xs)), min(ys))
    words |= {"xytext": (0, -4), "textcoords": "offset points"}
    _name(ax, obstacle.name, below, va="top", **words)


def _base(ax: Axes, robot: Robot, label: str) -> None:
    """Draw a robot's base as a circle, with a line in its forward direction."""
    from matplotlib.patches import Circle

    x, y, _ = robot.base
    look: dict[str, Any] = {"facecolor": "#DDE3EA", "edgecolor": EDGE}
    ax.add_patch(Circle((x, y), BASE_RADIUS, label=label, **look))
    ahead = 0.75 * BASE_RADIUS
    yaw = robot.base_yaw
    front = (x + ahead * math.cos(yaw), y + ahead * math.sin(yaw))
    _line(ax, (x, y), front, color=EDGE, lw=1.5)


def _name(ax: Axes, text: str, place: Point, va: str = "center", **look: Any) -> None:
    ax.annotate(text, place, ha="center", va=va, color=style.BLACK, **look)


def frame(ax: Axes, scene: Scene, corners: Sequence[Point]) -> None:
    """Set limits around ``corners``, obstacles and bases, and label the axes."""
    table = scene.support.frame.faces_up
    points = [*corners, *(scene.support.region or ())]
    for obstacle in scene.obstacles:
        radius = obstacle.shape.farthest((0.0, 0.0))
        points += _square(obstacle.pose.position, radius)
    if table:
        for robot in scene.robots:
            if robot.model != "hand":
                points += _square(robot.base[:2], 0.1)
    xs = [p[0] for p in points]
    ys = [p[1] for p in points]
    ax.set_xlim(min(xs) - MARGIN, max(xs) + MARGIN)
    ax.set_ylim(min(ys) - MARGIN, max(ys) + MARGIN)
    ax.set_aspect("equal", adjustable="box")
    if table:
        ax.set_xlabel("x [m]")
        ax.set_ylabel("y [m]")
    else:
        ax.set_xlabel("horizontal, to the left [m]")
        ax.set_ylabel("up [m]")
        ax.invert_xaxis()


def _square(center: Point, half: float) -> list[Point]:
    """Corners [m] of a square with half side ``half`` about ``center``."""
    x, y = center
    return [(x + dx, y + dy) for dx, dy in _rectangle(2.0 * half, 2.0 * half)]
