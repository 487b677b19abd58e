"""Watch over the distance between arms, once the object may be off its plan.

A plan keeps the arms apart where they follow it. Corrections lead the tips beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pushpressslide.core.arrays import Array
from pushpressslide.core.record import Ending

Spacing = Callable[[Sequence[Array]], float]
"""Smallest distance [m] between any two arms, whose joint positions (n,) are given."""

REACTION = 0.05  # [s] in which arms that approach each other are stopped
TOO_NEAR = -0.005  # [m] of the arms' outlines, which have 1 cm to spare
FASTEST = 1.0  # [m/s] at which two arms approach each other, at most


@dataclass(slots=True)
class SpacingWatch:
    """Tells when arms are about to touch. It measures the more often the nearer they
    are.
    """

    spacing: Spacing
    _time: float = 0.0  # [s] of the last measurement
    _distance: float | None = None  # [m] then; None: none so far

    @property
    def too_near(self) -> bool:
        """Whether the arms are nearer than where they are stopped."""
        return self._distance is not None and self._distance < TOO_NEAR

    def forget(self) -> None:
        """Forget the last measurement, because the arms have moved unwatched."""
        self._distance = None

    def step(self, time: float, postures: Sequence[Array]) -> Ending | None:
        """Ending of a run whose arms would touch, or None.

        ``postures`` (n,) [rad] are the arms' joint positions at a ``time`` [s].
        """
        before = self._distance
        passed = time - self._time
        if before is not None and passed < before / FASTEST:
            return None
        distance = self.spacing(postures)
        self._time = time
        self._distance = distance
        closing = 0.0
        if before is not None and passed > 0.0:
            closing = max((before - distance) / passed, 0.0)
        if distance > closing * REACTION:
            return None
        text = f"the arms come as near as {distance * 1e3:.1f} mm"
        if closing > 0.0:
            text += f", and nearer by {closing * 1e3:.0f} mm/s"
        return Ending("collision", text)
