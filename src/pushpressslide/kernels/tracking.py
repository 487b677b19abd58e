"""Tracking laws: one closed-form step each, from errors to the commanded motion of the
object (docs/mechanics.md, sections 3, 4.2 and 9).

Errors are REFERENCE MINUS ACTUAL.
"""

from __future__ import annotations

from math import sqrt

from pushpressslide.kernels.allocation import Wrench
from pushpressslide.kernels.elementary import arctangent, cosine, sine, square, tangent
from pushpressslide.kernels.kernel import kernel

Twist = tuple[float, float, float]
Stanley = tuple[float, float, float, float]
"""Gain over speed k / v [1/m], effective wheelbase [m] of the feed-forward (0 without
feed-forward), and bounds [rad] of the steering angle.
"""
Car = tuple[float, float, float, float, float, float]
"""Heading axis x, y in B, largest friction force [N], 1 + (D / rho)^2, -D [m], and -D /
rho^2 [1/m], where D is the lever from contact to centre of pressure.
"""
Pull = tuple[float, float, float, float]
"""Speed [m/s] in the path's metric, length [m] over which an error decays to 1/e,
radius [m] of the metric, and largest error [m] that is corrected in proportion.
"""


@kernel
def stanley_law(
    wheelbase: float, low: float, high: float, gain: float, feed_forward: float
) -> tuple[Stanley]:
    """Parameters of ``stanley_steering``.

    ``wheelbase`` [m] is the effective one, ``low`` and ``high`` [rad] are the bounds,
    ``gain`` is relative to the largest gain without overshoot, and ``feed_forward`` > 0
    enables feed-forward.
    """
    ahead = wheelbase if feed_forward > 0.0 else 0.0
    return ((gain / (4.0 * wheelbase), ahead, low, high),)


@kernel
def stanley_steering(
    left_error: float,
    heading_error: float,
    curvature: float,
    steering_scale: float,
    law: Stanley,
) -> tuple[float, bool]:
    """Steering angle [rad], and whether it was clipped."""
    slope, length, low, high = law
    delta = (
        -heading_error - arctangent(slope * left_error) - arctangent(length * curvature)
    )
    if steering_scale * low <= delta <= steering_scale * high:
        return delta, False
    return steering_scale * (low if delta < 0.0 else high), True


@kernel
def look_ahead_curvature(
    left_error: float,
    heading_error: float,
    path_curvature: float,
    look_ahead: float,
    limit: float,
) -> tuple[float, bool]:
    """Curvature [1/m] that drives towards a target sliding along the path, and whether
    it was clipped.
    """
    lateral = left_error * cosine(heading_error) + look_ahead * sine(heading_error)
    return clipped(path_curvature + 4.0 * lateral / (look_ahead * look_ahead), limit)


@kernel
def clipped(wanted: float, limit: float) -> tuple[float, bool]:
    """A number clipped to +-``limit``, and whether it was clipped."""
    if wanted > limit:
        return limit, True
    if wanted < -limit:
        return -limit, True
    return wanted, False


@kernel
def steered_push(delta: float, speed: float, car: Car) -> tuple[Wrench, Twist]:
    """Wrench and twist of a push at the steering angle ``delta`` [rad], in B.

    The wrench is about the centre of pressure; the twist and ``speed`` [m/s] are those
    of the virtual axle.
    """
    ex, ey, max_friction, stretch, arm, turning = car
    k = tangent(delta)
    # |f| = mu_s N / sqrt(1 + (D sin(delta) / rho)^2); along e, and to its left
    along = max_friction / sqrt(1.0 + stretch * k * k)
    across = along * k
    wrench = (along * ex - across * ey, along * ey + across * ex, arm * across)
    return wrench, (speed * ex, speed * ey, turning * speed * k)


@kernel
def pulled_twist(
    x: float, y: float, turned: float, rate: Twist, law: Pull
) -> tuple[Twist, tuple[float, float], bool]:
    """Twist of V's origin, in V, that leads a body along its path.

    It is followed by the path's own velocity at that point, per metre, in V, and by
    whether the pull was limited. The wanted pose is at ``x``, ``y`` [m] and ``turned``
    [rad] in V. ``rate`` is the path's twist at the wanted pose, in that pose's axes.
    """
    vx, vy, w = rate
    speed, decay, radius, upper = law
    c = cosine(turned)
    s = sine(turned)
    ahead = c * vx - s * vy
    aside = s * vx + c * vy
    off = sqrt(x * x + y * y + square(radius * turned))
    pull = speed / decay
    if off > upper:
        pull = speed / decay * (upper / off)
    twist = (
        speed * ahead + pull * x,
        speed * aside + pull * y,
        speed * w + pull * turned,
    )
    return twist, (ahead, aside), off > upper
