"""An even support as a compliant half-space, and the bases that stand on it.

Friction acts at the centroids of contact polygons. Against a half-space each triangle
of a rigid base is one polygon, fixed to the body: the friction wrench does not depend
on where the body is, and there are no more polygons than it needs.
"""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass, field
from itertools import accumulate, pairwise, product

import numpy as np
from pydrake.geometry import (
    AddCompliantHydroelasticPropertiesForHalfSpace,
    AddContactMaterial,
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    HalfSpace,
    Mesh,
    ProximityProperties,
    SceneGraph,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, RigidBody

from pushpressslide.core.control import Vector3
from pushpressslide.core.pieces import triangles
from pushpressslide.core.polygon import signed_area
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.shapes import Shape
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.sim.surfaces import (
    DISSIPATION,
    HYDROELASTIC_MODULUS,
    obj_mesh,
    rigid_properties,
    without_details,
)

Face = tuple[Vector3, ...]  # counter-clockwise, seen from outside
Triangle = tuple[Point, Point, Point]

CELLS = 7.0  # across a base where it is narrow
MOST_CELLS = 16  # along a base, however long it is
SLIVER = 1e-3  # of a cell, smaller pieces of which are left out
# [m] from the base up to where the sides begin, so that an upright body stands on its
# base alone
SKIN_GAP = 5e-4


@dataclass
class Plane:
    """The half-space of an even support in a plant, and the bases that stand on it."""

    support: GeometryId
    frame: SupportFrame
    bases: dict[BodyIndex, GeometryId] = field(default_factory=dict)

    def stand(
        self,
        plant: MultibodyPlant,
        body: RigidBody,
        shape: Shape,
        friction: float,
        cells: float = CELLS,
    ) -> None:
        """Give a body of a ``shape`` what it stands on: its base, in ``cells`` where it
        is narrow, and the rest of its skin, on which it lies once it has fallen over.
        """
        X = RigidTransform()
        mesh = base_mesh(shape, cells, self.frame.handedness)
        properties = rigid_properties(friction)
        base = plant.RegisterCollisionGeometry(body, X, mesh, "base", properties)
        self.bases[body.index()] = base

    def let_bases_stand(self, plant: MultibodyPlant, scene_graph: SceneGraph) -> None:
        """Let each base touch the support alone, and nothing else of its body do so."""
        bases = set(self.bases.values())
        standing = GeometrySet(list(bases))
        others = GeometrySet()
        beside = GeometrySet()
        for index in range(plant.num_bodies()):
            body = plant.get_body(BodyIndex(index))
            for geometry in plant.GetCollisionGeometriesForBody(body):
                if geometry == self.support or geometry in bases:
                    continue
                others.Add(geometry)
                if body.index() in self.bases:
                    beside.Add(geometry)
        scene_graph.collision_filter_manager().Apply(
            CollisionFilterDeclaration()
            .ExcludeWithin(standing)
            .ExcludeBetween(standing, others)
            .ExcludeBetween(beside, GeometrySet(self.support))
        )


def add_plane(
    plant: MultibodyPlant, frame: SupportFrame, thickness: float, friction: float
) -> Plane:
    """Add the plane of a support's ``frame`` to the world; it gives way as a layer of
    ``thickness`` [m].
    """
    properties = ProximityProperties()
    AddCompliantHydroelasticPropertiesForHalfSpace(
        thickness, HYDROELASTIC_MODULUS, properties
    )
    AddContactMaterial(
        dissipation=DISSIPATION,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    X = HalfSpace.MakePose(np.array(frame.normal), np.array(frame.origin))
    support = plant.RegisterCollisionGeometry(
        plant.world_body(), X, HalfSpace(), "support", properties
    )
    return Plane(support, frame)


def _told(record: logging.LogRecord) -> bool:
    """Whether a line of Drake's log is of use: that deformable bodies do not touch rigid
    half-spaces is not, where there are none.
    """
    return "deformable contact" not in record.getMessage()


logging.getLogger("drake").addFilter(_told)


def base_mesh(shape: Shape, cells: float = CELLS, up: float = 1.0) -> Mesh:
    """Return the base of a ``shape`` in triangles, and its sides and top a little
    higher; its frame is at G's origin in the plane, and at half height. ``up`` is -1
    where its z axis points into the support, as on a wall.
    """
    corners = _outline(shape)
    half = 0.5 * shape.height
    low = SKIN_GAP - half
    faces: list[Face] = [
        tuple((x, y, -half) for x, y in reversed(triangle))
        for triangle in base_triangles(corners, *_cell_counts(shape, cells))
    ]
    faces += [
        ((*a, low), (*b, low), (*b, half), (*a, half))
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    faces += [tuple((x, y, half) for x, y in triangle) for triangle in _cut(corners)]
    if up < 0.0:
        faces = [tuple((x, y, -z) for x, y, z in reversed(face)) for face in faces]
    vertices = [vertex for face in faces for vertex in face]
    ends = list(accumulate(map(len, faces), initial=0))
    numbers = [tuple(range(*each)) for each in pairwise(ends)]
    return Mesh(obj_mesh(vertices, numbers, "base.obj"))


def _outline(shape: Shape) -> tuple[Point, ...]:
    """Return the corners [m] of a base, counter-clockwise: those of a polygon as large
    as the footprint.
    """
    from shapely import Polygon, affinity

    polygon = Polygon(without_details(shape.outline()))
    grown = math.sqrt(shape.placed(Pose2()).area / polygon.area)
    whole = affinity.scale(polygon, grown, grown, origin="centroid")
    return tuple((x, y) for x, y in whole.exterior.coords[:-1])


def _cell_counts(shape: Shape, cells: float) -> tuple[int, int]:
    """Return the numbers of cells along x and y: more of them along a long side, but
    longer ones.
    """
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    nx, ny = (
        min(MOST_CELLS, round(cells * math.sqrt(width / shape.breadth)))
        for width in (x_max - x_min, y_max - y_min)
    )
    return nx, ny


def base_triangles(corners: tuple[Point, ...], nx: int, ny: int) -> list[Triangle]:
    """Return the triangles, counter-clockwise, of a polygon cut by a grid of ``nx`` and
    ``ny`` cells over its bounding rectangle.
    """
    import shapely

    polygon = shapely.Polygon(corners)
    shapely.prepare(polygon)
    x_min, y_min, x_max, y_max = polygon.bounds
    xs = np.linspace(x_min, x_max, nx + 1).tolist()
    ys = np.linspace(y_min, y_max, ny + 1).tolist()
    out: list[Triangle] = []
    for i, j in product(range(nx), range(ny)):
        a, b, c, d = _cell(xs[i : i + 2], ys[j : j + 2])
        cell = shapely.Polygon((a, b, c, d))
        if shapely.covers(polygon, cell):
            # the diagonal alternates, so that the base has no handedness
            out += (
                [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
            )
            continue
        for piece in shapely.get_parts(shapely.intersection(polygon, cell)):
            if piece.area == 0.0:  # a line or a point
                continue
            around = shapely.orient_polygons(piece).exterior.coords[:-1]
            cut = _cut(tuple((x, y) for x, y in around))
            out += [t for t in cut if signed_area(t) > SLIVER * cell.area]
    return out


def _cut(corners: tuple[Point, ...]) -> list[Triangle]:
    """Return triangles, counter-clockwise, that make up a polygon."""
    return [(corners[a], corners[b], corners[c]) for a, b, c in triangles(corners)]


def _cell(x: list[float], y: list[float]) -> tuple[Point, Point, Point, Point]:
    """Return the corners of a cell, counter-clockwise."""
    return (x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])
