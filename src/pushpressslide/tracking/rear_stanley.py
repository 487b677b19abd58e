"""Rear-wheel Stanley law at the virtual front axle (docs/mechanics.md, section 3).

Errors are REFERENCE MINUS ACTUAL: theta_e = theta_ref - theta, e = n_left . (p_ref - p_vfa), positive when
the path is to the left. Steering delta > 0 is a force to the left of the heading axis and turns the car to
the right: w = -(v / wheelbase) tan(delta). Of the four sign combinations only this one converges. (The
paper's eq. 14 with errors taken actual minus reference is the unstable one.)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan


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

    def steering(
        self, left_error: float, heading_error: float, curvature: float, grip: float = 1.0
    ) -> tuple[float, bool]:
        """Return the steering angle delta [rad] and whether it had to be clipped.

        ``left_error`` [m], ``heading_error`` [rad]: reference minus actual; ``curvature`` [1/m] of the path
        there; ``grip`` narrows the bounds.
        """
        wheelbase = self.wheelbase
        delta = -heading_error - atan(self.gain * left_error / (4.0 * wheelbase))  # atan(k e / v)
        if curvature != 0.0 and self.feed_forward:
            delta -= atan(wheelbase * curvature)
        low, high = self.steering_bounds
        if delta < grip * low:
            return grip * low, True
        if delta > grip * high:
            return grip * high, True
        return delta, False
