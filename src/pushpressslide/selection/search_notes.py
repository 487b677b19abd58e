"""What a search over sequences of motions tried, and why it was dropped."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class RefusedMotions:
    """Motions between two poses that a mode cannot do, all for one reason."""

    mode: str
    code: str  # of the refusals
    count: int
    text: str  # of the first of them


@dataclass(frozen=True, slots=True)
class DroppedSequence:
    """A sequence whose motions are possible each, but not for the arms."""

    modes: tuple[str, ...]
    time: float  # [s] that it would have taken
    why: str


@dataclass(frozen=True, slots=True)
class Searched:
    """What a search has tried."""

    poses: int  # on the way
    evaluated: int  # motions
    refused: tuple[RefusedMotions, ...] = ()  # the most frequent first
    dropped: tuple[DroppedSequence, ...] = ()  # in their order

    @property
    def notes(self) -> dict[str, Any]:
        """What a record keeps of it, by the keys of result.json."""
        data = asdict(self)
        return {"judged" if key == "evaluated" else key: data[key] for key in data}
