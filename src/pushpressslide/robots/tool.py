"""How the tool is held: its axis constant in the support's frame, its yaw free to follow the object.

The tip frame T has its origin at the centre of the tip's sphere and its z axis along the tool, out of the
flange. The support's axes are x and y along the surface, and height out of it towards the robots (on a table
those of the world; core/support_frame.py). An upright tool points along minus height. The TOOL YAW is the
angle, from x to y, of the tool's x axis projected on the surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.support_frame import WORLD_AXES, Matrix3

Array = NDArray[np.float64]

# that are tried, the wrist behind the contact
TOOL_TILTS = tuple(math.radians(a) for a in (0.0, 12.0, 24.0, 36.0))


@dataclass(frozen=True)
class ToolAttitude:
    """Direction of the tool's axis: tilted by ``tilt`` from upright, the tip leaning towards ``azimuth``.

    Along the support's axes it is (sin tilt cos azimuth, sin tilt sin azimuth, -cos tilt): the flange stands off the tip in
    the direction opposite to ``azimuth``. Raises PushPressSlideError for a tilt outside [0, pi/2).
    """

    tilt: float = 0.0  # [rad] in [0, pi/2)
    azimuth: float = 0.0  # [rad] from x to y
    axes: Matrix3 = WORLD_AXES  # of the support, see SupportFrame; the default is a table

    def __post_init__(self) -> None:
        if not 0.0 <= self.tilt < 0.5 * math.pi:
            raise PushPressSlideError(f"tool tilt {self.tilt!r} rad is not allowed; it lies in [0, pi/2)")

    @property
    def axis(self) -> Array:
        """Unit vector (3,) along the tool, out of the flange, in the world."""
        out: Array = np.array(self.axes) @ np.array(self._along_support())
        return out

    def _along_support(self) -> tuple[float, float, float]:
        s = math.sin(self.tilt)
        return (s * math.cos(self.azimuth), s * math.sin(self.azimuth), -math.cos(self.tilt))

    def rotation(self, tool_yaw: NDArray[np.float64] | float) -> Array:
        """Return R_WT (..., 3, 3) for tool yaws (...) [rad]."""
        yaw = np.asarray(tool_yaw, dtype=np.float64)
        z = np.array(self._along_support())
        up = -(z[0] * np.cos(yaw) + z[1] * np.sin(yaw)) / z[2]
        x = np.stack([np.cos(yaw), np.sin(yaw), up], axis=-1)
        x /= np.linalg.norm(x, axis=-1, keepdims=True)
        x, z = x @ np.array(self.axes).T, self.axis
        out: Array = np.stack([x, np.cross(z, x), np.broadcast_to(z, x.shape)], axis=-1)
        return out

    def rotation_at(self, tool_yaw: float) -> Array:
        """Return R_WT (3, 3) for one tool yaw [rad]: as ``rotation``, in plain floats, for a control loop."""
        zx, zy, zz = self._along_support()
        xx, xy = math.cos(tool_yaw), math.sin(tool_yaw)
        xz = -(zx * xx + zy * xy) / zz
        size = math.sqrt(1.0 + xz * xz)
        xx, xy, xz = xx / size, xy / size, xz / size
        if self.axes is not WORLD_AXES:
            (xx, xy, xz), (zx, zy, zz) = (
                tuple(a[0] * x + a[1] * y + a[2] * z for a in self.axes)
                for x, y, z in ((xx, xy, xz), (zx, zy, zz))
            )
        return np.array(
            [[xx, zy * xz - zz * xy, zx], [xy, zz * xx - zx * xz, zy], [xz, zx * xy - zy * xx, zz]]
        )

    def yaw(self, R_WT: Array) -> Array:
        """Return the tool yaws (...) [rad], in (-pi, pi], of tool rotations (..., 3, 3)."""
        x = R_WT[..., :, 0] @ np.array(self.axes)
        out: Array = np.arctan2(x[..., 1], x[..., 0])
        return out


UPRIGHT = ToolAttitude()
"""The tool points straight down at a table."""
