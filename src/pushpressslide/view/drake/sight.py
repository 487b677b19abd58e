"""Visibility of a contact from a direction, given the bodies between contact and
camera.

All points and directions are along x, y and height of the support's frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point

REACH = 3.0  # [m] of a line of sight
# [m] of a line of sight from a contact over which the tip's own rod is ignored
OWN = 0.05
TINY = 1e-12  # [m2] a shorter line is a point


@dataclass(frozen=True, slots=True)
class Block:
    """A body that stands on the support."""

    outline: tuple[Point, ...]  # [m]
    height: float  # [m]


@dataclass(frozen=True, slots=True)
class Limb:
    """Part of an arm: all points within ``radius`` of a line between two points [m]."""

    start: Vector3
    end: Vector3
    radius: float


@dataclass(frozen=True, eq=False)
class Moment:
    """Points to be seen, and bodies that may hide them, at one time of a run."""

    contacts: tuple[Vector3, ...]  # [m] points that are to be seen
    blocks: tuple[Block, ...]
    limbs: tuple[Limb, ...]
    # to be seen if possible [m]: the object's top, and where the forces are drawn
    corners: tuple[Vector3, ...] = ()
    forces: tuple[Vector3, ...] = ()

    @cached_property
    def polygons(self) -> tuple[tuple[Any, float], ...]:
        """Outlines of the blocks, and their heights [m]."""
        outlines = [(shapely.Polygon(b.outline), b.height) for b in self.blocks]
        for polygon, _ in outlines:
            shapely.prepare(polygon)
        return tuple(outlines)

    @cached_property
    def links(self) -> tuple[Array, Array, Array]:
        """Start and end (L, 3) and radius (L,) of the limbs [m]."""
        begins = np.array([limb.start for limb in self.limbs]).reshape(-1, 3)
        ends = np.array([limb.end for limb in self.limbs]).reshape(-1, 3)
        return begins, ends, np.array([limb.radius for limb in self.limbs])


def seen_share(moment: Moment, directions: Array) -> Array:
    """Share (...) of the contacts seen by far cameras. ``directions`` (..., 3) are unit
    vectors towards them.
    """
    return _share(moment, moment.contacts, directions)


def force_share(moment: Moment, directions: Array) -> Array:
    """Share (...) of the points of the drawn forces that far cameras see."""
    return _share(moment, moment.forces, directions)


def shown_share(moment: Moment, directions: Array) -> Array:
    """Share (...) of the object's corners that far cameras see."""
    return _share(moment, moment.corners, directions)


def _share(moment: Moment, points: tuple[Vector3, ...], directions: Array) -> Array:
    shape = directions.shape[:-1]
    if not points:
        return np.ones(shape)
    count = len(points)
    towards = np.repeat(directions.reshape(-1, 3), count, axis=0)
    repeated = np.tile(np.array(points), (len(towards) // count, 1))
    seen = are_seen(moment, repeated, towards)
    return np.asarray(seen.reshape(*shape, count).mean(axis=-1))


def are_seen(moment: Moment, points: Array, direction: Array) -> NDArray[np.bool_]:
    """Mask (P,) of the ``points`` (P, 3) with nothing between them and the camera.

    ``direction``, (3,) or (P, 3), are unit vectors towards the camera.
    """
    hidden = np.zeros(len(points), dtype=bool)
    for polygon, height in moment.polygons:
        hidden |= _behind_block(polygon, height, points, direction)
    if moment.limbs:
        starts, ends, radii = moment.links
        near = (points + OWN * direction)[:, None]
        far = (points + REACH * direction)[:, None]
        gaps = segment_distance(near, far, starts[None], ends[None])
        hidden |= (gaps < radii).any(axis=1)
    return ~hidden


def hidden_by_arms(moment: Moment, points: Array, eye: Array) -> NDArray[np.bool_]:
    """Mask (P,) of the ``points`` (P, 3) [m] that the arms hide from a camera at
    ``eye`` (3,) [m].
    """
    if not moment.limbs or not len(points):
        return np.zeros(len(points), dtype=bool)
    lines = eye - points
    lengths = np.linalg.norm(lines, axis=1, keepdims=True)
    near = points + np.minimum(OWN / np.maximum(lengths, TINY), 1.0) * lines
    starts, ends, radii = moment.links
    gaps = segment_distance(near[:, None], eye[None, None], starts[None], ends[None])
    return np.asarray((gaps < radii).any(axis=1))


def _behind_block(
    polygon: Any, height: float, points: Array, direction: Array
) -> NDArray[np.bool_]:
    """Mask (P,) of the ``points`` (P, 3) [m] that a block with a ``height`` [m] hides."""
    under = height - points[:, 2]
    rise = np.broadcast_to(direction, points.shape)[:, 2]
    upward = rise > 0.0
    lengths = np.full(len(points), REACH)
    out = np.maximum(under[upward], 0.0) / rise[upward]
    lengths[upward] = np.minimum(REACH, out)
    flat = np.asarray(direction)[..., :2]
    ends = points[:, :2] + lengths[:, None] * flat
    lines = shapely.linestrings(np.stack([points[:, :2], ends], axis=1))
    return np.asarray((under > 0.0) & shapely.intersects(polygon, lines))


def segment_distance(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Smallest distance [m] between the segments from ``a`` to ``b`` and from ``c`` to
    ``d``, (..., 3) each.
    """
    u = b - a
    v = d - c
    w = a - c
    uu = np.maximum(_dot(u, u), TINY)
    vv = np.maximum(_dot(v, v), TINY)
    uv = _dot(u, v)
    uw = _dot(u, w)
    vw = _dot(v, w)
    least = np.maximum(uu * vv - uv * uv, TINY)
    s = np.clip((uv * vw - vv * uw) / least, 0.0, 1.0)
    t = np.clip((uv * s + vw) / vv, 0.0, 1.0)
    s = np.clip((uv * t - uw) / uu, 0.0, 1.0)
    gap = w + s[..., None] * u - t[..., None] * v
    return np.asarray(np.linalg.norm(gap, axis=-1))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1))
