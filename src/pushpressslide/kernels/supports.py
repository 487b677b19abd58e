"""Friction laws of each kind of support, for ``kernels.sliding``."""

from __future__ import annotations

from typing import Any

from pushpressslide.kernels.edge_friction import polygon_friction
from pushpressslide.kernels.exact_surface import sampled_friction
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.support_friction import Friction, ellipsoid_friction


@kernel
def on_polygon(
    vx: float, vy: float, w: float, surface: Any, limit: float, sloped: bool
) -> Friction:
    """Friction law of a support under a polygon with a linear pressure. ``surface``
    holds the arguments of ``polygon_friction``.
    """
    plane, edges, series = surface
    return scaled(polygon_friction(vx, vy, w, plane, edges, series, sloped), limit, 1.0)


@kernel
def on_samples(
    vx: float, vy: float, w: float, surface: Any, limit: float, sloped: bool
) -> Friction:
    """Friction law of a support under samples of the load."""
    return scaled(sampled_friction(vx, vy, w, surface), limit, 1.0)


@kernel
def on_ellipsoid(
    vx: float, vy: float, w: float, rho: float, limit: float, sloped: bool
) -> Friction:
    """Friction law of an ellipsoidal limit surface with ``rho`` [m]."""
    return scaled(ellipsoid_friction(vx, vy, rho * w), limit, rho)


@kernel
def scaled(friction: Friction, limit: float, rho: float) -> Friction:
    """Wrench and slope for twists (v_x, v_y, w), from the dimensionless ``friction``.

    ``friction`` holds the wrench and slope for twists (v_x, v_y, rho w), divided by
    ``limit`` [N].
    """
    fx, fy, tau, xx, xy, xw, yy, yw, ww = friction
    arm = limit * rho
    return (
        limit * fx,
        limit * fy,
        arm * tau,
        limit * xx,
        limit * xy,
        arm * xw,
        limit * yy,
        arm * yw,
        arm * rho * ww,
    )
