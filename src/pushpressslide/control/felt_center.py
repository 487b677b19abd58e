"""Centre of mass of an object that two tips push, by the line of the felt force."""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.pose_filter import HAND_EYE
from pushpressslide.core import margins
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Point, along
from pushpressslide.core.query import MotionQuery
from pushpressslide.identification.center import LEARNT
from pushpressslide.identification.felt_drag import FeltDrag
from pushpressslide.identification.parameter import Parameter
from pushpressslide.identification.parameter_estimates import ParameterEstimates
from pushpressslide.rom.drives import TwistDrive

OFF = 0.1
"""Share of the tips' distance by which a centre is elsewhere, before it counts."""
ASIDE = 1.5
"""Standard deviation of the line of a force in the object, as a multiple of that of
where one tip touches it.
"""
TURNS = 2  # the twist of a centre depends on where it is


class FeltCenter(NamedTuple):
    """Centre of mass across a felt force."""

    coordinate: Parameter  # across the force, as it tells
    place: Point  # [m] of the centre in B
    deviation: float  # [m] standard deviation across the force


def with_felt_center(
    estimates: ParameterEstimates, felt: FeltCenter | None, segment: Segment
) -> ParameterEstimates:
    """The ``estimates`` with the centre that is ``felt``, if it contradicts that of a
    followed ``segment``.
    """
    drive = segment.drive
    if not isinstance(drive, TwistDrive):
        return estimates
    followed = estimates._replace(center=drive.offset)
    if felt is None:
        return followed
    first, second = segment.contacts
    least = max(OFF * math.dist(first.point, second.point), felt.deviation)
    if math.dist(felt.place, drive.offset) < least:
        return followed
    doubt = felt.deviation / math.hypot(*first.point)
    return followed._replace(center=felt.place, doubt=doubt, elsewhere=True)


def felt_center(
    felt: FeltDrag, segment: Segment, query: MotionQuery, before: CenterBelief
) -> FeltCenter | None:
    """Centre of mass by the force of two pushes that drive twists. It was believed at
    ``before``. None for other motions, if the belief is sure, and where the force tells
    little more than it.
    """
    drive = segment.drive
    if before.before == 0.0 or felt.time == 0.0 or not isinstance(drive, TwistDrive):
        return None
    first, second = segment.contacts
    distance = math.dist(first.point, second.point)
    period = query.motion.control_period
    share = math.sqrt(period / felt.time + period / margins.ARM.first_look)
    noise = share * query.sensing.force_noise
    aside = ASIDE * min(HAND_EYE, 2.0 * query.sensing.position_noise)
    X_GB = query.X_GB
    X_BG = X_GB.inverse()
    pressed = drive.with_center((0.0, 0.0)).surface.center
    center = before
    place = X_BG.apply(center.place)
    for _ in range(TURNS):
        line = felt.line(drive.with_center(place).surface, noise, distance, aside)
        if line is None or line.deviation > LEARNT * before.before:
            return None
        direction = X_GB.rotate(line.across)
        value = line.value - along(pressed, line.across)
        value += along(X_GB.position, direction)
        known = along(before.place, direction)
        most = math.sqrt(2.0) * before.before
        within = min(max(value, known - most), known + most)
        deviation = math.hypot(line.deviation, value - within)
        coordinate = Parameter(within, deviation, known, direction, within != value)
        center = before.knowing(coordinate)
        place = X_BG.apply(center.place)
    return FeltCenter(coordinate, place, center.deviation(direction))
