"""Kinds of fields: the allowed values in words, a reader, and the JSON Schema.

Reading is separate from decoding, so that every field is valid before fields are
compared. ``read`` returns plain data in the file's units with every default filled in.
``decode`` converts it to the data of a task, and ``encode`` is the inverse.

``encode`` also accepts other values from a program: lists, tuples, arrays, paths, and
mappings laid out like the file. A value that it cannot convert is returned unchanged
and then refused by ``read``.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, is_dataclass, replace
from dataclasses import fields as dataclass_fields
from functools import partial
from pathlib import PurePath
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.field_spec import REQUIRED
from pushpressslide.taskfile.place import Place, nearest


def _same(value: Any) -> Any:
    return value


def plain_value(value: Any) -> Any:
    """NumPy arrays and scalars, sequences, mappings and paths as plain data. Any other
    value is returned unchanged.
    """
    if isinstance(value, PurePath):
        return str(value)
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, Mapping):
        return {key: plain_value(one) for key, one in value.items()}
    if isinstance(value, list | tuple | range):
        return [plain_value(one) for one in value]
    return value


def attributes(data: Any) -> dict[str, Any]:
    """Fields of a dataclass by name."""
    return {field.name: getattr(data, field.name) for field in dataclass_fields(data)}


@dataclass(frozen=True, slots=True)
class Kind:
    """Allowed values of a field, and conversions of these values."""

    words: str  # allowed values in words
    many: str  # the same in the plural, for a list
    json: Mapping[str, Any]  # JSON Schema
    read: Callable[[Any, Place], Any]  # raises TaskError
    decode: Callable[[Any], Any] = _same
    encode: Callable[[Any], Any] = plain_value
    absent: Any = REQUIRED  # plain value of a field that is missing in the file
    # fields of a section, or of each section in a list
    fields: Mapping[str, Field] | None = None


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a section."""

    kind: Kind
    meaning: str
    default: Any = REQUIRED  # plain, in the file's units
    name: str = ""  # name in the data, if it is not the key without _deg

    @property
    def absent(self) -> Any:
        """Value of a field that the file omits. REQUIRED if it must not be omitted."""
        return self.kind.absent if self.default is REQUIRED else self.default


_LOWER = {"[": ("minimum", operator.ge), "(": ("exclusiveMinimum", operator.gt)}
_UPPER = {"]": ("maximum", operator.le), ")": ("exclusiveMaximum", operator.lt)}
"""JSON Schema key and comparison for the bracket at the upper end of a range."""
_NUMBERS: Mapping[bool, tuple[type[float], str, str]] = {
    False: (float, "finite", "number"),
    True: (int, "whole", "integer"),
}
"""Python type, word and JSON Schema type of a number. The key says whether it must be
whole.
"""


def number(
    unit: str, within: str, words: tuple[str, ...] = (), whole: bool = False
) -> Kind:
    """Kind of a finite number in a range, or of a word in its place.

    An end of ``within`` with a round bracket is open. An angle is in degrees in the
    file (unit "deg" or "deg/s") and in radians in the data.
    """
    low, high = (float(end) for end in within[1:-1].split(","))
    lower, is_above = _LOWER[within[0]]
    upper, is_below = _UPPER[within[-1]]
    convert, adjective, json_type = _NUMBERS[whole]

    def read(value: Any, place: Place) -> Any:
        """Read one value."""
        if value in words:
            return value
        if isinstance(value, bool) or not isinstance(value, (int, convert)):
            raise place.refused(value)
        # an integer may be too long for a float; a comparison takes it
        inside = is_above(value, low) and is_below(value, high)
        if place.bounded and not inside:
            raise place.refused(value)
        return convert(value)

    schema: dict[str, Any] = {"type": json_type, lower: low, upper: high}
    if words:
        schema = {"anyOf": [{"enum": list(words)}, schema]}
    span = f"in {within}"
    if unit:
        span = f"[{unit}] {span}"
    one = f"a {adjective} number {span}"
    kind = Kind(", ".join((*words, one)), f"finite numbers {span}", schema, read)
    if unit in ("deg", "deg/s"):
        return replace(kind, decode=math.radians, encode=degrees)
    return kind


def _leaf(
    words: str, many: str, json: Mapping[str, Any], sound: Callable[[Any], bool]
) -> Kind:
    """Kind of a single value that is either accepted unchanged or refused."""

    def read(value: Any, place: Place) -> Any:
        """Read one value."""
        if not sound(value):
            raise place.refused(value)
        return value

    return Kind(words, many, json, read)


def text(words: str, many: str = "", pattern: str = r"[\s\S]*") -> Kind:
    """Kind of a text that matches a pattern."""
    sound = re.compile(pattern).fullmatch
    json = {"type": "string", "pattern": f"^{pattern}$"}
    return _leaf(words, many, json, lambda v: isinstance(v, str) and bool(sound(v)))


def choice(*words: str) -> Kind:
    """Kind of a word from a fixed list."""
    json = {"enum": list(words)}
    return _leaf(f"one of {', '.join(words)}", "", json, lambda v: v in words)


FLAG = _leaf("true or false", "", {"type": "boolean"}, lambda v: isinstance(v, bool))
TEXT = text("text")
NAME = text(
    "a name: a letter, then letters, digits, '-', '_' or '.', at most 64 characters",
    pattern="[A-Za-z][A-Za-z0-9_.-]{0,63}",
)


def array(item: Kind, low: float, high: float) -> Kind:
    """Kind of a list, which is a tuple in the data."""
    size = f"{low:g} to {high:g}"
    if low == high:
        size = f"{low:g}"
    elif math.isinf(high):
        size = f"{low:g} or more"
    words = f"a list of {size} {item.many}"

    def read(value: Any, place: Place) -> Any:
        """Read one value."""
        if not isinstance(value, list) or not low <= len(value) <= high:
            raise place.refused(value)
        # for sections the message describes the whole list, with the fields of each
        allowed = place.allowed if item.fields else item.words
        return tuple(
            item.read(one, place.item(i, allowed)) for i, one in enumerate(value)
        )

    def encode(value: Any) -> Any:
        """Plain list made from a sequence, or from a single value."""
        if hasattr(value, "tolist"):
            value = value.tolist()
        single = isinstance(value, str | PurePath | Mapping)
        if single or is_dataclass(value):
            return [item.encode(value)]
        if not isinstance(value, Iterable):
            return value
        return [item.encode(one) for one in value]

    schema = {"type": "array", "items": item.json, "minItems": low}
    if math.isfinite(high):
        schema["maxItems"] = high
    return Kind(
        words,
        "",
        schema,
        read,
        lambda value: tuple(item.decode(one) for one in value),
        encode,
        REQUIRED if low else [],
        item.fields,
    )


def point(unit: str, within: str) -> Kind:
    """Kind of a point or vector in the plane."""
    axis = number(unit, within)
    words = f"a point [x, y] of two finite numbers [{unit}]"
    return replace(
        array(axis, 2, 2), words=words, many=f"points [x, y], each two {axis.many}"
    )


def _object_schema(fields: Mapping[str, Field], required: list[str]) -> dict[str, Any]:
    properties = {}
    for key, field in fields.items():
        properties[key] = {**field.kind.json, "description": field.meaning}
        if key not in required:
            properties[key]["default"] = field.absent
    return {
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _read_section(fields: Mapping[str, Field], value: Any, place: Place) -> Any:
    """Plain values of a section's fields. Raises TaskError."""
    if not isinstance(value, dict):
        raise place.refused(value)
    for key in value:
        if key not in fields:
            path = " ".join(place.field(key).path[:200].split())
            reason = f"unknown field; {nearest(key, fields)}"
            raise TaskError(place.source, path, key, reason)
    values = {}
    for key, field in fields.items():
        here = place.field(key, field.kind.words)
        plain = value.get(key, field.absent)
        if plain is REQUIRED:
            raise here.refused(None, "it is missing; ")
        values[key] = field.kind.read(plain, here)
    return values


@dataclass(frozen=True)
class _SectionEncoder:
    """Conversion of the data of a section to plain values."""

    fields: Mapping[str, Field]
    keys: Mapping[str, str]  # by the fields' names in the data
    data: type | tuple[type, ...]
    take: Callable[[Any], Mapping[str, Any]]
    order: tuple[str, ...]  # fields of a sequence

    def encode(self, value: Any) -> Any:
        """Make a plain value from the data of a task."""
        fields = self.fields
        if isinstance(value, Mapping):
            plain = dict(self._encoded(key, one) for key, one in value.items())
            return {key: plain[key] for key in (*fields, *plain) if key in plain}
        if hasattr(value, "tolist"):
            value = value.tolist()
        in_order = isinstance(value, list | tuple) and 0 < len(value) <= len(self.order)
        if in_order and not hasattr(value, "_fields"):
            return self.encode(dict(zip(self.order, value, strict=False)))
        if not isinstance(value, self.data):
            return plain_value(value)
        taken = self.take(value)
        known = {k: v for k, v in taken.items() if k in self.keys or k in fields}
        return self.encode(known)

    def _encoded(self, key: Any, value: Any) -> tuple[Any, Any]:
        """Key and plain value of a field, given by its key or by its name in the data."""
        if key in self.keys:
            key = self.keys[key]
            return key, self.fields[key].kind.encode(value)
        in_degrees = "_deg" in str(key)
        if in_degrees or key not in self.fields:
            return key, plain_value(value)
        return key, self.fields[key].kind.encode(value)


def section(
    fields: Mapping[str, Field],
    make: Callable[..., Any],
    take: Callable[[Any], Mapping[str, Any]] = attributes,
    data: type | tuple[type, ...] | None = None,
    order: tuple[str, ...] = (),
) -> Kind:
    """Kind of a section with the given fields, by key.

    ``make`` is called with the fields by name and returns data of type ``data``, which
    by default is ``make`` itself. ``take`` is the inverse; fields that it omits are not
    written. A sequence may replace the data; its elements are the fields in ``order``.
    """
    listed = f"with the fields {', '.join(fields)}"
    names = {key: f.name or key.removesuffix("_deg") for key, f in fields.items()}
    required = [key for key, field in fields.items() if field.absent is REQUIRED]

    def decode(value: Any) -> Any:
        """Make the data of a task from a plain value."""
        return make(**{names[k]: f.kind.decode(value[k]) for k, f in fields.items()})

    typed = data or (make if isinstance(make, type) else object)
    keys = {name: key for key, name in names.items()}
    return Kind(
        f"a section {listed}",
        f"sections {listed}",
        _object_schema(fields, required),
        partial(_read_section, fields),
        decode,
        _SectionEncoder(fields, keys, typed, take, order).encode,
        REQUIRED if required else {},
        fields,
    )


def shorthand(kind: Kind, key: str) -> Kind:
    """Kind of a section that may also be written as a single text: the value of the
    field ``key``.
    """

    def read(value: Any, place: Place) -> Any:
        """Read a section, or the single text in its place."""
        if isinstance(value, str):
            value = {key: value}
        return kind.read(value, place)

    return replace(
        kind,
        words=f"{kind.words}, or its {key} alone",
        json={"anyOf": [{"type": "string"}, kind.json]},
        read=read,
    )


def nullable(kind: Kind) -> Kind:
    """Kind of a value that may be null, and is null if the file omits it."""

    def unless_null(step: Callable[..., Any]) -> Callable[..., Any]:
        """Read null, or a value."""
        return lambda value, *place: None if value is None else step(value, *place)

    return replace(
        kind,
        words=f"{kind.words} or null",
        json={"anyOf": [kind.json, {"type": "null"}]},
        read=unless_null(kind.read),
        decode=unless_null(kind.decode),
        encode=unless_null(kind.encode),
        absent=None,
    )


def degrees(radians: Any) -> Any:
    """Angle [deg] that math.radians converts back to exactly ``radians``, with few
    digits if possible.

    If there is no such angle, the result is that of math.degrees. A value that is not a
    number is returned as plain data.
    """
    radians = plain_value(radians)
    if isinstance(radians, bool) or not isinstance(radians, int | float):
        return radians
    value = math.degrees(radians)
    candidates = [round(value, digits) for digits in (0, 1, 2, 3, 4, 6, 8, 10, 12)]
    candidates.append(value)
    down = up = value
    for _ in range(4):
        down = math.nextafter(down, -math.inf)
        up = math.nextafter(up, math.inf)
        candidates += [down, up]
    return next((c for c in candidates if math.radians(c) == radians), value)
