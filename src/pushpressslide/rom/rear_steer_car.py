"""An object pushed from one side, modelled as a rear-steer car at its virtual front
axle (VFA).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pushpressslide.core.pose import Point, Pose2, cross

# Steering beyond this angle [rad] is not used even where the friction cone allows it:
# at pi/2 the VFA stops.
STEERING_LIMIT = 1.5


@dataclass(frozen=True, slots=True)
class RearSteerCar:
    """The reduced model of one sticking side push (docs/mechanics.md, sections 2 and 3,
    "Offset contact").

    The vehicle frame V has its origin at the VFA and its x axis along the heading axis
    e, which leads from the contact through the centre of pressure. The steering is the
    angle of the contact force from e, positive to the left. On the ellipsoid the VFA
    has no side slip under any steering: its velocity is along e, and its path has the
    curvature -(D/rho^2) tan(steering). Raises ValueError for a contact that cannot push
    towards the centre of pressure.
    """

    contact: Point  # [m] in B
    normal: Point  # unit inward normal of the pushed face, in B
    cop: Point  # [m] in B
    rho: float  # [m] > 0
    mu: float  # friction of the pair end effector/object, >= 0
    # [1/m] least, < 0, and greatest, > 0, curvature of a path, whatever the friction
    bounds: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if not (self.rho > 0.0 and self.mu >= 0.0):
            raise ValueError(
                f"rho {self.rho} m, mu {self.mu}; need rho > 0 and mu >= 0"
            )
        if self.bounds is not None and not self.bounds[0] < 0.0 < self.bounds[1]:
            raise ValueError(f"bounds {self.bounds} 1/m; must have 0 between them")
        if abs(math.hypot(self.normal[0], self.normal[1]) - 1.0) > 1e-6:
            raise ValueError(f"normal {self.normal}; must be a unit vector")
        if not self.lever > 0.0:
            raise ValueError(f"contact {self.contact} is at the centre of pressure")
        low, high = self.steering_limits
        if low > high:
            raise ValueError(
                f"the heading axis is {math.degrees(self.eta):.1f} degrees off the "
                "inward normal; "
                "no force in the cone pushes along it"
            )

    @property
    def lever(self) -> float:
        """Distance D [m] from contact to centre of pressure."""
        return math.hypot(self.cop[0] - self.contact[0], self.cop[1] - self.contact[1])

    @property
    def axis(self) -> Point:
        """Heading axis e: unit vector in B from the contact to the centre of pressure."""
        d = self.lever
        return (
            (self.cop[0] - self.contact[0]) / d,
            (self.cop[1] - self.contact[1]) / d,
        )

    @property
    def eta(self) -> float:
        """Angle [rad] of the heading axis from the inward normal, positive to the left."""
        e = self.axis
        n = self.normal
        return math.atan2(cross(n, e), n[0] * e[0] + n[1] * e[1])

    @property
    def effective_wheelbase(self) -> float:
        """Distance rho^2/D [m] from the centre of pressure to the VFA."""
        return self.rho * self.rho / self.lever

    def reaching(self, reach: float) -> RearSteerCar:
        """Car whose VFA is at a distance ``reach`` [m] from the contact. Its force
        angles are as limited as before.

        Raises ValueError if this is not beyond the centre of pressure.
        """
        wheelbase = reach - self.lever
        if not wheelbase > 0.0:
            raise ValueError(f"reach {reach} m; must be greater than {self.lever}")
        bounds = self.bounds
        if bounds is not None:
            ratio = self.effective_wheelbase / wheelbase
            bounds = (ratio * bounds[0], ratio * bounds[1])
        return replace(self, rho=math.sqrt(wheelbase * self.lever), bounds=bounds)

    @property
    def X_BV(self) -> Pose2:
        """Pose of the vehicle frame in the body frame."""
        e = self.axis
        length = self.effective_wheelbase
        return Pose2(
            self.cop[0] + length * e[0],
            self.cop[1] + length * e[1],
            math.atan2(e[1], e[0]),
        )

    @property
    def steering_limits(self) -> tuple[float, float]:
        """Smallest and largest steering [rad]: [-atan mu - eta, atan mu - eta], clipped
        to +-STEERING_LIMIT and to the curvatures of ``bounds``.
        """
        half = math.atan(self.mu)
        low = max(-half - self.eta, -STEERING_LIMIT)
        high = min(half - self.eta, STEERING_LIMIT)
        if self.bounds is not None:
            rightmost, leftmost = self.bounds
            low = max(low, self.steering(leftmost))
            high = min(high, self.steering(rightmost))
        return low, high

    @property
    def curvature_limits(self) -> tuple[float, float]:
        """Smallest and largest curvature [1/m] of the VFA's path.

        Both may have the same sign.
        """
        low, high = self.steering_limits
        return self.curvature(high), self.curvature(low)

    @property
    def minimum_turning_radius(self) -> float:
        """Smallest turning radius [m], to the side with the tighter turns.

        Infinite if the car can only go straight.
        """
        largest = max(abs(k) for k in self.curvature_limits)
        return 1.0 / largest if largest > 0.0 else math.inf

    def curvature(self, steering: float) -> float:
        """Curvature kappa = -(D/rho^2) tan(steering) [1/m], positive to the left."""
        return -math.tan(steering) / self.effective_wheelbase

    def steering(self, curvature: float) -> float:
        """Steering [rad] for ``curvature`` [1/m].

        It is not limited to the friction cone.
        """
        return -math.atan(self.effective_wheelbase * curvature)

    def force(self, steering: float, max_force: float) -> Point:
        """Contact force [N] in B, on the limit surface.

        ``max_force`` [N] is mu_s N. |f| = mu_s N / sqrt(1 + (D sin(steering) / rho)^2).
        """
        c = math.cos(steering)
        s = math.sin(steering)
        f = max_force / math.sqrt(1.0 + (self.lever * s / self.rho) ** 2)
        e = self.axis
        return (f * (c * e[0] - s * e[1]), f * (s * e[0] + c * e[1]))

    def contact_velocity(self, speed: float, steering: float) -> Point:
        """Velocity [m/s] in B of the contact point when the VFA moves with ``speed``
        [m/s].

        It is v (e + (1 + D^2/rho^2) tan(steering) t). The pusher therefore moves at an
        angle psi from the heading axis that is larger than the steering.
        """
        e = self.axis
        k = (1.0 + (self.lever / self.rho) ** 2) * math.tan(steering)
        return (speed * (e[0] - k * e[1]), speed * (e[1] + k * e[0]))
