"""What a search over sequences of motions tried, and why it was dropped."""

from __future__ import annotations

from dataclasses import dataclass


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
    judged: int  # motions
    refused: tuple[RefusedMotions, ...] = ()  # the most frequent first
    dropped: tuple[DroppedSequence, ...] = ()  # in their order
