"""Squeeze of an object between two contacts: equal and opposite forces along the line
between them, which change no wrench.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact


class Squeeze:
    """Forces of two contacts, and what a squeeze between the contacts makes of them."""

    def __init__(
        self, contacts: Sequence[Contact], forces: Array, normals: Array
    ) -> None:
        """Take ``forces`` (n, m, 4) [N] in B, and ``normals`` (m, 2) [N] of presses."""
        (ax, ay), (bx, by) = (contact.point for contact in contacts)
        apart = math.hypot(bx - ax, by - ay) * math.sqrt(2.0)
        direction = np.array([(bx - ax) / apart, (by - ay) / apart])
        self._parts = (
            (contacts[0], forces[..., :2], direction, normals[:, 0]),
            (contacts[1], forces[..., 2:], -direction, normals[:, 1]),
        )

    def bounds(self, friction: Array) -> tuple[Array, Array, Array]:
        """Least and largest squeeze (n, m) [N] for which both forces are in their cones
        of ``friction`` (n,), and the share of the squeeze that acts along the slip of
        the contact whose cone is left first.
        """
        first, second = (_cone_bounds(*part, friction[:, None]) for part in self._parts)
        low = np.maximum(first[0], second[0])
        high = np.minimum(first[1], second[1])
        beyond = [np.maximum(one[0], -one[1]) for one in (first, second)]
        sliding = np.where(beyond[0] > beyond[1], first[2], second[2])
        return low, high, sliding


def _cone_bounds(
    contact: Contact, forces: Array, direction: Array, normals: Array, friction: Array
) -> tuple[Array, Array, float]:
    """Least and largest squeeze (n, m) for which one force is in its cone, and the
    share of the squeeze along its slip.
    """
    if contact.kind == "top":
        return _disc_bounds(forces, direction, friction * normals)
    nx, ny = contact.normal
    axes = np.array([(nx, -ny), (ny, nx)])
    force = forces @ axes
    along = direction @ axes
    low = np.full(force.shape[:2], -np.inf)
    high = np.full(force.shape[:2], np.inf)
    for side in (1.0, -1.0):  # side f_t <= mu f_n
        rest = friction * force[..., 0] - side * force[..., 1]
        rate = side * along[1] - friction * along[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            bound = rest / rate
        high = np.where(rate > 0.0, np.minimum(high, bound), high)
        low = np.where(rate < 0.0, np.maximum(low, bound), low)
        never = (rate == 0.0) & (rest < 0.0)
        low = np.where(never, np.inf, low)
    return low, high, abs(float(along[1]))


def _disc_bounds(
    forces: Array, direction: Array, limits: Array
) -> tuple[Array, Array, float]:
    """``_cone_bounds`` of a press with a friction of ``limits`` (n, m) [N]."""
    size = float(direction @ direction)
    middle = -(forces @ direction) / size
    rest = (forces**2).sum(axis=-1) - size * middle**2
    square = (limits**2 - rest) / size
    half = np.sqrt(np.maximum(square, 0.0))
    low = np.where(square < 0.0, np.inf, middle - half)
    return low, middle + half, math.sqrt(size)
