"""Summary of a search over sequences of motions: what was tried, and why it was
dropped.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class RefusedMotions:
    """Motions between two poses that a mode cannot do, all for the same reason."""

    mode: str
    code: str  # code of the refusals
    count: int
    text: str  # text of the first refusal


@dataclass(frozen=True, slots=True)
class DroppedSequence:
    """A sequence of feasible motions for which the arms have no joint path."""

    modes: tuple[str, ...]
    time: float  # [s] estimated time of the sequence
    why: str


@dataclass(frozen=True, slots=True)
class SearchNotes:
    """Everything that a search has tried."""

    poses: int  # between start and goal
    evaluated: int  # motions
    refused: tuple[RefusedMotions, ...] = ()  # the most frequent first
    dropped: tuple[DroppedSequence, ...] = ()  # in their order

    @property
    def notes(self) -> dict[str, Any]:
        """The notes on the search in a record, by the keys of result.json."""
        data = asdict(self)
        return {"judged" if key == "evaluated" else key: data[key] for key in data}
