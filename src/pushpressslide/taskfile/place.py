"""Position of a value in a task file, and the error for an invalid value there."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, replace

from pushpressslide.core.errors import TaskError

Fault = tuple[str, object, str]
"""A fault in a file: the field's dotted name, its value, and the allowed values."""


def refuse(source: str, faults: Iterable[Fault]) -> None:
    """Raise TaskError for the first of the faults, if there is one."""
    for fault in faults:
        raise TaskError(source, *fault)


def nearest(name: object, known: Iterable[str]) -> str:
    """Text ``did you mean 'x'? known: ...``. The question is omitted if no known name
    is similar.
    """
    names = list(known)
    close = difflib.get_close_matches(str(name)[:64], names, n=1, cutoff=0.6)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}known: {', '.join(names)}"


@dataclass(frozen=True, slots=True)
class Place:
    """A field of a file, or the whole file."""

    source: str  # names the file
    path: str = ""  # dotted name of the field, list items by index
    allowed: str = ""  # allowed values in words
    # whether numbers are held to their ranges; not in a file of this package's own
    bounded: bool = True

    def field(self, key: object, allowed: str = "") -> Place:
        """Place of a field in this section."""
        path = f"{self.path}.{key}" if self.path else str(key)
        return replace(self, path=path, allowed=allowed)

    def item(self, index: int, allowed: str = "") -> Place:
        """Place of an element in this list."""
        return replace(self, path=f"{self.path}[{index}]", allowed=allowed)

    def refused(self, value: object, fault: str = "") -> TaskError:
        """Error for a value at this place: the cause, and the allowed values."""
        reason = f"{fault}allowed: {self.allowed}"
        return TaskError(self.source, self.path, value, reason)
