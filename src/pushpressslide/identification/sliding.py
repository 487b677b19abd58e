"""The exact limit surface for many wrenches at once, each with its own loads.

Source: docs/mechanics.md, section 1. ``mechanics.limit_surface.exact_twist_direction``
does the same for one wrench.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.identification.pairs import LENGTH, unit


def slide(
    points: Array, shares: Array, radii: Array, wrenches: Array
) -> tuple[Array, Array]:
    """Unit directions (m, 3) of sliding, and for each wrench the mu N (m,) [N] at which
    it lies on the limit surface.

    ``points`` (n, 2) [m] and ``radii`` (n,) [m], > 0, are those of the loads;
    ``shares`` (m, n) are the loads' shares of the total for each wrench; ``wrenches``
    (m, 3) [N, N m] are not zero. Everything is about the origin, with directions as in
    ``Pairs``. The direction of sliding has the smallest friction power among all
    directions in which the wrench has unit power. Newton steps with a line search find
    it for all wrenches at once.
    """
    size = np.linalg.norm(wrenches / (1.0, 1.0, LENGTH), axis=1)
    target = wrenches / (1.0, 1.0, LENGTH) / size[:, None]
    basis = _basis(target)
    x, y = points.T / LENGTH
    friction = _Friction(x, y, (radii / LENGTH) ** 2, shares)
    nu = target
    power = friction.power(nu)
    for _ in range(60):
        step, descent = _newton_step(*friction.derivatives(nu), basis)
        change = (basis @ step[:, :, None])[:, :, 0]
        length = np.ones(len(step))
        for _ in range(30):
            new = nu + length[:, None] * change
            new_power = friction.power(new)
            short = new_power > power + 1e-4 * length * descent + 1e-14
            if not short.any():
                break
            length[short] *= 0.5
        nu = new
        power = new_power
        if np.abs(length[:, None] * change).max() < 1e-9:
            break
    return unit(nu), size / power


@dataclass(frozen=True, eq=False)
class _Friction:
    """The friction of n loads, with separate load shares for each of m wrenches."""

    x: Array  # (n,) over LENGTH
    y: Array  # (n,)
    radii_squared: Array  # (n,) over LENGTH^2
    shares: Array  # (m, n)

    def power(self, nu: Array) -> Array:
        """Power (m,) of the friction, divided by mu N, under twists (m, 3)."""
        total: Array = (self.shares * self._speeds(nu)[2]).sum(1)
        return total

    def derivatives(self, nu: Array) -> tuple[Array, Array]:
        """Gradients (m, 3) and Hessians (m, 3, 3) of the power."""
        x = self.x
        y = self.y
        px, py, speed = self._speeds(nu)
        moments = x * py - y * px + self.radii_squared * nu[:, 2:]
        units = np.stack([px, py, moments], axis=2) / speed[:, :, None]
        gradient = (self.shares[:, None] @ units)[:, 0]
        k = self.shares / speed
        hessian = -(k[:, :, None] * units).transpose(0, 2, 1) @ units
        hessian[:, 0, 0] += k.sum(1)
        hessian[:, 1, 1] += k.sum(1)
        hessian[:, 2, 2] += k @ (x**2 + y**2 + self.radii_squared)
        hessian[:, [0, 2], [2, 0]] -= (k @ y)[:, None]
        hessian[:, [1, 2], [2, 1]] += (k @ x)[:, None]
        return gradient, hessian

    def _speeds(self, nu: Array) -> tuple[Array, Array, Array]:
        px = nu[:, :1] - nu[:, 2:] * self.y
        py = nu[:, 1:2] + nu[:, 2:] * self.x
        return px, py, np.sqrt(px**2 + py**2 + self.radii_squared * nu[:, 2:] ** 2)


def _newton_step(gradient: Array, hessian: Array, basis: Array) -> tuple[Array, Array]:
    """Newton steps (m, 2) along the ``basis`` (m, 3, 2), and the directional
    derivatives (m,) along them.
    """
    slopes = (gradient[:, None] @ basis)[:, 0]
    curvature = basis.transpose(0, 2, 1) @ hessian @ basis
    curvature += (
        1e-12 * (1.0 + np.trace(curvature, axis1=1, axis2=2))[:, None, None] * np.eye(2)
    )
    solved = np.linalg.solve(curvature, slopes[:, :, None])
    step = -solved[:, :, 0].astype(np.float64)
    descent: Array = (slopes * step).sum(1)
    return step, descent


def _basis(normals: Array) -> Array:
    """Two unit vectors perpendicular to each of the unit ``normals`` (m, 3), as columns
    (m, 3, 2).
    """
    other = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = unit(np.cross(normals, other))
    return np.stack([first, np.cross(normals, first)], axis=2)
