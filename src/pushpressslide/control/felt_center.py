"""Centre of mass of an object that two tips push, by the line of the felt force."""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.core import margins
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Point
from pushpressslide.core.query import MotionQuery
from pushpressslide.identification.felt_drag import FeltDrag
from pushpressslide.identification.online import MEMORY
from pushpressslide.identification.parameter import Parameter
from pushpressslide.identification.parameter_estimates import ParameterEstimates
from pushpressslide.rom.drives import TwistDrive

OFF = 0.1
"""Share of the tips' distance by which a centre is elsewhere, before it counts."""
TURNS = 2  # the twist of a centre depends on where it is


class FeltCenter(NamedTuple):
    """Centre of mass across a felt force."""

    center: CenterBelief
    told: Parameter  # what the force tells of it
    apart: float  # [m] distance of the tips

    def with_center(
        self, estimates: ParameterEstimates, segment: Segment, query: MotionQuery
    ) -> ParameterEstimates:
        """The ``estimates`` with the centre, if it contradicts that of a followed
        ``segment``.
        """
        x, y = query.X_GB.inverse().apply(self.center.place)
        drive = segment.drive
        assert isinstance(drive, TwistDrive)
        off = math.dist((x, y), drive.offset)
        direction = self.told.direction
        assert direction is not None
        deviation = self.center.deviation(direction)
        if off < max(OFF * self.apart, deviation):
            return estimates._replace(center=drive.offset)
        lever = math.hypot(*segment.contacts[0].point)
        return estimates._replace(
            center=(x, y), doubt=deviation / lever, elsewhere=True
        )


def felt_center(
    felt: FeltDrag, segment: Segment, query: MotionQuery, before: CenterBelief
) -> FeltCenter | None:
    """Centre of mass that two pushes feel, which was believed at ``before``. None if it
    is sure, or not known yet.
    """
    drive = segment.drive
    if before.before == 0.0 or not isinstance(drive, TwistDrive):
        return None
    first, second = segment.contacts
    apart = math.dist(first.point, second.point)
    period = query.motion.control_period
    share = math.sqrt(period / MEMORY + period / margins.ARM.first_look)
    noise = share * query.sensing.force_noise
    X_GB = query.X_GB
    X_BG = X_GB.inverse()
    pressed = drive.at((0.0, 0.0)).surface.center
    center = before
    for _ in range(TURNS):
        surface = drive.at(X_BG.apply(center.place)).surface
        line = felt.line(surface, noise, apart)
        if line is None:
            return None
        direction = X_GB.rotate(line.across)
        value = line.value - _along(pressed, line.across)
        value += _along(X_GB.position, direction)
        known = _along(before.place, direction)
        most = math.sqrt(2.0) * before.before
        within = min(max(value, known - most), known + most)
        told = Parameter(within, line.deviation, known, direction, within != value)
        center = before.knowing(told)
    return FeltCenter(center, told, apart)


def _along(point: Point, direction: Point) -> float:
    return point[0] * direction[0] + point[1] * direction[1]
