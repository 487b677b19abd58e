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

from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.core.whole_file import write_whole

FRAMES_PER_SECOND = 30
FORCE_SCALE = 0.02  # [m/N] length of the force arrows
ROUND_SIDES = 48


def write_replay(task: Task, plan: Plan, record: Record, out: Path) -> Path:
    """Write the page to the file ``out`` (a folder: to replay.html in it), whole or not
    at all; return it.
    """
    data = json.dumps(
        replay_data(task, plan, record), separators=(",", ":"), allow_nan=False
    )
    template = (
        resources.files("pushpressslide.planar")
        .joinpath("replay_page.html")
        .read_text("utf-8")
    )
    page = template.replace("@TITLE@", escape(task.name)).replace(
        '"@DATA@"', data.replace("</", "<\\/")
    )
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def replay_data(task: Task, plan: Plan, record: Record) -> dict[str, Any]:
    """Return what the page plays: metres, degrees and newtons, rounded to 0.1 mm, 0.01
    degree and 0.01 N.
    """
    arrays = record.arrays
    time = arrays["time"]
    frames = _frames(time)
    pose = arrays["object_pose"][frames]
    axles = [
        task.object.X_GB.compose(Pose2(*map(float, row)))
        for row in arrays["vehicle_frame"][frames]
    ]
    tips = np.moveaxis(arrays["tip_position"][frames][:, :, :2], 1, 0)
    forces = np.nan_to_num(np.moveaxis(arrays["measured_force"][frames], 1, 0))
    contacts = [contact for grasp in plan.by_placement for contact in grasp.contacts]
    obstacles = []
    for obstacle in task.obstacles:
        a = 0.5 * obstacle.size[0]
        b = 0.5 * obstacle.size[1]
        corners = [
            list(obstacle.pose.apply(c)) for c in ((-a, -b), (a, -b), (a, b), (-a, b))
        ]
        obstacles.append({"name": obstacle.name, "corners": corners})
    return {
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
        "radii": [robot.tip_radius for robot in task.robots],
        "path": np.round(arrays["plan_path"][:, :2], 4).tolist(),
        "axles": [
            [round(X.x, 4), round(X.y, 4), round(math.degrees(X.yaw), 2)] for X in axles
        ],
        "outline": _outline(task),
        "goal": [task.goal.x, task.goal.y, math.degrees(task.goal.yaw)],
        "tolerance": task.tolerance.position,
        "obstacles": obstacles,
        "bases": [
            [r.base[0], r.base[1]]
            for r in task.robots
            if r.model != "hand" and task.support.kind == "table"
        ],
        "forceScale": FORCE_SCALE,
        "mirror": task.support.kind == "wall",  # on a wall x points to the left
        "reason": record.reason,
        "mode": ", ".join(record.modes),
    }


def _frames(time: NDArray[np.float64]) -> NDArray[np.intp]:
    """Ticks nearest to an even grid of ``FRAMES_PER_SECOND``, first and last included."""
    if len(time) < 2:
        return np.arange(len(time))
    grid = np.linspace(
        time[0], time[-1], max(2, math.ceil((time[-1] - time[0]) * FRAMES_PER_SECOND))
    )
    return np.unique(np.clip(np.searchsorted(time, grid), 0, len(time) - 1))


def _degrees(poses: NDArray[np.float64]) -> list[list[float]]:
    out = np.column_stack(
        [np.round(poses[:, :2], 4), np.round(np.degrees(poses[:, 2]), 2)]
    )
    plain: list[list[float]] = out.tolist()
    return plain


def _outline(task: Task) -> list[list[float]]:
    shape = task.object.shape
    if isinstance(shape, Cylinder):
        angles = [2.0 * math.pi * i / ROUND_SIDES for i in range(ROUND_SIDES)]
        return [
            [round(shape.radius * math.cos(a), 5), round(shape.radius * math.sin(a), 5)]
            for a in angles
        ]
    return [list(corner) for corner in shape.footprint]
