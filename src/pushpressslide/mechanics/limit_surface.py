"""Limit surfaces, the relation of wrench and sliding: the ellipsoid and the exact one.

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
from pushpressslide.mechanics.checks import check_force, check_rho
from pushpressslide.mechanics.pressure import PressureSamples

# roundings of the surface's edges, from coarse to fine, for pressures with pins
PIN_SOFTENINGS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)


@dataclass(frozen=True, slots=True)
class EllipsoidLimitSurface:
    """H(W) = (fx^2 + fy^2 + (tau/rho)^2) / max_force^2, with the moment about the
    centre of pressure.
    """

    max_force: float  # [N] mu_s N > 0
    rho: float  # [m] > 0
    center: Point = (0.0, 0.0)  # [m] centre of pressure in B

    def __post_init__(self) -> None:
        check_force(self.max_force, "max_force")
        check_rho(self.rho)

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
            mu * samples.loads, speed, out=np.zeros_like(speed), where=speed != 0.0
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
    """Return the direction of sliding, and the wrench over mu times the surface's."""
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
    basis = np.linalg.svd(target[None, :])[2][1:].T
    x = r[:, 0] / rho
    y = r[:, 1] / rho
    power = _FrictionPower(share, x, y, (samples.radii / rho) ** 2, target, basis)
    extended = bool((samples.radii[samples.loads > 0.0] > 0.0).all())
    z = np.zeros(2)
    for softening in (0.0,) if extended else PIN_SOFTENINGS:
        z = power.least(z, softening)
    value = power.value(z, 0.0)
    nu = target + basis @ z
    norm = float(np.linalg.norm(nu))
    nu /= norm
    return Twist(float(nu[0]), float(nu[1]), float(nu[2]) / rho, cop), size / (
        value * load
    )


@dataclass(frozen=True, eq=False)
class _FrictionPower:
    """Power of the friction over mu N, for twists with unit power of the wrench.

    These are target + basis z, in (vx, vy, rho w). ``softening`` rounds the edges that
    the surface of pins has.
    """

    share: Array  # (n,) of the load
    x: Array  # (n,) of the sample from the CoP, over rho
    y: Array  # (n,)
    radii_squared: Array  # (n,) over rho^2
    target: Array  # (3,)
    basis: Array  # (3, 2)

    def value(self, z: Array, softening: float) -> float:
        """Return the power at z (2,)."""
        return float(self.share @ self._speeds(z, softening)[0])

    def with_derivatives(
        self, z: Array, softening: float
    ) -> tuple[float, Array, Array]:
        """Return power, gradient (2,) and Hessian (2, 2) at z (2,)."""
        speed, (px, py, turn), soft = self._speeds(z, softening)
        x = self.x
        y = self.y
        # Each sample's speed is |A_i nu| with the rows of A_i below; its gradient is
        # A^T u, u the unit vector.
        inverse = 1.0 / np.maximum(speed, 1e-300)
        twist_row = np.stack([px, py, x * py - y * px + soft * turn])
        unit = twist_row * inverse
        gradient = unit @ self.share
        k = self.share * inverse
        hessian = np.empty((3, 3))
        hessian[0, 0] = hessian[1, 1] = k.sum()
        hessian[0, 1] = hessian[1, 0] = 0.0
        hessian[0, 2] = hessian[2, 0] = -(k @ y)
        hessian[1, 2] = hessian[2, 1] = k @ x
        hessian[2, 2] = k @ (x * x + y * y + soft)
        hessian -= (unit * k) @ unit.T
        basis = self.basis
        value = float(self.share @ speed)
        return value, basis.T @ gradient, basis.T @ hessian @ basis

    def least(self, z: Array, softening: float) -> Array:
        """Return z of the least power by Newton steps with a line search from ``z``."""
        for _ in range(60):
            value, gradient, hessian = self.with_derivatives(z, softening)
            if np.abs(gradient).max() < 1e-13:
                break
            damping = 1e-13 * (1.0 + float(np.trace(hessian)))
            step = np.linalg.solve(hessian + damping * np.eye(2), -gradient)
            t = 1.0
            slope = float(gradient @ step)
            while (
                t > 1e-8
                and self.value(z + t * step, softening)
                > value + 1e-4 * t * slope + 1e-15
            ):
                t *= 0.5
            z = z + t * step
            if t * float(np.abs(step).max()) < 1e-14:
                break
        return z

    def _speeds(
        self, z: Array, softening: float
    ) -> tuple[Array, tuple[Array, Array, float], Array]:
        """Return the samples' speeds (n,), their velocities and turn, and soft radii."""
        nu = self.target + self.basis @ z
        px = nu[0] - self.y * nu[2]
        py = nu[1] + self.x * nu[2]
        soft = self.radii_squared + softening**2
        speed = np.sqrt(px**2 + py**2 + soft * nu[2] ** 2)
        return speed, (px, py, nu[2]), soft
