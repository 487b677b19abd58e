"""Second moments of solid bodies of uniform density and one kilogram."""

from __future__ import annotations

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import Box, Cylinder

TWELFTH = 1.0 / 12.0

Moments = tuple[float, float, float, float, float, float]
"""Ixx, Iyy, Izz, Ixy, Ixz and Iyz [m^2]."""


def solid_center(shape: Shape) -> float:
    """Height [m] of a solid's centre of mass above its half height."""
    if isinstance(shape, MeshBody):
        return shape.solid.center[2] - 0.5 * shape.height
    return 0.0


def solid_moments(shape: Shape) -> Moments:
    """Moments of inertia of a solid of one kilogram about its centre of mass."""
    if isinstance(shape, MeshBody):
        xx, yy, zz, xy, xz, yz = shape.solid.inertia
        return (xx, yy, zz, xy, xz, yz)
    if isinstance(shape, Box):
        xx, yy, zz = (v * v for v in shape.size)
        sums = (yy + zz, xx + zz, xx + yy)
        about_x, about_y, about_z = (TWELFTH * v for v in sums)
        return (about_x, about_y, about_z, 0.0, 0.0, 0.0)
    if isinstance(shape, Cylinder):
        round_ = shape.radius * shape.radius
        across = TWELFTH * (3.0 * round_ + shape.height * shape.height)
        return (across, across, 0.5 * round_, 0.0, 0.0, 0.0)
    return _prism_moments(np.array(shape.corners), shape.height)


def _prism_moments(corners: Array, height: float) -> Moments:
    """Moments of a prism, by the triangles between its edges and its mean corner.
    ``corners`` (m, 2) [m], ``height`` [m].
    """
    a = corners - np.mean(corners, axis=0)
    b = np.roll(a, -1, axis=0)
    areas = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    aa = a[:, :, None] * a[:, None, :]
    bb = b[:, :, None] * b[:, None, :]
    ab = a[:, :, None] * b[:, None, :]
    ba = b[:, :, None] * a[:, None, :]
    second = np.einsum("k,kij->ij", areas / 12.0, 2.0 * (aa + bb) + ab + ba)
    centroid = np.einsum("k,ki->i", areas / 3.0, a + b) / areas.sum()
    second = second / areas.sum() - np.outer(centroid, centroid)
    (xx, xy), (_, yy) = second.tolist()
    h2 = height**2 / 12.0
    return (yy + h2, xx + h2, xx + yy, -xy, 0.0, 0.0)
