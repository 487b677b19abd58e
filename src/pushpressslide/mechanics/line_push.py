"""A flat finger that pushes a face: the object sticks to it, slips along it, or turns
away from it.

Source: studies/docs/stable-push.md; Lynch and Mason, "Stable pushing", 1996. As long as
the object moves with the finger, its twist is known, and so is the wrench on the exact
limit surface. The finger can exert this wrench if the wrench is in the cone spanned by
the friction cones at both ends of the finger. All forces of the finger act on one line,
so the resultant must be inside the friction cone and act between the ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.task import ObjectModel
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.checks import check_friction, check_point
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure

STEPS = 100  # steps of the iteration for the pressure, which depends on the push
EVEN = 10  # full steps before the steps are halved
SETTLED = 1e-9  # tolerance of the force over the load
RESOLUTION = 8  # of the base


class LinePush(NamedTuple):
    """Load on a finger under the assumption that the object moves as if fixed to it."""

    wrench: Wrench  # on the object, about the centre of pressure
    # |f_t| over mu f_n; inf where the finger would have to pull
    friction_utilisation: float
    # where the resultant acts: -1 at the finger's start, 0 in its middle, 1 at its end
    center: float

    @property
    def sticks(self) -> bool:
        """Whether the finger can exert the load, so that the object neither slips nor
        turns away from it.
        """
        return self.friction_utilisation <= 1.0 and abs(self.center) <= 1.0


@dataclass(frozen=True, slots=True)
class FlatFinger:
    """A straight finger that lies on a face of the object, in B.

    Seen from ``start`` to ``end`` the object is on the left, as along its outline.
    Raises ValueError for ends that coincide and friction < 0.
    """

    start: Point  # [m]
    end: Point  # [m]
    friction: float  # of the pair finger/object

    def __post_init__(self) -> None:
        check_point(self.start, "start")
        check_point(self.end, "end")
        check_friction(self.friction)
        if not self.length > 0.0:
            raise ValueError(f"finger from {self.start} to {self.end} m; has no length")

    @property
    def length(self) -> float:
        """Distance between the ends [m]."""
        return math.dist(self.start, self.end)

    @property
    def tangent(self) -> Point:
        """Unit vector from start to end."""
        x = (self.end[0] - self.start[0]) / self.length
        y = (self.end[1] - self.start[1]) / self.length
        return (x, y)

    @property
    def normal(self) -> Point:
        """Unit vector into the object."""
        x, y = self.tangent
        return (-y, x)

    def hold(self, wrench: Wrench) -> LinePush:
        """Load on the finger for ``wrench`` on the object, in B."""
        force = (wrench.fx, wrench.fy)
        push = force[0] * self.normal[0] + force[1] * self.normal[1]
        if not push > 0.0:
            return LinePush(wrench, math.inf, 0.0)
        slide = abs(cross(self.normal, force))
        utilisation = math.inf if slide > 0.0 else 0.0
        if self.friction > 0.0:
            utilisation = slide / (self.friction * push)
        # the resultant, s from the start, has the moment s f_n about it
        moment = wrench.moved_to(self.start).tau
        return LinePush(wrench, utilisation, 2.0 * moment / (push * self.length) - 1.0)


def push_sticks(
    body: ObjectModel,
    support_friction: float,
    finger: FlatFinger,
    twist: Twist,
    height: float = 0.0,
) -> LinePush:
    """Load on ``finger`` if ``body`` moves with it, and the margins of this load.

    ``twist`` is that of finger and object, in B, of any magnitude. ``height`` [m] is
    the height of the finger above the support: the push shifts the centre of pressure
    by h F / N. Raises ValueError for a zero twist, and if the object tips.
    """

    def pressure(cop: Point) -> PressureSamples:
        """Pressure of unit load with its centre at ``cop`` [m]."""
        return support_pressure(body.shape, 1.0, body.center_of_mass, cop, RESOLUTION)

    return line_push(pressure, support_friction, finger, twist, height)


def line_push(
    pressure_at: Callable[[Point], PressureSamples],
    support_friction: float,
    finger: FlatFinger,
    twist: Twist,
    height: float = 0.0,
) -> LinePush:
    """``push_sticks`` for any pressure.

    ``pressure_at(p)`` returns the distribution whose centre of pressure is at p [m] in
    B. For a body that is not pushed, p is (0, 0).
    """
    check_friction(support_friction, "support_friction")
    if not any(twist[:3]):
        raise ValueError("twist (0, 0, 0); must not be zero")
    wrench = _needed(pressure_at, support_friction, twist, height)
    return finger.hold(wrench)


def _needed(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    twist: Twist,
    height: float,
) -> Wrench:
    """Wrench that drives ``twist``.

    The wrench itself shifts the centre of pressure, and is consistent with the shifted
    pressure.

    Raises ValueError if the object tips.
    """
    x = 0.0
    y = 0.0
    for step in range(STEPS):
        samples = pressure_at((height * x, height * y))
        wrench = exact_wrench(samples, mu, twist)
        dx = wrench.fx / samples.total_load - x
        dy = wrench.fy / samples.total_load - y
        if height == 0.0 or math.hypot(dx, dy) < SETTLED:
            return wrench
        part = 1.0 if step < EVEN else 0.5
        x += part * dx
        y += part * dy
    raise ValueError(f"a push at {height:g} m has no balance; the object tips")
