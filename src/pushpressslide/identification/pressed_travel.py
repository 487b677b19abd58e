"""Travels of a tip that presses on an object and drags it, with the turns of the object,
by pictures.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.identification.turning import along_object

STRAIGHT = 0.25
"""Largest angle [rad] between the directions of two parts of one travel."""
LONGEST = 0.05  # [m] of one travel
LEAST = 0.008  # [m] of a travel that tells anything
SLID = 0.25
"""Share of its length by which the tip of a travel that tells anything slides at most."""
MOST = 60  # number of travels that are remembered
ALIKE = 5e-3  # [m] between the places of travels that tell the same


class PressedTravel(NamedTuple):
    """Travel of a tip and turn of the object under it, both along the object's axes."""

    began: Point  # [m] of the tip in G
    ended: Point  # [m]
    load: float  # [N]
    displacement: Point  # [m] of the tip in the object's axes
    turn: float  # [rad]
    deviation: float  # [rad] standard deviation of the turn
    force: float  # [N] mean of the drag that the tip feels
    pictures: int = 1

    @property
    def place(self) -> Point:
        """Middle [m] of the tip's places in G."""
        (x0, y0), (x1, y1) = self.began, self.ended
        return 0.5 * (x0 + x1), 0.5 * (y0 + y1)

    @property
    def length(self) -> float:
        """Length [m] of the tip's displacement."""
        return math.hypot(*self.displacement)

    @property
    def direction(self) -> float:
        """Direction [rad] of the tip's displacement, in the object's axes."""
        x, y = self.displacement
        return math.atan2(y, x)

    @property
    def tells(self) -> bool:
        """Whether the travel tells how a tip that sticks turns the object."""
        slid = math.dist(self.began, self.ended)
        return self.length > LEAST and slid < SLID * self.length

    def straight_on(self, other: PressedTravel) -> bool:
        """Whether the ``other`` travel has the same direction."""
        return abs(wrap_angle(other.direction - self.direction)) <= STRAIGHT

    def joined(self, other: PressedTravel) -> PressedTravel | None:
        """Both as one travel. None if they lead elsewhere, or are too long."""
        length = self.length + other.length
        if length > LONGEST or self.load != other.load or not self.straight_on(other):
            return None
        joined = self.with_more(other)
        unsure = max(self.deviation, other.deviation)
        return joined._replace(ended=other.ended, deviation=unsure)

    def repeats(self, other: PressedTravel) -> bool:
        """Whether the travel tells the same as an ``other`` one."""
        near = math.dist(self.place, other.place) < ALIKE
        return near and self.load == other.load and self.straight_on(other)

    def with_more(self, other: PressedTravel) -> PressedTravel:
        """Both as one travel from where this one began. Their errors are independent."""
        (ax, ay), (bx, by) = self.displacement, other.displacement
        pictures = self.pictures + other.pictures
        return PressedTravel(
            self.began,
            self.ended,
            self.load,
            (ax + bx, ay + by),
            self.turn + other.turn,
            math.hypot(self.deviation, other.deviation),
            (self.pictures * self.force + other.pictures * other.force) / pictures,
            pictures,
        )


def without_repeats(travels: Sequence[PressedTravel]) -> list[PressedTravel]:
    """The ``travels``, with those that tell the same as one."""
    out: list[PressedTravel] = []
    for travel in travels:
        for i, other in enumerate(out):
            if other.repeats(travel):
                out[i] = other.with_more(travel)
                break
        else:
            out.append(travel)
    return out


class PressedPicture(NamedTuple):
    """An object under a press in a picture."""

    X_WG: Pose2
    deviation: float  # [rad] standard deviation of the yaw
    tip: Point  # [m]
    load: float  # [N]
    force: float  # [N] along the support


class PressedTravels(NamedTuple):
    """Travels of a placement, and the last picture of an uninterrupted drag."""

    travels: tuple[PressedTravel, ...] = ()
    last: PressedPicture | None = None

    def paused(self) -> PressedTravels:
        """The same while the tip does not drag the object."""
        return self if self.last is None else self._replace(last=None)

    def including(self, picture: PressedPicture) -> PressedTravels:
        """The same with one more ``picture``."""
        before = self.last
        if before is None:
            return self._replace(last=picture)
        turn = wrap_angle(picture.X_WG.yaw - before.X_WG.yaw)
        (x, y), (before_x, before_y) = picture.tip, before.tip
        step = (x - before_x, y - before_y)
        fresh = PressedTravel(
            before.X_WG.unapply(before.tip),
            picture.X_WG.unapply(picture.tip),
            picture.load,
            along_object(step, before.X_WG.yaw, turn),
            turn,
            math.sqrt(2.0) * picture.deviation,
            picture.force,
        )
        travels = self.travels
        joined = travels[-1].joined(fresh) if travels else None
        if joined is None:
            if travels and not travels[-1].tells:
                travels = travels[:-1]  # as of a tip at rest
            travels = (*travels[1 - MOST :], fresh)
        else:
            travels = (*travels[:-1], joined)
        return PressedTravels(travels, picture)

    @property
    def telling(self) -> tuple[PressedTravel, ...]:
        """Travels that tell how the object turns."""
        return tuple(one for one in self.travels if one.tells)
