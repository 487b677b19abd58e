"""Limit surfaces: which wrench goes with which sliding. The ellipsoid, and the exact
one by quadrature.

Source: docs/mechanics.md, section 1. Quasi-static and rate independent: a wrench fixes
the direction of motion, never the speed. ``EllipsoidLimitSurface`` is plain floats, for
control loops; the exact surface is NumPy, for reference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.pressure import PressureSamples


@dataclass(frozen=True, slots=True)
class EllipsoidLimitSurface:
    """H(W) = (fx^2 + fy^2 + (tau/rho)^2) / max_force^2, with the moment about the
    centre of pressure.
    """

    max_force: float  # [N] mu_s N > 0
    rho: float  # [m] > 0
    center: Point = (0.0, 0.0)  # [m] centre of pressure in B

    def __post_init__(self) -> None:
        if not (self.max_force > 0.0 and math.isfinite(self.max_force)):
            raise ValueError(f"max_force {self.max_force} N; must be finite and > 0")
        if not (self.rho > 0.0 and math.isfinite(self.rho)):
            raise ValueError(f"rho {self.rho} m; must be finite and > 0")

    def level(self, wrench: Wrench) -> float:
        """Return H(W), any reference point: 1 on the surface, below 1 at rest."""
        w = wrench.moved_to(self.center)
        return (w.fx * w.fx + w.fy * w.fy + (w.tau / self.rho) ** 2) / self.max_force**2

    def twist_direction(self, wrench: Wrench) -> Twist:
        """Return the direction of sliding under ``wrench``, as a twist of the centre of
        pressure.

        nu ~ (fx, fy, tau/rho^2), normalised so that vx^2 + vy^2 + (rho w)^2 = 1
        m^2/s^2; zero for a zero wrench.
        """
        w = wrench.moved_to(self.center)
        vx = w.fx
        vy = w.fy
        rho_w = w.tau / self.rho
        norm = math.sqrt(vx * vx + vy * vy + rho_w * rho_w)
        if norm == 0.0:
            return Twist(0.0, 0.0, 0.0, self.center)
        return Twist(vx / norm, vy / norm, rho_w / (self.rho * norm), self.center)

    def wrench(self, twist: Twist) -> Wrench:
        """Return the wrench on the surface, about its centre, that drives ``twist``
        (any body point).

        W = mu_s N (vx, vy, rho^2 w) / sqrt(vx^2 + vy^2 + rho^2 w^2); zero for a zero
        twist.
        """
        t = twist.moved_to(self.center)
        rho_w = self.rho * t.w
        norm = math.sqrt(t.vx * t.vx + t.vy * t.vy + rho_w * rho_w)
        if norm == 0.0:
            return Wrench(0.0, 0.0, 0.0, self.center)
        k = self.max_force / norm
        return Wrench(k * t.vx, k * t.vy, k * self.rho * rho_w, self.center)


def exact_wrenches(samples: PressureSamples, mu: float, twists: Array) -> Array:
    """Return the wrenches (m, 3) [N, N m] that drive ``twists`` (m, 3), both at the
    CoP.

    W = mu sum N_i (v_i, r_i x v_i) / |v_i|, r_i from the CoP; the friction of the
    support is -W. A sample exactly at the centre of rotation gives no force. ``mu`` is
    the friction of the pair object/support.
    """
    twists = np.asarray(twists, dtype=np.float64)
    if twists.ndim != 2 or twists.shape[1] != 3:
        raise ValueError(f"twists {twists.shape}; need (m, 3)")
    r = samples.points - np.array(samples.cop)
    out = np.empty_like(twists)
    block = 32  # keeps the temporaries in the cache
    for i in range(0, len(twists), block):
        vx, vy, w = (c[:, None] for c in twists[i : i + block].T)
        px = vx - w * r[:, 1]
        py = vy + w * r[:, 0]
        speed = np.sqrt(px**2 + py**2 + (samples.radii * w) ** 2)
        k = np.divide(
            mu * samples.loads, speed, out=np.zeros_like(speed), where=speed > 0.0
        )
        fx = k * px
        fy = k * py
        torque = r[:, 0] * fy - r[:, 1] * fx + k * samples.radii**2 * w
        out[i : i + block] = np.stack([fx.sum(1), fy.sum(1), torque.sum(1)], axis=1)
    return out


def exact_wrench(samples: PressureSamples, mu: float, twist: Twist) -> Wrench:
    """Return the wrench, about the CoP, that slides the object with ``twist`` (any body
    point).
    """
    cop = samples.cop
    t = twist.moved_to(cop)
    fx, fy, tau = exact_wrenches(samples, mu, np.array([[t.vx, t.vy, t.w]]))[0]
    return Wrench(float(fx), float(fy), float(tau), cop)


def exact_twist_direction(samples: PressureSamples, wrench: Wrench) -> Twist:
    """Return the direction of sliding under ``wrench``, as a twist of the CoP with |(v,
    rho w)| = 1.

    The twist with the least friction power among those with unit power of the wrench
    (maximum dissipation), which is the normal of the exact surface; rho is the mean
    distance of the load to the CoP. Where the surface has an edge or a vertex (pins),
    one of its normals. Raises ValueError for a zero wrench or a pressure without
    extent.
    """
    return _slide(samples, wrench)[0]


def exact_level(samples: PressureSamples, mu: float, wrench: Wrench) -> float:
    """Return by what factor ``wrench`` exceeds the exact surface: 1 on it, below 1 at
    rest.

    Of degree one in the wrench, where the ellipsoid's H is of degree two.
    """
    return _slide(samples, wrench)[1] / mu


def exact_slide(
    samples: PressureSamples, mu: float, wrench: Wrench
) -> tuple[Twist, float]:
    """Return ``exact_twist_direction`` and ``exact_level`` at once, for the cost of
    one.
    """
    twist, factor = _slide(samples, wrench)
    return twist, factor / mu


def _slide(samples: PressureSamples, wrench: Wrench) -> tuple[Twist, float]:
    cop = samples.cop
    r = samples.points - np.array(cop)
    load = samples.total_load
    share = samples.loads / load
    rho = float(share @ np.sqrt((r**2).sum(1) + samples.radii**2))
    if rho == 0.0:
        raise ValueError(
            "the pressure has no extent; it resists no moment, so no twist is "
            "determined"
        )
    about = wrench.moved_to(cop)
    target = np.array([about.fx, about.fy, about.tau / rho])
    size = float(np.linalg.norm(target))
    if not (size > 0.0 and math.isfinite(size)):
        raise ValueError("a zero wrench has no direction of sliding")
    target /= size
    # Twists with unit power of the wrench: target + basis z, in (vx, vy, rho w).
    basis = np.linalg.svd(target[None, :])[2][1:].T
    x = r[:, 0] / rho
    y = r[:, 1] / rho
    radii_squared = (samples.radii / rho) ** 2

    def power(
        z: Array, softening: float, derivatives: bool
    ) -> tuple[float, Array, Array]:
        nu = target + basis @ z
        px = nu[0] - y * nu[2]
        py = nu[1] + x * nu[2]
        soft = radii_squared + softening**2
        speed = np.sqrt(px**2 + py**2 + soft * nu[2] ** 2)
        value = float(share @ speed)
        if not derivatives:
            return value, z, z
        # Each sample's speed is |A_i nu| with the rows of A_i below; its gradient is
        # A^T u, u the unit vector.
        inverse = 1.0 / np.maximum(speed, 1e-300)
        twist_row = np.stack([px, py, x * py - y * px + soft * nu[2]])
        unit = twist_row * inverse
        gradient = unit @ share
        k = share * inverse
        hessian = np.empty((3, 3))
        hessian[0, 0] = hessian[1, 1] = k.sum()
        hessian[0, 1] = hessian[1, 0] = 0.0
        hessian[0, 2] = hessian[2, 0] = -(k @ y)
        hessian[1, 2] = hessian[2, 1] = k @ x
        hessian[2, 2] = k @ (x * x + y * y + soft)
        hessian -= (unit * k) @ unit.T
        return value, basis.T @ gradient, basis.T @ hessian @ basis

    z = np.zeros(2)
    extended = bool((samples.radii[samples.loads > 0.0] > 0.0).all())
    for softening in (0.0,) if extended else (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8):
        for _ in range(60):
            value, gradient, hessian = power(z, softening, True)
            if np.abs(gradient).max() < 1e-13:
                break
            damping = 1e-13 * (1.0 + float(np.trace(hessian)))
            step = np.linalg.solve(hessian + damping * np.eye(2), -gradient)
            t = 1.0
            slope = float(gradient @ step)
            while (
                t > 1e-8
                and power(z + t * step, softening, False)[0]
                > value + 1e-4 * t * slope + 1e-15
            ):
                t *= 0.5
            z = z + t * step
            if t * float(np.abs(step).max()) < 1e-14:
                break
    value = power(z, 0.0, False)[0]
    nu = target + basis @ z
    norm = float(np.linalg.norm(nu))
    nu /= norm
    return Twist(float(nu[0]), float(nu[1]), float(nu[2]) / rho, cop), size / (
        value * load
    )
