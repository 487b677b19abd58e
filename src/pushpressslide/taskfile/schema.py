"""The task file as a tree of fields, derived from the metadata of a task's dataclasses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, fields, is_dataclass, replace
from dataclasses import Field as DataField
from pathlib import PurePath
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from pushpressslide.core.field_spec import REQUIRED, FieldSpec
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import CENTROID
from pushpressslide.core.task import (
    BodyGoal,
    ObjectModel,
    Obstacle,
    Robot,
    Shape,
    Task,
)
from pushpressslide.taskfile import kinds, layouts
from pushpressslide.taskfile.kinds import Field, Kind
from pushpressslide.taskfile.shapes import (
    NAMES,
    SHAPE,
    named_shape,
    one_shape,
    with_one_shape,
)
from pushpressslide.taskfile.supports import make_support, support_fields

_ORDER = (
    "name",
    "description",
    "support",
    "object",
    "contact",
    "start",
    "goal",
    "goals",
    "tool",
    "tolerance",
    "robots",
    "obstacles",
    "modes",
    "limits",
    "belief",
    "start_error",
    "sensing",
    "truth",
    "motion",
    "legs",
    "disturbances",
)
"""Fields of the whole file, in the order in which they are written. Others follow."""

_LAYOUTS = {
    "Limits.workspace": layouts.WORKSPACE,
    "Opening.center": layouts.CENTER,
    "Robot.base": layouts.STAND,
    "Support.frame": layouts.STAND,
    "Task.goal": layouts.GOAL,
    "Task.start_error": layouts.START_ERROR,
}
"""Fields whose layout in the file differs from their type."""

_SPREAD = ("Obstacle.shape",)
"""Fields that the file replaces by their subfields."""

_KINDS = {
    BodyGoal: layouts.BODY_GOAL,
    Pose2: layouts.POSE,
    Shape: SHAPE,
    bool: kinds.FLAG,
    str: kinds.TEXT,
}


def _object(shape: Shape, mass: Any, center_of_mass: Any) -> ObjectModel:
    center = shape.centroid if center_of_mass is None else center_of_mass
    mass = shape.file_mass if mass is None else mass
    return ObjectModel(shape, mass, center)


def _object_fields(body: ObjectModel) -> dict[str, Any]:
    center = None if body.center_of_mass is CENTROID else body.center_of_mass
    return {**kinds.attributes(body), "center_of_mass": center}


def _robot(base: layouts.Stand, **others: Any) -> Robot:
    return Robot(base=base[:3], base_yaw=base.yaw, **others)


def _robot_fields(robot: Robot) -> dict[str, Any]:
    base: Any = kinds.plain_value(robot.base)
    if isinstance(base, list) and len(base) <= 3:
        x, y, z = (*base, 0.0, 0.0, 0.0)[:3]
        base = layouts.Stand(x, y, z, robot.base_yaw)
    return {**kinds.attributes(robot), "base": base}


def _obstacle(**others: Any) -> Obstacle:
    shapes = {name: others.pop(name) for name in NAMES}
    return Obstacle(shape=one_shape(**shapes), **others)


def _obstacle_fields(obstacle: Obstacle) -> dict[str, Any]:
    return {**kinds.attributes(obstacle), **named_shape(obstacle.shape)}


_MAKE: dict[str, Callable[..., Any]] = {
    "ObjectModel": _object,
    "Obstacle": _obstacle,
    "Robot": _robot,
    "Support": make_support,
    "Task": dict,
    "ToolUse": dict,
}
"""Functions that make data from the file's fields, where the constructor does not
accept these fields.
"""

_TAKE: dict[str, Callable[[Any], dict[str, Any]]] = {
    "ObjectModel": _object_fields,
    "Obstacle": _obstacle_fields,
    "Robot": _robot_fields,
    "Support": support_fields,
    "Task": dict,
}
"""Inverses of these functions, where the result is not simply the fields of the data.
"""


def _section(data: Any) -> Kind:
    """Section of the file for a dataclass."""
    hints = get_type_hints(data)
    keyed: dict[str, Field] = {}
    for field in fields(data):
        if "entry" in field.metadata:
            spec = field.metadata["entry"]
            key = spec.key or field.name + ("_deg" if spec.unit == "deg" else "")
            kind = _LAYOUTS.get(f"{data.__name__}.{field.name}")
            placed = _field(field, spec, kind or _kind(hints[field.name], spec))
            if spec.section:
                key, inner = key.split(".")
                placed = _wrapped(inner, placed, spec.section)
            if f"{data.__name__}.{field.name}" in _SPREAD:
                keyed |= placed.kind.fields or {}
            else:
                keyed[key] = placed
    ordered = {key: keyed[key] for key in (*_ORDER, *keyed) if key in keyed}
    name = data.__name__
    kind = kinds.section(
        ordered if data is Task else keyed,
        _MAKE.get(name, data),
        _TAKE.get(name, kinds.attributes),
        data,
    )
    if data is Robot:
        return _named_model(kind)
    return with_one_shape(kind) if data is Obstacle else kind


def _named_model(robot: Kind) -> Kind:
    """Kind of a robot. A program may also give a robot by the name of its model."""

    def encode(value: Any) -> Any:
        """Make a plain value from a robot, or from the name of its model."""
        if isinstance(value, str | PurePath):
            value = {"model": value}
        return robot.encode(value)

    return replace(robot, encode=encode)


def _field(field: DataField[Any], spec: FieldSpec, kind: Kind) -> Field:
    default = spec.default_in_file
    if default is REQUIRED and field.default is None:
        default = None
    elif default is REQUIRED and field.default is not MISSING and not kind.fields:
        default = kind.encode(field.default)
    if default is None:
        kind = kinds.nullable(kind)
    return Field(kind, spec.meaning, default, field.name)


def _wrapped(key: str, field: Field, meaning: str) -> Field:
    """Section with a single field."""
    alone = kinds.section(
        {key: field},
        lambda **values: values[field.name],
        lambda value: {field.name: value},
    )
    return Field(alone, meaning, name=field.name)


def _kind(hint: Any, spec: FieldSpec) -> Kind:
    """Kind of a field, from its type. None in a union makes the kind nullable."""
    if hint in _KINDS:
        return kinds.NAME if spec.is_name else _KINDS[hint]
    union = get_origin(hint) in (Union, UnionType)
    members = get_args(hint) if union else (hint,)
    words = tuple(w for m in members if get_origin(m) is Literal for w in get_args(m))
    types = [m for m in members if m is not NoneType and get_origin(m) is not Literal]
    if not types:
        return kinds.choice(*words)
    (only,) = types
    if only in (int, float):
        return kinds.number(spec.unit, spec.within, words, only is int)
    if get_origin(only) is tuple:
        return _array(get_args(only), spec)
    if is_dataclass(only):
        return _section(only)
    return _kind(only, spec)


def _array(items: tuple[Any, ...], spec: FieldSpec) -> Kind:
    """Kind of a tuple: a fixed number of numbers, or any number of elements."""
    low, high = spec.count
    if items[-1] is not ...:
        low = high = len(items)
        return kinds.array(_kind(float, spec), low, high)
    if items[0] is str:
        return kinds.array(kinds.text("a name", "names"), low, high)
    if get_origin(items[0]) is tuple:
        return kinds.array(kinds.point(spec.unit, spec.within), low, high)
    return kinds.array(_kind(items[0], spec), low, high)


SCHEMA = _section(Task)
"""Kind of the whole file. In the data it is the fields of a task by name."""
