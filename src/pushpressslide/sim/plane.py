"""A flat support as a rigid half-space, and the bases that stand on it.

Friction acts at the centroids of contact polygons. A half-space cuts each tetrahedron
of a compliant base in one polygon, which is nearly fixed to the body. The friction
wrench therefore does not depend on the body's position, and the number of polygons is
minimal. Centroids are nearer to the middle than the areas they represent. A base is
therefore enlarged by about 1 % to restore the moment of friction.

The half-space is the rigid body, since contact polygons lie on the rigid surface. If
the base were rigid, the normals of the polygons would tilt with it. Tilted by a
hundredth of a degree, the base would slide along them, in a step of 4 ms, by a
twentieth of its indentation. A solver that takes the friction from the load at the
start of the step would overestimate it by the same fraction.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, pairwise

import numpy as np
from pydrake.geometry import (
    CollisionFilterDeclaration,
    Convex,
    GeometryId,
    GeometrySet,
    HalfSpace,
    SceneGraph,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, RigidBody

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.ridge import LENGTH, Ridge
from pushpressslide.core.ridge import NAME as RIDGE
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.geometry import quadrature
from pushpressslide.geometry.areas import joined_ring, polygons
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.pieces import convex_pieces, triangles
from pushpressslide.geometry.polygon import turns
from pushpressslide.geometry.shapes import Shape
from pushpressslide.mechanics.bowed import bow_factors
from pushpressslide.sim.surfaces import (
    HYDROELASTIC_MODULUS,
    compliant_properties,
    rigid_properties,
    softness,
    without_details,
)
from pushpressslide.sim.volume_mesh import VolumeMesh

Triangle = tuple[int, int, int]

SUPPORT = "support"  # name of its geometry
CELLS = 6.0  # across a base where it is narrow
FINE = 12  # resolution of the rule for a base's mean distance from its middle
# smallest detail of a patch's outline, as a share of the breadth of the base's hull
BASE_DETAIL = 0.01
MOST_CELLS = 16  # along a base, however long it is
# share of a base by which its top is smaller: what the support cuts from sides that lean
# inwards gives way without a force, and is no constraint
LEAN = 1e-3
STRAIGHT = 1e-3  # [rad] of a corner that is only a point of a side
FLATS = 8  # across a ridge
BURIED = 0.005  # [m] of a ridge below the support
RIDGE_COLOR = np.array([0.62, 0.60, 0.56, 1.0])
FINEST = 1e-6  # [m] of the corners of cells; lines that are nearer together are one


@dataclass
class Plane:
    """The half-space of a flat support in a plant, and the bases that stand on it."""

    supports: list[GeometryId]  # the half-space, and a ridge on it
    frame: SupportFrame
    bases: dict[BodyIndex, list[GeometryId]] = field(default_factory=dict)

    def stand(
        self,
        plant: MultibodyPlant,
        body: RigidBody,
        shape: Shape,
        friction: float,
        cells: float = CELLS,
        bow: float = 0.0,
    ) -> None:
        """Add a body's base, with ``cells`` across it if it is narrow, and the faces on
        which the body lies after falling over. Its rim is lower and its middle higher by
        ``bow`` [m].
        """
        properties = compliant_properties(friction, 1.0)
        meshes = base_meshes(shape, cells, self.frame.handedness, bow)
        self.bases[body.index()] = [
            plant.RegisterCollisionGeometry(
                body, RigidTransform(), mesh.drake(), f"base_{i}", properties
            )
            for i, mesh in enumerate(meshes)
        ]

    def add_ridge(self, plant: MultibodyPlant, ridge: Ridge, friction: float) -> None:
        """Add a rigid ridge, which bodies climb as the edges of their bases reach it."""
        section = ridge.profile(FLATS)
        section += [(y, -BURIED) for y, _ in (section[0], section[-1])]
        points = np.array(
            [
                self.frame.point((*ridge.pose.apply((x, y)), h))
                for x in (-0.5 * LENGTH, 0.5 * LENGTH)
                for y, h in section
            ]
        )
        shape = Convex(points.T, "ridge")
        world = plant.world_body()
        properties = rigid_properties(friction)
        X = RigidTransform()
        self.supports.append(
            plant.RegisterCollisionGeometry(world, X, shape, RIDGE, properties)
        )
        plant.RegisterVisualGeometry(world, X, shape, f"{RIDGE}_visual", RIDGE_COLOR)

    def let_bases_stand(self, plant: MultibodyPlant, scene_graph: SceneGraph) -> None:
        """Let the bases touch the support. No other part of their bodies may touch it."""
        bases = set(chain.from_iterable(self.bases.values()))
        standing = GeometrySet(list(bases))
        others = GeometrySet()
        beside = GeometrySet()
        for index in range(plant.num_bodies()):
            body = plant.get_body(BodyIndex(index))
            for geometry in plant.GetCollisionGeometriesForBody(body):
                if geometry in self.supports or geometry in bases:
                    continue
                others.Add(geometry)
                if body.index() in self.bases:
                    beside.Add(geometry)
        scene_graph.collision_filter_manager().Apply(
            CollisionFilterDeclaration()
            .ExcludeWithin(standing)
            .ExcludeBetween(standing, others)
            .ExcludeBetween(beside, GeometrySet(self.supports))
        )


def add_plane(plant: MultibodyPlant, frame: SupportFrame, friction: float) -> Plane:
    """Add the plane of a support's ``frame`` to the world."""
    X = HalfSpace.MakePose(np.array(frame.normal), np.array(frame.origin))
    support = plant.RegisterCollisionGeometry(
        plant.world_body(), X, HalfSpace(), SUPPORT, rigid_properties(friction)
    )
    return Plane([support], frame)


# Drake warns that deformable bodies do not touch rigid half-spaces, of which there are
# none here
logging.getLogger("drake").addFilter(
    lambda record: "deformable contact" not in record.getMessage()
)


def bow_depth(shape: Shape, load: float, bow: float) -> float:
    """Distance [m] by which the rim of a base under a ``load`` [N] must be lower, for a
    pressure that differs by a share ``bow`` there.
    """
    return bow * load / shape.base_area * softness(shape) / HYDROELASTIC_MODULUS


def base_meshes(
    shape: Shape, cells: float = CELLS, up: float = 1.0, bow: float = 0.0
) -> list[VolumeMesh]:
    """Convex parts of a ``shape`` as tetrahedra, with ``cells`` across a narrow base.
    ``up`` is -1 if the shape's z axis points into the support, as on a wall. The rim is
    lower by ``bow`` [m], and the middle higher.
    """
    ring = _base_ring(shape) if isinstance(shape, MeshBody) else _outline(shape)
    whole = shape.hull if isinstance(shape, MeshBody) else shape
    bounds = whole.bounds(Pose2())
    counts = _cell_counts(bounds, whole.breadth, cells)
    x_min, x_max, y_min, y_max = bounds
    xs = np.linspace(x_min, x_max, counts[0] + 1).tolist()
    ys = np.linspace(y_min, y_max, counts[1] + 1).tolist()
    half = 0.5 * shape.height
    middle = softness(shape) - half
    parts = [base_triangles(_turning(part), xs, ys) for part in convex_pieces(ring)]
    meshes = [_prism(part, half, middle, up) for part in _widened(parts)]
    if bow == 0.0:
        return meshes
    return [_bent(mesh, shape, -up * half, -up * bow) for mesh in meshes]


def _bent(mesh: VolumeMesh, shape: Shape, foot: float, bow: float) -> VolumeMesh:
    """A mesh whose vertices at the height ``foot`` [m] are moved by up to ``bow`` [m]."""
    points = np.array([(x, y) for x, y, _ in mesh.vertices])
    moved = bow * (bow_factors(shape, points, 1.0) - 1.0)
    vertices = tuple(
        (x, y, z + dz if z == foot else z)
        for (x, y, z), dz in zip(mesh.vertices, moved.tolist(), strict=True)
    )
    return replace(mesh, vertices=vertices)


def _widened(parts: Sequence[Flat]) -> list[Flat]:
    """Parts of a base, enlarged about the base's centroid.

    The mean distance of the triangles' centroids from this point is then that of the
    base's area, which restores the moment of friction in a turn on the spot.
    """
    corners = np.concatenate(
        [np.array(part.points)[np.array(part.triangles)] for part in parts]
    )
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]  # twice
    centroids = corners.mean(axis=1)
    x, y = (areas @ centroids / areas.sum()).tolist()
    outlines = [np.array([part.points[i] for i in part.corners]) for part in parts]
    places, weights = quadrature.pieces_rule(outlines, FINE)
    within = np.hypot(*(places - (x, y)).T) @ weights / weights.sum()
    lost = np.hypot(*(centroids - (x, y)).T) @ areas / areas.sum()
    return [part.scaled((x, y), float(within / lost)) for part in parts]


def _outline(shape: Shape) -> tuple[Point, ...]:
    """Corners [m] of a base, counter-clockwise, as a polygon with the footprint's area."""
    from shapely import Polygon, affinity

    polygon = Polygon(without_details(shape.outline()))
    grown = math.sqrt(shape.placed(Pose2()).area / polygon.area)
    whole = affinity.scale(polygon, grown, grown, origin="centroid")
    return tuple((x, y) for x, y in whole.exterior.coords[:-1])


def _base_ring(shape: MeshBody) -> tuple[Point, ...]:
    """Corners [m] of one ring about the patches of a base. Each patch keeps its area
    but has few corners.
    """
    import shapely
    from shapely import affinity

    patches = []
    for patch in polygons(shape.base):
        detail = min(BASE_DETAIL * shape.hull.breadth, 0.25 * shape.breadth)
        simple = patch.simplify(detail)
        grown = math.sqrt(patch.area / simple.area)
        patches.append(affinity.scale(simple, grown, grown, origin="centroid"))
    return joined_ring(shapely.union_all(patches))


def _turning(corners: tuple[Point, ...]) -> tuple[Point, ...]:
    """Corners [m] at which the border changes direction."""
    by = zip(corners, turns(corners), strict=True)
    return tuple(corner for corner, turn in by if turn > STRAIGHT)


def _cell_counts(
    bounds: tuple[float, float, float, float], breadth: float, cells: float
) -> tuple[int, int]:
    """Numbers of cells along x and y. A long side has more cells, which are also
    longer.
    """
    x_min, x_max, y_min, y_max = bounds
    nx, ny = (
        min(MOST_CELLS, round(cells * math.sqrt(width / breadth)))
        for width in (x_max - x_min, y_max - y_min)
    )
    return nx, ny


@dataclass(frozen=True)
class Flat:
    """Triangles, counter-clockwise, that tile a convex polygon and share whole edges."""

    points: tuple[Point, ...]  # [m]
    triangles: tuple[Triangle, ...]
    corners: tuple[int, ...]  # of the polygon, counter-clockwise

    def scaled(self, center: Point, factor: float) -> Flat:
        """The polygon scaled by ``factor`` about a ``center`` [m]."""
        x, y = center
        points = tuple(
            (x + factor * (px - x), y + factor * (py - y)) for px, py in self.points
        )
        return replace(self, points=points)

    @property
    def sides(self) -> list[list[int]]:
        """Indices of the points along each side of the polygon, including its ends."""
        edges = {(t[i], t[(i + 1) % 3]) for t in self.triangles for i in range(3)}
        after = {a: b for a, b in edges if (b, a) not in edges}
        out = []
        for corner in self.corners:
            side = [corner, after[corner]]
            while side[-1] not in self.corners:
                side.append(after[side[-1]])
            out.append(side)
        return out


def base_triangles(
    corners: tuple[Point, ...], xs: Sequence[float], ys: Sequence[float]
) -> Flat:
    """A convex polygon cut along the lines at ``xs`` and ``ys`` [m], with each cell cut
    into triangles.
    """
    import shapely

    polygon = shapely.Polygon(corners)
    x_min, y_min, x_max, y_max = polygon.bounds
    along_y = [shapely.LineString([(x, y_min), (x, y_max)]) for x in xs]
    along_x = [shapely.LineString([(x_min, y), (x_max, y)]) for y in ys]
    inside = shapely.intersection([*along_x, *along_y], polygon)
    # lines that meet get a common point there, so that neighbours have the same corners
    noded = shapely.union_all([*inside, polygon.exterior], grid_size=FINEST)
    numbers: dict[Point, int] = {}
    out: list[Triangle] = []
    for cell in shapely.get_parts(shapely.polygonize([noded])):
        around = shapely.orient_polygons(cell).exterior.coords[:-1]
        vertices = tuple((x, y) for x, y in around)
        for triangle in _cut(vertices, xs, ys):
            a, b, c = (numbers.setdefault(vertices[i], len(numbers)) for i in triangle)
            out.append((a, b, c))
    points = tuple(numbers)
    at_corners = (
        min(numbers.values(), key=lambda i: math.dist(points[i], corner))
        for corner in corners
    )
    return Flat(points, tuple(out), tuple(at_corners))


def _cut(
    corners: tuple[Point, ...], xs: Sequence[float], ys: Sequence[float]
) -> Sequence[Triangle]:
    """Triangles of a cell, each given by indices of its corners."""
    if len(corners) != 4 or min(turns(corners)) < STRAIGHT:
        return triangles(corners)
    # the diagonal alternates, so that the base has no handedness
    first = corners.index(min(corners))
    x, y = np.mean(corners, axis=0)
    parity = int(np.searchsorted(xs, x) + np.searchsorted(ys, y)) % 2
    a, b, c, d = ((first + parity + i) % 4 for i in range(4))
    return (a, b, c), (a, c, d)


def _prism(base: Flat, half: float, middle: float, up: float) -> VolumeMesh:
    """An upright prism of height 2 ``half`` [m] on ``base``. All its triangles are
    joined to a vertex at the height ``middle`` [m], which has the highest pressure.

    Apart from the tetrahedra of the base, few touch the support. Since the sides lean
    inwards by ``LEAN``, the support cuts only negligible slivers from these.
    """
    sides = base.sides
    n = len(base.points)
    m = len(sides)
    foot = [(x, y, -up * half) for x, y in base.points]
    center = np.mean([base.points[side[0]] for side in sides], axis=0)
    smaller = base.scaled((center[0], center[1]), 1.0 - LEAN)
    head = [(*smaller.points[side[0]], up * half) for side in sides]
    inside = (*center.tolist(), up * middle)
    faces = [(c, b, a) for a, b, c in base.triangles]
    faces += [(n, n + i, n + i + 1) for i in range(1, m - 1)]
    for i, side in enumerate(sides):
        faces += [(a, b, n + i) for a, b in pairwise(side)]
        faces.append((side[-1], n + (i + 1) % m, n + i))
    # the fourth vertex is on the side to which the first three turn left
    turned = [(a, c, b) if up > 0.0 else (a, b, c) for a, b, c in faces]
    tetrahedra = tuple((a, b, c, n + m) for a, b, c in turned)
    return VolumeMesh((*foot, *head, inside), tetrahedra)
