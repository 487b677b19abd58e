"""What is believed of an object's centre of mass during a run."""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.identification.parameter import Parameter


class CenterBelief(NamedTuple):
    """Place of the centre of mass in G, and its covariance."""

    x: float  # [m]
    y: float  # [m]
    xx: float  # [m^2]
    xy: float = 0.0
    yy: float = 0.0
    before: float = 0.0  # [m] standard deviation in every direction, before the run

    @classmethod
    def before_run(cls, scene: Scene) -> CenterBelief:
        """The belief of a ``scene`` before a run."""
        x, y = scene.body.center_of_mass
        before = math.sqrt(0.5) * scene.center_error
        return cls(x, y, before * before, 0.0, before * before, before)

    @property
    def place(self) -> Point:
        """Mean [m] in G."""
        return self.x, self.y

    @property
    def error(self) -> float:
        """Distance [m] of the centre from its mean, in the least known direction, as a
        ``belief.center_error``.
        """
        middle = 0.5 * (self.xx + self.yy)
        most = middle + math.hypot(0.5 * (self.xx - self.yy), self.xy)
        return math.sqrt(2.0 * most)

    def deviation(self, direction: Point) -> float:
        """Standard deviation [m] along a unit ``direction`` in G."""
        ex, ey = direction
        variance = ex * ex * self.xx + 2.0 * ex * ey * self.xy + ey * ey * self.yy
        return math.sqrt(max(variance, 0.0))

    def knowing(self, coordinate: Parameter | None) -> CenterBelief:
        """The belief with an identified coordinate. One at its bound leaves it as unsure
        as before.
        """
        if coordinate is None or coordinate.direction is None:
            return self
        ex, ey = coordinate.direction
        px = self.xx * ex + self.xy * ey
        py = self.xy * ex + self.yy * ey
        total = ex * px + ey * py + coordinate.deviation**2
        if total == 0.0:
            return self
        off = (coordinate.value - ex * self.x - ey * self.y) / total
        x = self.x + off * px
        y = self.y + off * py
        if coordinate.at_bound:
            return self._replace(x=x, y=y)
        return self._replace(
            x=x,
            y=y,
            xx=self.xx - px * px / total,
            xy=self.xy - px * py / total,
            yy=self.yy - py * py / total,
        )


def beside_center(placement: Plan, center: CenterBelief) -> bool:
    """Whether a ``placement`` of a single contact is planned for another centre of mass,
    across the line to its contact, than the believed ``center``.
    """
    first = placement.segments[0]
    if len(first.contacts) > 1:
        return False
    (contact,) = first.contacts
    lever = math.hypot(*contact.point)
    if lever == 0.0:
        return False
    X_GB = placement.query.X_GB
    x, y = contact.point
    ex, ey = X_GB.rotate((-y / lever, x / lever))
    planned_x, planned_y = X_GB.position
    off = abs(ex * (center.x - planned_x) + ey * (center.y - planned_y))
    sure = center.deviation((ex, ey))
    return off > max(margins.ARM.off_line * lever, sure)
