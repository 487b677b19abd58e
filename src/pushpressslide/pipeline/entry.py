"""How a pressed object goes into an opening of the support, up to its back.

Once the support no longer carries it the object drops in, and the tips follow: pressed with its load against
a damper with which they could still stop at the back. All is told by how deep the tips are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.control import TipState
from pushpressslide.core.plan import Contact, Plan

ENTERED = 0.003  # [m] of any tip beyond where it touched at which the object counts as going in
SEATED = 0.002  # [m] from the back at which it counts as seated
SEAT_TIME = 3.0  # [s] that is waited for it at the end of the motion
BRAKE, LANDING = 1.0, 0.05  # [m/s^2] of the tips before the back, [m/s] at which they meet it


@dataclass(frozen=True, slots=True)
class Entry:
    """The way into the opening that the goal lies in."""

    stop: float  # [m] depth of its back
    radii: tuple[float, ...]  # [m] of the tips, by arm

    def depth(self, tip: TipState, contact: Contact) -> float:
        """Return how much deeper a tip is than when its contact was on the support's face [m]."""
        return contact.tip_place(self.radii[contact.arm])[1] - tip.position[2]

    def speed(self, depth: float) -> float:
        """Return the speed [m/s] at which a tip at ``depth`` [m] may go in."""
        return math.sqrt(2.0 * BRAKE * max(self.stop - depth, 0.0) + LANDING * LANDING)

    def begun(self, depths: list[float]) -> bool:
        """Return whether the object goes in."""
        return max(depths) > ENTERED

    def ended(self, depths: list[float]) -> bool:
        """Return whether the object is seated."""
        return min(depths) > self.stop - SEATED


def entry(plan: Plan) -> Entry | None:
    """Return the way into the opening that the last stretch's goal lies in; None where it lies in none."""
    task = plan.stretches[-1].task
    opening = task.support.opening
    if opening is None or not task.enters:
        return None
    return Entry(opening.depth, tuple(robot.tip_radius for robot in task.robots))
