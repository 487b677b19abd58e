"""Plans of a run on disk: plan.json, a list of stages with every choice considered, and
plan.png.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, asdict, fields, is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from pushpressslide.core.bodies import Stage
from pushpressslide.core.drive import Drive
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Restart, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.whole_file import write_whole
from pushpressslide.modes import MODES
from pushpressslide.report.json_text import to_json
from pushpressslide.report.stages import StagePlan, StageRun

SCHEMA = 8


def stages_to_dict(task: Task, stages: Sequence[StagePlan]) -> dict[str, Any]:
    """Stages of a task as plain data, as in plan.json.

    Each stage has its plan and all choices considered. A started stage also has its
    start time and start state.
    """
    return {
        "schema": SCHEMA,
        "task": task.name,
        "stages": [_stage_to_dict(task, stage) for stage in stages],
    }


def plan_to_dict(plan: Plan, choices: Sequence[Choice] = ()) -> dict[str, Any]:
    """A plan, without its task, as plain data.

    It contains the segments, those details of the planning that are not in the task
    file, the replans after a recovery, and the ``choices`` considered.
    """
    restart = plan.restart
    out: dict[str, Any] = {
        "searched": plan.from_search,
        "pushes": plan.may_push,
        "segments": [_segment_to_dict(segment) for segment in plan.segments],
        "restart": None if restart is None else _restart_to_dict(restart),
        "later": [plan_to_dict(later) for later in plan.later],
    }
    if choices:
        out["choices"] = [_choice_to_dict(choice) for choice in choices]
    return out


def plan_from_dict(data: Mapping[str, Any], task: Task) -> Plan:
    """Plan from the data of ``plan_to_dict``.

    Raises KeyError, TypeError or ValueError for any other data.
    """
    return _plan_from(data, Plan(task))


def _plan_from(data: Mapping[str, Any], before: Plan) -> Plan:
    """Plan from the data of ``plan_to_dict``, as a continuation of the plan ``before``."""
    if not data["segments"] and not before.at_goal:
        raise ValueError("a plan without segments")
    task = before.task
    searched = before.from_search
    restart = None
    if data["restart"] is not None:
        restart = _restart_from_dict(data["restart"])
        task = task.resumed(restart)
        searched = searched or restart.legs is not None
    plan = Plan(
        task,
        tuple(_segment_from_dict(item) for item in data["segments"]),
        restart,
        data.get("searched", searched),
        data.get("pushes", before.may_push),
    )
    later = plan
    for item in data["later"]:
        later = _plan_from(item, later)
        plan = plan.followed(later)
    return plan


def _restart_to_dict(restart: Restart) -> dict[str, Any]:
    """A restart as plain data, with the object's pose as its state."""
    data = asdict(restart)
    del data["state"]
    return {"leg": data.pop("leg"), "pose": asdict(restart.state.object), **data}


def _restart_from_dict(data: Mapping[str, Any]) -> Restart:
    """Restart from the data of ``_restart_to_dict``."""
    hints = get_type_hints(Restart)
    del hints["state"]
    values = {
        name: _of_type(kind, data[name]) for name, kind in hints.items() if name in data
    }
    return Restart(WorldState({OBJECT: _of_type(Pose2, data["pose"])}), **values)


def stage_from_dict(data: Mapping[str, Any], task: Task) -> StagePlan:
    """A stage from the data of ``stages_to_dict``. ``task`` is the task of the stage."""
    return StagePlan(
        purpose_from_dict(data), plan_from_dict(data, task), choices_from_dict(data)
    )


def purpose_from_dict(data: Mapping[str, Any]) -> Stage:
    """Purpose of a stage from the data of ``stages_to_dict``."""
    return Stage(data["body"], Pose2(**data["goal"]), data["aside"])


def choices_from_dict(data: Mapping[str, Any]) -> tuple[Choice, ...]:
    """Choices stored with a plan. Empty if none are stored."""
    return tuple(_choice_from_dict(item) for item in data.get("choices", ()))


def drive_to_dict(drive: Drive) -> dict[str, Any]:
    """A drive as plain data, with its class name under "drive"."""
    assert is_dataclass(drive)
    assert not isinstance(drive, type)
    return {"drive": type(drive).__name__, **asdict(drive)}


def write_plans(task: Task, stages: Sequence[StagePlan], out: Path) -> list[Path]:
    """Write plan.json and the pictures of the plans to folder ``out``. Return the paths
    of plan.json and of the pictures.
    """
    data = write_whole(out / "plan.json", to_json(stages_to_dict(task, stages)))
    return [data, *write_plan_pictures(stages, out)]


def write_plan_pictures(stages: Sequence[StagePlan], out: Path) -> list[Path]:
    """Write plan.png, legs.png for a plan of several motions, and object.png for a body
    from a mesh, to folder ``out``. Return the paths of the pictures.

    For several stages they are plan-1.png and so on.
    """
    from pushpressslide.report.filmstrip import filmstrip, motions
    from pushpressslide.report.object_figure import planned_object
    from pushpressslide.report.plane import plan_figure
    from pushpressslide.report.style import png

    older = ("plan*.png", "legs*.png", "object*.png")
    for path in (path for pattern in older for path in out.glob(pattern)):
        path.unlink()
    pictures = []
    for number, stage in enumerate(stages, start=1):
        which = f"-{number}" if len(stages) > 1 else ""
        if len(motions(stage.plan)) > 1:
            strip = png(filmstrip(stage.plan))
            pictures.append(write_whole(out / f"legs{which}.png", strip))
        body = planned_object(stage.plan)
        if body is not None:
            pictures.append(write_whole(out / f"object{which}.png", png(body)))
        picture = png(plan_figure(stage.plan))
        pictures.append(write_whole(out / f"plan{which}.png", picture))
    return pictures


def _stage_to_dict(task: Task, stage_plan: StagePlan) -> dict[str, Any]:
    """A stage as plain data. In a task with goals it includes the stage's own task."""
    from pushpressslide.taskfile.dump import task_data

    out: dict[str, Any] = asdict(stage_plan.stage)
    if isinstance(stage_plan, StageRun):
        out["began"] = stage_plan.began
        out["poses"] = {body: asdict(X) for body, X in stage_plan.state.poses.items()}
        out["planned_anew"] = stage_plan.anew
    if task.goals:
        out["task"] = task_data(stage_plan.plan.task)
    return out | plan_to_dict(stage_plan.plan, stage_plan.choices)


def _segment_to_dict(segment: Segment) -> dict[str, Any]:
    return {
        "mode": segment.mode,
        "contacts": [asdict(contact) for contact in segment.contacts],
        "drive": drive_to_dict(segment.drive),
        "path": _path_to_dict(segment.path),
        "profile": asdict(segment.profile),
        "goal": _pose_to_list(segment.goal),
        "cone_margin": segment.cone_margin,
        "leg": segment.leg,
    }


def _segment_from_dict(data: Mapping[str, Any]) -> Segment:
    mode = data["mode"]
    return Segment(
        mode,
        _contacts_from(data["contacts"]),
        _drive_from_dict(mode, data["drive"]),
        _path_from_dict(data["path"]),
        SpeedProfile(**data["profile"]),
        Pose2(*data["goal"]),
        data["cone_margin"],
        data["leg"],
    )


def _choice_to_dict(choice: Choice) -> dict[str, Any]:
    return {
        "mode": choice.mode,
        "label": choice.label,
        "feasible": choice.feasible,
        "reason": choice.reason,
        "contacts": [asdict(contact) for contact in choice.contacts],
        "segments": [_segment_to_dict(segment) for segment in choice.segments],
        "time": choice.time,
        "merits": choice.summary,
        "refusal": None if choice.refusal is None else asdict(choice.refusal),
        "leg": choice.leg,
    }


def _choice_from_dict(data: Mapping[str, Any]) -> Choice:
    refusal = data["refusal"]
    return Choice(
        data["mode"],
        data["label"],
        _contacts_from(data["contacts"]),
        tuple(_segment_from_dict(item) for item in data["segments"]),
        data["time"],
        data["merits"],
        None if refusal is None else Refusal(**refusal),
        data["leg"],
    )


def _contacts_from(data: Sequence[Mapping[str, Any]]) -> tuple[Contact, ...]:
    return tuple(
        Contact(**{**c, "point": tuple(c["point"]), "normal": tuple(c["normal"])})
        for c in data
    )


def _drive_from_dict(mode: str, data: Mapping[str, Any]) -> Drive:
    """Drive of a mode, of the class named in the data."""
    kinds = {kind.__name__: kind for kind in MODES[mode].drives}
    drive: Drive = _of_type(kinds[data["drive"]], data)
    return drive


def _of_type(kind: Any, data: Any) -> Any:
    """Plain ``data`` converted to ``kind``: a dataclass, a tuple, a plain value, or
    None if allowed.
    """
    if isinstance(kind, UnionType):
        others = [part for part in get_args(kind) if part is not NoneType]
        return data if data is None else _of_type(others[0], data)
    if is_dataclass(kind):
        if not isinstance(data, Mapping):
            raise TypeError(f"{data!r} is no mapping")
        hints = get_type_hints(kind)
        values = {
            field.name: _of_type(hints[field.name], data[field.name])
            for field in fields(kind)
            if field.name in data or field.default is MISSING
        }
        assert callable(kind)
        return kind(**values)
    if get_origin(kind) is tuple:
        parts = get_args(kind)
        if parts[-1] is ...:  # any number of one kind
            parts = parts[:1] * len(data)
        pairs = zip(parts, data, strict=True)
        return tuple(_of_type(part, value) for part, value in pairs)
    return data


def _pose_to_list(pose: Pose2) -> list[float]:
    return [pose.x, pose.y, pose.yaw]


def _path_to_dict(path: MotionPath) -> dict[str, Any]:
    """A path as plain data: arcs as (curvature, length), or constant twists as (vx, vy,
    w, length) with their radius.
    """
    if isinstance(path, ArcPath):
        return {
            "start": _pose_to_list(path.start),
            "pieces": [list(segment) for segment in path.sections],
        }
    pieces = [[*rate, length] for rate, length in path.sections]
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
