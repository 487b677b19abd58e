"""A Task back to the text of a task file, with every field resolved, in the file's
layout and units.
"""

from __future__ import annotations

import math
from typing import Any

import yaml

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, Motion, Shape, Support, Task


def degrees(radians: float) -> float:
    """Return the angle [deg] that math.radians turns back into the same ``radians``, if
    there is one.
    """
    value = math.degrees(radians)
    candidates = [round(value, digits) for digits in (0, 1, 2, 3, 4, 6, 8, 10, 12)] + [
        value
    ]
    down = up = value
    for _ in range(4):
        down = math.nextafter(down, -math.inf)
        up = math.nextafter(up, math.inf)
        candidates += [down, up]
    return next((c for c in candidates if math.radians(c) == radians), value)


def _pose(pose: Pose2) -> dict[str, float]:
    return {"x": pose.x, "y": pose.y, "yaw_deg": degrees(pose.yaw)}


def _shape(shape: Shape) -> dict[str, Any]:
    if isinstance(shape, Box):
        return {"box": list(shape.size)}
    if isinstance(shape, Cylinder):
        return {"cylinder": {"radius": shape.radius, "height": shape.height}}
    return {
        "prism": {
            "polygon": [list(corner) for corner in shape.corners],
            "height": shape.height,
        }
    }


def _support(support: Support) -> dict[str, Any]:
    out: dict[str, Any] = {"kind": support.kind, "friction": support.friction}
    if support.kind == "wall":
        x, y, z = support.frame.origin
        frame = support.frame
        opening = support.opening
        heading = math.atan2(frame.axes[1][2], frame.axes[0][2])
        out["pose"] = {"x": x, "y": y, "z": z, "yaw_deg": degrees(heading)}
        if opening is not None:
            (cx, cy) = opening.center
            out["opening"] = {
                "size": list(opening.size),
                "pose": {"x": cx, "y": cy},
                "depth": opening.depth,
            }
    return out


def _limits(task: Task) -> dict[str, Any]:
    region = task.limits.workspace
    workspace = (
        None if region is None else {"x": list(region[:2]), "y": list(region[2:])}
    )
    return {
        "time": task.limits.time,
        "normal_force": task.limits.normal_force,
        "workspace": workspace,
    }


def _belief(task: Task) -> dict[str, Any]:
    """Only what differs from the truth, so that a changed truth in the file is also
    believed.
    """
    told = task.believed
    pairs = {
        "support_friction": (told.support_friction, task.support.friction),
        "contact_friction": (told.contact_friction, task.contact_friction),
        "mass": (told.mass, task.object.mass),
    }
    return {
        **{name: (a if a != b else None) for name, (a, b) in pairs.items()},
        "rho": told.rho,
    }


def _motion(motion: Motion) -> dict[str, Any]:
    return {name: getattr(motion, name) for name in Motion.__dataclass_fields__}


def task_data(task: Task) -> dict[str, Any]:
    """Return the task as plain data in the layout and units of the file."""
    return {
        "name": task.name,
        "description": task.description,
        "support": _support(task.support),
        "object": {
            "shape": _shape(task.object.shape),
            "mass": task.object.mass,
            "center_of_mass": list(task.object.center_of_mass),
        },
        "contact": {"friction": task.contact_friction},
        "start": _pose(task.start),
        "goal": _pose(task.goal)
        if task.tool is None
        else {**_pose(task.tool.goal), "body": task.tool.body},
        **({} if task.tool is None else {"tool": {"face": task.tool.face}}),
        "tolerance": {
            "position": task.tolerance.position,
            "yaw_deg": degrees(task.tolerance.yaw),
        },
        "robots": [
            {
                "model": r.model,
                "base": {
                    "x": r.base[0],
                    "y": r.base[1],
                    "z": r.base[2],
                    "yaw_deg": degrees(r.base_yaw),
                },
                "tip_frame": r.tip_frame,
                "tip_radius": r.tip_radius,
                "tip_length": r.tip_length,
            }
            for r in task.robots
        ],
        "obstacles": [
            {
                "name": o.name,
                "box": list(o.size),
                "pose": _pose(o.pose),
                "movable": o.movable,
                "mass": o.mass,
                "friction": o.friction,
            }
            for o in task.obstacles
        ],
        "modes": None if task.modes is None else list(task.modes),
        "limits": _limits(task),
        "belief": _belief(task),
        "start_error": _pose(task.start_error),
        "sensing": {
            "position_noise": task.sensing.position_noise,
            "yaw_noise_deg": degrees(task.sensing.yaw_noise),
            "force_noise": task.sensing.force_noise,
            "delay": task.sensing.delay,
        },
        "motion": _motion(task.motion),
        "legs": [
            {
                "mode": leg.mode,
                "pose": None if leg is task.legs[-1] else _pose(leg.goal),
                "motion": _motion(leg.motion),
            }
            for leg in task.legs
        ]
        or None,
    }


def dump_task(task: Task) -> str:
    """Return the YAML text of a task, every default written out; it loads again to an
    equal task.
    """
    return yaml.safe_dump(
        task_data(task),
        sort_keys=False,
        default_flow_style=None,
        width=110,
        allow_unicode=True,
    )
