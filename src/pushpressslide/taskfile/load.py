"""Task files: from YAML to a checked Task.

Every field is defined by the metadata of ``core/task.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import Shown, TaskError, path_value
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import (
    MODELS,
    PATHS,
    doubled_by_tip,
    is_robot_file,
)
from pushpressslide.core.task import ObjectModel, Obstacle, Robot, Task
from pushpressslide.selection.tool_use import tool_use
from pushpressslide.taskfile.checks import check, wall_faults
from pushpressslide.taskfile.dump import dump_task, task_data
from pushpressslide.taskfile.goals import check_goals, goals_faults
from pushpressslide.taskfile.gone import without_gone
from pushpressslide.taskfile.legs import inherited, leg_faults, legs_to
from pushpressslide.taskfile.place import Fault, Place, nearest, refuse
from pushpressslide.taskfile.schema import SCHEMA
from pushpressslide.taskfile.shapes import located, mass_faults, shape_faults
from pushpressslide.taskfile.supports import support_faults
from pushpressslide.taskfile.yaml_text import apply_overrides, read_yaml

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
    """Files of the tasks that come with the package, by name."""
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
    """Text with its line ends and repeated spaces as single spaces."""
    return " ".join(text.split())


def load_task(name_or_path: str | Path, overrides: Sequence[str] = ()) -> Task:
    """Complete, checked task of a shipped name or of a YAML file.

    Args:
        name_or_path: name of a shipped task, or path of a YAML file.
        overrides: ``a.b=c`` each, the value as YAML, in the file's units.

    Raises:
        TaskError: one line that names the file, the field, the value and what is
        allowed.
    """
    path = file_of(name_or_path)
    data = read_yaml(path)
    apply_overrides(data, overrides)
    return task_from_data(data, str(path))


def file_of(name_or_path: str | Path) -> Path:
    """File of a shipped task, or the given path.

    Raises:
        TaskError: for a name of no shipped task.
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
    return path


def check_task(task: Task) -> None:
    """Check a task built or changed in Python like one read from a file.

    Raises:
        TaskError: as :func:`load_task`.
    """
    task_from_data(task_data(task), task.source or task.name)


def task_from_data(data: Mapping[str, Any], source: str) -> Task:
    """Checked task of plain data in the file's layout and units.

    ``source`` names the file in messages.

    Raises:
        TaskError: as :func:`load_task`.
    """
    plain = _plain(without_gone(data, source, ran=False), Place(source))
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
    refuse(source, _workspace_faults(plain["limits"]["workspace"] or {}))
    task = _task(plain, values, source)
    refuse(source, wall_faults(task.scene, task.start, task.goal))
    staged = bool(task.goals)
    true_start = task.true_start
    for query in (task.query,) if staged else task.queries():
        check(query, task.object, true_start, staged=staged)
        true_start = query.goal
    check_goals(task)
    return task


def load_written_task(path: Path) -> Task:
    """Task of a file written by :func:`dump_task`, unchanged.

    It is not checked again: a body that a run has thrown off the table is read at its
    last pose.

    Raises:
        TaskError: for a file of another layout, or a mesh that is gone.
    """
    return written_task(read_yaml(path), str(path))


def written_task(data: Mapping[str, Any], source: str) -> Task:
    """Task of data from :func:`task_data`, as by :func:`load_written_task`. ``source``
    names their file.
    """
    data = without_gone(data, source, ran=True)
    plain = _plain(data, Place(source, bounded=False))
    refuse(source, shape_faults("object.shape", plain["object"]["shape"]))
    for i, body in enumerate(plain["obstacles"]):
        refuse(source, shape_faults(f"obstacles[{i}]", body))
    return _task(plain, SCHEMA.decode(plain), source)


def _plain(data: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """Fields of the file with every default, and the full paths of its meshes."""
    plain: dict[str, Any] = SCHEMA.read(inherited(data), place)
    folder = Path(place.source).parent
    body = plain["object"]
    plain["object"] = {**body, "shape": located(body["shape"], folder)}
    plain["obstacles"] = [located(one, folder) for one in plain["obstacles"]]
    return plain


def _task(plain: Mapping[str, Any], values: Mapping[str, Any], source: str) -> Task:
    """Task of a file's fields and their decoded ``values``."""
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
"""Fields of a robot that go with a model given by its path."""


def _located(robot: Robot, folder: Path) -> Robot:
    """The robot with the full path of its model, if it is given by a path."""
    if robot.model in MODELS:
        return robot
    packages = tuple(str((folder / place).resolve()) for place in robot.packages)
    model = str((folder / robot.model).resolve())
    return replace(robot, model=model, packages=packages)


def _tip_faults(robot: Mapping[str, Any], field: str) -> Iterator[Fault]:
    """Yield fields of a robot that do not go with its ``tip``."""
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
