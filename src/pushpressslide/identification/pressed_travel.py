"""Travels of a tip that presses on an object and drags it, with the turns of the object,
by pictures.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point, Pose2, wrap_angle

STRAIGHT = 0.25
"""Largest angle [rad] between the directions of two parts of one travel."""
LONGEST = 0.05  # [m] of one travel
LEAST = 0.008  # [m] of a travel that tells anything
MOST = 60  # number of travels that are remembered


class PressedTravel(NamedTuple):
    """Travel of a tip and turn of the object under it, both along the object's axes."""

    place: Point  # [m] of the tip in G, the mean of its ends
    load: float  # [N]
    way: Point  # [m] in the object's axes
    turn: float  # [rad]
    deviation: float  # [rad] standard deviation of the turn

    @property
    def length(self) -> float:
        """Length of the way [m]."""
        return math.hypot(*self.way)

    def joined(self, other: PressedTravel) -> PressedTravel | None:
        """Both as one travel. None if they lead elsewhere, or are too long."""
        (ax, ay), (bx, by) = self.way, other.way
        between = abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by))
        size, added = self.length, other.length
        if size + added > LONGEST or self.load != other.load or between > STRAIGHT:
            return None
        share = added / (size + added) if size + added > 0.0 else 0.5
        (px, py), (qx, qy) = self.place, other.place
        return PressedTravel(
            (px + share * (qx - px), py + share * (qy - py)),
            self.load,
            (ax + bx, ay + by),
            self.turn + other.turn,
            max(self.deviation, other.deviation),
        )


class PressedTravels(NamedTuple):
    """Travels of a placement, and the last picture of an uninterrupted drag."""

    travels: tuple[PressedTravel, ...] = ()
    X_WG: Pose2 | None = None
    tip: Point = (0.0, 0.0)  # [m]

    def paused(self) -> PressedTravels:
        """The same while the tip does not drag the object."""
        return self if self.X_WG is None else self._replace(X_WG=None)

    def including(
        self, X_WG: Pose2, tip: Point, load: float, deviation: float
    ) -> PressedTravels:
        """The same with one more picture, of an object at ``X_WG`` whose yaw has the
        standard ``deviation`` [rad], dragged by a ``tip`` [m] with a ``load`` [N].
        """
        before = self.X_WG
        if before is None:
            return self._replace(X_WG=X_WG, tip=tip)
        turn = wrap_angle(X_WG.yaw - before.yaw)
        middle = Pose2(0.0, 0.0, before.yaw + 0.5 * turn)
        way = middle.unrotate((tip[0] - self.tip[0], tip[1] - self.tip[1]))
        place = X_WG.unapply(tip)
        fresh = PressedTravel(place, load, way, turn, math.sqrt(2.0) * deviation)
        travels = self.travels
        joined = travels[-1].joined(fresh) if travels else None
        if joined is None:
            travels = (*travels[1 - MOST :], fresh)
        else:
            travels = (*travels[:-1], joined)
        return PressedTravels(travels, X_WG, tip)

    @property
    def telling(self) -> tuple[PressedTravel, ...]:
        """Travels that are long enough to tell how the object turns."""
        return tuple(one for one in self.travels if one.length > LEAST)
