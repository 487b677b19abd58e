"""Rear-wheel Stanley law at the virtual front axle (docs/mechanics.md, section 3).

Errors are REFERENCE MINUS ACTUAL: theta_e = theta_ref - theta, e = n_left . (p_ref - p_vfa), positive when
the path is to the left. Steering delta > 0 is a force to the left of the heading axis and turns the car to
the right: w = -(v / wheelbase) tan(delta). Of the four sign combinations only this one converges. (The
paper's eq. 14 with errors taken actual minus reference is the unstable one.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Pose2, wrap_angle


@dataclass(frozen=True, slots=True)
class RearStanley:
    """The law for one car.

    ``gain`` is k in units of the largest value without overshoot, v / (4 wheelbase): in these units the law
    does not depend on the speed. Steering is held inside ``steering_bounds`` [rad].
    """

    wheelbase: float  # [m] from the CoP to the virtual front axle, rho^2 / d
    steering_bounds: tuple[float, float]  # [rad]
    gain: float = 1.0
    feed_forward: bool = True  # remove the steady offset on a curve

    def errors(self, reference: Pose2, actual: Pose2) -> tuple[float, float, float]:
        """Return (along [m], left [m], heading [rad]) of the reference as seen from the actual axle pose."""
        c, s = math.cos(actual.yaw), math.sin(actual.yaw)
        dx, dy = reference.x - actual.x, reference.y - actual.y
        # e is measured along the PATH's normal, so that it is the cross-track error at any heading error
        cr, sr = math.cos(reference.yaw), math.sin(reference.yaw)
        return (c * dx + s * dy, -sr * dx + cr * dy, wrap_angle(reference.yaw - actual.yaw))

    def steering(
        self, left_error: float, heading_error: float, curvature: float, grip: float = 1.0
    ) -> tuple[float, bool]:
        """Return the steering angle delta [rad] and whether it had to be clipped.

        ``left_error`` [m], ``heading_error`` [rad]: reference minus actual; ``curvature`` [1/m] of the path
        there; ``grip`` narrows the bounds.
        """
        cross_track = self.gain * left_error / (4.0 * self.wheelbase)  # k e / v
        delta = -heading_error - math.atan(cross_track)
        if self.feed_forward:
            delta -= math.atan(self.wheelbase * curvature)
        low, high = grip * self.steering_bounds[0], grip * self.steering_bounds[1]
        if delta < low:
            return low, True
        if delta > high:
            return high, True
        return delta, False
