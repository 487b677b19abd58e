"""Rear-wheel Stanley law at the virtual front axle (docs/mechanics.md, section 3).

Errors are REFERENCE MINUS ACTUAL: theta_e = theta_ref - theta, e = n_left . (p_ref -
p_vfa), positive when the path is to the left. Steering delta > 0 is a force to the left
of the heading axis and turns the car to the right: w = -(v / effective wheelbase)
tan(delta). Of the four combinations of signs only this one converges. (The paper's eq.
14, with errors as actual minus reference, is unstable.)
"""

from __future__ import annotations

from collections.abc import Callable

from pushpressslide.kernels.tracking import stanley_law, stanley_steering

Steering = Callable[[float, float, float, float], tuple[float, bool]]


def rear_stanley(
    effective_wheelbase: float,
    steering_bounds: tuple[float, float],
    gain: float = 1.0,
    feed_forward: bool = True,
) -> Steering:
    """The law ``steer(left_error, heading_error, curvature, steering_scale)`` of one
    car.

    ``effective_wheelbase`` [m] is the distance rho^2 / d from the CoP to the virtual
    front axle. ``gain`` is k relative to the largest value without overshoot, v / (4
    effective_wheelbase), so that the law does not depend on the speed. ``feed_forward``
    removes the steady-state error on a curve. ``left_error`` [m] and ``heading_error``
    [rad] are reference minus actual; ``curvature`` [1/m] is the path's curvature at the
    nearest point; ``steering_scale`` narrows ``steering_bounds`` [rad]. The law returns
    the steering angle delta [rad] and whether it was clipped.
    """
    (law,) = stanley_law(effective_wheelbase, *steering_bounds, gain, feed_forward)

    def steer(
        left_error: float, heading_error: float, curvature: float, steering_scale: float
    ) -> tuple[float, bool]:
        """Steering angle [rad], and whether it was clipped."""
        return stanley_steering(
            left_error, heading_error, curvature, steering_scale, law
        )

    return steer
