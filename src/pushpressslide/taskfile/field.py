"""One field of the task file: its type, unit, range, default and meaning, and what it
takes in words.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

Kind = Literal[
    "number",
    "integer",
    "boolean",
    "text",
    "name",
    "names",
    "numbers",
    "points",
    "section",
    "sections",
]

REQUIRED: Any = object()
"""Default of a field that the file must give."""


@dataclass(frozen=True, slots=True)
class Field:
    """One field of the file; a default of None means that the field may also be given
    as null.
    """

    kind: Kind
    help: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False  # the bound itself is not allowed
    open_high: bool = False
    default: Any = REQUIRED
    choices: tuple[str, ...] = ()  # of a text; words in place of a number
    count: tuple[int, float] = (0, math.inf)  # least and most items of a list
    # of a section, or of each section in a list
    fields: Mapping[str, Field] | None = None

    @property
    def interval(self) -> str:
        """The range of a number, in words: ``in (0, 2)``, ``> 0``, or nothing."""
        if math.isinf(self.low) and math.isinf(self.high):
            return ""
        if math.isinf(self.high):
            return f"{'>' if self.open_low else '>='} {self.low:g}"
        return (
            f"in {'(' if self.open_low else '['}{self.low:g}, "
            f"{self.high:g}{')' if self.open_high else ']'}"
        )

    @property
    def size(self) -> str:
        """The number of items of a list, in words."""
        low, high = self.count
        if low == high:
            return f"{low}"
        return f"{low} or more" if math.isinf(high) else f"{low} to {high:g}"

    @property
    def allowed(self) -> str:
        """What the field takes, in words."""
        number = " ".join(
            filter(None, (f"[{self.unit}]" if self.unit else "", self.interval))
        )
        match self.kind:
            case "number":
                words = f"{', '.join((*self.choices, 'a finite number'))} {number}"
            case "integer":
                words = f"a whole number {number}"
            case "boolean":
                words = "true or false"
            case "text":
                words = f"one of {', '.join(self.choices)}" if self.choices else "text"
            case "name":
                words = "a name: a letter, then letters, digits, '-', '_' or '.', at most 64 characters"
            case "names":
                words = f"a list of {self.size} names"
            case "numbers":
                words = f"a list of {self.size} finite numbers {number}"
            case "points":
                words = f"a list of {self.size} points [x, y], each two finite numbers {number}"
            case "section":
                words = f"a section with the fields {', '.join(self.fields or ())}"
            case "sections":
                words = f"a list of {self.size} sections with the fields {', '.join(self.fields or ())}"
        return words.strip() + (" or null" if self.default is None else "")
