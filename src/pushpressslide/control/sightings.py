"""What pictures tell beside the object's pose, for the result alone: their delay, where
tips touch the faces that they push, and how a single tip turns the object.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.control.following import BoundLaws
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import TipState
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.identification.pressed_travel import (
    PressedPicture,
    PressedTravels,
)
from pushpressslide.identification.running_mean import RunningMean
from pushpressslide.identification.turning import Sight, TurnState
from pushpressslide.rom.drives import PressedDrive, RearSteerDrive, UnicycleDrive

NO_MEAN = RunningMean()
BETWEEN = 0.09  # [s] least time between two pictures compared with tips: it costs time
TURNS_TELL = (RearSteerDrive, UnicycleDrive)
"""Drives by one tip that head along the line through the contact."""
INDEPENDENT = 3.0
"""The same as a multiple of the time over which the noise of poses is correlated."""


class Sightings(NamedTuple):
    """Means over the pictures of a placement."""

    delay: RunningMean = NO_MEAN  # [s] from a picture's stamp to its arrival
    # [m] by contact: how deep its tip's sphere is in the face that it pushes, as the
    # tip is measured and the face seen
    depths: tuple[RunningMean, ...] = ()
    turns: TurnState = TurnState()  # of an object that a single tip moves
    pressed: PressedTravels = PressedTravels()  # of an object that a single press drags
    compared: float = -math.inf  # [s] stamp of the last one compared with tips

    def arrived(self, stamp: float, time: float) -> Sightings:
        """With a new picture of the ``stamp`` [s] that arrived at ``time`` [s]."""
        return self._replace(delay=self.delay.including(time - stamp))


class Estimated(NamedTuple):
    """What is estimated at the stamp of a picture."""

    X_WG: Pose2
    deviation: float = 0.0  # [rad] standard deviation of its yaw
    # [m] from where a single tip is measured to where it is seen to be, world
    tip_error: Point = (0.0, 0.0)


class PictureComparison:
    """Compares pictures of a driven object with the tips that drive it."""

    def __init__(self, query: MotionQuery) -> None:
        """Bind to the believed object and tips."""
        self._X_GB = query.X_GB
        self._radii = tuple(robot.tip_radius for robot in query.scene.robots)
        self._felt = query.sensing.felt_force
        self._between = max(BETWEEN, INDEPENDENT * query.sensing.noise_time)

    def due(self, before: Sightings, picture: StampedPose) -> bool:
        """Whether a new ``picture`` is to be compared: one in a while, whose noise is its
        own.
        """
        return picture.time - before.compared >= self._between

    def step(
        self,
        before: Sightings,
        picture: StampedPose,
        estimated: Estimated,
        places: Sequence[Point],
        binding: BoundLaws,
        tips: Sequence[TipState],
    ) -> Sightings:
        """``before`` and a ``picture`` of an object that was ``estimated`` there.

        ``places`` [m] are those of the contacts' tips at that time, empty if they did
        not drive the object.
        """
        if not places:
            return before._replace(
                turns=before.turns.paused(), pressed=before.pressed.paused()
            )
        turns = before.turns.paused()
        drive = binding.segment.drive
        if isinstance(drive, TURNS_TELL):
            sight = Sight(places[0], estimated.X_WG.yaw, picture.X_WG.yaw)
            turns = before.turns.including(sight)
        pressed = before.pressed
        if isinstance(drive, PressedDrive):
            (contact,) = binding.segment.contacts
            (x, y), (off_x, off_y) = places[0], estimated.tip_error
            tip = (x + off_x, y + off_y)
            fx, fy, _ = tips[contact.arm].force
            force = math.hypot(fx, fy)
            pressed = pressed.including(
                PressedPicture(
                    estimated.X_WG, estimated.deviation, tip, contact.load, force
                )
            )
        depths = before.depths or (NO_MEAN,) * len(places)
        depths = self._depths(depths, picture.X_WG, places, binding, tips)
        return before._replace(
            depths=depths, turns=turns, pressed=pressed, compared=picture.time
        )

    def _depths(
        self,
        before: Sequence[RunningMean],
        X_WG: Pose2,
        places: Sequence[Point],
        binding: BoundLaws,
        tips: Sequence[TipState],
    ) -> tuple[RunningMean, ...]:
        """Depths with those in a picture. The present forces say which tips touch."""
        X_WB = X_WG.compose(self._X_GB)
        means = list(before)
        pairs = zip(binding.segment.contacts, binding.sides, strict=True)
        for i, (contact, side) in enumerate(pairs):
            if side is None:
                continue
            fx, fy, _ = tips[contact.arm].force
            x, y, _ = contact.direction(X_WB)
            if fx * x + fy * y < self._felt:
                continue
            gap, _ = side.gap(X_WB.unapply(places[i]), self._radii[contact.arm])
            if math.isfinite(gap):
                means[i] = means[i].including(-gap)
        return tuple(means)
