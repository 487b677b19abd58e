"""Where the virtual axle of one contact is: on the ellipsoid, exactly, and with the height of the contact.

Source: docs/mechanics.md, sections 2, 3 and 4. The heading axis is the line of contact and CoP; the axle is
the point on it, beyond the CoP, that has no velocity across it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.limit_surface import exact_level, exact_slide, exact_twist_direction
from pushpressslide.mechanics.pressure import PressureSamples
from pushpressslide.mechanics.rho import rho_straight

# Below this force angle [rad] the limit of straight motion is used, which differs from the exact one in
# second order.
STRAIGHT_ANGLE = 1e-4


def axle_distance(rho: float, lever: float) -> float:
    """Return rho^2 / d [m], from the CoP away from the contact: the same for every force on the ellipsoid.

    ``lever`` d [m] is the distance from CoP to contact; raises ValueError unless > 0.
    """
    if not lever > 0.0:
        raise ValueError(f"lever {lever} m; the contact must not be at the centre of pressure")
    return rho * rho / lever


def exact_axle_distance(samples: PressureSamples, lever: Point, force_angle: float) -> float:
    """Return the exact distance [m] from the CoP to the virtual axle, positive away from the contact.

    ``lever`` [m] is the contact relative to the CoP; ``force_angle`` [rad] is the angle of the contact force
    from the heading axis (either direction of it: a force and its opposite give the same axle). The ratio
    v_t/w of the CoP's velocity across the axis (t to the left of CoP to contact) to the angular velocity; it
    tends to the variance along the axis over d for a straight push and grows or shrinks with the angle.
    Support friction does not enter. Raises ValueError for a zero lever.
    """
    d = math.hypot(lever[0], lever[1])
    axle_distance(1.0, d)
    e = (lever[0] / d, lever[1] / d)
    c, s = math.cos(force_angle), math.sin(force_angle)
    if abs(s) < STRAIGHT_ANGLE:
        return rho_straight(samples, e) ** 2 / d
    f = (c * e[0] - s * e[1], c * e[1] + s * e[0])
    twist = exact_twist_direction(samples, Wrench(f[0], f[1], cross(lever, f), samples.cop))
    return (twist.vy * e[0] - twist.vx * e[1]) / twist.w


def axle_with_height(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    force_angle: float,
) -> Point:
    """Return the virtual axle [m] in B when the force acts at ``height`` [m] above the support.

    The drag shifts the CoP from ``cop`` to cop + h F / N, and with it the pressure; ``pressure_at(p)`` gives
    the distribution (any total load) whose CoP is p. F is of the magnitude that slides, found by iteration.
    The force angle [rad] is from the axis CoP to contact, so near pi the contact is pushed back towards the
    CoP. For straight motion x_va = (x_cop +- h mu) - rho_x^2(x_cop +- h mu) / d with d unshifted
    (docs/mechanics.md, section 4). ``mu`` is the friction of the pair object/support. Raises ValueError when
    the shifted CoP leaves the base: the object tips.
    """
    lever = (contact[0] - cop[0], contact[1] - cop[1])
    d = math.hypot(lever[0], lever[1])
    axle_distance(1.0, d)
    e = (lever[0] / d, lever[1] / d)
    c, s = math.cos(force_angle), math.sin(force_angle)
    f = (c * e[0] - s * e[1], c * e[1] + s * e[0])
    ratio = mu  # |F| / N
    for _ in range(30):
        shifted = (cop[0] + height * ratio * f[0], cop[1] + height * ratio * f[1])
        samples = pressure_at(shifted)
        wrench = Wrench(f[0], f[1], cross((contact[0] - shifted[0], contact[1] - shifted[1]), f), shifted)
        new_ratio = 1.0 / (exact_level(samples, mu, wrench) * samples.total_load)
        converged = abs(new_ratio - ratio) < 1e-10
        ratio = new_ratio
        if converged or height == 0.0:
            break
    if abs(s) < STRAIGHT_ANGLE:
        reach = rho_straight(samples, e) ** 2 / d
        return (shifted[0] - reach * e[0], shifted[1] - reach * e[1])
    twist = exact_twist_direction(samples, wrench).moved_to(cop)
    reach = (twist.vy * e[0] - twist.vx * e[1]) / twist.w
    return (cop[0] - reach * e[0], cop[1] - reach * e[1])


def pushed_twist(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    contact: Point,
    height: float,
    force_angle: float,
) -> Twist:
    """Return the twist of B's origin, the CoM, under a push at ``height`` [m], on the exact surface; only its
    direction counts.

    The force acts at ``contact`` [m] in B, ``force_angle`` [rad] from the axis contact to CoM, and moves the
    CoP from the CoM by h F / N, sideways too; |F| is what slides, found by iteration. ``pressure_at(p)``
    gives the distribution whose CoP is p. Raises ValueError when the CoP leaves the base: the object tips.
    """
    d = math.hypot(contact[0], contact[1])
    axle_distance(1.0, d)
    e = (-contact[0] / d, -contact[1] / d)
    c, s = math.cos(force_angle), math.sin(force_angle)
    f = (c * e[0] - s * e[1], c * e[1] + s * e[0])
    ratio = mu  # |F| / N
    for _ in range(6):
        cop = (height * ratio * f[0], height * ratio * f[1])
        samples = pressure_at(cop)
        wrench = Wrench(f[0], f[1], cross((contact[0] - cop[0], contact[1] - cop[1]), f), cop)
        twist, level = exact_slide(samples, mu, wrench)
        new_ratio = 1.0 / (level * samples.total_load)
        converged = abs(new_ratio - ratio) < 1e-4
        ratio = new_ratio
        if converged or height == 0.0:
            break
    return twist.moved_to((0.0, 0.0))
