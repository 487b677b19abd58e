"""A plan on disk: plan.json, with every choice that was weighed, and plan.png."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import style
from pushpressslide.report.json_text import to_json

SCHEMA = 3


def plan_to_dict(plan: Plan, choices: Sequence[Choice] = ()) -> dict[str, Any]:
    """Return a plan, less its task, as plain data; ``choices`` are all that selection
    weighed.
    """
    out: dict[str, Any] = {
        "schema": SCHEMA,
        "task": plan.task.name,
        "grasps": [
            {
                "choice": _choice_to_dict(grasp.choice),
                "stretches": [_stretch_to_dict(stretch) for stretch in grasp.stretches],
            }
            for grasp in plan.grasps
        ],
    }
    if choices:
        out["choices"] = [_choice_to_dict(choice) for choice in choices]
    return out


def plan_from_dict(data: Mapping[str, Any], task: Task) -> Plan:
    """Return the plan of ``plan_to_dict``; raises KeyError, TypeError or ValueError on
    other data.
    """
    if data["schema"] != SCHEMA:
        raise ValueError(f"schema {data['schema']}, this version reads {SCHEMA}")
    grasp = None
    for one in reversed(data["grasps"]):
        grasp = _grasp_from_dict(one, task, grasp)
    if grasp is None:
        raise ValueError("a plan without grasps")
    return grasp


def _grasp_from_dict(data: Mapping[str, Any], task: Task, after: Plan | None) -> Plan:
    plan = None
    choices = _choice_from_dict(data["choice"]).stretches
    for choice, stretch in reversed(list(zip(choices, data["stretches"], strict=True))):
        path = _path_from_dict(stretch["path"])
        profile = SpeedProfile(**stretch["profile"])
        plan = Plan(
            task.parts[choice.leg], choice, path, profile, Pose2(*stretch["X_BV"]), plan
        )
    if plan is None:
        raise ValueError("a plan without stretches")
    return replace(plan, next_grasp=after)


def _stretch_to_dict(stretch: Plan) -> dict[str, Any]:
    profile = stretch.profile
    return {
        "path": _path_to_dict(stretch.path),
        "profile": {
            "length": profile.length,
            "speed": profile.speed,
            "acceleration": profile.acceleration,
        },
        "X_BV": _pose_to_list(stretch.X_BV),
    }


def choices_from_dict(data: Mapping[str, Any]) -> tuple[Choice, ...]:
    """Return the choices that were stored beside a plan; empty if none were."""
    return tuple(_choice_from_dict(entry) for entry in data.get("choices", ()))


def write_plan(
    plan: Plan, out: Path, choices: Sequence[Choice] = ()
) -> tuple[Path, Path]:
    """Write plan.json and plan.png to folder ``out``; return their paths."""
    from pushpressslide.report.plane import plan_figure

    return (
        write_whole(out / "plan.json", to_json(plan_to_dict(plan, choices))),
        write_whole(out / "plan.png", style.png(plan_figure(plan))),
    )


def _pose_to_list(pose: Pose2) -> list[float]:
    return [pose.x, pose.y, pose.yaw]


def _path_to_dict(path: MotionPath) -> dict[str, Any]:
    """Arcs as (curvature, length), constant twists as (vx, vy, w, length) with their
    radius.
    """
    if isinstance(path, ArcPath):
        return {
            "start": _pose_to_list(path.start),
            "pieces": [list(piece) for piece in path.pieces],
        }
    pieces = [[*rate, length] for rate, length in path.pieces]
    return {"start": _pose_to_list(path.start), "pieces": pieces, "radius": path.radius}


def _path_from_dict(data: Mapping[str, Any]) -> MotionPath:
    start = Pose2(*data["start"])
    if "radius" not in data:
        return ArcPath(
            start, tuple((float(k), float(length)) for k, length in data["pieces"])
        )
    pieces = tuple(
        ((float(x), float(y), float(w)), float(length))
        for x, y, w, length in data["pieces"]
    )
    return TwistPath(start, pieces, float(data["radius"]))


def _choice_to_dict(choice: Choice) -> dict[str, Any]:
    return {
        "mode": choice.mode,
        "feasible": choice.feasible,
        "reason": choice.reason,
        "contacts": [
            {
                "arm": c.arm,
                "kind": c.kind,
                "point": list(c.point),
                "normal": list(c.normal),
                "height": c.height,
                "load": c.load,
            }
            for c in choice.contacts
        ],
        "path_length": choice.path_length,
        "time": choice.time,
        "friction_margin": choice.friction_margin,
        "parameters": dict(choice.parameters),
        "path": None if choice.path is None else _path_to_dict(choice.path),
        "goal": None if choice.goal is None else _pose_to_list(choice.goal),
        "leg": choice.leg,
        "judged": choice.judged,
        "following": None
        if choice.following is None
        else _choice_to_dict(choice.following),
    }


def _choice_from_dict(data: Mapping[str, Any]) -> Choice:
    contacts = tuple(
        Contact(**{**c, "point": tuple(c["point"]), "normal": tuple(c["normal"])})
        for c in data["contacts"]
    )
    path = None if data["path"] is None else _path_from_dict(data["path"])
    return Choice(
        data["mode"],
        data["feasible"],
        data["reason"],
        contacts,
        data["path_length"],
        data["time"],
        data["friction_margin"],
        data["parameters"],
        path,
        None if data["goal"] is None else Pose2(*data["goal"]),
        None if data["following"] is None else _choice_from_dict(data["following"]),
        data["leg"],
        data["judged"],
    )
