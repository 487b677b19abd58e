"""Task files: from YAML to a checked Task.

Every field is defined by the metadata of ``core/task.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from math import radians
from os import PathLike
from pathlib import Path
from typing import Any

from pushpressslide.core import margins
from pushpressslide.core.errors import Shown, TaskError, path_value
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import (
    MODELS,
    PATHS,
    doubled_by_tip,
    is_robot_file,
)
from pushpressslide.core.slips import warn_of_slip
from pushpressslide.core.task import ObjectModel, Obstacle, Robot, Task
from pushpressslide.core.truth import refuse_truth
from pushpressslide.selection.tool_use import tool_use
from pushpressslide.taskfile.checks import check, wall_faults
from pushpressslide.taskfile.disturbances import disturbance_faults
from pushpressslide.taskfile.dump import dump_task, task_data
from pushpressslide.taskfile.goals import check_goals, goals_faults
from pushpressslide.taskfile.gone import without_gone
from pushpressslide.taskfile.kinds import plain_value
from pushpressslide.taskfile.legs import inherited, leg_faults, legs_to
from pushpressslide.taskfile.place import Fault, Place, nearest, refuse
from pushpressslide.taskfile.schema import SCHEMA
from pushpressslide.taskfile.shapes import located, mass_faults, shape_faults
from pushpressslide.taskfile.supports import support_faults
from pushpressslide.taskfile.yaml_text import Overrides, apply_overrides, read_yaml

__all__ = [
    "check_task",
    "descriptions_of_shipped_tasks",
    "dump_task",
    "load_task",
    "shipped_tasks",
    "task_from_data",
]

_SHIPPED = Path(__file__).parent.parent / "tasks"


def shipped_tasks() -> dict[str, Path]:
    """Files of the tasks that ship with the package, by name."""
    return {
        path.stem: path
        for path in sorted(_SHIPPED.glob("*.yaml"), key=lambda path: path.stem)
    }


def descriptions_of_shipped_tasks() -> dict[str, str]:
    """Description of each shipped task, by name. The tasks are not checked."""
    return {
        name: one_line(read_yaml(path)["description"])
        for name, path in shipped_tasks().items()
    }


def one_line(text: str) -> str:
    """Text on one line: line breaks and repeated spaces become single spaces."""
    return " ".join(text.split())


def load_task(
    task: str | PathLike[str] | Mapping[str, Any], overrides: Overrides = ()
) -> Task:
    """Complete, checked task from a shipped name, a YAML file, or a mapping.

    Args:
        task: name of a shipped task, path of a YAML file, or a mapping with the fields
            of a file. In a mapping, an angle has a key that ends in ``_deg``; poses and
            shapes may also be ``Pose2`` and ``Box``, or sequences of numbers.
        overrides: values by field, as ``{"contact.friction": 0.5}``, or texts
            ``field=value``, the value as YAML.

    Raises:
        TaskError: one line that names the file, the field, the value and what is
        allowed.
    """
    if isinstance(task, Mapping):
        return _of_python(task, overrides, str(task.get("name", "task")))
    if not isinstance(task, str | PathLike):
        allowed = (
            "allowed: a Task, the name of a shipped task, the path of a YAML file, or "
            "a mapping with a task's fields"
        )
        raise TaskError("", "task", task, allowed)
    path = file_of(Path(task))
    data = read_yaml(path)
    apply_overrides(data, _plain_overrides(overrides))
    return task_from_data(data, str(path))


def _of_python(data: Mapping[Any, Any], overrides: Overrides, source: str) -> Task:
    """Checked task from a program's data, whose types may differ from those of the
    file.
    """
    plain = SCHEMA.encode(data)
    apply_overrides(plain, _plain_overrides(overrides))
    return task_from_data(plain, source)


def _plain_overrides(overrides: Overrides) -> Overrides:
    """Overrides with the values of a mapping as plain data in the file's units."""
    if not isinstance(overrides, Mapping):
        return overrides
    return {name: _plain_field(str(name), v) for name, v in overrides.items()}


def _plain_field(name: str, value: Any) -> Any:
    """Value of the field ``name`` (dotted), as plain data in the file's units."""
    kind = SCHEMA
    key = ""
    for key in name.split("."):
        # an index in a list, whose kind has the fields of its sections
        if key.isdecimal():
            continue
        if key not in (kind.fields or {}):
            return plain_value(value)
        kind = (kind.fields or {})[key].kind
    if key.isdecimal() or "_deg" in key:
        return plain_value(value)
    return kind.encode(value)


def file_of(name_or_path: Path) -> Path:
    """File of a shipped task, or the given path.

    Raises:
        TaskError: for a name of no shipped task.
    """
    shipped = shipped_tasks()
    path = shipped.get(str(name_or_path)) or name_or_path
    if path.parent == Path() and not path.suffix and not path.exists():
        raise TaskError(
            str(name_or_path),
            "",
            name_or_path,
            "no such task; allowed: the path of a YAML file, or the name of a shipped "
            "task; " + nearest(name_or_path, shipped),
        )
    return path


def check_task(task: Task, overrides: Overrides = ()) -> Task:
    """Task built or changed in Python, checked like one read from a file.

    Lists, tuples, mappings and names in place of poses, shapes and robots are
    converted. ``overrides`` are those of :func:`load_task`.

    Raises:
        TaskError: as :func:`load_task`.
    """
    name = str(task.name)
    try:
        checked = _of_python(task_data(task), overrides, name)
    except TaskError as error:
        raise in_radians(error) from None
    if not overrides and same_types(task, checked):
        return task
    return replace(checked, source=task.source)


def in_radians(error: TaskError) -> TaskError:
    """Error for an angle, converted from degrees in the file to radians for a program."""
    value = error.value
    if not error.field.endswith("_deg") or not isinstance(value, int | float):
        return error
    field = error.field.removesuffix("_deg")
    allowed = f"{error.allowed}; were degrees meant? Pose2.deg takes them"
    return TaskError(error.source, field, Shown(f"{radians(value):g} rad"), allowed)


def same_types(one: Any, other: Any) -> bool:
    """Whether two tasks, or parts of tasks, have the same types of values throughout."""
    if type(one) is not type(other):
        return False
    if isinstance(one, tuple):
        same_count = len(one) == len(other)
        return same_count and all(map(same_types, one, other))
    if not is_dataclass(one):
        return True
    names = [field.name for field in fields(one)]
    return all(same_types(getattr(one, n), getattr(other, n)) for n in names)


def task_from_data(data: Mapping[str, Any], source: str) -> Task:
    """Checked task from plain data in the file's layout and units.

    ``source`` names the file in messages.

    Raises:
        TaskError: as :func:`load_task`.
    """
    data = without_gone(data, source, ran=False)
    if isinstance(data.get("truth"), str):
        data = {**data, "truth": {"tier": data["truth"]}}
    plain = _plain(data, Place(source))
    folder = Path(source).parent
    refuse(source, shape_faults("object.shape", plain["object"]["shape"]))
    refuse(source, mass_faults(plain["object"]))
    for i, body in enumerate(plain["obstacles"]):
        refuse(source, shape_faults(f"obstacles[{i}]", body))
    for i, robot in enumerate(plain["robots"]):
        refuse(source, _tip_faults(robot, f"robots[{i}]"))
    values = SCHEMA.decode(plain)
    body = values["object"]
    obstacles = values["obstacles"]
    centers = {name: plain[name]["center_of_mass"] for name in ("object", "belief")}
    refuse(source, _body_faults(centers, body, obstacles))
    refuse(source, goals_faults(plain, obstacles))
    for i, robot in enumerate(values["robots"]):
        refuse(source, _model_faults(robot, folder, f"robots[{i}]"))
    refuse(source, support_faults(plain["support"]))
    refuse(source, leg_faults(plain))
    refuse(source, disturbance_faults(plain))
    refuse(source, _workspace_faults(plain["limits"]["workspace"] or {}))
    task = _task(plain, values, source)
    _warn_of_masses(task)
    for i, robot in enumerate(task.robots):
        if robot.interface != "torque":
            where = f"with robots[{i}].interface {robot.interface}"
            refuse_truth(task.truth, task.truth.for_servos(), source, where)
        elif robot.delay > margins.LATEST_TORQUE:
            allowed = f"allowed with interface torque: [0, {margins.LATEST_TORQUE:g}] s"
            raise TaskError(source, f"robots[{i}].delay", robot.delay, allowed)
    if task.goals:
        flat = replace(task.truth, ridge=0.0)
        refuse_truth(task.truth, flat, source, "in a task with `goals`")
    refuse(source, wall_faults(task.scene, task.start, task.goal))
    true_start = task.true_start
    rests = not task.legs and task.tolerance.holds(true_start, task.goal)
    for query in (task.query,) if task.goals else task.queries():
        check(query, task.object, true_start, may_rest=rests or bool(task.goals))
        true_start = query.goal
    check_goals(task)
    return task


OSMIUM = 22_590.0
"""Density [kg/m^3] of the densest metal."""


def _warn_of_masses(task: Task) -> None:
    """Warn of bodies denser than any metal."""
    bodies = {"object": (task.object.mass, task.object.shape)}
    for i, body in enumerate(task.obstacles):
        if body.movable:
            bodies[f"obstacles[{i}]"] = (body.mass, body.shape)
    for name, (mass, shape) in bodies.items():
        volume = shape.base_area * shape.height
        if mass > OSMIUM * volume:
            warn_of_slip(
                f"{task.source}: {name}.mass: {mass:g} kg in {1e3 * volume:.3g} litres "
                f"is denser than any metal ({1e-3 * OSMIUM:.1f} kg in a litre); were "
                "grams meant?"
            )


def load_written_task(path: Path) -> Task:
    """Task from a file written by :func:`dump_task`, unchanged.

    It is not checked again, since a body may have left the table during a run and is
    read at its last pose.

    Raises:
        TaskError: for a file of another layout, or a mesh that is gone.
    """
    return written_task(read_yaml(path), str(path))


def written_task(data: Mapping[str, Any], source: str) -> Task:
    """Task from the data of :func:`task_data`, as in :func:`load_written_task`.
    ``source`` names the file of the data.
    """
    data = without_gone(data, source, ran=True)
    plain = _plain(data, Place(source, bounded=False))
    refuse(source, shape_faults("object.shape", plain["object"]["shape"]))
    for i, body in enumerate(plain["obstacles"]):
        refuse(source, shape_faults(f"obstacles[{i}]", body))
    return _task(plain, SCHEMA.decode(plain), source)


def _plain(data: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """Fields of the file with every default, and with the full paths of its meshes."""
    plain: dict[str, Any] = SCHEMA.read(inherited(data), place)
    folder = Path(place.source).parent
    body = plain["object"]
    plain["object"] = {**body, "shape": located(body["shape"], folder)}
    plain["obstacles"] = [located(one, folder) for one in plain["obstacles"]]
    return plain


def _task(plain: Mapping[str, Any], values: Mapping[str, Any], source: str) -> Task:
    """Task from a file's fields and their decoded ``values``."""
    tool = None
    goal = values["start"]
    if plain["goals"] is None:
        tool, goal = tool_use(plain, values["object"], values["obstacles"], source)
    folder = Path(source).parent
    resolved = {
        "goal": goal,
        "tool": tool,
        "robots": tuple(_located(robot, folder) for robot in values["robots"]),
        "goals": values["goals"] or (),
        "legs": legs_to(goal, values["legs"]),
        "description": one_line(values["description"]),
        "source": source,
    }
    return Task(**{**values, **resolved})


def _body_faults(
    centers: Mapping[str, Point | None],
    body: ObjectModel,
    obstacles: Sequence[Obstacle],
) -> Iterator[Fault]:
    hull = body.shape.hull
    if centers["object"] is None and hull.depth(body.shape.centroid) <= 0.0:
        x, y = body.shape.centroid
        off = -1e3 * hull.depth((x, y))
        place = Shown(
            f"its centre of mass ({x:.3g}, {y:.3g}) m, {off:.3g} mm outside its base"
        )
        yield (
            "object.shape",
            place,
            "it tips over; allowed: a body that stands, or give center_of_mass",
        )
    for section, center in centers.items():
        if center is None:
            continue
        depth = body.shape.hull.depth(center)
        if depth <= 0.0:
            allowed = (
                f"a point inside the base's convex hull, here {-depth:.4g} m outside"
            )
            yield f"{section}.center_of_mass", list(center), f"allowed: {allowed}"
    names = ["object"]
    for i, obstacle in enumerate(obstacles):
        if obstacle.name in names:
            allowed = f"allowed: a name of its own, not one of {', '.join(names)}"
            yield f"obstacles[{i}].name", obstacle.name, allowed
        names.append(obstacle.name)


OF_FILES = (
    "tip",
    "home",
    "rotor_inertia",
    "gear_ratio",
    "joint_friction",
    "limits",
)
"""Fields of a robot that are allowed only for a model given by its path."""


def _located(robot: Robot, folder: Path) -> Robot:
    """The robot with the full path of its model, if it is given by a path."""
    if robot.model in MODELS:
        return robot
    packages = tuple(str((folder / place).resolve()) for place in robot.packages)
    model = str((folder / robot.model).resolve())
    return replace(robot, model=model, packages=packages)


def _tip_faults(robot: Mapping[str, Any], field: str) -> Iterator[Fault]:
    """Yield a fault for each field of a robot that conflicts with the robot's ``tip``."""
    tip = robot["tip"]
    name = tip and doubled_by_tip(robot, tip["radius"], tip["length"])
    if name:
        yield f"{field}.{name}", robot[name], "allowed: this or tip, not both"


def _model_faults(robot: Robot, folder: Path, field: str) -> Iterator[Fault]:
    path = folder / robot.model
    models = ", ".join(MODELS)
    if robot.model in MODELS:
        for name in OF_FILES:
            if getattr(robot, name) is not None:
                key = "home_deg" if name == "home" else name
                allowed = "allowed: for a model given by its path"
                yield f"{field}.{key}", Shown("given"), allowed
        return
    if not is_robot_file(path):
        near = nearest(robot.model, MODELS)
        allowed = f"allowed: {models}, or {PATHS}; {near}"
        yield f"{field}.model", robot.model, allowed
    elif not path.is_file():
        allowed = f"no such file; allowed: {models} or a path"
        yield f"{field}.model", path_value(robot.model), allowed
    elif robot.tip_frame is None and robot.tip is None:
        allowed = (
            "a tip on a link of the file, as {link: tool0}, or tip_frame, the name of "
            "the frame at the tip's centre; pps robot FILE lists the links"
        )
        yield f"{field}.tip", None, f"it is missing; allowed: {allowed}"


def _workspace_faults(region: Mapping[str, Any]) -> Iterator[Fault]:
    for axis, (lower, upper) in region.items():
        if not lower < upper:
            allowed = "allowed: [lower, upper] with lower < upper"
            yield f"limits.workspace.{axis}", [lower, upper], allowed
