"""Shapes of bodies as MuJoCo geoms, in the frame with z zero at half height."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.mesh_parts import convex_corners
from pushpressslide.geometry.pieces import convex_pieces
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import Box, Cylinder

FOOT = 4e-3
"""Radius [m] of a foot's sphere."""
UNTOUCHED = {"contype": 0, "conaffinity": 0, "mass": 0.0}
"""Of every geom: pairs alone make contact, and bodies have masses of their own."""


def add_solid(
    spec: Any, body: Any, shape: Shape, name: str, **place: Sequence[float]
) -> tuple[str, ...]:
    """Add the convex geoms whose union is a shape to a body, and return their names.
    ``place`` holds pos and quat in the body.
    """
    kinds = mujoco.mjtGeom
    if isinstance(shape, Box):
        size = [0.5 * v for v in shape.size]
        body.add_geom(name=name, type=kinds.mjGEOM_BOX, size=size, **UNTOUCHED, **place)
        return (name,)
    if isinstance(shape, Cylinder):
        size = [shape.radius, 0.5 * shape.height, 0.0]
        kind = kinds.mjGEOM_CYLINDER
        body.add_geom(name=name, type=kind, size=size, **UNTOUCHED, **place)
        return (name,)
    names = []
    for i, corners in enumerate(_parts(shape)):
        part = f"{name}_{i}"
        mesh = spec.add_mesh(name=part)
        mesh.uservert = corners.ravel()
        body.add_geom(
            name=part, type=kinds.mjGEOM_MESH, meshname=part, **UNTOUCHED, **place
        )
        names.append(part)
    return tuple(names)


def add_feet(body: Any, name: str, points: Array, level: float) -> list[str]:
    """Add a sphere at each of ``points`` (n, 2) [m] to a body, with its centre at z =
    ``level`` [m], and return the names.
    """
    names = []
    for i, (x, y) in enumerate(points.tolist()):
        foot = f"{name}_{i}"
        body.add_geom(
            name=foot,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[FOOT, 0.0, 0.0],
            pos=[x, y, level],
            **UNTOUCHED,
        )
        names.append(foot)
    return names


def _parts(shape: Shape) -> list[Array]:
    """Corners (n, 3) [m] of the convex parts of a shape."""
    if isinstance(shape, MeshBody):
        return [np.array(corners) for corners in convex_corners(shape)]
    half = 0.5 * shape.height
    return [_prism(piece, half) for piece in convex_pieces(shape.corners)]


def _prism(corners: Sequence[Point], half: float) -> Array:
    flat = np.array(corners)
    ends = [np.column_stack([flat, np.full(len(flat), z)]) for z in (-half, half)]
    return np.concatenate(ends)
