"""Poses in the plane, SE(2), in plain floats."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.slips import called_from_inside, warn_of_slip
from pushpressslide.kernels.plane import cross as cross
from pushpressslide.kernels.plane import from_axis as from_axis
from pushpressslide.kernels.plane import in_axis as in_axis

NUMBERS = (float, int)

Point = tuple[float, float]
"""A point or a vector in the plane: (x, y) [m]. Its frame is stated at each use."""


def wrap_angle(angle: float) -> float:
    """``angle`` [rad] wrapped into (-pi, pi]."""
    wrapped = math.remainder(angle, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def along(a: Point, direction: Point) -> float:
    """Coordinate of ``a`` along a unit vector."""
    return a[0] * direction[0] + a[1] * direction[1]


def turned_left(a: Point) -> Point:
    """Vector J a: a turned by +90 degrees."""
    return (-a[1], a[0])


@dataclass(frozen=True, slots=True)
class Pose2:
    """Pose X_AB of a frame B in a frame A: origin (x, y) [m] in A, yaw [rad]
    counter-clockwise.

    A yaw above 2 pi causes a TaskWarning. ``Pose2.deg`` takes degrees.
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def __post_init__(self) -> None:
        yaw = self.yaw
        if isinstance(yaw, NUMBERS) and math.tau < abs(yaw) < math.inf:
            self._warn_of_degrees()

    def _warn_of_degrees(self) -> None:
        """Warn if the yaw is above 2 pi and was not computed by this package."""
        if called_from_inside(3):
            return
        warn_of_slip(
            f"Pose2: yaw {self.yaw:g} rad is above 2 pi; were degrees meant? "
            f"Pose2.deg(x, y, {self.yaw:g}) takes them"
        )

    @classmethod
    def deg(cls, x: float, y: float, yaw_deg: float) -> Pose2:
        """Pose at (x, y) [m] with a yaw [deg]."""
        return cls(x, y, math.radians(yaw_deg))

    @property
    def wrapped(self) -> Pose2:
        """The same pose with its yaw in (-pi, pi]."""
        return Pose2(self.x, self.y, wrap_angle(self.yaw))

    @property
    def position(self) -> Point:
        """Origin of B in A [m]."""
        return (self.x, self.y)

    def rotate(self, v_B: Point) -> Point:
        """Components in A of a vector given in B."""
        c = math.cos(self.yaw)
        s = math.sin(self.yaw)
        return (c * v_B[0] - s * v_B[1], s * v_B[0] + c * v_B[1])

    def unrotate(self, v_A: Point) -> Point:
        """Components in B of a vector given in A."""
        c = math.cos(self.yaw)
        s = math.sin(self.yaw)
        return (c * v_A[0] + s * v_A[1], -s * v_A[0] + c * v_A[1])

    def apply(self, p_B: Point) -> Point:
        """Position in A of a point given in B."""
        x, y = self.rotate(p_B)
        return (self.x + x, self.y + y)

    def unapply(self, p_A: Point) -> Point:
        """Position in B of a point given in A."""
        return self.unrotate((p_A[0] - self.x, p_A[1] - self.y))

    def compose(self, other: Pose2) -> Pose2:
        """Pose X_AC = X_AB X_BC, with self = X_AB. The yaw is not wrapped."""
        yaw = self.yaw
        c = math.cos(yaw)
        s = math.sin(yaw)
        x, y = other.x, other.y
        return Pose2(
            self.x + (c * x - s * y), self.y + (s * x + c * y), yaw + other.yaw
        )

    def inverse(self) -> Pose2:
        """Pose X_BA."""
        x, y = self.unrotate((-self.x, -self.y))
        return Pose2(x, y, -self.yaw)
