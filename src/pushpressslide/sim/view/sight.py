"""Whether a contact is seen from a direction: what stands between it and the camera.

All points and directions are along x, y and height of the support's frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point

REACH = 3.0  # [m] of a line of sight
# [m] of a line of sight from a contact on, in which the tip's own rod does not count
OWN = 0.05


@dataclass(frozen=True, slots=True)
class Block:
    """A body that stands on the support."""

    outline: tuple[Point, ...]  # [m]
    height: float  # [m]


@dataclass(frozen=True, slots=True)
class Limb:
    """A piece of an arm: all within ``radius`` of a line between two points [m]."""

    begin: Vector3
    end: Vector3
    radius: float


@dataclass(frozen=True, slots=True)
class Moment:
    """What there is to see, and what may hide it, at one time of a run."""

    contacts: tuple[Vector3, ...]  # [m] points that are to be seen
    blocks: tuple[Block, ...]
    limbs: tuple[Limb, ...]


def seen_share(moment: Moment, direction: Array) -> float:
    """Return the share of the contacts that a far camera in ``direction`` (3,) sees;
    ``direction`` is a unit vector towards it.
    """
    if not moment.contacts:
        return 1.0
    seen = [is_seen(moment, point, direction) for point in moment.contacts]
    return float(np.mean(seen))


def is_seen(moment: Moment, point: Vector3, direction: Array) -> bool:
    """Return whether nothing is between ``point`` and the camera."""
    if any(_behind_block(block, point, direction) for block in moment.blocks):
        return False
    return not any(_behind_limb(limb, point, direction) for limb in moment.limbs)


def _behind_block(block: Block, point: Vector3, direction: Array) -> bool:
    x, y, z = point
    if z >= block.height:
        return False
    length = REACH
    rise = float(direction[2])
    if rise > 0.0:
        length = min(REACH, (block.height - z) / rise)
    end = (x + length * direction[0], y + length * direction[1])
    line = shapely.LineString([(x, y), end])
    return bool(line.intersects(shapely.Polygon(block.outline)))


def _behind_limb(limb: Limb, point: Vector3, direction: Array) -> bool:
    begin = np.array(point) + OWN * direction
    end = np.array(point) + REACH * direction
    gap = segment_distance(begin, end, np.array(limb.begin), np.array(limb.end))
    return gap < limb.radius


def segment_distance(a: Array, b: Array, c: Array, d: Array) -> float:
    """Return the least distance [m] between the lines from ``a`` to ``b`` and from ``c``
    to ``d``, (3,) each.
    """
    u = b - a
    v = d - c
    w = a - c
    uu, uv, vv = float(u @ u), float(u @ v), float(v @ v)
    uw, vw = float(u @ w), float(v @ w)
    least = uu * vv - uv * uv
    s = 0.0
    if least > 1e-12:
        s = min(1.0, max(0.0, (uv * vw - vv * uw) / least))
    t = 0.0
    if vv > 1e-12:
        t = min(1.0, max(0.0, (uv * s + vw) / vv))
    if uu > 1e-12:
        s = min(1.0, max(0.0, (uv * t - uw) / uu))
    return float(np.linalg.norm(w + s * u - t * v))
