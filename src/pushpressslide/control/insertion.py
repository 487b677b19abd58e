"""Insertion of a pressed object into an opening of the support, as far as its back.

When the support no longer carries the object, it drops in and the tips follow. A damper
acts against their load and limits the tips to a speed from which they can still stop at
the back. Feed-forward brakes the arm's own inertia. Only the depth of the tips is
measured.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pushpressslide.core.control import TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Scene

# [m] motion of any tip beyond its first contact at which the object counts as entering
ENTERED = 0.002
SEATED = 0.002
# [m] distance from the back and [m/s] speed of the tips below which it counts as seated
AT_REST = 0.01
SEAT_TIME = 3.0  # [s] longest wait for this at the end of the motion
HOLD_TIME = 0.5  # [s] for which an object is held at a goal if nothing else carries it
BRAKE = 1.0
# [m/s^2] deceleration of the tips before the back, and [m/s] speed at which they meet
# it
LANDING = 0.05


@dataclass(frozen=True, slots=True)
class Insertion:
    """Insertion into the opening that the goal lies in."""

    stop: float  # [m] depth of its back
    # of each contact: its arm, and the tip's height [m] on the face
    tips: tuple[tuple[int, float], ...]

    def depths(self, tips: Sequence[TipState]) -> list[float]:
        """Depth [m] of each tip below its height on an object that rests on the
        support.
        """
        return [height - tips[arm].position[2] for arm, height in self.tips]

    def speeds(
        self, measured: Sequence[TipState], begun: Sequence[Vector3]
    ) -> list[float | None]:
        """Allowed insertion speed [m/s] of each tip. None while the object still rests
        on the support.

        ``begun`` [m] is the position of each tip at the start of the motion, when its
        load already presses it into the face.
        """
        tips = (measured[arm] for arm, _ in self.tips)
        if (
            max(p[2] - tip.position[2] for p, tip in zip(begun, tips, strict=True))
            <= ENTERED
        ):
            return [None] * len(self.tips)
        lefts = (max(self.stop - depth, 0.0) for depth in self.depths(measured))
        return [math.sqrt(2.0 * BRAKE * left + LANDING * LANDING) for left in lefts]

    def seated(self, tips: Sequence[TipState]) -> bool:
        """Whether all tips are fully inserted and at rest."""
        fastest = max(abs(tips[arm].velocity[2]) for arm, _ in self.tips)
        return min(self.depths(tips)) > self.stop - SEATED and fastest < AT_REST


def braking(speed: float, allowed: float) -> float:
    """Deceleration [m/s^2] that keeps a tip inserted at ``speed`` [m/s] within the
    allowed speed.
    """
    return BRAKE * min(1.0, (speed / allowed) ** 2) if speed > 0.0 else 0.0


def insertion_of(
    scene: Scene, goal: Pose2, contacts: Sequence[Contact]
) -> Insertion | None:
    """Insertion into the opening that ``goal``, X_WG, lies in, or None."""
    opening = scene.support.opening
    if opening is None or not scene.enters(goal):
        return None
    tips = tuple(
        (contact.arm, contact.tip_place(scene.robots[contact.arm].tip_radius)[1])
        for contact in contacts
    )
    return Insertion(opening.depth, tips)
