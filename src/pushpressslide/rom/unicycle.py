"""An object pressed from above at one place, modelled as a unicycle at its virtual
axle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pushpressslide.core.pose import Point, Pose2


@dataclass(frozen=True, slots=True)
class Unicycle:
    """The reduced model of one sticking top press (docs/mechanics.md, sections 2 and
    4).

    The vehicle frame V has its origin at the virtual axle and its x axis along the
    heading axis. This axis leads from the centre of pressure to the contact, or the
    other way round if driven ``backward``. On the ellipsoid the axle has no side slip
    under any contact force. Raises ValueError for a contact at the centre of pressure,
    where the object only translates.
    """

    contact: Point  # [m] in B
    cop: Point  # [m] in B, with the press
    rho: float  # [m] > 0
    backward: bool = False  # drive with the contact behind the axle
    # [m] ahead by which the drag at the contact's height moves the centre of pressure
    shift: float = 0.0

    def __post_init__(self) -> None:
        if not self.rho > 0.0:
            raise ValueError(f"rho {self.rho} m; must be > 0")
        if self.contact == self.cop:
            raise ValueError(
                f"contact {self.contact} is at the centre of pressure; the object only "
                "translates"
            )

    @property
    def lever(self) -> float:
        """Signed distance d [m] of the contact ahead of the CoP, negative when driven
        backward.
        """
        d = math.hypot(self.contact[0] - self.cop[0], self.contact[1] - self.cop[1])
        return -d if self.backward else d

    @property
    def axis(self) -> Point:
        """Heading axis e: unit vector in B."""
        d = self.lever
        return (
            (self.contact[0] - self.cop[0]) / d,
            (self.contact[1] - self.cop[1]) / d,
        )

    @property
    def effective_wheelbase(self) -> float:
        """Signed effective wheelbase rho^2 / d [m]: tan(force angle) per curvature."""
        return self.rho * self.rho / self.lever

    @property
    def X_BV(self) -> Pose2:
        """Pose of the vehicle frame in the body frame, with its origin at cop + (shift
        - rho^2/d) e.
        """
        e = self.axis
        ahead = self.shift - self.effective_wheelbase
        return Pose2(
            self.cop[0] + ahead * e[0],
            self.cop[1] + ahead * e[1],
            math.atan2(e[1], e[0]),
        )

    @property
    def axle(self) -> float:
        """Coordinate [m] of the virtual axle on the heading axis, from B's origin."""
        X_BV = self.X_BV
        ex, ey = self.axis
        return X_BV.x * ex + X_BV.y * ey

    def with_axle(self, axle: float, effective_wheelbase: float) -> Unicycle:
        """The vehicle with its virtual axle at ``axle`` [m] from B's origin and an
        ``effective_wheelbase`` [m] > 0.
        """
        rho = math.sqrt(effective_wheelbase * abs(self.lever))
        car = replace(self, rho=rho, shift=0.0)
        return replace(car, shift=axle - car.axle)

    def shifted(self, offset: Point) -> Unicycle:
        """The vehicle displaced by ``offset`` [m] in B."""
        x, y = offset
        return replace(
            self,
            contact=(self.contact[0] + x, self.contact[1] + y),
            cop=(self.cop[0] + x, self.cop[1] + y),
        )

    @property
    def length(self) -> float:
        """Distance [m] from the axle to the contact, without the shift."""
        return abs(self.lever + self.effective_wheelbase)

    def force(self, speed: float, turn_rate: float, max_force: float) -> Point:
        """Contact force [N] in B, on the limit surface, for a motion of V.

        Zero without motion. f ~ v e + (rho^2/d) w t with |f| = mu_s N / sqrt(1 + (d
        sin(phi)/rho)^2); ``max_force`` [N] is mu_s N.
        """
        e = self.axis
        d = self.lever
        along = speed
        across = self.effective_wheelbase * turn_rate
        size = math.hypot(along, across)
        if size == 0.0:
            return (0.0, 0.0)
        k = max_force / math.hypot(size, d * across / self.rho)
        return (k * (along * e[0] - across * e[1]), k * (along * e[1] + across * e[0]))

    def contact_velocity(self, speed: float, turn_rate: float) -> Point:
        """Velocity [m/s] in B of the contact point: v e + (d + rho^2/d) w t."""
        e = self.axis
        d = self.lever
        across = (d + self.effective_wheelbase - self.shift) * turn_rate
        return (speed * e[0] - across * e[1], speed * e[1] + across * e[0])
