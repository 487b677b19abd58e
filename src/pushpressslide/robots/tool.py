"""Tool attitude: the tool's axis is constant in the support's frame, or turns with the
object about the support's normal.

The tip frame T has its origin at the centre of the tip's sphere and its z axis along
the tool, out of the flange. S is the frame of the support: x and y along the surface, z
out of it towards the robots (on a table the world's axes; left-handed on a wall, see
core/support_frame.py). An upright tool points along -z_S. The TOOL YAW is the angle,
from x_S to y_S, of the tool's x axis projected on the plane of x_S and y_S.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.support_frame import WORLD_AXES, Matrix3

# leans that are tried for a tool that turns with the object: tilts and sides
SIDES = (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi)  # [rad]
TOOL_TILTS = tuple(math.radians(a) for a in (0.0, 12.0, 24.0, 36.0))


@dataclass(frozen=True)
class ToolAttitude:
    """Direction of the tool's axis: tilted by ``tilt`` from upright, with the tip
    leaning towards ``azimuth``.

    In S the axis is (sin tilt cos azimuth, sin tilt sin azimuth, -cos tilt): the flange
    is displaced from the tip in the direction opposite to ``azimuth``. With ``turns``
    this is the axis at tool yaw 0, and the whole tool turns about z_S with the yaw, as
    if fixed to the object.

    Raises PushPressSlideError for a tilt outside [0, pi/2).
    """

    tilt: float = 0.0  # [rad] in [0, pi/2)
    azimuth: float = 0.0  # [rad] from x_S to y_S
    axes: Matrix3 = WORLD_AXES  # of S in the world, rows; the default is a table
    turns: bool = False

    def __post_init__(self) -> None:
        if not 0.0 <= self.tilt < 0.5 * math.pi:
            raise PushPressSlideError(
                f"tool tilt {self.tilt!r} rad is not allowed; it lies in [0, pi/2)"
            )

    @property
    def axis(self) -> Array:
        """Unit vector (3,) along the tool, out of the flange, in the world."""
        s = math.sin(self.tilt)
        axis_S = (
            s * math.cos(self.azimuth),
            s * math.sin(self.azimuth),
            -math.cos(self.tilt),
        )
        out: Array = np.array(self.axes) @ np.array(axis_S)
        return out

    def rolled(self, radius: float, turned: float) -> float:
        """Distance [m] that a tip of ``radius`` [m] rolls on an object that turns by
        ``turned`` [rad].

        A tilted tool that keeps its attitude rolls, because the object turns about an
        axis other than the tool's.
        """
        if self.turns:
            return 0.0
        half = 0.5 * min(turned, math.pi)
        return 2.0 * radius * math.sin(self.tilt) * math.sin(half)

    def rotation(self, tool_yaw: Array | float) -> Array:
        """Rotation R_WT (..., 3, 3) for tool yaws (...) [rad]."""
        yaw = np.asarray(tool_yaw, dtype=np.float64)
        if self.turns:
            cos = np.cos(yaw)
            sin = np.sin(yaw)
            zero = np.zeros_like(yaw)
            turn = np.stack(
                [cos, -sin, zero, sin, cos, zero, zero, zero, zero + 1.0], axis=-1
            )
            fixed = replace(self, axes=WORLD_AXES, turns=False).rotation_at(0.0)
            return self._in_world(turn.reshape(*yaw.shape, 3, 3) @ fixed)
        s = math.sin(self.tilt)
        c = math.cos(self.tilt)
        z = np.array([s * math.cos(self.azimuth), s * math.sin(self.azimuth), -c])
        x = np.stack(
            [np.cos(yaw), np.sin(yaw), (z[0] * np.cos(yaw) + z[1] * np.sin(yaw)) / c],
            axis=-1,
        )
        x /= np.linalg.norm(x, axis=-1, keepdims=True)
        R_ST = np.stack([x, np.cross(z, x), np.broadcast_to(z, x.shape)], axis=-1)
        return self._in_world(R_ST)

    def _in_world(self, R_ST: Array) -> Array:
        """Rotation R_WT with the x and z axes of T that ``R_ST`` gives in S.

        In a left-handed S the y axis of T is reversed, so that the result is a
        rotation.
        """
        if self.axes is WORLD_AXES:
            return R_ST
        axes, hand = self._support_axes
        out: Array = axes @ R_ST * hand
        return out

    @cached_property
    def _support_axes(self) -> tuple[Array, Array]:
        """The axes of S in the world as columns (3, 3), and the signs (3,) by which the
        axes of T are multiplied.
        """
        axes = np.array(self.axes)
        return axes, np.array([1.0, round(float(np.linalg.det(axes))), 1.0])

    def rotation_at(self, tool_yaw: float) -> Array:
        """Rotation R_WT (3, 3) for one tool yaw [rad], as ``rotation`` but in plain
        floats, for control loops.
        """
        s = math.sin(self.tilt)
        cz = -math.cos(self.tilt)
        zx = s * math.cos(self.azimuth)
        zy = s * math.sin(self.azimuth)
        cos = math.cos(tool_yaw)
        sin = math.sin(tool_yaw)
        x, y = (1.0, 0.0) if self.turns else (cos, sin)
        up = -(zx * x + zy * y) / cz
        size = math.sqrt(1.0 + up * up)
        x = x / size
        y = y / size
        up = up / size
        R_ST = np.array(
            [
                [x, zy * up - cz * y, zx],
                [y, cz * x - zx * up, zy],
                [up, zx * y - zy * x, cz],
            ]
        )
        if self.turns:
            R_ST = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ R_ST
        return self._in_world(R_ST)

    def yaw(self, R_WT: Array) -> Array:
        """Tool yaws (...) [rad], in (-pi, pi], of tool rotations (..., 3, 3)."""
        x = R_WT[..., :, 0] @ np.array(self.axes)
        out: Array = np.arctan2(x[..., 1], x[..., 0])
        return out


UPRIGHT = ToolAttitude()
"""Attitude of a tool that points straight down at a table."""
