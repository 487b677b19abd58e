"""Drag of an object that several tips move, by what they feel: the force that slides it
straight, mu_s N.

While an object slides, its support resists by as much however hard the tips are
commanded to push. The tips' own motion tells whether it slides. On the ellipsoid with
the radius rho, a force F with the moment m about the centre of pressure slides an object
whose straight drag is sqrt(F^2 + (m / rho)^2) (docs/mechanics.md, section 1).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.wrench import Wrench
from pushpressslide.identification.online import LEAST_SPEED, MEMORY

ENOUGH = 0.3
"""[s] of sliding that tell the drag."""


class FeltDrag(NamedTuple):
    """Wrench on a sliding object, summed over time with forgetting."""

    fx: float = 0.0  # [N s] in B
    fy: float = 0.0
    tau: float = 0.0  # [N m s] about the drive's centre
    time: float = 0.0  # [s] that the sums have

    def step(self, wrench: Wrench, power: float, dt: float) -> FeltDrag:
        """The sums after a tick of ``dt`` [s] with a ``wrench`` on the object in B.

        ``power`` [W] is that of the tips. An object that they do not move tells
        nothing: its support may hold it with less than it can.
        """
        if power < LEAST_SPEED * math.hypot(wrench.fx, wrench.fy):
            return self
        keep = math.exp(-dt / MEMORY)
        return FeltDrag(
            keep * self.fx + dt * wrench.fx,
            keep * self.fy + dt * wrench.fy,
            keep * self.tau + dt * wrench.tau,
            keep * self.time + dt,
        )

    def drag(self, rho: float) -> float | None:
        """Drag [N] on an ellipsoid of radius ``rho`` [m]. None before it is known."""
        if self.time < ENOUGH:
            return None
        return math.hypot(self.fx, self.fy, self.tau / rho) / self.time
