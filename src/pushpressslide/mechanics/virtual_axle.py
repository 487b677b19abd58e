"""Where the virtual axle of one contact is: on the ellipsoid, exactly, and with the
height of the contact.

Source: docs/mechanics.md, sections 2, 3 and 4. The heading axis is the line of contact
and CoP; the axle is the point on it, beyond the CoP, that has no velocity across it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.limit_surface import exact_slide, exact_twist_direction
from pushpressslide.mechanics.pressure import PressureSamples
from pushpressslide.mechanics.rho import rho_straight

# Below this force angle [rad] the limit of straight motion is used, which differs from
# the exact one in second order.
STRAIGHT_ANGLE = 1e-4
STEPS = 6  # of the iteration for the force that slides
CONVERGED = 1e-4  # of the force over the load


def axle_distance(rho: float, lever: float) -> float:
    """Return rho^2 / d [m], from the CoP away from the contact: the same for every
    force on the ellipsoid.

    ``lever`` d [m] is the distance from CoP to contact; raises ValueError unless > 0.
    """
    if not lever > 0.0:
        raise ValueError(
            f"lever {lever} m; the contact must not be at the centre of pressure"
        )
    return rho * rho / lever


def exact_axle_distance(
    samples: PressureSamples, lever: Point, force_angle: float
) -> float:
    """Return the exact distance [m] from the CoP to the virtual axle, positive away
    from the contact.

    ``lever`` [m] is the contact relative to the CoP; ``force_angle`` [rad] is the angle
    of the contact force from the heading axis (either direction of it: a force and its
    opposite give the same axle). The ratio v_t/w of the CoP's velocity across the axis
    (t to the left of CoP to contact) to the angular velocity; it tends to the variance
    along the axis over d for a straight push and grows or shrinks with the angle.
    Support friction does not enter. Raises ValueError for a zero lever.
    """
    d = math.hypot(lever[0], lever[1])
    axle_distance(1.0, d)
    e = (lever[0] / d, lever[1] / d)
    if abs(math.sin(force_angle)) < STRAIGHT_ANGLE:
        return rho_straight(samples, e) ** 2 / d
    f = turned(e, force_angle)
    twist = exact_twist_direction(
        samples, Wrench(f[0], f[1], cross(lever, f), samples.cop)
    )
    return (twist.vy * e[0] - twist.vx * e[1]) / twist.w


def sliding(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    direction: Point,
) -> tuple[PressureSamples, Wrench, Twist]:
    """Return the pressure under which a force along the unit vector ``direction``
    slides the object, its wrench about that pressure's centre, of a force of 1 N, and
    the twist, of which only the direction counts.

    The force acts at ``contact`` [m] in B, ``height`` [m] above the support, and moves
    the CoP from ``cop`` by h F / N; |F| is what slides, found by iteration.
    ``pressure_at(p)`` gives the distribution (any total load) whose CoP is p; ``mu`` is
    the friction of the pair object/support. Raises ValueError where the CoP leaves the
    base: the object tips.
    """
    ratio = mu  # |F| / N
    for _ in range(STEPS):
        moved = (
            cop[0] + height * ratio * direction[0],
            cop[1] + height * ratio * direction[1],
        )
        samples = pressure_at(moved)
        arm = (contact[0] - moved[0], contact[1] - moved[1])
        wrench = Wrench(*direction, cross(arm, direction), moved)
        twist, level = exact_slide(samples, mu, wrench)
        last = ratio
        ratio = 1.0 / (level * samples.total_load)
        if abs(ratio - last) < CONVERGED or height == 0.0:
            break
    return samples, wrench, twist


def dragged_twist(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    direction: Point,
) -> Twist:
    """Return the twist of B's origin under the force of ``sliding``, on the exact
    surface; only its direction counts.
    """
    _, _, twist = sliding(pressure_at, mu, cop, contact, height, direction)
    return twist.moved_to((0.0, 0.0))


def axle_with_height(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    force_angle: float,
) -> Point:
    """Return the virtual axle [m] in B when the force of ``sliding`` acts at ``height``
    [m].

    The force angle [rad] is from the axis CoP to contact, so near pi the contact is
    pushed back towards the CoP. For straight motion x_va = (x_cop +- h mu) -
    rho_x^2(x_cop +- h mu) / d with d unshifted (docs/mechanics.md, section 4). Raises
    ValueError when the shifted CoP leaves the base: the object tips.
    """
    lever = (contact[0] - cop[0], contact[1] - cop[1])
    d = math.hypot(lever[0], lever[1])
    axle_distance(1.0, d)
    e = (lever[0] / d, lever[1] / d)
    samples, wrench, twist = sliding(
        pressure_at, mu, cop, contact, height, turned(e, force_angle)
    )
    if abs(math.sin(force_angle)) < STRAIGHT_ANGLE:
        distance = rho_straight(samples, e) ** 2 / d
        x, y = wrench.about
        return (x - distance * e[0], y - distance * e[1])
    twist = twist.moved_to(cop)
    distance = (twist.vy * e[0] - twist.vx * e[1]) / twist.w
    return (cop[0] - distance * e[0], cop[1] - distance * e[1])


def turned(e: Point, angle: float) -> Point:
    """Return ``e`` turned by ``angle`` [rad] to the left."""
    c = math.cos(angle)
    s = math.sin(angle)
    return (c * e[0] - s * e[1], s * e[0] + c * e[1])
