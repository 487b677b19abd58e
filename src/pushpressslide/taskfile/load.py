"""Task files: YAML to a checked Task, and back. Every field, range and default is in
task_schema.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.polygon import centroid, convexity_fault, signed_area
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import (
    Belief,
    Box,
    Cylinder,
    Limits,
    Motion,
    ObjectModel,
    Obstacle,
    Opening,
    Prism,
    Robot,
    Sensing,
    Shape,
    Support,
    Task,
    Tolerance,
)
from pushpressslide.selection.tool_use import tool_use
from pushpressslide.taskfile.checks import MODELS, check, check_wall
from pushpressslide.taskfile.dump import dump_task
from pushpressslide.taskfile.legs import inherited, legs
from pushpressslide.taskfile.reader import nearest, read
from pushpressslide.taskfile.schema import SCHEMA
from pushpressslide.taskfile.yaml_text import apply_overrides, read_yaml

__all__ = ["dump_task", "load_task", "shipped_tasks", "task_from_data"]

_SHIPPED = Path(__file__).parent.parent / "tasks"


def shipped_tasks() -> dict[str, Path]:
    """Return the tasks that come with the package: name to file, by name."""
    return {
        path.stem: path
        for path in sorted(_SHIPPED.glob("*.yaml"), key=lambda path: path.stem)
    }


def load_task(name_or_path: str | Path, overrides: Sequence[str] = ()) -> Task:
    """Return the complete, checked task of a shipped name or of a YAML file.

    Args:
        name_or_path: name of a shipped task, or path of a YAML file.
        overrides: ``a.b=c`` each, the value as YAML, in the file's units.

    Raises:
        TaskError: one line that names the file, the field, the value and what is
        allowed.
    """
    shipped = shipped_tasks()
    path = shipped.get(str(name_or_path)) or Path(name_or_path)
    if path.parent == Path() and not path.suffix and not path.exists():
        raise TaskError(
            str(name_or_path),
            "",
            name_or_path,
            "no such task; allowed: the path of a YAML file, or the name of a shipped "
            "task; " + nearest(name_or_path, shipped),
        )
    data = read_yaml(path)
    apply_overrides(data, overrides)
    return task_from_data(data, str(path))


def task_from_data(data: Mapping[str, Any], source: str) -> Task:
    """Return the checked task of plain data in the file's layout and units; ``source``
    names it in messages.

    Raises:
        TaskError: as :func:`load_task`.
    """
    d = read(SCHEMA, inherited(data), "", source)
    belief = d["belief"]
    contact_friction = d["contact"]["friction"]
    model = ObjectModel(*_object(d["object"], source))
    obstacles = _obstacles(d["obstacles"], source)
    tool, goal = tool_use(d, model, obstacles, source)
    task = Task(
        name=d["name"],
        object=model,
        start=_pose(d["start"]),
        goal=goal,
        robots=tuple(_robot(r, i, source) for i, r in enumerate(d["robots"])),
        support=_support(d["support"], source),
        contact_friction=contact_friction,
        tolerance=Tolerance(
            d["tolerance"]["position"], math.radians(d["tolerance"]["yaw_deg"])
        ),
        obstacles=obstacles,
        tool=tool,
        modes=d["modes"],
        legs=legs(d, goal, source),
        limits=_limits(d["limits"], source),
        belief=Belief(
            _told(belief["support_friction"], d["support"]["friction"]),
            _told(belief["contact_friction"], contact_friction),
            _told(belief["mass"], model.mass),
            belief["rho"],
        ),
        start_error=_pose(d["start_error"]),
        sensing=Sensing(
            d["sensing"]["position_noise"],
            math.radians(d["sensing"]["yaw_noise_deg"]),
            d["sensing"]["force_noise"],
            d["sensing"]["delay"],
        ),
        motion=Motion(**d["motion"]),
        description=" ".join(d["description"].split()),
        source=source,
    )
    check_wall(task)
    for part in task.parts:
        check(part)
    return task


def _support(d: Mapping[str, Any], source: str) -> Support:
    pose = d["pose"]
    opening = d["opening"]
    if d["kind"] == "table":
        for name in ("pose", "opening"):
            if d[name] is not None:
                allowed = f"only a wall has one; allowed for a table: leave support.{name} out"
                raise TaskError(source, f"support.{name}", d[name], allowed)
        return Support("table", d["friction"])
    if pose is None:
        raise TaskError(
            source, "support.pose", None, "it is missing; allowed: the pose of the wall"
        )
    frame = SupportFrame.of_wall(
        (pose["x"], pose["y"], pose["z"]), math.radians(pose["yaw_deg"])
    )
    hole = None
    if opening is not None:
        hole = Opening(
            opening["size"],
            (opening["pose"]["x"], opening["pose"]["y"]),
            opening["depth"],
        )
    return Support("wall", d["friction"], frame, hole)


def _told(value: float | None, truth: float) -> float:
    return truth if value is None else value


def _pose(d: Mapping[str, Any]) -> Pose2:
    return Pose2(d["x"], d["y"], math.radians(d["yaw_deg"]))


def _object(
    d: Mapping[str, Any], source: str
) -> tuple[Shape, float, tuple[float, float]]:
    shape, middle = _shape(d["shape"], source)
    com = d["center_of_mass"]
    if com is not None and shape.depth(com) <= 0.0:
        allowed = f"allowed: a point inside the footprint, here {-shape.depth(com):.4g} m outside"
        raise TaskError(source, "object.center_of_mass", list(com), allowed)
    return shape, d["mass"], com if com is not None else middle


def _shape(d: Mapping[str, Any], source: str) -> tuple[Shape, tuple[float, float]]:
    """Return the shape and its centroid [m] in G."""
    given = [name for name, value in d.items() if value is not None]
    if len(given) != 1:
        raise TaskError(
            source, "object.shape", given, f"allowed: exactly one of {', '.join(d)}"
        )
    if d["box"] is not None:
        return Box(d["box"]), (0.0, 0.0)
    if d["cylinder"] is not None:
        return Cylinder(d["cylinder"]["radius"], d["cylinder"]["height"]), (0.0, 0.0)
    polygon = d["prism"]["polygon"]
    fault = convexity_fault(polygon)
    if fault is not None:
        allowed = f"{fault}; allowed: a convex polygon of at least 3 distinct corners, in order"
        raise TaskError(
            source, "object.shape.prism.polygon", [list(p) for p in polygon], allowed
        )
    if signed_area(polygon) < 0.0:
        polygon = polygon[:1] + polygon[:0:-1]
    return Prism(polygon, d["prism"]["height"]), centroid(polygon)


def _robot(d: Mapping[str, Any], i: int, source: str) -> Robot:
    model = d["model"]
    base = d["base"]
    if model not in MODELS:
        path = Path(source).parent / model
        if path.suffix.lower() not in (".urdf", ".sdf"):
            allowed = (
                f"allowed: {', '.join(MODELS)}, or the path of a .urdf or .sdf file; "
                f"{nearest(model, MODELS)}"
            )
            raise TaskError(source, f"robots[{i}].model", model, allowed)
        if not path.is_file():
            raise TaskError(
                source,
                f"robots[{i}].model",
                model,
                f"no such file; allowed: {', '.join(MODELS)} or a path",
            )
        if d["tip_frame"] is None:
            allowed = (
                "it is missing; allowed: the name of the frame at the tip, as the "
                "model is given by path"
            )
            raise TaskError(source, f"robots[{i}].tip_frame", None, allowed)
        model = str(path.resolve())
    position = (base["x"], base["y"], base["z"])
    return Robot(
        model,
        position,
        math.radians(base["yaw_deg"]),
        d["tip_frame"],
        d["tip_radius"],
        d["tip_length"],
    )


def _obstacles(items: Sequence[Mapping[str, Any]], source: str) -> tuple[Obstacle, ...]:
    names = ["object"]
    for i, d in enumerate(items):
        if d["name"] in names:
            allowed = f"allowed: a name of its own, not one of {', '.join(names)}"
            raise TaskError(source, f"obstacles[{i}].name", d["name"], allowed)
        names.append(d["name"])
    return tuple(
        Obstacle(
            d["name"],
            d["box"],
            _pose(d["pose"]),
            d["movable"],
            d["mass"],
            d["friction"],
        )
        for d in items
    )


def _limits(d: Mapping[str, Any], source: str) -> Limits:
    region = d["workspace"]
    if region is None:
        return Limits(d["time"], d["normal_force"])
    for axis in ("x", "y"):
        if not region[axis][0] < region[axis][1]:
            allowed = "allowed: [lower, upper] with lower < upper"
            raise TaskError(
                source, f"limits.workspace.{axis}", list(region[axis]), allowed
            )
    return Limits(d["time"], d["normal_force"], (*region["x"], *region["y"]))
