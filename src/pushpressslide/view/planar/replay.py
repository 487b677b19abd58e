"""Replay on the planar engine: one HTML page that plays a run seen from above, offline,
without Drake.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.bodies import OBJECT as OWN
from pushpressslide.core.bodies import SET_DOWN, goal_places
from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Shape, Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.view.bar import filled, json_in_page, package_text
from pushpressslide.view.timeline import frames, run_timeline

ROOM = "pushpressslide.view.planar"
FORCE_SCALE = 0.02  # [m/N] length of the force arrows
GOAL = "#009e73"
PATH = "#222222"
TRACE = "#0072b2"
REFERENCE = "#8a8a8a"
FORCE = "#a8387d"
CONE = "#e69f00"
PRESS = "#cc79a7"
OBJECT = "#d98c40"
OBJECT_EDGE = "#8a5a1e"
EDGE = "#6b7280"
CONE_LENGTH = 0.12  # [m] of a friction cone

Placed = tuple[Shape, Pose2]
"""A shape at a pose X_WG."""


def write_replay(
    plan: Plan,
    record: Record,
    out: Path,
    goals: Sequence[Placed] = (),
    parts: Sequence[Record] = (),
) -> Path:
    """Write the page to the file ``out``, completely or not at all, and return its
    path.

    If ``out`` is a folder, the file is replay.html. ``goals`` replace the task's own if
    given. ``parts`` are the records of the stages, if there are several.
    """
    page = filled(
        package_text("replay_page.html", ROOM),
        {
            "TITLE": escape(plan.task.name),
            "MODE": escape(", ".join(record.modes)),
            "LEGEND": "".join(map(_item, legend(plan))),
            "SCRIPT": package_text("replay_page.js", ROOM),
            "DATA": json_in_page(replay_data(plan, record, goals, parts)),
            "COURSE": json_in_page(
                run_timeline(plan, record, frames(record.arrays["time"])).plain()
            ),
        },
    )
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def task_goals(task: Task) -> list[Placed]:
    """Every goal of a task."""
    return [(shape, X_WG) for _, shape, X_WG in goal_places(task)]


def legend(plan: Plan) -> list[tuple[str, str, bool]]:
    """Colour, meaning and dash style of everything drawn."""
    kinds = {
        c.kind for package_text in plan.by_placement for c in package_text.contacts
    }
    out = [
        (GOAL, "goal", False),
        (PATH, "planned path of the tracking point", True),
        (TRACE, "its trace; the ring is the virtual axle", False),
        (REFERENCE, "reference at this time", True),
        (FORCE, f"contact force, {1e3 * FORCE_SCALE:.0f} mm a newton", False),
    ]
    if "side" in kinds:
        out.append((CONE, "friction cone", False))
    if "top" in kinds:
        out += [(PRESS, "pressing tip", False), (CONE, "friction disc", False)]
    return out


def _item(item: tuple[str, str, bool]) -> str:
    color, text, dashed = item
    css = ' class="dash"' if dashed else ""
    return f'<li style="--c:{color}"{css}>{escape(text)}</li>'


def replay_data(
    plan: Plan,
    record: Record,
    goals: Sequence[Placed] = (),
    parts: Sequence[Record] = (),
) -> dict[str, Any]:
    """Data that the page plays, in [m], [deg] and [N], rounded to 0.1 mm, 0.01 deg and
    0.01 N.
    """
    task = plan.task
    arrays = record.arrays
    ticks = frames(arrays["time"])
    tips = np.moveaxis(arrays["tip_position"][ticks][:, :, :2], 1, 0)
    forces = np.nan_to_num(np.moveaxis(arrays["measured_force"][ticks], 1, 0))
    stages = list(parts) or [replace(record, plan=plan)]
    scene, own_ticks = scene_ticks(record, ticks)
    axles = []
    contacts: list[list[float | str | None]] = [[] for _ in task.robots]
    for number, stage in enumerate(stages):
        own = own_ticks[scene == number]
        axles += _axles(stage, own)
        found = _contacts(stage, own)
        contacts = [row + more for row, more in zip(contacts, found, strict=True)]
    return {
        **_support_data(task, goals or task_goals(task)),
        "scenes": list(map(_scene_data, stages)),
        "scene": scene.tolist(),
        "moving": (arrays["phase"][ticks] == PHASES.index("move")).tolist(),
        "pose": _degrees(arrays["object_pose"][ticks]),
        "reference": _degrees(arrays["reference_pose"][ticks]),
        "tips": np.round(tips, 4).tolist(),
        "forces": np.round(forces[:, :, :2], 2).tolist(),
        "loads": np.round(np.maximum(0.0, -forces[:, :, 2]), 2).tolist(),
        "contacts": contacts,
        "friction": task.contact_friction,
        "axles": axles,
    }


def scene_ticks(
    record: Record, ticks: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Stage number of each tick of a run, and the tick's index in its stage."""
    number = record.arrays.get("stage")
    if number is None:
        return np.zeros_like(ticks), ticks
    scene = number[ticks].astype(np.intp)
    first = np.searchsorted(number, scene, side="left")
    return scene, ticks - first


def _axles(record: Record, ticks: NDArray[np.intp]) -> list[list[float]]:
    """Poses X_GV of the tracking point at ticks of a stage, with the yaw in [deg]."""
    X_GB = record.plan.task.X_GB
    rows = record.arrays["vehicle_frame"][ticks]
    found = [X_GB.compose(Pose2(*map(float, row))) for row in rows]
    return [
        [round(X.x, 4), round(X.y, 4), round(math.degrees(X.yaw), 2)] for X in found
    ]


def _contacts(
    record: Record, ticks: NDArray[np.intp]
) -> list[list[float | str | None]]:
    """Direction [deg] of the push in the object's frame, for each arm and frame. "top"
    for a press, None without a contact.
    """
    plan = record.plan
    parts = plan.by_placement
    number = record.arrays["placement"][ticks].astype(int)
    out: list[list[float | str | None]] = []
    for arm in range(len(plan.task.robots)):
        row: list[float | str | None] = []
        for n in number:
            contact = next((c for c in parts[n].contacts if c.arm == arm), None)
            if contact is None:
                row.append(None)
            elif contact.kind == "top":
                row.append("top")
            else:
                x, y = plan.task.X_GB.rotate(contact.normal)
                row.append(round(math.degrees(math.atan2(y, x)), 2))
        out.append(row)
    return out


def _support_data(task: Task, goals: Sequence[Placed]) -> dict[str, Any]:
    """Data common to all stages: goals, tips, bases and the support."""
    aims = [[list(X.apply(c)) for c in shape.outline()] for shape, X in goals]
    bases = [robot.base for robot in task.robots if robot.model != "hand"]
    wall = not task.support.frame.faces_up
    return {
        "radii": [robot.tip_radius for robot in task.robots],
        "goals": aims,
        "region": [list(corner) for corner in task.support.region or ()],
        "bases": [] if wall else [[x, y] for x, y, _ in bases],
        "forceScale": FORCE_SCALE,
        "mirror": wall,  # on a wall x points to the left
    }


def _scene_data(record: Record) -> dict[str, Any]:
    """Data of one stage: the fixed bodies, the outline of the moved body, and its path."""
    task = record.plan.task
    outline = [[round(x, 5), round(y, 5)] for x, y in task.object.shape.outline()]
    obstacles = []
    for obstacle in task.obstacles:
        corners = obstacle.shape.outline()
        places = [list(obstacle.pose.apply(corner)) for corner in corners]
        name = OWN if obstacle.name == SET_DOWN else obstacle.name
        obstacles.append({"name": name, "corners": places})
    return {
        "outline": outline,
        "obstacles": obstacles,
        "path": np.round(record.arrays["plan_path"][:, :2], 4).tolist(),
    }


def _degrees(poses: Array) -> list[list[float]]:
    out = np.column_stack(
        [np.round(poses[:, :2], 4), np.round(np.degrees(poses[:, 2]), 2)]
    )
    plain: list[list[float]] = out.tolist()
    return plain
