"""What pictures tell beside the object's pose, for the result alone: their delay, and
where tips touch the faces that they push.
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
from pushpressslide.geometry.sides import Side
from pushpressslide.identification.running_mean import RunningMean

NO_MEAN = RunningMean()
BETWEEN = 0.015  # [s] least time between two pictures that are compared with tips
INDEPENDENT = 3.0
"""The same as a multiple of the time over which the noise of poses is correlated."""


class Sightings(NamedTuple):
    """Means over the pictures of a placement."""

    delay: RunningMean = NO_MEAN  # [s] from a picture's stamp to its arrival
    # [m] by contact: how deep its tip's sphere is in the face that it pushes, as the
    # tip is measured and the face seen
    depths: tuple[RunningMean, ...] = ()
    compared: float = -math.inf  # [s] stamp of the last picture for the depths

    def arrived(self, stamp: float, time: float) -> Sightings:
        """With a new picture of the ``stamp`` [s] that arrived at ``time`` [s]."""
        return self._replace(delay=self.delay.including(time - stamp))


class TouchComparison:
    """Compares measured tips with the faces that pictures show."""

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
        places: Sequence[Point],
        binding: BoundLaws,
        tips: Sequence[TipState],
    ) -> Sightings:
        """``before`` and a ``picture``, taken while the contacts drove the object.

        ``places`` [m] are those of the contacts' tips at that time. The forces of
        ``tips`` say which of them touch.
        """
        X_WB = picture.X_WG.compose(self._X_GB)
        contacts = binding.segment.contacts
        means = list(before.depths or (NO_MEAN,) * len(contacts))
        for i, (contact, side) in enumerate(zip(contacts, binding.sides, strict=True)):
            if side is None:
                continue
            fx, fy, _ = tips[contact.arm].force
            x, y, _ = contact.direction(X_WB)
            if fx * x + fy * y < self._felt:
                continue
            depth = _depth(side, X_WB, places[i], self._radii[contact.arm])
            if math.isfinite(depth):
                means[i] = means[i].including(depth)
        return before._replace(depths=tuple(means), compared=picture.time)


def _depth(side: Side, X_WB: Pose2, place: Point, radius: float) -> float:
    """Depth [m] in a ``side`` of the sphere of a tip at ``place`` [m], infinite beyond
    its ends.
    """
    gap, _ = side.gap(X_WB.unapply(place), radius)
    return -gap
