"""The frame of plans, on any support: x and y along the surface, height out of it.

On a table x, y and height are the world's axes. On a wall x points to the left and y up
as seen by the robots that face it, and height out of the wall towards them. These axes
are left-handed in the world: a positive yaw, from x to y, is about the normal that
points INTO the wall. Within the plane there is no difference between a table and a
wall.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.checks import check_fields
from pushpressslide.core.control import Vector3

Matrix3 = tuple[Vector3, Vector3, Vector3]

WORLD_AXES: Matrix3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class SupportFrame:
    """Axes of plans in the world: p_W = origin + axes p."""

    origin: Vector3 = (0.0, 0.0, 0.0)  # [m]
    # rows; its columns are the world directions of x, y and height
    axes: Matrix3 = WORLD_AXES

    def __post_init__(self) -> None:
        check_fields(self)

    @classmethod
    def of_wall(cls, origin: Vector3, yaw: float) -> SupportFrame:
        """Frame of a wall through ``origin`` [m] whose normal points along ``yaw``
        [rad].
        """
        c = math.cos(yaw)
        s = math.sin(yaw)
        c, s = (round(v) if abs(v - round(v)) < 1e-15 else v for v in (c, s))
        return cls(origin, ((s, 0.0, c), (-c, 0.0, s), (0.0, 1.0, 0.0)))

    @classmethod
    def of_incline(cls, angle: float) -> SupportFrame:
        """Frame of a plane through the world's origin that rises along x by ``angle``
        [rad].
        """
        c = math.cos(angle)
        s = math.sin(angle)
        return cls(axes=((c, 0.0, -s), (0.0, 1.0, 0.0), (s, 0.0, c)))

    @property
    def normal(self) -> Vector3:
        """World direction out of the support, along which heights are measured."""
        return self.direction((0.0, 0.0, 1.0))

    @property
    def faces_up(self) -> bool:
        """Whether the support is seen from above. Otherwise it is seen from the front."""
        return self.normal[2] > 0.5

    @property
    def handedness(self) -> float:
        """1 if x, y and height are right-handed, -1 if they are left-handed."""
        a, b, c = self.spin_axis
        x, y, z = self.normal
        return math.copysign(1.0, a * x + b * y + c * z)

    @property
    def spin_axis(self) -> Vector3:
        """World direction of the yaw axis: x cross y."""
        (a, b, _), (c, d, _), (e, f, _) = self.axes
        return (c * f - e * d, e * b - a * f, a * d - c * b)

    def direction(self, v: Vector3) -> Vector3:
        """World components of a vector given along x, y and height."""
        x, y, z = v
        a, b, c = self.axes
        return (
            a[0] * x + a[1] * y + a[2] * z,
            b[0] * x + b[1] * y + b[2] * z,
            c[0] * x + c[1] * y + c[2] * z,
        )

    def components(self, v_W: Vector3) -> Vector3:
        """Components along x, y and height of a vector given in the world."""
        x, y, z = v_W
        a, b, c = self.axes
        return (
            a[0] * x + b[0] * y + c[0] * z,
            a[1] * x + b[1] * y + c[1] * z,
            a[2] * x + b[2] * y + c[2] * z,
        )

    def point(self, p: Vector3) -> Vector3:
        """World position of a point (x, y, height) [m]."""
        x, y, z = self.direction(p)
        return (self.origin[0] + x, self.origin[1] + y, self.origin[2] + z)

    def coordinates(self, p_W: Vector3) -> Vector3:
        """X, y and height [m] of a point given in the world."""
        x, y, z = self.origin
        return self.components((p_W[0] - x, p_W[1] - y, p_W[2] - z))


TABLE = SupportFrame()
"""Frame of a table: the world frame."""
