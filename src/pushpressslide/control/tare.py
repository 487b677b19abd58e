"""Zero of the force sensors, found while the tips touch nothing."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.core.control import TipState, Vector3


class Tare:
    """The mean force of each sensor without contact, and what is measured beyond it."""

    def __init__(self, arms: int) -> None:
        """Start without measurements of any arm."""
        self._sums: list[Vector3] = [(0.0, 0.0, 0.0)] * arms
        self._counts = [0] * arms
        self._measured = False  # whether a free tip has measured any force

    def add(self, tips: Sequence[TipState], free: Sequence[bool]) -> None:
        """Take the measured forces of the tips that are ``free``."""
        for arm, (tip, alone) in enumerate(zip(tips, free, strict=True)):
            if alone:
                x, y, z = self._sums[arm]
                fx, fy, fz = tip.force
                self._sums[arm] = (x + fx, y + fy, z + fz)
                self._counts[arm] += 1
                self._measured = self._measured or any(tip.force)

    def removed(self, tips: Sequence[TipState]) -> tuple[TipState, ...]:
        """The ``tips`` without the mean force that they measure in the air."""
        if not self._measured:
            return tuple(tips)
        return tuple(self._removed(arm, tip) for arm, tip in enumerate(tips))

    def _removed(self, arm: int, tip: TipState) -> TipState:
        total = self._sums[arm]
        if total == (0.0, 0.0, 0.0):
            return tip
        share = 1.0 / self._counts[arm]
        fx, fy, fz = tip.force
        x = fx - share * total[0]
        y = fy - share * total[1]
        z = fz - share * total[2]
        return TipState(tip.position, tip.velocity, (x, y, z))
