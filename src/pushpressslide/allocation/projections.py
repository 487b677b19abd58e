"""The wrenches that two side contacts can give, as a cone; and where a wrench outside
of it is moved to.

Source: docs/mechanics.md, section 6. The cone is spanned by four edge wrenches, one for
each edge of the two friction cones. Scaling never brings a wrench into a cone, so what
is wanted has to be changed: to the nearest wrench, or with the force kept, or with the
moment kept. Closed forms of fixed cost, plain floats.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Literal, NamedTuple

from pushpressslide.core.pose import Point, cross
from pushpressslide.mechanics.checks import (
    check_friction,
    check_normal,
    check_point,
    check_rho,
)
from pushpressslide.mechanics.friction import cone_edges

Vector = tuple[float, float, float]
# two edges, their product, and one over the square of their cross product
Span = tuple[int, int, float, float]
Projection = Literal["nearest", "force_priority", "torque_priority"]
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
FLAT = 1e-9  # sine of the angle below which two edge wrenches span no facet


class EdgeForces(NamedTuple):
    """Forces of two contacts on a facet of their wrench cone.

    At least one of them is on its cone's edge.
    """

    forces: tuple[Point, Point]  # [N] in B
    normals: tuple[float, float]  # [N]


class WrenchCone:
    """The wrenches (fx, fy [N], tau [N m]) about B's origin that two side contacts can
    give, in B.

    ``points`` [m] and unit inward ``normals`` in B, ``friction`` of the pair
    tip/object. Distances are in the norm diag(1, 1, 1/rho^2), in which the error of the
    object's twist is measured on the ellipsoid of ``rho`` [m].
    """

    def __init__(
        self,
        points: Sequence[Point],
        normals: Sequence[Point],
        friction: float,
        rho: float,
    ) -> None:
        """Prepare the cone. Raises InputError unless the points are finite, ``friction``
        is >= 0, ``rho`` > 0 and both normals have unit length.
        """
        for point in points:
            check_point(point, "point")
        check_friction(friction)
        check_rho(rho)
        for normal in normals:
            check_normal(normal)
        self._rho = rho
        self._rays = tuple(
            ray for normal in normals for ray in cone_edges(normal, friction)
        )
        self._edges = tuple(
            (ray[0], ray[1], cross(points[i // 2], ray) / rho)
            for i, ray in enumerate(self._rays)
        )
        """Edge wrenches with the moment over rho, for a normal force of 1 N."""
        self._squares = tuple(_dot(edge, edge) for edge in self._edges)
        self._pairs, planes = self._spans()
        if friction == 0.0:
            planes += self._planes_across(planes)
        self.facets: tuple[Vector, ...] = tuple(
            facet for plane in planes for facet in self._facets(plane)
        )
        """Rows (a, b, c): the cone is a fx + b fy + c tau >= 0 in all of them; none if
        it is all wrenches.
        """
        self._push = (normals[0][0] + normals[1][0], normals[0][1] + normals[1][1])

    def _spans(self) -> tuple[tuple[Span, ...], list[Vector]]:
        """Return the pairs of edges that span a plane, and the planes' normals."""
        pairs = []
        planes: list[Vector] = []
        for i, j in combinations(range(4), 2):
            plane = _cross(self._edges[i], self._edges[j])
            square = _dot(plane, plane)
            if square < FLAT * FLAT * self._squares[i] * self._squares[j]:
                continue
            product = _dot(self._edges[i], self._edges[j])
            size = math.sqrt(square)
            pairs.append((i, j, product, 1.0 / (size * size)))
            planes.append(plane)
        return tuple(pairs), planes

    def _planes_across(self, planes: Sequence[Vector]) -> list[Vector]:
        """Return normals of planes that bound a flat cone, which that of contacts
        without friction is: those at right angles to its plane, or about its line.
        """
        first = self._edges[0]
        if planes:
            return [_cross(planes[0], edge) for edge in self._edges]
        least = min(range(3), key=lambda i: abs(first[i]))
        aside = _cross(first, AXES[least])
        return [aside, _cross(first, aside), first]

    def _facets(self, normal: Vector) -> Iterator[Vector]:
        """Yield the facets of the plane with a ``normal``: none where edges lie on both
        sides of it.
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
        """Return the number [N] that decides: distance of a wrench to the nearest
        facet, negative outside.

        Infinite where the contacts can give every wrench.
        """
        return min(
            (a * fx + b * fy + c * tau for a, b, c in self.facets), default=math.inf
        )

    def nearest(self, fx: float, fy: float, tau: float) -> EdgeForces:
        """Return the forces whose wrench is nearest to one that is not inside the cone.

        That wrench lies on a facet, so it is the best of the four edges and their six
        pairs: least squares with coefficients >= 0, by enumeration.
        """
        z = tau / self._rho
        along = [a * fx + b * fy + c * z for a, b, c in self._edges]
        trials = [
            (i, i, a / self._squares[i], 0.0) for i, a in enumerate(along) if a > 0.0
        ]
        for i, j, product, inverse in self._pairs:
            k_i = (self._squares[j] * along[i] - product * along[j]) * inverse
            k_j = (self._squares[i] * along[j] - product * along[i]) * inverse
            if k_i > 0.0 and k_j > 0.0:
                trials.append((i, j, k_i, k_j))
        least = fx * fx + fy * fy + z * z
        best = (0, 0, 0.0, 0.0)
        for trial in trials:
            i, j, k_i, k_j = trial
            ax, ay, az = self._edges[i]
            bx, by, bz = self._edges[j]
            dx = fx - k_i * ax - k_j * bx
            dy = fy - k_i * ay - k_j * by
            dz = z - k_i * az - k_j * bz
            distance = dx * dx + dy * dy + dz * dz
            if distance < least:
                least = distance
                best = trial
        k = [0.0, 0.0, 0.0, 0.0]
        i, j, k_i, k_j = best
        k[i] += k_i
        k[j] += k_j
        (ax, ay), (bx, by), (cx, cy), (dx, dy) = self._rays
        first = (k[0] * ax + k[1] * bx, k[0] * ay + k[1] * by)
        second = (k[2] * cx + k[3] * dx, k[2] * cy + k[3] * dy)
        return EdgeForces((first, second), (k[0] + k[1], k[2] + k[3]))

    def with_force_kept(self, fx: float, fy: float, tau: float) -> Vector:
        """Return the wrench of the cone with this force and the nearest moment.

        Where no moment makes the force possible, the wrench as it is.
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
        """Return the wrench of the cone with this moment and the least more force along
        the sum of the normals.

        Where no such force is enough, the wrench as it is.
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
