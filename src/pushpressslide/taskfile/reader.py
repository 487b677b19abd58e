"""Checks plain data against the schema: types, finiteness, ranges, unknown names; fills
in the defaults.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.field import REQUIRED, Field

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_.-]{0,63}")


def nearest(name: object, known: Iterable[str]) -> str:
    """Return ``did you mean 'x'? known: ...``, with the nearest of the known names
    first if one is near.
    """
    names = list(known)
    close = difflib.get_close_matches(str(name)[:64], names, n=1, cutoff=0.5)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}known: {', '.join(names)}"


def read(field: Field, value: Any, path: str, source: str) -> Any:
    """Return the checked value of one field, sections and lists included, with the
    defaults filled in.

    Units stay those of the file. ``path`` is the field's dotted name; ``source`` names
    the file.

    Raises:
        TaskError: a value of the wrong type or out of range, a missing field, an
        unknown name.
    """
    if value is None and field.default is None:
        return None
    match field.kind:
        case "section":
            return _section(field, value, path, source)
        case "sections":
            items = _list(field, value, path, source)
            return [
                _section(field, item, f"{path}[{i}]", source)
                for i, item in enumerate(items)
            ]
        case "number" | "integer":
            return (
                value if value in field.choices else _number(field, value, path, source)
            )
        case "numbers":
            items = _list(field, value, path, source)
            return tuple(
                _number(field, item, f"{path}[{i}]", source)
                for i, item in enumerate(items)
            )
        case "points":
            items = _list(field, value, path, source)
            return tuple(
                _point(field, item, f"{path}[{i}]", source)
                for i, item in enumerate(items)
            )
        case "names":
            items = _list(field, value, path, source)
            return tuple(
                _text(field, item, f"{path}[{i}]", source)
                for i, item in enumerate(items)
            )
        case "boolean":
            if not isinstance(value, bool):
                raise TaskError(source, path, value, f"allowed: {field.allowed}")
            return value
        case "text" | "name":
            return _text(field, value, path, source)


def _section(field: Field, value: Any, path: str, source: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise TaskError(source, path, value, f"allowed: {field.allowed}")
    fields = field.fields or {}
    for key in value:
        if key not in fields:
            name = f"{path}.{key}" if path else str(key)
            raise TaskError(
                source,
                " ".join(name[:200].split()),
                key,
                f"unknown field; {nearest(key, fields)}",
            )
    out: dict[str, Any] = {}
    for key, inner in fields.items():
        name = f"{path}.{key}" if path else key
        if key in value:
            out[key] = read(inner, value[key], name, source)
        elif inner.default is REQUIRED:
            raise TaskError(
                source, name, None, f"it is missing; allowed: {inner.allowed}"
            )
        else:
            out[key] = read(inner, inner.default, name, source)
    return out


def _list(field: Field, value: Any, path: str, source: str) -> list[Any]:
    low, high = field.count
    if not isinstance(value, list) or not low <= len(value) <= high:
        raise TaskError(source, path, value, f"allowed: {field.allowed}")
    return value


def _number(field: Field, value: Any, path: str, source: str) -> float | int:
    error = TaskError(source, path, value, f"allowed: {_one(field)}")
    if isinstance(value, bool) or not isinstance(
        value, int if field.kind == "integer" else (int, float)
    ):
        raise error
    try:
        number = float(value)
    except OverflowError:
        raise error from None
    below = number <= field.low if field.open_low else number < field.low
    above = number >= field.high if field.open_high else number > field.high
    if not math.isfinite(number) or below or above:
        raise error
    return int(value) if field.kind == "integer" else number


def _one(field: Field) -> str:
    if field.kind in ("number", "integer"):
        return field.allowed
    return " ".join(
        filter(
            None,
            (
                "a finite number",
                f"[{field.unit}]" if field.unit else "",
                field.interval,
            ),
        )
    )


def _point(field: Field, value: Any, path: str, source: str) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        raise TaskError(
            source,
            path,
            value,
            f"allowed: a point [x, y] of two finite numbers [{field.unit}]",
        )
    return (
        _number(field, value[0], f"{path}[0]", source),
        _number(field, value[1], f"{path}[1]", source),
    )


def _text(field: Field, value: Any, path: str, source: str) -> str:
    if not isinstance(value, str):
        raise TaskError(
            source,
            path,
            value,
            f"allowed: {'a name' if field.kind == 'names' else field.allowed}",
        )
    if field.choices and value not in field.choices:
        raise TaskError(source, path, value, f"allowed: {field.allowed}")
    if field.kind == "name" and not _NAME.fullmatch(value):
        raise TaskError(source, path, value, f"allowed: {field.allowed}")
    return value
