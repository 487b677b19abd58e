"""Friction of tips that slide over the top of an object, from their forces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.core.control import Vector3
from pushpressslide.identification.parameter import Parameter

ROLLED = 0.015
"""Standard deviation of a friction that forces without noise tell: a tip also rolls and
sinks in.
"""
MOST_UNSURE = 0.2
"""Largest standard deviation, as a share of the friction."""

LEAST_LOAD = 0.5
"""Smallest load of a tip that tells its friction, as a share of the planned one."""


class TipFriction(NamedTuple):
    """Identified friction of the tips, and the forces that told it."""

    value: float
    deviation: float  # standard deviation
    load: float  # [N] of all tips on the object
    drag: float  # [N] of all tips together, along the top

    @classmethod
    def of_slide(
        cls, forces: Sequence[Vector3], planned: float, unsure: float
    ) -> TipFriction | None:
        """Friction of presses with the ``forces`` [N] on the object, in the support's
        frame, of which one slides: that with the largest share of its load.

        ``unsure`` [N] is the standard deviation of each component. None if a tip
        hardly presses, beside the ``planned`` load [N] of each, or too little is known.
        """
        loads = [-z for _, _, z in forces]
        drags = [math.hypot(x, y) for x, y, _ in forces]
        if not min(loads) >= LEAST_LOAD * planned > 0.0 or not max(drags) > 0.0:
            return None
        value, load = max((drag / n, n) for drag, n in zip(drags, loads, strict=True))
        force = math.sqrt(1.0 + value * value) * unsure
        deviation = math.hypot(force / load, ROLLED)
        if not deviation < MOST_UNSURE * value:
            return None
        drag = math.hypot(*(math.fsum(force[i] for force in forces) for i in (0, 1)))
        return cls(value, deviation, math.fsum(loads), drag)

    def parameter(self, belief: float) -> Parameter:
        """The identified friction beside the ``belief`` before."""
        return Parameter(self.value, self.deviation, belief)
