"""Limit surfaces, which relate wrenches to sliding: the ellipsoid and the exact
surface.

Source: docs/mechanics.md, section 1. Sliding is quasi-static and rate independent: a
wrench determines the direction of motion, but not the speed. ``EllipsoidLimitSurface``
uses plain floats and is meant for control loops; the exact surface serves as a
reference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.kernels import exact_surface as kernels
from pushpressslide.kernels.exact_surface import Extent, friction_of_sample
from pushpressslide.kernels.limit_surface import (
    ellipsoid_level,
    ellipsoid_twist,
    ellipsoid_wrench,
)
from pushpressslide.mechanics.checks import check_force, check_rho
from pushpressslide.mechanics.pressure import PressureSamples


@dataclass(frozen=True, slots=True)
class EllipsoidLimitSurface:
    """Ellipsoid H(W) = (fx^2 + fy^2 + (tau/rho)^2) / max_force^2, with the moment about
    the centre of pressure.
    """

    max_force: float  # [N] mu_s N > 0
    rho: float  # [m] > 0
    center: Point = (0.0, 0.0)  # [m] centre of pressure in B

    def __post_init__(self) -> None:
        check_force(self.max_force, "max_force")
        check_rho(self.rho)

    def level(self, wrench: Wrench) -> float:
        """Level H(W) of a wrench about any reference point: 1 on the surface, below 1
        at rest.
        """
        fx, fy, tau, _ = wrench.moved_to(self.center)
        return ellipsoid_level(fx, fy, tau, self.max_force, self.rho)

    def twist_direction(self, wrench: Wrench) -> Twist:
        """Direction of sliding under ``wrench``, as a twist of the centre of pressure.

        It is nu ~ (fx, fy, tau/rho^2), normalised so that vx^2 + vy^2 + (rho w)^2 = 1
        m^2/s^2. Zero for a zero wrench.
        """
        fx, fy, tau, _ = wrench.moved_to(self.center)
        return Twist(*ellipsoid_twist(fx, fy, tau, self.rho), self.center)

    def wrench(self, twist: Twist) -> Wrench:
        """Wrench on the surface, about its centre, that drives ``twist`` (any body
        point).

        W = mu_s N (vx, vy, rho^2 w) / sqrt(vx^2 + vy^2 + rho^2 w^2). Zero for a zero
        twist.
        """
        vx, vy, w, _ = twist.moved_to(self.center)
        driving = ellipsoid_wrench(vx, vy, w, self.max_force, self.rho)
        return Wrench(*driving, self.center)


def exact_wrenches(samples: PressureSamples, mu: float, twists: Array) -> Array:
    """Wrenches (m, 3) [N, N m] that drive ``twists`` (m, 3), both at the CoP.

    W = mu sum N_i (v_i, r_i x v_i) / |v_i|, with r_i relative to the CoP. The friction
    of the support is -W. A sample exactly at the centre of rotation contributes no
    force. ``mu`` is the friction of the pair object/support.
    """
    twists = np.asarray(twists, dtype=np.float64)
    if twists.ndim != 2 or twists.shape[1] != 3:
        raise ValueError(f"twists {twists.shape}; need (m, 3)")
    x, y = (samples.points - np.array(samples.cop)).T
    loads = mu * samples.loads
    out = np.empty_like(twists)
    block = 32  # keeps the temporaries in the cache
    for i in range(0, len(twists), block):
        vx, vy, w = (c[:, None] for c in twists[i : i + block].T)
        parts = friction_of_sample((vx, vy, w), x, y, samples.radii, loads)
        out[i : i + block] = np.stack([part.sum(1) for part in parts], axis=1)
    return out


def exact_wrench(samples: PressureSamples, mu: float, twist: Twist) -> Wrench:
    """Wrench about the CoP that slides the object with ``twist``, which may be given at
    any body point.
    """
    cop = samples.cop
    t = twist.moved_to(cop)
    fx, fy, tau = exact_wrenches(samples, mu, np.array([[t.vx, t.vy, t.w]]))[0]
    return Wrench(float(fx), float(fy), float(tau), cop)


def exact_twist_direction(samples: PressureSamples, wrench: Wrench) -> Twist:
    """Direction of sliding under ``wrench``, as a twist of the CoP with |(v, rho w)| =
    1.

    The twist has the smallest friction power among all twists at which the wrench has
    unit power (maximum dissipation); it is the normal of the exact surface. At an edge
    or a vertex of the surface (pins), it is one of the normals. Rho is the mean
    distance of the load from the CoP. Raises ValueError for a zero wrench or a pressure
    without extent.
    """
    return _slide(samples, wrench)[0]


def exact_level(samples: PressureSamples, mu: float, wrench: Wrench) -> float:
    """Factor by which ``wrench`` exceeds the exact surface: 1 on it, below 1 at rest.

    It is of degree one in the wrench, unlike the H of the ellipsoid, which is of degree
    two.
    """
    return _slide(samples, wrench)[1] / mu


def exact_slide(
    samples: PressureSamples, mu: float, wrench: Wrench
) -> tuple[Twist, float]:
    """``exact_twist_direction`` and ``exact_level``, at the cost of one of them."""
    twist, factor = _slide(samples, wrench)
    return twist, factor / mu


def _slide(samples: PressureSamples, wrench: Wrench) -> tuple[Twist, float]:
    """Direction of sliding, and the friction mu at which the wrench lies on the limit
    surface.
    """
    extent, over_rho = slide_samples(samples)
    if extent[0] == 0.0:
        raise ValueError(
            "the pressure has no extent; it resists no moment, so no twist is "
            "determined"
        )
    fx, fy, tau, cop = wrench.moved_to(samples.cop)
    (vx, vy, w), factor = kernels.exact_slide(fx, fy, tau, extent, over_rho)
    if math.isnan(factor):
        raise ValueError("a zero wrench has no direction of sliding")
    return Twist(vx, vy, w, cop), factor / samples.total_load


def slide_samples(samples: PressureSamples) -> tuple[Extent, Array]:
    """Parameters and samples (4, m) for ``kernels.exact_surface.exact_slide``."""
    x, y = (samples.points - np.array(samples.cop)).T
    square = samples.radii**2
    share = samples.loads / samples.total_load
    rho = float(share @ np.sqrt(x * x + y * y + square))
    pinned = bool((samples.radii[samples.loads > 0.0] == 0.0).any())
    if rho == 0.0:
        return (rho, float(pinned)), np.stack([x, y, square, share])
    over_rho = np.stack([x / rho, y / rho, square / rho**2, share])
    return (rho, float(pinned)), over_rho


def load_spread(samples: PressureSamples) -> tuple[float, float, float]:
    """Mean squares xx, xy and yy [m^2] of the load's distribution about its centre."""
    x, y = (samples.points - np.array(samples.cop)).T
    share = samples.loads / samples.total_load
    return float(share @ (x * x)), float(share @ (x * y)), float(share @ (y * y))
