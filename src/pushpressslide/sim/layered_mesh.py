"""Volume mesh of an upright body on a concave footprint, for hydroelastic contact.

Drake assigns each vertex of a volume mesh a pressure proportional to its distance from
the surface, and interpolates. The mesh has a second, inner surface at a constant depth
below the outer one. The pressure therefore grows linearly inwards everywhere on base,
top and sides, including edges and corners.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point, cross
from pushpressslide.geometry.pieces import triangles
from pushpressslide.sim.volume_mesh import Tetrahedron, VolumeMesh

Prism = tuple[int, int, int, int, int, int]  # a triangle, and the one above it

# largest depth, as a share of the height: the inner surface fits between base and top
DEEPEST = 0.45
SHALLOWER = 0.8  # factor from one tried depth to the next
TRIES = 60
# used share of the depth at which the inner outline is still valid, so that its edges
# keep a length
SOUND = 0.9


@dataclass(frozen=True, slots=True)
class LayeredMesh:
    """A mesh with an inner surface."""

    mesh: VolumeMesh
    depth: float  # [m] of the inner surface under the outer one


def layered_mesh(corners: tuple[Point, ...], height: float) -> LayeredMesh:
    """Mesh of a prism on a simple polygon, counter-clockwise [m].

    Raises ValueError if the polygon is too thin to hold the inner outline of the mesh.
    """
    n = len(corners)
    depth, inner = _inner(corners, DEEPEST * height)
    half = 0.5 * height
    rings = (
        (corners, -half),
        (corners, half),
        (inner, -half),
        (inner, depth - half),
        (inner, half - depth),
        (inner, half),
    )
    vertices = tuple((x, y, z) for ring, z in rings for x, y in ring)
    foot, head, below, low, high, above = (range(i * n, (i + 1) * n) for i in range(6))
    prisms: list[Prism] = []
    for i in range(n):
        j = (i + 1) % n
        for a, b, c in ((foot, below, low), (foot, low, high), (foot, high, head)):
            prisms.append((a[i], b[i], c[i], a[j], b[j], c[j]))
        prisms.append((head[i], high[i], above[i], head[j], high[j], above[j]))
    for i, j, k in triangles(inner):
        for lower, upper in ((below, low), (low, high), (high, above)):
            prisms.append((lower[i], lower[j], lower[k], upper[i], upper[j], upper[k]))
    cells = tuple(cell for prism in prisms for cell in _cut(prism))
    mesh = VolumeMesh(vertices, tuple(_turned(vertices, c) for c in cells))
    return LayeredMesh(mesh, depth)


def _inner(
    corners: tuple[Point, ...], deepest: float
) -> tuple[float, tuple[Point, ...]]:
    """A depth [m], and the outline moved inwards by this depth, corner by corner."""
    depth = deepest
    for _ in range(TRIES):
        if _is_sound(corners, depth):
            break
        depth *= SHALLOWER
    else:
        raise ValueError("the outline is too thin to have an inner one")
    depth *= SOUND
    return depth, _inset(corners, depth)


def _inset(corners: tuple[Point, ...], depth: float) -> tuple[Point, ...]:
    """Corners of the outline with each edge moved inwards by ``depth`` [m]."""
    out = []
    for before, at, after in zip(
        corners[-1:] + corners[:-1], corners, corners[1:] + corners[:1], strict=True
    ):
        ax, ay = _normal(before, at)
        bx, by = _normal(at, after)
        share = depth / (1.0 + ax * bx + ay * by)
        out.append((at[0] + share * (ax + bx), at[1] + share * (ay + by)))
    return tuple(out)


def _normal(a: Point, b: Point) -> Point:
    """Unit normal to the left of the direction from a to b."""
    length = math.dist(a, b)
    return (-(b[1] - a[1]) / length, (b[0] - a[0]) / length)


def _is_sound(corners: tuple[Point, ...], depth: float) -> bool:
    """Whether the outline moved inwards by ``depth`` [m] keeps all its edges, and is
    nowhere nearer than ``depth`` to the original outline.
    """
    from shapely import Polygon

    inner = _inset(corners, depth)
    n = len(corners)
    for i in range(n):
        j = (i + 1) % n
        edge = (corners[j][0] - corners[i][0], corners[j][1] - corners[i][1])
        moved = (inner[j][0] - inner[i][0], inner[j][1] - inner[i][1])
        if edge[0] * moved[0] + edge[1] * moved[1] <= 0.0:
            return False
    area = Polygon(inner)
    outer = Polygon(corners)
    if not (area.is_valid and outer.contains(area)):
        return False
    return bool(area.exterior.distance(outer.exterior) > (1.0 - 1e-6) * depth)


def _cut(prism: Prism) -> list[Tetrahedron]:
    """Three tetrahedra of a triangular prism (Dompierre and others, 1999).

    Each rectangle is cut at its lowest-numbered vertex, so that neighbours agree.
    """
    lowest = prism.index(min(prism))
    a, b, c, d, e, f = (prism[k] for k in _ORDERS[lowest])
    if min(b, f) < min(c, e):
        return [(a, b, c, f), (a, b, f, e), (a, e, f, d)]
    return [(a, b, c, e), (a, e, c, f), (a, e, f, d)]


_ORDERS = (
    (0, 1, 2, 3, 4, 5),
    (1, 2, 0, 4, 5, 3),
    (2, 0, 1, 5, 3, 4),
    (3, 5, 4, 0, 2, 1),
    (4, 3, 5, 1, 0, 2),
    (5, 4, 3, 2, 1, 0),
)
"""Orders of a prism's vertices that put a given vertex first, by the index of this
vertex. It is the vertex with the lowest number.
"""


def _turned(vertices: tuple[Vector3, ...], cell: Tetrahedron) -> Tetrahedron:
    """The tetrahedron, reordered so that the first three vertices run counter-clockwise
    as seen from the fourth.
    """
    a, b, c, d = (vertices[i] for i in cell)
    u, v, w = ((p[0] - a[0], p[1] - a[1], p[2] - a[2]) for p in (b, c, d))
    across = (
        cross((u[1], u[2]), (v[1], v[2])),
        cross((u[2], u[0]), (v[2], v[0])),
        cross((u[0], u[1]), (v[0], v[1])),
    )
    volume = across[0] * w[0] + across[1] * w[1] + across[2] * w[2]
    return cell if volume > 0.0 else (cell[1], cell[0], cell[2], cell[3])
