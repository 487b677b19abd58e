"""The twists that two side contacts can drive: their wrench cone mapped through the
limit surface.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from pushpressslide.allocation.projections import WrenchCone
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import cross
from pushpressslide.core.twist_path import TwistRate
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.friction import cone_edges
from pushpressslide.mechanics.height_term import DraggedSurface

ORIGIN = (0.0, 0.0)
LESS = 0.8  # factor on the friction, repeated until the object cannot be squeezed
INWARD = 0.3  # share of the cone's middle in the twists near its edges


class TwistCone:
    """Twists of the CoM, B's origin, that ``contacts`` can drive with ``friction`` of
    the pair tip/object.
    """

    def __init__(
        self, contacts: Sequence[Contact], friction: float, surface: DraggedSurface
    ) -> None:
        """Precompute the parts that do not depend on the twist."""
        self.contacts = tuple(contacts)
        self.surface = surface
        points = [c.point for c in contacts]
        normals = [c.normal for c in contacts]
        self._wrenches = WrenchCone(points, normals, friction, surface.rho)
        # all wrenches, by squeezing: what counts is what a push gives
        while not self._wrenches.facets:
            friction *= LESS
            self._wrenches = WrenchCone(points, normals, friction, surface.rho)
        self._edges = []
        for point, normal in zip(points, normals, strict=True):
            for fx, fy in cone_edges(normal, friction):
                tau = cross(point, (fx, fy))
                size = math.hypot(fx, fy, tau / surface.rho)
                self._edges.append((fx / size, fy / size, tau / size))

    def wrench(self, vx: float, vy: float, w: float) -> Wrench:
        """Wrench [N, N m] about the CoM that drives a twist of the CoM."""
        return self.surface.wrench(Twist(vx, vy, w)).moved_to(ORIGIN)

    def cone_margin(self, vx: float, vy: float, w: float) -> float:
        """Angle [rad] of a twist's wrench from the edge of the cone, negative outside
        (see ``angle``).

        The angle is measured in the norm diag(1, 1, 1/rho^2), in which it is also the
        angle by which the twist may be turned.
        """
        fx, fy, tau, _ = self.wrench(vx, vy, w)
        size = math.hypot(fx, fy, tau / self.surface.rho)
        if size <= 0.0:
            return 0.0
        margin = self._wrenches.margin(fx, fy, tau)
        return math.asin(max(-1.0, min(1.0, margin / size)))

    def cone_margins(self, twists: Array) -> Array:
        """``cone_margin`` (m,) of twists (m, 3)."""
        cx, cy = self.surface.center
        rho = self.surface.rho
        vx, vy, w = twists.T
        fx, fy, tau = self.surface.wrenches(
            np.stack([vx - w * cy, vy + w * cx, w], axis=-1)
        ).T
        tau = tau + cx * fy - cy * fx
        lower = (np.array(self._wrenches.facets) @ (fx, fy, tau)).min(axis=0)
        size = np.maximum(np.hypot(np.hypot(fx, fy), tau / rho), 1e-300)
        out: Array = np.arcsin(np.clip(lower / size, -1.0, 1.0))
        return out

    def angle(self, vx: float, vy: float, w: float) -> float:
        """Angle [rad] between a twist's wrench and the edge of the cone, negative
        outside.

        Inside it is ``cone_margin``, outside minus the angle to the nearest wrench of
        the cone.

        For a wrench outside the cone, ``cone_margin`` itself is the angle to the plane
        of the nearest facet.
        """
        wanted = self.wrench(vx, vy, w)
        nearest = self.nearest(wanted)
        rho = self.surface.rho
        if nearest is None:
            return self.cone_margin(vx, vy, w)
        size = math.hypot(nearest.fx, nearest.fy, nearest.tau / rho)
        return -math.acos(
            min(1.0, size / math.hypot(wanted.fx, wanted.fy, wanted.tau / rho))
        )

    def nearest(self, wrench: Wrench) -> Wrench | None:
        """Nearest wrench of the cone, about B's origin.

        None for a wrench inside the cone.
        """
        fx, fy, tau, _ = wrench.moved_to(ORIGIN)
        if self._wrenches.margin(fx, fy, tau) >= 0.0:
            return None
        first, second = self._wrenches.nearest(fx, fy, tau).forces
        p, q = (contact.point for contact in self.contacts)
        return Wrench(
            first[0] + second[0],
            first[1] + second[1],
            cross(p, first) + cross(q, second),
        )

    def rays(self, margin: float) -> list[TwistRate]:
        """Twists ``margin`` [rad] inside the cone, near its edges and between them."""
        middle = tuple(0.25 * sum(parts) for parts in zip(*self._edges, strict=True))
        out = []
        for a, b in ((0, 0), (1, 1), (2, 2), (3, 3), *combinations(range(4), 2)):
            parts = zip(self._edges[a], self._edges[b], middle, strict=True)
            wrench = Wrench(
                *(0.5 * (1.0 - INWARD) * (p + q) + INWARD * m for p, q, m in parts)
            )
            twist = self.surface.twist_direction(wrench).moved_to(ORIGIN)
            out.append((twist.vx, twist.vy, twist.w))
        return [
            ray
            for ray, inside in zip(out, self.cone_margins(np.array(out)), strict=True)
            if inside >= margin
        ]
