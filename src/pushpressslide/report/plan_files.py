"""A plan on disk: plan.json, with every choice that was weighed, and plan.png."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task

SCHEMA = 1


def plan_to_dict(plan: Plan, choices: Sequence[Choice] = ()) -> dict[str, Any]:
    """Return a plan, less its task, as plain data; ``choices`` are all that selection weighed."""
    out: dict[str, Any] = {
        "schema": SCHEMA,
        "task": plan.task.name,
        "choice": _choice_to_dict(plan.choice),
        "path": _path_to_dict(plan.path),
        "profile": {
            "length": plan.profile.length,
            "speed": plan.profile.speed,
            "acceleration": plan.profile.acceleration,
        },
        "X_BV": _pose_to_list(plan.X_BV),
    }
    if choices:
        out["choices"] = [_choice_to_dict(choice) for choice in choices]
    return out


def plan_from_dict(data: Mapping[str, Any], task: Task) -> Plan:
    """Return the plan of ``plan_to_dict``; raises KeyError, TypeError or ValueError on other data."""
    if data["schema"] != SCHEMA:
        raise ValueError(f"schema {data['schema']}, this version reads {SCHEMA}")
    return Plan(
        task,
        _choice_from_dict(data["choice"]),
        _path_from_dict(data["path"]),
        SpeedProfile(**data["profile"]),
        Pose2(*data["X_BV"]),
    )


def choices_from_dict(data: Mapping[str, Any]) -> tuple[Choice, ...]:
    """Return the choices that were stored beside a plan; empty if none were."""
    return tuple(_choice_from_dict(entry) for entry in data.get("choices", ()))


def write_plan(plan: Plan, out: Path, choices: Sequence[Choice] = ()) -> tuple[Path, Path]:
    """Write plan.json and plan.png to folder ``out``; return their paths."""
    from pushpressslide.core.whole_file import write_whole
    from pushpressslide.report.files import to_json
    from pushpressslide.report.plane import plan_figure
    from pushpressslide.report.style import png

    return (
        write_whole(out / "plan.json", to_json(plan_to_dict(plan, choices))),
        write_whole(out / "plan.png", png(plan_figure(plan))),
    )


def _pose_to_list(pose: Pose2) -> list[float]:
    return [pose.x, pose.y, pose.yaw]


def _path_to_dict(path: ArcPath) -> dict[str, Any]:
    return {"start": _pose_to_list(path.start), "pieces": [list(piece) for piece in path.pieces]}


def _path_from_dict(data: Mapping[str, Any]) -> ArcPath:
    return ArcPath(Pose2(*data["start"]), tuple((float(k), float(length)) for k, length in data["pieces"]))


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
            }
            for c in choice.contacts
        ],
        "path_length": choice.path_length,
        "time": choice.time,
        "friction_margin": choice.friction_margin,
        "parameters": dict(choice.parameters),
        "path": None if choice.path is None else _path_to_dict(choice.path),
    }


def _choice_from_dict(data: Mapping[str, Any]) -> Choice:
    contacts = tuple(
        Contact(
            c["arm"], c["kind"], (c["point"][0], c["point"][1]), (c["normal"][0], c["normal"][1]), c["height"]
        )
        for c in data["contacts"]
    )
    path = None if data["path"] is None else _path_from_dict(data["path"])
    return Choice(
        data["mode"], data["feasible"], data["reason"], contacts, data["path_length"], data["time"],
        data["friction_margin"], data["parameters"], path,
    )  # fmt: skip
