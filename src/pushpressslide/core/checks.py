"""Checks of a scene's numbers for the constructors of all public data.

Each check raises InputError, in one line, with the field, the value and the allowed
range. The narrower ranges of a task file are in ``core.field_spec`` and are checked by
its reader.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields
from functools import cache
from numbers import Real
from typing import Any

from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, Pose2

FINITE = "finite"
POSITIVE = "finite and > 0"
NOT_NEGATIVE = "finite and >= 0"


def check_positive(value: float, name: str, unit: str = "m") -> None:
    """Raise InputError unless a number is finite and > 0."""
    if not is_number(value) or not 0.0 < value < math.inf:
        _refuse(name, value, unit, POSITIVE)


def check_places(points: Sequence[Point], name: str, min_count: int = 1) -> None:
    """Raise InputError unless there are at least ``min_count`` points [m], all of them
    finite.
    """
    if not isinstance(points, Sequence) and not hasattr(points, "tolist"):
        raise InputError(f"{name} {points!r}; must be points (x, y)")
    if len(points) < min_count:
        raise InputError(f"{name} of {len(points)} points; must be {min_count} or more")
    for point in points:
        if isinstance(point, str) or not hasattr(point, "__len__") or len(point) != 2:
            raise InputError(f"{name} {point!r}; must be points (x, y)")
        if not all(is_number(value) and math.isfinite(value) for value in point):
            _refuse(name, point, "m", FINITE)


def check_pose(pose: Pose2, name: str) -> None:
    """Raise InputError unless all numbers of a pose are finite."""
    if not isinstance(pose, Pose2):
        raise InputError(f"{name} {pose!r}; must be a Pose2")
    if not all(is_number(v) and math.isfinite(v) for v in (pose.x, pose.y, pose.yaw)):
        _refuse(name, (pose.x, pose.y, pose.yaw), "", FINITE)


def check_fields(data: Any) -> None:
    """Raise InputError unless all numbers in a dataclass's fields are finite and have
    the sign that the task file requires.
    """
    kind: Any = type(data)
    for name, unit, allowed in field_rules(kind):
        value = getattr(data, name)
        if value is not None and not _holds(value, allowed):
            _refuse(f"{kind.__name__}.{name}", value, unit, allowed)


@cache
def field_rules(kind: Any) -> tuple[tuple[str, str, str], ...]:
    """Name, unit and allowed range of each field."""
    rules = []
    for one in fields(kind):
        spec = one.metadata.get("entry")
        within = spec.within if spec else ""
        unit = spec.unit if spec else ""
        allowed = FINITE
        if within:
            least = float(within[1:].split(",")[0])
            if least > 0.0 or (least == 0.0 and within[0] == "("):
                allowed = POSITIVE
            elif least == 0.0:
                allowed = NOT_NEGATIVE
        rules.append((one.name, unit.replace("deg", "rad"), allowed))
    return tuple(rules)


def _holds(value: Any, allowed: str) -> bool:
    """Whether all numbers in a value are within the ``allowed`` range."""
    if isinstance(value, float | int):
        if not math.isfinite(value):
            return False
        if allowed is FINITE:
            return True
        return value > 0.0 if allowed is POSITIVE else value >= 0.0
    if isinstance(value, tuple):
        return all(_holds(part, allowed) for part in value)
    if isinstance(value, Pose2):
        numbers = filter(is_number, (value.x, value.y, value.yaw))
        return all(map(math.isfinite, numbers))
    return True


def is_number(value: object) -> bool:
    """Whether a value is a real number of Python or NumPy."""
    return isinstance(value, Real) and not isinstance(value, bool)


def _refuse(name: str, value: object, unit: str, allowed: str) -> None:
    raise InputError(
        f"{' '.join([name, repr(value), unit]).rstrip()}; must be {allowed}"
    )
