"""The task of a run as an HTML table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Obstacle, Robot, Task
from pushpressslide.report.page_tables import table


def task_table(task: Task, result: Mapping[str, Any]) -> str:
    """Object, frictions, poses, robots and engine of a run."""
    rows = [
        ("Object", f"{task.object.shape.description}, {_mass(task)}"),
        ("Friction", _frictions(task)),
        ("Start", _pose(task.start)),
    ]
    if task.start_error != Pose2(0.0, 0.0, 0.0):
        rows.append(("True start, off by", _pose(task.start_error)))
    if task.goals:
        wanted = "; ".join(f"{g.body} to {_pose(g.pose)}" for g in task.goals)
        rows.append(("Goals", wanted))
    else:
        rows.append(("Goal", _pose(task.goal)))
    tool = task.tool
    if tool is not None:
        goal = f"{_pose(tool.goal)}, pushed by face {tool.face}"
        rows.append((f"Goal of {tool.body}", goal))
    tolerance = task.tolerance
    within = f"{1e3 * tolerance.position:g} mm, {math.degrees(tolerance.yaw):g}°"
    rows.append(("Tolerance", within))
    rows.append(("Robots", "; ".join(map(_robot, task.robots))))
    if task.obstacles:
        rows.append(("Obstacles", ", ".join(map(_obstacle, task.obstacles))))
    rows.append(("Engine", _engine(result)))
    cells = [
        [f"<th scope=row>{escape(name)}</th>", f"<td>{escape(text)}</td>"]
        for name, text in rows
    ]
    return table((), cells)


def _mass(task: Task) -> str:
    return _with_belief(task.object.mass, task.scene.body.mass, " kg")


def _frictions(task: Task) -> str:
    told = task.scene
    support = _with_belief(task.support.friction, told.support.friction)
    tip = _with_belief(task.contact_friction, told.contact_friction)
    return f"{task.support.kind} {support}, end effector {tip}"


def _with_belief(true: float, belief: float, unit: str = "") -> str:
    text = f"{true:g}{unit}"
    if belief != true:
        text += f" (believed {belief:g}{unit})"
    return text


def _pose(pose: Pose2) -> str:
    return f"({pose.x:.3f}, {pose.y:.3f}) m, {math.degrees(pose.yaw):.1f}°"


def _robot(robot: Robot) -> str:
    name = Path(robot.model).name
    if robot.model == "hand":
        return name
    x, y, z = robot.base
    return f"{name} at ({x:g}, {y:g}, {z:g}) m"


def _obstacle(obstacle: Obstacle) -> str:
    if obstacle.movable:
        return f"{obstacle.name} (can move)"
    return obstacle.name


def _engine(result: Mapping[str, Any]) -> str:
    text = f"{result['engine']}, seed {result['seed']}"
    step = result.get("time_step")
    if not step:
        return text
    return f"{text}, time step {1e3 * step:g} ms"
