"""The exact limit surface for many wrenches at once, each with its own loads. Arrays
in, arrays out.

Source: docs/mechanics.md, section 1; ``mechanics.limit_surface.exact_twist_direction``
is the single call.
"""

from __future__ import annotations

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.identification.pairs import LENGTH, unit


def slide(
    points: Array, shares: Array, radii: Array, wrenches: Array
) -> tuple[Array, Array]:
    """Return unit directions (m, 3) of sliding, and the mu N (m,) [N] that put each
    wrench on the surface.

    ``points`` (n, 2) [m] and ``radii`` (n,) [m], > 0, of the loads; ``shares`` (m, n)
    of the total load for each wrench; ``wrenches`` (m, 3) [N, N m], not zero. All about
    the origin, directions as in ``Pairs``. The direction has the least friction power
    among those with unit power of the wrench; Newton steps with a line search, all
    wrenches at a time.
    """
    x, y = points.T / LENGTH
    radii_squared = (radii / LENGTH) ** 2
    arms = x**2 + y**2 + radii_squared
    size = np.linalg.norm(wrenches / (1.0, 1.0, LENGTH), axis=1)
    target = wrenches / (1.0, 1.0, LENGTH) / size[:, None]
    basis = _basis(target)

    def speeds(nu: Array) -> tuple[Array, Array, Array]:
        px = nu[:, :1] - nu[:, 2:] * y
        py = nu[:, 1:2] + nu[:, 2:] * x
        return px, py, np.sqrt(px**2 + py**2 + radii_squared * nu[:, 2:] ** 2)

    nu = target
    power = (shares * speeds(nu)[2]).sum(1)
    for _ in range(60):
        px, py, speed = speeds(nu)
        units = (
            np.stack([px, py, x * py - y * px + radii_squared * nu[:, 2:]], axis=2)
            / speed[:, :, None]
        )
        gradient = (shares[:, None] @ units)[:, 0]
        k = shares / speed
        hessian = -(k[:, :, None] * units).transpose(0, 2, 1) @ units
        hessian[:, 0, 0] += k.sum(1)
        hessian[:, 1, 1] += k.sum(1)
        hessian[:, 2, 2] += k @ arms
        hessian[:, [0, 2], [2, 0]] -= (k @ y)[:, None]
        hessian[:, [1, 2], [2, 1]] += (k @ x)[:, None]
        slopes = (gradient[:, None] @ basis)[:, 0]
        curvature = basis.transpose(0, 2, 1) @ hessian @ basis
        curvature += (
            1e-12
            * (1.0 + np.trace(curvature, axis1=1, axis2=2))[:, None, None]
            * np.eye(2)
        )
        step = -np.linalg.solve(curvature, slopes[:, :, None])[:, :, 0]
        descent = (slopes * step).sum(1)
        change = (basis @ step[:, :, None])[:, :, 0]
        length = np.ones(len(step))
        for _ in range(30):
            new = nu + length[:, None] * change
            new_power = (shares * speeds(new)[2]).sum(1)
            short = new_power > power + 1e-4 * length * descent + 1e-14
            if not short.any():
                break
            length[short] *= 0.5
        nu = new
        power = new_power
        if np.abs(length[:, None] * change).max() < 1e-9:
            break
    return unit(nu), size / power


def _basis(normals: Array) -> Array:
    """Return two unit vectors across each of the unit ``normals`` (m, 3), as columns
    (m, 3, 2).
    """
    other = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = unit(np.cross(normals, other))
    return np.stack([first, np.cross(normals, first)], axis=2)
