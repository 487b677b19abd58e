"""Two pushes at right angles: their feasible wrenches in closed form
(docs/mechanics.md, section 6).

Contact B at (-d, 0) pushes along +x, contact L at (0, d) along -y. Both normals pass
through the centre of mass, so that only friction turns the object. P = fx, Q = -fy, T =
tau/d, and u is the friction force of B: f_B = (P + T + u, u), f_L = (-T - u, -Q - u).
``WrenchCone`` gives the same for any other contacts.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point


class Feasibility(NamedTuple):
    """Feasibility of a wrench, given by its tightest condition."""

    spare: float  # [N] reserve of the deciding condition; negative: impossible
    condition: str  # the deciding condition in words

    @property
    def feasible(self) -> bool:
        """Whether all conditions hold."""
        return self.spare >= 0.0


def feasibility(
    fx: float, fy: float, tau: float, d: float, friction: float
) -> Feasibility:
    """Tightest condition of section 6 for a wrench (fx, fy [N], tau [N m]) about the
    CoM.

    ``d`` [m] is the distance of both contacts to the CoM. With ``friction`` above 1
    every wrench is possible.
    """
    if friction > 1.0:
        return Feasibility(math.inf, "friction above 1")
    p = fx
    q = -fy
    t = tau / d
    mu = friction
    less, more, whole = _friction_factors(mu)
    return min(
        Feasibility(p + t, "contact B would have to pull"),
        Feasibility(q - t, "contact L would have to pull"),
        Feasibility(
            (less * p + more * q) / whole - t, "the moment to the left exceeds friction"
        ),
        Feasibility(
            (more * p + less * q) / whole + t,
            "the moment to the right exceeds friction",
        ),
    )


def _friction_factors(mu: float) -> tuple[float, float, float]:
    """The factors mu (1 - mu), mu (1 + mu) and 1 + mu^2."""
    return mu * (1.0 - mu), mu * (1.0 + mu), 1.0 + mu * mu


def friction_interval(
    fx: float, fy: float, tau: float, d: float, friction: float
) -> tuple[float, float]:
    """Interval [N] of B's friction force u in which both forces are in their cones.

    If there is no such friction force, the lower end is above the upper end.
    """
    p = fx
    q = -fy
    t = tau / d
    mu = friction
    low = max(-mu * (p + t), -(mu * q + t)) / (1.0 + mu)
    if mu < 1.0:
        return low, min(mu * (p + t), mu * q - t) / (1.0 - mu)
    if mu == 1.0:
        if p + t >= 0.0 and q - t >= 0.0:
            return low, math.inf
        return math.inf, -math.inf
    return max(low, -mu * (p + t) / (mu - 1.0), (t - mu * q) / (mu - 1.0)), math.inf


def forces(
    fx: float, fy: float, tau: float, d: float, friction: float
) -> tuple[Point, Point]:
    """Forces [N] of B and L for a feasible wrench, with u = -T/2 clipped to its
    interval.

    u = -T/2 is the paper's symmetric split. It has the smallest sum of squared friction
    forces.
    """
    low, high = friction_interval(fx, fy, tau, d, friction)
    t = tau / d
    u = min(max(-0.5 * t, low), high)
    return (fx + t + u, u), (-t - u, fy - u)


def least_drift(fx: float, fy: float, tau: float, d: float, friction: float) -> float:
    """Smallest b >= 0 [N] that makes (fx + b, fy - b, tau) feasible.

    The moment has priority over the force. Infinite if no b suffices, as for a moment
    without friction.
    """
    if friction > 1.0:
        return 0.0
    if friction == 0.0 and tau != 0.0:
        return math.inf
    p = fx
    q = -fy
    t = tau / d
    mu = friction
    drift = max(0.0, -t - p, t - q)
    if mu == 0.0:
        return drift
    less, more, whole = _friction_factors(mu)
    return max(
        drift,
        (whole * t - less * p - more * q) / (2.0 * mu),
        (-whole * t - more * p - less * q) / (2.0 * mu),
    )


def moment_limits(
    fx: float, fy: float, d: float, friction: float
) -> tuple[float, float]:
    """Smallest and largest moment [N m] that a force with fx >= 0, fy <= 0 allows, for
    friction <= 1.
    """
    p = fx
    q = -fy
    mu = friction
    less, more, whole = _friction_factors(mu)
    right = min(p, (more * p + less * q) / whole)
    left = min(q, (less * p + more * q) / whole)
    return -d * right, d * left


def turning_center(fx: float, fy: float, tau: float, rho: float) -> Point:
    """Centre [m] about which a wrench turns an object on the ellipsoid of ``rho`` [m].

    (-fy, fx) rho^2 / tau, relative to the CoP, about which ``tau`` is taken; ``tau``
    must not be zero.
    """
    k = rho * rho / tau
    return (-fy * k, fx * k)


def turning_corners(
    d: float, friction: float, rho: float, left: bool
) -> tuple[Point, Point]:
    """Centres [m] about which contact B or L alone turns the object at its friction
    limit.

    With K = rho^2/d they are K (1, 1/mu) and K (1/mu, -1) for turns to the left, and K
    (1, -1/mu) and K (-1/mu, -1) for turns to the right.
    """
    k = rho * rho / d
    far = k / friction if friction > 0.0 else math.inf
    if left:
        return (k, far), (far, -k)
    return (k, -far), (-far, -k)


def can_turn_about(
    center: Point, left: bool, d: float, friction: float, rho: float
) -> bool:
    """Whether two pushes can turn an object to the left (or right) about ``center``
    [m], relative to the CoM.

    To the left, the possible centres are the segment between the two
    ``turning_corners``, and all its points displaced by any x, y >= 0. To the right,
    they are the mirror image of this region about y = -x. Both regions are unbounded,
    disjoint, and joined only through infinity. With ``friction`` above 1 an object can
    be turned about every point, without friction about none.
    """
    if friction > 1.0:
        return True
    if friction == 0.0:
        return False
    x, y = center if left else (-center[1], -center[0])
    (ax, ay), (bx, by) = turning_corners(d, friction, rho, True)
    return x >= ax and y >= by and (ay - by) * (x - ax) + (bx - ax) * (y - ay) >= 0.0


def least_turning_radius(d: float, friction: float, rho: float) -> float:
    """Smallest distance [m] of a turning centre from the CoM: K sqrt((1 + 1/mu^2) / 2)
    with K = rho^2 / d, for mu <= 1. Infinite without friction.
    """
    if friction == 0.0:
        return math.inf
    return rho * rho / d * math.sqrt(0.5 * (1.0 + 1.0 / friction**2))


def translation_radii(d: float, friction: float, rho: float) -> tuple[float, float]:
    """Distances [m] from the CoM to the turning centres when the net force is along one
    normal, for friction < 1.

    With both frictions at their limits, the distances are K (1 + mu^2) / (mu (1 + mu))
    and K (1 + mu) / mu, with K = rho^2 / d. Under a force along +x the object turns to
    the right about both centres, under one along -y to the left. They are the correct
    values of the paper's d_min and d_max. Infinite without friction.
    """
    if friction == 0.0:
        return math.inf, math.inf
    k = rho * rho / d
    mu = friction
    return k * (1.0 + mu * mu) / (mu * (1.0 + mu)), k * (1.0 + mu) / mu
