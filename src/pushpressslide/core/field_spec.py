"""Field specs of the task file: metadata of the dataclasses.

The reader, its messages, the dump, help(), the tables in the documentation and the JSON
Schema are all derived from these specs. To add a field, only its dataclass has to be
changed.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from typing import Any, TypeVar

T = TypeVar("T")

REQUIRED: Any = object()
"""Default of a required field."""

FRICTIONS = "(0, 2)"
"""Range of the friction coefficient of a pair of surfaces."""


@dataclass(frozen=True, slots=True)
class FieldSpec:
    """Spec of one field of the task file."""

    meaning: str
    # unit in the file; an angle is in degrees there ("deg", key in _deg), in radians
    # here
    unit: str = ""
    within: str = ""  # range of a number, with a round bracket at an open end: "(0, 2]"
    key: str = ""  # key in the file, if it is not the field's name
    section: str = ""  # meaning of section ``a``, for a key ``a.b``
    # default in the file, if it is not that of the data
    default_in_file: Any = REQUIRED
    # smallest and largest number of items in a list
    count: tuple[int, float] = (0, math.inf)
    is_name: bool = False  # a text that is a name: letters, digits, - _ .


def field_spec(
    meaning: str, unit: str = "", within: str = "", **details: Any
) -> Mapping[str, FieldSpec]:
    """Metadata of a field of the task file.

    ``details`` are fields of :class:`FieldSpec`.
    """
    return {"entry": FieldSpec(meaning, unit, within, **details)}


def setting(
    default: T, meaning: str, unit: str = "", within: str = "", **details: Any
) -> T:
    """Dataclass field with a default and a spec for the task file."""
    metadata = field_spec(meaning, unit, within, **details)
    return field(default=default, metadata=metadata)


def documented(data: type[T]) -> type[T]:
    """Dataclass whose docstring ends with a list of its fields: meaning, unit, range,
    default.
    """
    data.__doc__ = "\n".join([str(data.__doc__).rstrip(), "", *_help_lines(data)])
    return data


def _help_lines(data: Any) -> Iterator[str]:
    """Yield help lines on the fields of a dataclass, in SI units and radians."""
    wrap = textwrap.TextWrapper(
        width=88, initial_indent=8 * " ", subsequent_indent=12 * " "
    )
    yield "    Fields:"
    for one in fields(data):
        spec = one.metadata.get("entry")
        if spec is not None:
            yield from wrap.wrap(_help_text(spec, one))


def _help_text(spec: FieldSpec, one: Field[Any]) -> str:
    """Name, unit, range, default and meaning of a field, with angles in radians."""
    text = one.name
    in_degrees = spec.unit in ("deg", "deg/s")
    if spec.unit:
        text += f" [{spec.unit.replace('deg', 'rad')}]"
    if spec.within:
        text += f" in {_in_radians(spec.within) if in_degrees else spec.within}"
    default = None if spec.default_in_file is None else one.default
    has_default = one.default is not MISSING
    if has_default and not hasattr(default, "__dataclass_fields__"):
        shown = f"{default:.4g}" if isinstance(default, float) else repr(default)
        text += f", default {shown}"
    return f"{text}: {spec.meaning.replace('null', 'None')}"


def _in_radians(within: str) -> str:
    """Range of an angle in radians, from its range in degrees."""
    low, high = (math.radians(float(end)) for end in within[1:-1].split(","))
    return f"{within[0]}{low:.4g}, {high:.4g}{within[-1]}"
