"""The paper's own formulas for two contacts, kept for comparison only. They check no
cone.

Equations are numbered as in studies/docs/paper-map.md. Forces [N] are on the object, in
B; moments are about the CoM.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.contacts import least_norm_forces


def synchronised_pushes(fx: float, fy: float) -> tuple[Point, Point]:
    """Two equal forces from behind (case 3, mode 1; eq. 18).

    Their moment is -d_x fy, whatever the wanted moment.
    """
    return (0.5 * fx, 0.5 * fy), (0.5 * fx, 0.5 * fy)


def differential_pushes(
    fx: float, tau: float, half_width: float
) -> tuple[Point, Point]:
    """Left and right force from behind, without friction (case 3, mode 2; eq. 20).

    The paper treats the pair as a differential drive. For |tau| > half_width fx one
    force is negative and would have to pull, so the object can neither turn in place
    nor reverse.
    """
    half = 0.5 * tau / half_width
    return (0.5 * fx - half, 0.0), (0.5 * fx + half, 0.0)


def orthogonal_pushes(
    fx: float, fy: float, tau: float, d: float, bias: float = 0.0
) -> tuple[Point, Point]:
    """Forces [N] of contact B at (-d, 0) and L at (0, d), with friction split evenly
    (case 4; eqs. 22, 23).

    The ``bias`` [N] on both normal forces is not an internal force: the forces add up
    to (fx + bias, fy - bias, tau).
    """
    friction = -0.5 * tau / d
    return (fx - friction + bias, friction), (friction, -(-fy + friction + bias))


def least_bias(fx: float, fy: float, tau: float, d: float, friction: float) -> float:
    """Smallest bias [N] that puts the forces of ``orthogonal_pushes`` into their cones.
    Infinite for a moment if there is no friction.

    The bias is never smaller than ``orthogonal.least_drift``, the smallest that any
    split of the forces needs.
    """
    p = fx
    q = -fy
    t = tau / d
    if friction == 0.0:
        return math.inf if t else max(0.0, -p, -q)
    tilted = 0.5 * abs(t) / friction
    return max(0.0, tilted - 0.5 * t - p, tilted + 0.5 * t - q)


def unicycle_distances(d: float, friction: float, rho: float) -> tuple[float, float]:
    """The paper's d_min and d_max [m], (1 -+ mu^2) K / mu^2, between which case 4 has
    its tracking points.

    The paper has one tracking point to the left and one to the right. The correct
    distances are ``orthogonal.translation_radii``: the object turns the same way about
    both centres. Infinite without friction.
    """
    if friction == 0.0:
        return math.inf, math.inf
    k = rho * rho / d
    return k * (1.0 - friction**2) / friction**2, k * (1.0 + friction**2) / friction**2


def pressed_forces(
    points: Sequence[Point], fx: float, fy: float, tau: float
) -> tuple[Point, ...]:
    """Tangential forces at ``points`` [m] with the smallest sum of squares (case 5; eq.
    24).

    The moment is about the CoM, but the limit surface is about the CoP. Unless the two
    coincide, an object that should only translate also turns.
    """
    return least_norm_forces(points, Wrench(fx, fy, tau))
