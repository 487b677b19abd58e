"""The cone of wrenches that two side contacts can give, and the nearest wrench in the
cone (docs/mechanics.md, section 6).

The cone is spanned by four edge wrenches, one for each edge of the two friction cones.
Distances are in the norm diag(1, 1, 1/rho^2).
"""

from __future__ import annotations

from math import inf, sqrt

from pushpressslide.kernels.allocation import Vector, Wrench
from pushpressslide.kernels.kernel import kernel

FLAT = 1e-9  # sine of the angle below which two edge wrenches span no facet

Points = tuple[Vector, Vector]
Edge = tuple[float, float, float, float]
"""Edge wrench for a normal force of 1 N: force x, y, moment over rho, and squared norm.
"""
Edges = tuple[Edge, Edge, Edge, Edge]
"""The right and left edge of contact 1, then of contact 2."""
Span = Vector
"""Two numbers for a pair of edges: their scalar product, and the inverse square of the
size of their cross product. The second is 0 for parallel edges.
"""
Spans = tuple[Span, Span, Span, Span, Span, Span]
Cone = tuple[Edges, Spans]
"""The edges, and the spans of the pairs 12, 13, 14, 23, 24 and 34."""
Parts = tuple[float, float, float, float]


@kernel
def wrench_cone(points: Points, normals: Points, friction: float, rho: float) -> Cone:
    """Cone of the wrenches that two contacts at ``points`` [m] can give.

    ``rho`` [m] is that of the ellipsoid.
    """
    a = cone_edge(points[0], normals[0], -friction, rho)
    b = cone_edge(points[0], normals[0], friction, rho)
    c = cone_edge(points[1], normals[1], -friction, rho)
    d = cone_edge(points[1], normals[1], friction, rho)
    spans = (span(a, b), span(a, c), span(a, d), span(b, c), span(b, d), span(c, d))
    return (a, b, c, d), spans


@kernel
def cone_edge(point: Vector, normal: Vector, friction: float, rho: float) -> Edge:
    """Left edge of a contact's cone. For the right edge, pass the negative friction."""
    fx = normal[0] - friction * normal[1]
    fy = normal[1] + friction * normal[0]
    turn = (point[0] * fy - point[1] * fx) / rho
    return fx, fy, turn, fx * fx + fy * fy + turn * turn


@kernel
def span(a: Edge, b: Edge) -> Span:
    """Scalar product of two edges, and the inverse square of their cross product, which
    is 0 for parallel edges.
    """
    ax, ay, az, a_square = a
    bx, by, bz, b_square = b
    nx = ay * bz - az * by
    ny = az * bx - ax * bz
    nz = ax * by - ay * bx
    square = nx * nx + ny * ny + nz * nz
    product = ax * bx + ay * by + az * bz
    if square < FLAT * FLAT * a_square * b_square:
        return product, 0.0
    size = sqrt(square)
    return product, 1.0 / (size * size)


@kernel
def nearest_parts(fx: float, fy: float, z: float, cone: Cone) -> Parts:
    """Coefficients of the cone's edges whose sum is the wrench nearest to a given one
    outside the cone. ``z`` is the moment divided by rho.

    The nearest wrench lies on a facet. It is therefore the best solution among the four
    edges and their six pairs: non-negative least squares by enumeration.
    """
    a, b, c, d = cone[0]
    ons = (
        a[0] * fx + a[1] * fy + a[2] * z,
        b[0] * fx + b[1] * fy + b[2] * z,
        c[0] * fx + c[1] * fy + c[2] * z,
        d[0] * fx + d[1] * fy + d[2] * z,
    )
    wrench = (fx, fy, z)
    lower, parts = nearest_edge(wrench, cone[0], ons)
    return nearest_facet(wrench, cone, ons, lower, parts)


@kernel
def nearest_edge(wrench: Wrench, edges: Edges, ons: Parts) -> tuple[float, Parts]:
    """Squared distance and coefficients of the nearest wrench on an edge, or of the
    zero wrench.

    ``ons`` are the scalar products of edges and wrench.
    """
    a, b, c, d = edges
    fx, fy, z = wrench
    lower = fx * fx + fy * fy + z * z
    parts = (0.0, 0.0, 0.0, 0.0)
    distance, k = along_edge(wrench, a, ons[0])
    if distance < lower:
        lower = distance
        parts = (k, 0.0, 0.0, 0.0)
    distance, k = along_edge(wrench, b, ons[1])
    if distance < lower:
        lower = distance
        parts = (0.0, k, 0.0, 0.0)
    distance, k = along_edge(wrench, c, ons[2])
    if distance < lower:
        lower = distance
        parts = (0.0, 0.0, k, 0.0)
    distance, k = along_edge(wrench, d, ons[3])
    if distance < lower:
        lower = distance
        parts = (0.0, 0.0, 0.0, k)
    return lower, parts


@kernel
def nearest_facet(
    wrench: Wrench, cone: Cone, ons: Parts, min_error: float, parts: Parts
) -> Parts:
    """Coefficients of the nearest wrench between two edges, or ``parts`` if no such
    wrench is nearer than ``min_error``.
    """
    (a, b, c, d), (ab, ac, ad, bc, bd, cd) = cone
    on_a, on_b, on_c, on_d = ons
    distance, k, m = between(wrench, a, b, (on_a, on_b), ab)
    if distance < min_error:
        min_error = distance
        parts = (k, m, 0.0, 0.0)
    distance, k, m = between(wrench, a, c, (on_a, on_c), ac)
    if distance < min_error:
        min_error = distance
        parts = (k, 0.0, m, 0.0)
    distance, k, m = between(wrench, a, d, (on_a, on_d), ad)
    if distance < min_error:
        min_error = distance
        parts = (k, 0.0, 0.0, m)
    distance, k, m = between(wrench, b, c, (on_b, on_c), bc)
    if distance < min_error:
        min_error = distance
        parts = (0.0, k, m, 0.0)
    distance, k, m = between(wrench, b, d, (on_b, on_d), bd)
    if distance < min_error:
        min_error = distance
        parts = (0.0, k, 0.0, m)
    distance, k, m = between(wrench, c, d, (on_c, on_d), cd)
    if distance < min_error:
        parts = (0.0, 0.0, k, m)
    return parts


@kernel
def along_edge(wrench: Wrench, edge: Edge, on: float) -> Vector:
    """Squared distance and coefficient of the nearest wrench along an edge. The
    distance is infinite if the contact would have to pull.
    """
    if not on > 0.0:
        return inf, 0.0
    fx, fy, z = wrench
    ax, ay, az, square = edge
    k = on / square
    dx = fx - k * ax
    dy = fy - k * ay
    dz = z - k * az
    return dx * dx + dy * dy + dz * dz, k


@kernel
def between(wrench: Wrench, a: Edge, b: Edge, ons: Vector, span: Span) -> Wrench:
    """Squared distance and coefficients of the nearest wrench between two edges. The
    distance is infinite if a contact would have to pull.
    """
    ax, ay, az, a_square = a
    bx, by, bz, b_square = b
    on_a, on_b = ons
    product, inverse = span
    k = (b_square * on_a - product * on_b) * inverse
    m = (a_square * on_b - product * on_a) * inverse
    if not (k > 0.0 and m > 0.0):
        return inf, 0.0, 0.0
    fx, fy, z = wrench
    dx = fx - k * ax - m * bx
    dy = fy - k * ay - m * by
    dz = z - k * az - m * bz
    return dx * dx + dy * dy + dz * dz, k, m
