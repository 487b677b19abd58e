"""The ellipsoidal limit surface, also with its centre displaced by drag: wrench of a
twist, and twist of a wrench (docs/mechanics.md, sections 1 and 1.2).
"""

from __future__ import annotations

from math import sqrt

from pushpressslide.kernels.allocation import Wrench
from pushpressslide.kernels.elementary import square
from pushpressslide.kernels.kernel import kernel

Twist = tuple[float, float, float]
Ellipsoid = tuple[float, float, float]
"""Largest force mu_s N [N], rho [m], and the displacement [m] of the centre of pressure
by this force: h mu_s for forces at height h.
"""
Placed = tuple[float, float, float, float, float]
"""An ``Ellipsoid``, and the position [m] in B of the centre of pressure without drag.
"""


@kernel
def ellipsoid_wrench(
    vx: float, vy: float, w: float, max_force: float, rho: float
) -> Wrench:
    """Wrench on the limit surface that drives a twist of the centre of pressure. Zero
    for a zero twist.

    W = mu_s N (vx, vy, rho^2 w) / sqrt(vx^2 + vy^2 + rho^2 w^2).
    """
    rho_w = rho * w
    norm = sqrt(vx * vx + vy * vy + rho_w * rho_w)
    if norm == 0.0:
        return 0.0, 0.0, 0.0
    k = max_force / norm
    return k * vx, k * vy, k * rho * rho_w


@kernel
def dragged_wrench(vx: float, vy: float, w: float, surface: Ellipsoid) -> Wrench:
    """Wrench on the limit surface that drives a twist. Zero for a zero twist.

    Wrench and twist refer to the centre of pressure without drag.
    """
    max_force, rho, lift = surface
    turn = square(rho * w)
    shift = square(lift * w)
    # |v_center|^2 = v^2 (1 + shift / (v^2 + turn)) for the speed v of the moved centre
    # of pressure
    resting = vx * vx + vy * vy
    half = 0.5 * (resting - turn - shift)
    v_squared = half + sqrt(half * half + resting * turn)
    norm = sqrt((0.0 if v_squared < 0.0 else v_squared) + turn)
    if norm == 0.0:
        return 0.0, 0.0, 0.0
    # v_center = F - k J F, F the velocity of the moved centre of pressure
    k = lift * w / norm
    scale = max_force / (norm * (1.0 + k * k))
    return (
        scale * (vx - k * vy),
        scale * (vy + k * vx),
        max_force * square(rho) * w / norm,
    )


@kernel
def ellipsoid_twist(fx: float, fy: float, tau: float, rho: float) -> Twist:
    """Direction of sliding (fx, fy, tau / rho^2) under a wrench, with |(v, rho w)| = 1
    m/s. Zero for a zero wrench.

    Wrench and twist refer to the centre of pressure.
    """
    spin = tau / rho
    norm = sqrt(fx * fx + fy * fy + spin * spin)
    if norm == 0.0:
        return 0.0, 0.0, 0.0
    return fx / norm, fy / norm, spin / (rho * norm)


@kernel
def dragged_twist(fx: float, fy: float, tau: float, surface: Ellipsoid) -> Twist:
    """Direction of sliding under a wrench that is scaled to the surface.

    Wrench and twist refer to the centre of pressure without drag. The result is
    ``ellipsoid_twist`` about the displaced centre.
    """
    _, rho, lift = surface
    vx, vy, w = ellipsoid_twist(fx, fy, tau, rho)
    k = lift * w
    return vx + k * vy, vy - k * vx, w


@kernel
def ellipsoid_level(
    fx: float, fy: float, tau: float, max_force: float, rho: float
) -> float:
    """Level H(W) of a wrench about the centre of pressure: 1 on the surface."""
    return (fx * fx + fy * fy + square(tau / rho)) / square(max_force)


@kernel
def driving_wrench(vx: float, vy: float, w: float, placed: Placed) -> Wrench:
    """``dragged_wrench`` for wrench and twist of B's origin."""
    max_force, rho, lift, x, y = placed
    surface = (max_force, rho, lift)
    fx, fy, tau = dragged_wrench(vx - w * y, vy + w * x, w, surface)
    return fx, fy, tau + x * fy - y * fx


@kernel
def driven_twist(
    fx: float, fy: float, tau: float, placed: Placed
) -> tuple[Twist, float]:
    """``dragged_twist`` for wrench and twist of B's origin, and the level of the
    wrench.
    """
    max_force, rho, lift, x, y = placed
    surface = (max_force, rho, lift)
    tau = tau - x * fy + y * fx
    vx, vy, w = dragged_twist(fx, fy, tau, surface)
    return (vx + w * y, vy - w * x, w), ellipsoid_level(fx, fy, tau, max_force, rho)
