"""Friction of tips that slide over the top of an object, from their forces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.core.control import Vector3
from pushpressslide.identification.parameter import Parameter

ROLLED = 0.02
"""Standard deviation of an identified friction of the tips, as a share of it: a tip also
rolls and sinks in.
"""


class TipFriction(NamedTuple):
    """Identified friction of the tips."""

    value: float
    deviation: float  # standard deviation

    @classmethod
    def of_slide(cls, forces: Sequence[Vector3], unsure: float) -> TipFriction | None:
        """Friction of presses that slide with the ``forces`` [N] on the object, in the
        support's frame. None if they do not press.

        ``unsure`` [N] is the standard deviation of each component.
        """
        normal = -math.fsum(z for _, _, z in forces)
        along = math.fsum(math.hypot(x, y) for x, y, _ in forces)
        if normal <= 0.0:
            return None
        value = along / normal
        force = math.sqrt(len(forces) * (1.0 + value * value)) * unsure
        return cls(value, math.hypot(force / normal, ROLLED * value))

    def beside(self, believed: float) -> Parameter:
        """The identified friction beside the ``believed`` one."""
        return Parameter(self.value, self.deviation, believed)
