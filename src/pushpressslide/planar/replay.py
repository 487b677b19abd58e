"""The planar engine's replay: one HTML page that plays a run seen from above, offline,
without Drake.
"""

from __future__ import annotations

import json
import math
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole

FRAMES_PER_SECOND = 30
FORCE_SCALE = 0.02  # [m/N] length of the force arrows


def write_replay(plan: Plan, record: Record, out: Path) -> Path:
    """Write the page to the file ``out``, whole or not at all, and return its path.

    In a folder ``out`` it is replay.html.
    """
    data = json.dumps(replay_data(plan, record), separators=(",", ":"), allow_nan=False)
    template = (
        resources.files("pushpressslide.planar")
        .joinpath("replay_page.html")
        .read_text("utf-8")
    )
    page = template.replace("@TITLE@", escape(plan.task.name)).replace(
        '"@DATA@"', data.replace("</", "<\\/")
    )
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def replay_data(plan: Plan, record: Record) -> dict[str, Any]:
    """Return what the page plays: metres, degrees and newtons, rounded to 0.1 mm, 0.01
    degree and 0.01 N.
    """
    task = plan.task
    arrays = record.arrays
    time = arrays["time"]
    frames = _frames(time)
    pose = arrays["object_pose"][frames]
    axles = [
        task.X_GB.compose(Pose2(*map(float, row)))
        for row in arrays["vehicle_frame"][frames]
    ]
    tips = np.moveaxis(arrays["tip_position"][frames][:, :, :2], 1, 0)
    forces = np.nan_to_num(np.moveaxis(arrays["measured_force"][frames], 1, 0))
    contacts = [
        contact for placement in plan.by_placement for contact in placement.contacts
    ]
    return {
        **_scene_data(task),
        "time": np.round(time[frames] - time[0], 3).tolist() if len(time) else [],
        "phase": [PHASES[int(p)] for p in arrays["phase"][frames]],
        "pose": _degrees(pose),
        "reference": _degrees(arrays["reference_pose"][frames]),
        "tips": np.round(tips, 4).tolist(),
        "forces": np.round(forces[:, :, :2], 2).tolist(),
        "loads": np.round(np.maximum(0.0, -forces[:, :, 2]), 2).tolist(),
        "pressing": [
            any(c.arm == i and c.kind == "top" for c in contacts)
            for i in range(len(task.robots))
        ],
        "path": np.round(arrays["plan_path"][:, :2], 4).tolist(),
        "axles": [
            [round(X.x, 4), round(X.y, 4), round(math.degrees(X.yaw), 2)] for X in axles
        ],
        "reason": record.reason,
        "mode": ", ".join(record.modes),
    }


def _scene_data(task: Task) -> dict[str, Any]:
    """Return what does not move: outlines, goal, obstacles and bases."""
    outline = [[round(x, 5), round(y, 5)] for x, y in task.object.shape.outline()]
    obstacles = []
    for obstacle in task.obstacles:
        corners = obstacle.shape.outline()
        places = [list(obstacle.pose.apply(corner)) for corner in corners]
        obstacles.append({"name": obstacle.name, "corners": places})
    bases = [robot.base for robot in task.robots if robot.model != "hand"]
    wall = not task.support.frame.faces_up
    return {
        "radii": [robot.tip_radius for robot in task.robots],
        "outline": outline,
        "goal": [task.goal.x, task.goal.y, math.degrees(task.goal.yaw)],
        "tolerance": task.tolerance.position,
        "obstacles": obstacles,
        "region": [list(corner) for corner in task.support.region or ()],
        "bases": [] if wall else [[x, y] for x, y, _ in bases],
        "forceScale": FORCE_SCALE,
        "mirror": wall,  # on a wall x points to the left
    }


def _frames(time: Array) -> NDArray[np.intp]:
    """Ticks nearest to an even grid of ``FRAMES_PER_SECOND``, first and last included."""
    if len(time) < 2:
        return np.arange(len(time))
    grid = np.linspace(
        time[0], time[-1], max(2, math.ceil((time[-1] - time[0]) * FRAMES_PER_SECOND))
    )
    return np.unique(np.clip(np.searchsorted(time, grid), 0, len(time) - 1))


def _degrees(poses: Array) -> list[list[float]]:
    out = np.column_stack(
        [np.round(poses[:, :2], 4), np.round(np.degrees(poses[:, 2]), 2)]
    )
    plain: list[list[float]] = out.tolist()
    return plain
