"""The cone of wrenches that two side contacts can give, and projections onto it.

Source: docs/mechanics.md, section 6. The cone is spanned by four edge wrenches, one for
each edge of the two friction cones. Scaling never brings a wrench into a cone. A wrench
outside is therefore replaced by the nearest one in the cone, or by one with the same
force or the same moment. All formulas are closed forms of fixed cost, in plain floats.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import Literal, NamedTuple

from pushpressslide.core.pose import Point
from pushpressslide.kernels.wrench_cone import FLAT, nearest_parts, wrench_cone
from pushpressslide.mechanics.checks import (
    check_friction,
    check_normal,
    check_point,
    check_rho,
)

Vector = tuple[float, float, float]
Projection = Literal["nearest", "force_priority", "torque_priority"]
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class EdgeForces(NamedTuple):
    """Forces of two contacts on a facet of their wrench cone.

    At least one of the forces is on an edge of its friction cone.
    """

    forces: tuple[Point, Point]  # [N] in B
    normals: tuple[float, float]  # [N]


class WrenchCone:
    """The wrenches (fx, fy [N], tau [N m]) about B's origin that two side contacts can
    provide, in B.

    ``points`` [m] and unit inward ``normals`` are in B; ``friction`` is that of the
    pair tip/object. Distances are in the norm diag(1, 1, 1/rho^2), which measures the
    error of the object's twist on the ellipsoid of ``rho`` [m].
    """

    def __init__(
        self,
        points: Sequence[Point],
        normals: Sequence[Point],
        friction: float,
        rho: float,
    ) -> None:
        """Precompute the cone. Raises InputError unless the points are finite,
        ``friction`` is >= 0, ``rho`` > 0 and both normals have unit length.
        """
        for point in points:
            check_point(point, "point")
        check_friction(friction)
        check_rho(rho)
        for normal in normals:
            check_normal(normal)
        self._rho = rho
        first, second = points
        self._cone = wrench_cone(
            (first, second), (normals[0], normals[1]), friction, rho
        )
        self._edges = tuple(edge[:3] for edge in self._cone[0])
        """Edge wrenches with the moment over rho, for a normal force of 1 N."""
        self._squares = tuple(edge[3] for edge in self._cone[0])
        pairs = zip(combinations(self._edges, 2), self._cone[1], strict=True)
        planes = [_cross(a, b) for (a, b), (_, inverse) in pairs if inverse > 0.0]
        if friction == 0.0:
            planes += self._planes_across(planes)
        self.facets: tuple[Vector, ...] = tuple(
            facet for plane in planes for facet in self._facets(plane)
        )
        """Rows (a, b, c): the cone is a fx + b fy + c tau >= 0 for all rows. Empty if
        the cone contains all wrenches.
        """
        self._push = (normals[0][0] + normals[1][0], normals[0][1] + normals[1][1])

    def _planes_across(self, planes: Sequence[Vector]) -> list[Vector]:
        """Normals of planes that bound a flat cone, such as that of contacts without
        friction.

        The planes are at right angles to the cone's plane, or contain its line.
        """
        first = self._edges[0]
        if planes:
            return [_cross(planes[0], edge) for edge in self._edges]
        lower = min(range(3), key=lambda i: abs(first[i]))
        aside = _cross(first, AXES[lower])
        return [aside, _cross(first, aside), first]

    def _facets(self, normal: Vector) -> Iterator[Vector]:
        """Yield the facets of the cone in the plane with this ``normal``. There are
        none if edges lie on both sides of the plane.
        """
        size = math.sqrt(_dot(normal, normal))
        sides = [
            _dot(normal, edge) / (size * math.sqrt(square))
            for edge, square in zip(self._edges, self._squares, strict=True)
        ]
        for sign in (1.0, -1.0):
            if all(sign * side >= -FLAT for side in sides):
                a, b, c = (sign * part / size for part in normal)
                yield a, b, c / self._rho

    def margin(self, fx: float, fy: float, tau: float) -> float:
        """Distance [N] of a wrench to the nearest facet, negative outside.

        Infinite if the contacts can give every wrench.
        """
        return min(
            (a * fx + b * fy + c * tau for a, b, c in self.facets), default=math.inf
        )

    def nearest(self, fx: float, fy: float, tau: float) -> EdgeForces:
        """Contact forces for a given wrench outside the cone: those of the nearest
        wrench inside.
        """
        k1, k2, k3, k4 = nearest_parts(fx, fy, tau / self._rho, self._cone)
        a, b, c, d = self._cone[0]
        first = (k1 * a[0] + k2 * b[0], k1 * a[1] + k2 * b[1])
        second = (k3 * c[0] + k4 * d[0], k3 * c[1] + k4 * d[1])
        return EdgeForces((first, second), (k1 + k2, k3 + k4))

    def moved_by(
        self, projection: Projection
    ) -> Callable[[float, float, float], Vector]:
        """Projection of a wrench onto the cone that keeps its force or its moment, if
        possible.
        """
        if projection == "force_priority":
            return self.with_force_kept
        return self.with_torque_kept

    def with_force_kept(self, fx: float, fy: float, tau: float) -> Vector:
        """Wrench of the cone with the force of the given wrench and the nearest
        possible moment. The given wrench if no moment makes the force feasible.
        """
        low = -math.inf
        high = math.inf
        for a, b, c in self.facets:
            rest = a * fx + b * fy
            if abs(c) * self._rho < FLAT:
                if rest < 0.0:
                    return (fx, fy, tau)
            elif c > 0.0:
                low = max(low, -rest / c)
            else:
                high = min(high, -rest / c)
        if low > high:
            return (fx, fy, tau)
        return (fx, fy, min(max(tau, low), high))

    def with_torque_kept(self, fx: float, fy: float, tau: float) -> Vector:
        """Wrench of the cone with the moment of the given wrench and the smallest
        additional force along the sum of the normals. The given wrench if no such force
        suffices.
        """
        px, py = self._push
        drift = 0.0
        for a, b, c in self.facets:
            short = -(a * fx + b * fy + c * tau)
            if short > 0.0:
                rate = a * px + b * py
                if rate <= FLAT:
                    return (fx, fy, tau)
                drift = max(drift, short / rate)
        return (fx + drift * px, fy + drift * py, tau)


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )
