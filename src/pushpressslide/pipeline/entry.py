"""How a pressed object goes into an opening of the support, up to its back.

Once the support no longer carries it the object drops in, and the tips follow: pressed with its load against
a damper with which they could still stop at the back. All is told by how deep the tips are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.control import Measurement
from pushpressslide.core.plan import Plan

ENTERED = 0.003  # [m] of any tip beyond where it touched at which the object counts as going in
SEATED = 0.002  # [m] from the back at which it counts as seated
SEAT_TIME = 3.0  # [s] that is waited for it at the end of the motion
BRAKE, LANDING = 1.0, 0.05  # [m/s^2] of the tips before the back, [m/s] at which they meet it


@dataclass(frozen=True, slots=True)
class Entry:
    """The way into the opening that the goal lies in."""

    stop: float  # [m] depth of its back
    tips: tuple[tuple[int, float], ...]  # of each contact: its arm, and the tip's height [m] on the face

    def depths(self, measurement: Measurement) -> list[float]:
        """Return how much deeper each tip is than when its contact was on the face [m]."""
        return [height - measurement.tips[arm].position[2] for arm, height in self.tips]

    def speeds(self, measurement: Measurement) -> list[float | None]:
        """Return the speed [m/s] at which each tip may go in; None while the support is pressed."""
        depths = self.depths(measurement)
        if max(depths) <= ENTERED:
            return [None] * len(depths)
        lefts = (max(self.stop - depth, 0.0) for depth in depths)
        return [math.sqrt(2.0 * BRAKE * left + LANDING * LANDING) for left in lefts]

    def seated(self, measurement: Measurement) -> bool:
        """Return whether all tips are as deep as they go."""
        return min(self.depths(measurement)) > self.stop - SEATED


def entry(plan: Plan) -> Entry | None:
    """Return the way into the opening that the last stretch's goal lies in; None where it lies in none."""
    task = plan.stretches[-1].task
    opening = task.support.opening
    if opening is None or not task.enters:
        return None
    contacts = plan.choice.contacts
    return Entry(
        opening.depth, tuple((c.arm, c.tip_place(task.robots[c.arm].tip_radius)[1]) for c in contacts)
    )
