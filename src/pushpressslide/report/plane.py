"""Pictures seen from above (on a wall: from the front): what is planned, and what came
of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.report import series, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BASE_RADIUS = 0.09  # [m] at which a robot's base is drawn
STATIONS = 6  # footprints between start and end
ARROW = 0.08  # [m] length of the largest force arrow
ROUND_SIDES = 48


def outline(task: Task, pose: Pose2) -> list[tuple[float, float]]:
    """Return the object's footprint at ``pose`` X_WG, as corners in the world [m]."""
    shape = task.object.shape
    if isinstance(shape, Cylinder):
        angles = [2.0 * math.pi * i / ROUND_SIDES for i in range(ROUND_SIDES)]
        corners = [
            (shape.radius * math.cos(a), shape.radius * math.sin(a)) for a in angles
        ]
    else:
        corners = list(shape.footprint)
    return [pose.apply(corner) for corner in corners]


def plan_figure(plan: Plan) -> Figure:
    """Return the plan from above: the tracking point's paths, footprints, obstacles,
    bases and contacts.
    """
    made, axes = style.figure(height=5.6)
    ax = axes[0]
    task = plan.task
    stretches = plan.segments
    goal = plan.goal
    each = max(2, STATIONS // len(stretches))
    shares = np.linspace(0.0, 1.0, each + 2)
    poses = [
        plan.object_pose(stretch, u * stretch.path.length)
        for stretch in stretches
        for u in shares
    ]
    _surroundings(ax, task)
    _footprints(ax, task, poses[1:-1], style.SKY, "planned on the way")
    _footprint(ax, task, task.start, style.BLACK, "start", fill=True)
    _footprint(ax, task, goal, style.GREEN, "goal", fill=True)
    for i, stretch in enumerate(stretches):
        line = [
            stretch.path.pose(s) for s in np.linspace(0.0, stretch.path.length, 200)
        ]
        label = None if i else "path of the tracking point"
        ax.plot(
            [p.x for p in line],
            [p.y for p in line],
            color=style.BLUE,
            label=label,
            lw=1.8,
        )
        ax.plot(line[0].x, line[0].y, "o", color=style.BLUE, ms=5)
    X_WB = task.start.compose(task.object.X_GB)
    ax.plot(
        X_WB.x, X_WB.y, "+", color=style.BLACK, ms=9, mew=1.5, label="centre of mass"
    )
    _contacts(
        ax,
        [
            (grasp, grasp.task.start.compose(task.object.X_GB))
            for grasp in plan.by_placement
        ],
    )
    corners = [c for pose in [*poses, task.start, goal] for c in outline(task, pose)]
    way = sum(series.path_length(stretch.path) for stretch in stretches)
    seconds = sum(stretch.profile.duration for stretch in stretches)
    modes = ", ".join(grasp.segments[0].mode for grasp in plan.by_placement)
    parts = f", {len(stretches)} stretches" if len(stretches) > 1 else ""
    _frame(ax, task, corners, f"Plan: {modes}, {way:.3f} m in {seconds:.1f} s{parts}")
    return made


def path_figure(task: Task, plan: Plan, record: Record) -> Figure:
    """Return the run from above: reference path, tracked point, footprints, goal,
    measured contact forces.
    """
    made, axes = style.figure(height=5.6)
    ax = axes[0]
    pose = record.arrays["object_pose"]
    tracked = series.tracked_poses(task, record)
    (at,) = np.nonzero(series.contact_phase(record))
    at = at if len(at) else np.arange(len(pose))
    picks = at[np.linspace(0, len(at) - 1, STATIONS + 2).round().astype(int)]
    poses = [Pose2(*(float(v) for v in pose[i])) for i in picks]
    last = Pose2(*(float(v) for v in pose[-1]))
    _surroundings(ax, task)
    _footprint(ax, task, task.goal, style.GREEN, "goal", fill=True)
    _footprints(ax, task, poses[1:-1], style.GREY, "object on the way")
    _footprint(ax, task, poses[0], style.BLACK, "start", dashed=True)
    _footprint(ax, task, last, style.ORANGE, "end")
    for name, values in record.arrays.items():
        if name.startswith("body_"):
            ends = series.planar_poses(values)[[0, -1]]
            ax.plot(
                ends[:, 0],
                ends[:, 1],
                color=style.PURPLE,
                marker="s",
                ms=4,
                label=name.removeprefix("body_"),
            )
    for i, reference in enumerate(series.stretch_paths(record)):
        first = i == 0
        gone = at[record.arrays["stretch"][at] == i]
        ax.plot(
            *tracked[gone, :2].T,
            "-o",
            color=style.BLUE,
            lw=2.4,
            ms=5,
            markevery=[0] if len(gone) else None,
            label="tracking point" if first else None,
        )
        ax.plot(
            *reference[:, :2].T,
            "--",
            color=style.BLACK,
            lw=1.0,
            label="reference path" if first else None,
        )
    largest = _forces(ax, task, plan, record, picks[1:-1])
    taken = [
        (grasp, _first_pose(part)) for grasp, part in series.by_grasp(plan, record)
    ]
    _contacts(ax, [(grasp, pose.compose(task.object.X_GB)) for grasp, pose in taken])
    if largest > 0.0:
        flat = (
            "in the plane, "
            if any(
                c.kind == "top" for grasp in plan.by_placement for c in grasp.contacts
            )
            else ""
        )
        label = f"contact force, {flat}largest {largest:.1f} N"
        ax.plot([], [], color=style.AMBER, marker=">", ms=6, label=label)
    corners = [c for p in [*poses, last, task.goal] for c in outline(task, p)]
    corners += [(float(x), float(y)) for x, y in tracked[at][::50, :2]]
    _frame(
        ax,
        task,
        corners,
        "The run, seen "
        + ("from above" if task.support.kind == "table" else "from the front"),
    )
    return made


def _forces(
    ax: Axes, task: Task, plan: Plan, record: Record, picks: Sequence[int]
) -> float:
    """Draw the measured forces at the picked ticks, each at its contact; return the
    largest [N].
    """
    force = record.arrays["measured_force"][:, :, :2]
    pose = record.arrays["object_pose"]
    contacts = plan.contacts_by_leg
    leg = record.arrays["leg"]
    sizes = np.linalg.norm(force[picks], axis=2)
    largest = float(np.nanmax(sizes)) if sizes.size else 0.0
    if not largest > series.CONTACT_FORCE:
        return 0.0
    for tick in picks:
        X_WB = Pose2(*(float(v) for v in pose[tick])).compose(task.object.X_GB)
        for contact in contacts[int(leg[tick])]:
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
    """Where the object is when a grasp begins to move it."""
    at = int(np.argmax(series.in_phase(record, "move")))
    return Pose2(*(float(v) for v in record.arrays["object_pose"][at]))


def _contacts(ax: Axes, grasps: Sequence[tuple[Plan, Pose2]]) -> None:
    """Draw where the tips of each grasp touch the object at its X_WB: a dot on top, a
    short arrow into a side.
    """
    touched = [(contact, X_WB) for grasp, X_WB in grasps for contact in grasp.contacts]
    kinds = {contact.kind for contact, _ in touched}
    for contact, X_WB in touched:
        x, y = X_WB.apply(contact.point)
        if contact.kind == "top":
            ax.plot(x, y, "o", color=style.ORANGE, ms=8, zorder=6)
        else:
            n = X_WB.rotate(contact.normal)
            _arrow(ax, (x - ARROW * n[0], y - ARROW * n[1]), (x, y), style.ORANGE)
    for kind, label, marker in (
        ("top", "press on top", "o"),
        ("side", "push on a side", ">"),
    ):
        if kind in kinds:
            ax.plot([], [], marker, color=style.ORANGE, ms=7, label=label)


def _arrow(
    ax: Axes, tail: tuple[float, float], head: tuple[float, float], color: str
) -> None:
    options: dict[str, Any] = {
        "arrowstyle": "-|>",
        "color": color,
        "lw": 1.8,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    ax.annotate("", xy=head, xytext=tail, arrowprops=options, zorder=5)


def _footprint(
    ax: Axes,
    task: Task,
    pose: Pose2,
    color: str,
    label: str,
    *,
    fill: bool = False,
    dashed: bool = False,
) -> None:
    from matplotlib.patches import Polygon

    corners = outline(task, pose)
    if fill:
        ax.add_patch(
            Polygon(corners, closed=True, facecolor=color, alpha=0.13, edgecolor="none")
        )
    ax.add_patch(
        Polygon(
            corners,
            closed=True,
            fill=False,
            edgecolor=color,
            lw=1.5,
            ls="--" if dashed else "-",
            label=label,
        )
    )
    front = pose.rotate((1.0, 0.0))
    reach = 0.35 * max(math.dist(corner, (pose.x, pose.y)) for corner in corners)
    ax.plot(
        [pose.x, pose.x + reach * front[0]],
        [pose.y, pose.y + reach * front[1]],
        color=color,
        lw=1.3,
    )


def _footprints(
    ax: Axes, task: Task, poses: Sequence[Pose2], color: str, label: str
) -> None:
    from matplotlib.patches import Polygon

    for i, pose in enumerate(poses):
        ax.add_patch(
            Polygon(
                outline(task, pose),
                closed=True,
                fill=False,
                edgecolor=color,
                lw=0.9,
                alpha=0.75,
                label=label if i == 0 else None,
            )
        )


def _surroundings(ax: Axes, task: Task) -> None:
    from matplotlib.patches import Circle, Polygon

    if (opening := task.support.opening) is not None:
        w, h = opening.size
        x, y = opening.center
        corners = [
            (x + a * w, y + b * h)
            for a, b in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
        ]
        ax.add_patch(
            Polygon(
                corners,
                closed=True,
                fill=False,
                edgecolor="#6B7280",
                ls=":",
                label="opening",
            )
        )
    for i, obstacle in enumerate(task.obstacles):
        a = 0.5 * obstacle.size[0]
        b = 0.5 * obstacle.size[1]
        corners = [obstacle.pose.apply(c) for c in ((-a, -b), (a, -b), (a, b), (-a, b))]
        label = "obstacle" if i == 0 else None
        ax.add_patch(
            Polygon(
                corners,
                closed=True,
                facecolor="#B9BEC6",
                edgecolor="#6B7280",
                hatch="///",
                label=label,
            )
        )
        box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8}
        words: dict[str, Any] = {
            "ha": "center",
            "va": "center",
            "fontsize": 8,
            "color": style.BLACK,
        }
        ax.annotate(
            obstacle.name,
            obstacle.pose.position,
            bbox=box,
            annotation_clip=True,
            **words,
        )
    for i, robot in enumerate(task.robots):
        if robot.model == "hand" or task.support.kind == "wall":
            continue
        label = "robot base" if i == 0 else None
        centre = (robot.base[0], robot.base[1])
        ax.add_patch(
            Circle(
                centre,
                BASE_RADIUS,
                facecolor="#DDE3EA",
                edgecolor="#6B7280",
                label=label,
            )
        )
        ahead = 0.75 * BASE_RADIUS
        ax.plot(
            [centre[0], centre[0] + ahead * math.cos(robot.base_yaw)],
            [centre[1], centre[1] + ahead * math.sin(robot.base_yaw)],
            color="#6B7280",
            lw=1.5,
        )
        if len(task.robots) > 1:
            place = (centre[0], centre[1] - 0.5 * BASE_RADIUS)
            ax.annotate(
                f"arm {i}",
                place,
                ha="center",
                va="center",
                fontsize=7.5,
                color=style.BLACK,
            )


def _frame(
    ax: Axes, task: Task, corners: Sequence[tuple[float, float]], title: str
) -> None:
    """Set limits around ``corners``, obstacles and bases, and label the axes."""
    points = list(corners)
    for obstacle in task.obstacles:
        reach = 0.5 * math.hypot(obstacle.size[0], obstacle.size[1])
        points += [
            (obstacle.pose.x + dx, obstacle.pose.y + dy)
            for dx in (-reach, reach)
            for dy in (-reach, reach)
        ]
    if task.support.kind == "table":
        for robot in (r for r in task.robots if r.model != "hand"):
            points += [
                (robot.base[0] + d, robot.base[1] + e)
                for d in (-0.1, 0.1)
                for e in (-0.1, 0.1)
            ]
    margin = 0.05
    xs = [p[0] for p in points]
    ys = [p[1] for p in points]
    ax.set_xlim(min(xs) - margin, max(xs) + margin)
    ax.set_ylim(min(ys) - margin, max(ys) + margin)
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlabel(
        "x [m]" if task.support.kind == "table" else "horizontal, to the left [m]"
    )
    ax.set_ylabel("y [m]" if task.support.kind == "table" else "up [m]")
    if task.support.kind == "wall":
        ax.invert_xaxis()
    style.title(ax, title)
    style.legend(ax)
