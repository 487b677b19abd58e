"""Tracking of a twist path by an object that can be driven in any direction, or in the
directions of a cone (docs/mechanics.md, section 9).

The command is the path's twist, plus a pull towards the nearest pose of the path. The
pull is proportional to the error and to the speed. Since friction is rate independent,
errors decay over a distance and not over a time. Errors are REFERENCE MINUS ACTUAL.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import cos, hypot, remainder, sin

from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.kernels.tracking import pulled_twist
from pushpressslide.mechanics.height_term import DraggedSurface

IntoCone = Callable[[Wrench], Wrench | None]
"""Function that returns the nearest wrench that the contacts can provide. None if they
can provide the requested one.
"""

TURN = 2.0 * math.pi
SHARE = 0.5  # largest pull, as a share of the path's speed


class HolonomicTracker:
    """Tracking law of feed-forward and pull, with the wrench on the limit surface for
    the resulting motion.

    V may be any frame of the body; the wrench is about the surface's centre.
    """

    def __init__(
        self,
        X_BV: Pose2,
        surface: DraggedSurface,
        decay: float,
        into_cone: IntoCone | None = None,
        share: float = SHARE,
    ) -> None:
        """Bind the law. ``decay`` [m] > 0 is the distance over which an error falls to
        1/e. ``share`` is in [0, 1).
        """
        self._X_BV = X_BV
        self._surface = surface
        self._into_cone = into_cone
        self._decay = decay
        self._share = share
        self._axes = (cos(X_BV.yaw), sin(X_BV.yaw))

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench and twist that follow ``path``, a TwistPath.

        ``speed`` [m/s] is in the path's own metric; ``steering_scale`` in (0, 1]
        reduces the pull.
        """
        assert isinstance(path, TwistPath)
        X_WV = X_WB.compose(self._X_BV)
        progress = path.nearest(X_WV, progress)
        wanted = path.pose(progress)
        rate = path.rate(progress)
        x, y = X_WV.unrotate((wanted.x - X_WV.x, wanted.y - X_WV.y))
        turned = remainder(wanted.yaw - X_WV.yaw, TURN)
        # [m] of error that is pulled at in proportion
        most = steering_scale * self._share * self._decay
        law = (speed, self._decay, path.radius, most)
        (vx, vy, w), along, limited = pulled_twist(x, y, turned, rate, law)
        size = hypot(*along)
        tx = 1.0
        ty = 0.0
        if size > 0.0:
            tx = along[0] / size
            ty = along[1] / size
        error = (tx * x + ty * y, tx * y - ty * x, turned)
        a, b = self._axes
        twist = Twist(a * vx - b * vy, b * vx + a * vy, w, self._X_BV.position)
        return self._guidance(twist, progress, error, limited)

    def _guidance(
        self,
        twist: Twist,
        progress: float,
        error: tuple[float, float, float],
        saturated: bool,
    ) -> Guidance:
        """Guidance with ``twist``, or with the nearest twist that the contacts can
        drive.
        """
        wrench = self._surface.wrench(twist)
        nearest = None
        if self._into_cone is not None:
            nearest = self._into_cone(wrench)
        if nearest is not None:
            twist, wrench = self._driven(twist, wrench, nearest)
            saturated = True
        a, b = self._axes
        fx = wrench.fx
        fy = wrench.fy
        steering = math.atan2(a * fy - b * fx, a * fx + b * fy)
        moved = twist.moved_to((0.0, 0.0))
        return Guidance(progress, *wrench, *moved, steering, error, saturated)

    def _driven(
        self, twist: Twist, wanted: Wrench, nearest: Wrench
    ) -> tuple[Twist, Wrench]:
        """Twist of the object under the wrench ``nearest``, and this wrench scaled onto
        the limit surface.

        ``nearest`` replaces ``wanted``. The speed is reduced to the part of ``twist``
        that the wrench achieves.
        """
        surface = self._surface
        nearest = nearest.moved_to(surface.center)
        size = hypot(nearest.fx, nearest.fy, nearest.tau / surface.rho)
        if size == 0.0:
            return Twist(0.0, 0.0, 0.0), nearest
        moved = twist.moved_to(surface.center)
        # max_force times |(v, rho w)|
        power = wanted.fx * moved.vx + wanted.fy * moved.vy + wanted.tau * moved.w
        k = power * size / surface.max_force**2
        scale = surface.max_force / size
        direction = surface.twist_direction(nearest)
        return (
            Twist(k * direction.vx, k * direction.vy, k * direction.w, surface.center),
            Wrench(
                scale * nearest.fx,
                scale * nearest.fy,
                scale * nearest.tau,
                surface.center,
            ),
        )
