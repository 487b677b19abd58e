"""Field specs of the task file: metadata of the dataclasses.

The reader, its messages, the dump, the tables of the documentation and the JSON Schema
are all derived from these specs. A new field needs a change only in its dataclass.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

T = TypeVar("T")

REQUIRED: Any = object()
"""Default of a field that the file must give."""

FRICTIONS = "(0, 2)"
"""Range of the friction coefficient of a pair of surfaces."""


@dataclass(frozen=True, slots=True)
class FieldSpec:
    """Spec of one field of the task file."""

    meaning: str
    # of the file; an angle is in degrees there ("deg", key in _deg), in radians here
    unit: str = ""
    within: str = ""  # range of a number, an open end in a round bracket: "(0, 2]"
    key: str = ""  # in the file, if it is not the field's name
    section: str = ""  # meaning of the section of its own that ``a`` of key ``a.b`` is
    default_in_file: Any = REQUIRED  # if it is not the data's
    count: tuple[int, float] = (0, math.inf)  # least and most items of a list
    is_name: bool = False  # a text that names something: letters, digits, - _ .


def field_spec(
    meaning: str, unit: str = "", within: str = "", **details: Any
) -> Mapping[str, FieldSpec]:
    """Metadata of a field of the task file.

    ``details`` are those of :class:`Entry`.
    """
    return {"entry": FieldSpec(meaning, unit, within, **details)}


def setting(
    default: T, meaning: str, unit: str = "", within: str = "", **details: Any
) -> T:
    """Dataclass field with a default and a task file spec."""
    metadata = field_spec(meaning, unit, within, **details)
    return field(default=default, metadata=metadata)
