"""Meshes in memory, and hydroelastic properties."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise, product

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    Convex,
    Cylinder,
    InMemoryMesh,
    Mesh,
    ProximityProperties,
)
from pydrake.geometry import Shape as DrakeShape
from pydrake.multibody.plant import CoulombFriction

from pushpressslide.core import task as model
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point
from pushpressslide.core.support_frame import TABLE
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.pieces import convex_pieces, triangles
from pushpressslide.geometry.polygon import signed_area
from pushpressslide.sim.layered_mesh import layered_mesh
from pushpressslide.sim.mesh_shapes import convex_parts, drawn_mesh, touched_parts

# [Pa] the indentation stays below 0.1 mm at the loads of a 3 kg object
HYDROELASTIC_MODULUS = 1.0e7
# largest indentation of a tip, as a share of its radius: its rod stays outside
DEEPEST = 1.0 / 3.0
DISSIPATION = 5.0  # [s/m] Hunt-Crossley; damps the bounce of the first touch
SLIVER = 1e-6  # smallest piece of a tile that is kept, as a share of the tile
DETAIL = 1e-4  # [m] detail of a concave outline that is too small to matter for contact
Tile = tuple[int, ...]
Bounds = tuple[float, float, float, float]


def rigid_properties(
    friction: float, resolution: float | None = None
) -> ProximityProperties:
    """Properties of a rigid hydroelastic surface with surface (not pair) friction
    ``friction``.
    """
    properties = ProximityProperties()
    if resolution is None:
        AddRigidHydroelasticProperties(properties)
    else:
        AddRigidHydroelasticProperties(resolution, properties)
    AddContactMaterial(
        dissipation=DISSIPATION,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    return properties


def compliant_properties(
    friction: float, resolution: float, modulus: float = HYDROELASTIC_MODULUS
) -> ProximityProperties:
    """Properties of a compliant hydroelastic surface with surface (not pair) friction
    ``friction`` and a ``modulus`` [Pa].
    """
    properties = ProximityProperties()
    AddCompliantHydroelasticProperties(resolution, modulus, properties)
    AddContactMaterial(
        dissipation=DISSIPATION,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    return properties


def _normal(a: Vector3, b: Vector3, c: Vector3) -> Vector3:
    """Unit normal of a triangle."""
    normal = np.cross(np.subtract(b, a), np.subtract(c, a))
    x, y, z = (normal / np.linalg.norm(normal)).tolist()
    return (x, y, z)


def obj_mesh(
    vertices: Sequence[Vector3],
    faces: Sequence[Tile],
    name: str,
    *,
    visual: bool = False,
) -> InMemoryMesh:
    """A surface mesh of ``faces``, each given by indices of ``vertices`` [m],
    counter-clockwise as seen from outside. A ``visual`` mesh has normals.
    """
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    for k, face in enumerate(faces):
        normal = ""
        if visual:  # what draws pictures asks for normals
            x, y, z = _normal(*(vertices[i] for i in face[:3]))
            lines.append(f"vn {x:.6g} {y:.6g} {z:.6g}")
            normal = f"//{k + 1}"
        lines.append("f " + " ".join(f"{i + 1}{normal}" for i in face))
    return InMemoryMesh(mesh_file=MemoryFile("\n".join(lines) + "\n", ".obj", name))


def support_grid(
    bounds: Bounds, tile: float, support: model.Support | None = None
) -> Mesh:
    """The support's surface as a triangle mesh in the world, facing outwards.

    It covers ``bounds``, which are x_min, x_max, y_min, y_max [m] in the support's
    frame, up to the edge of a region. It also covers the sides and the back of an
    opening. Friction acts at the centroids of the contact polygons, so the edge
    ``tile`` [m] of a grid cell determines the error of the friction moment: about 1 %
    for a third of the object's width.
    """
    support = support or model.Support()
    frame = support.frame
    surface = _TiledSurface()
    if support.opening is not None:
        _tile_opening(surface, bounds, tile, support.opening)
    elif support.region is not None:
        _tile_region(surface, bounds, tile, support.region)
    else:
        xs, ys = _plane_lines(bounds, tile)
        surface.add(xs, ys, lambda x, y: (x, y, 0.0))
        if frame != TABLE:
            # Drake's convex hull of a plane that is not level must not be flat
            x_min, x_max, y_min, _ = bounds
            surface.add([x_min, x_max], [-tile, 0.0], lambda x, z: (x, y_min, z))
    faces = surface.faces
    if frame.handedness < 0.0:
        # left-handed axes turn a face inside out
        faces = [face[::-1] for face in faces]
    vertices = [frame.point(v) for v in surface.vertices]
    return Mesh(obj_mesh(vertices, faces, "support_grid.obj"))


class _TiledSurface:
    """Vertices and triangles of a surface, added patch by patch."""

    def __init__(self) -> None:
        self.vertices: list[Vector3] = []
        self.faces: list[Tile] = []

    def add(
        self,
        us: Sequence[float],
        vs: Sequence[float],
        place: Callable[[float, float], Vector3],
        parity: int = 0,
    ) -> None:
        """Add the tiles between the lines ``us`` and ``vs``.

        Seen from outside, v is to the left of u. ``parity`` sets the direction of the
        first tile's diagonal.
        """
        first = len(self.vertices)
        n = len(us)
        self.vertices.extend(place(u, v) for v in vs for u in us)
        for j in range(len(vs) - 1):
            for i in range(n - 1):
                a = first + j * n + i
                b = a + 1
                c = a + n + 1
                d = a + n
                # the diagonal alternates, so that the grid has no handedness
                if (i + j + parity) % 2 == 0:
                    self.faces += [(a, b, c), (a, c, d)]
                else:
                    self.faces += [(a, b, d), (b, c, d)]

    def add_flat(self, corners: tuple[Point, ...], tile: float) -> None:
        """Add a polygon in the plane at height zero, which is a part of a ``tile`` [m]."""
        first = len(self.vertices)
        self.vertices.extend((x, y, 0.0) for x, y in corners)
        for face in triangles(corners):
            area = signed_area(tuple(corners[i] for i in face))
            if area > SLIVER * tile * tile:
                self.faces.append(tuple(first + i for i in face))


def _tile_region(
    surface: _TiledSurface,
    bounds: Bounds,
    tile: float,
    region: tuple[Point, ...],
) -> None:
    """Add the tiles of a plane that lie in a region, clipped at the region's edge."""
    import shapely

    polygon = shapely.Polygon(region)
    shapely.prepare(polygon)
    xs, ys = _plane_lines(bounds, tile)
    for (i, (x, x_next)), (j, (y, y_next)) in product(
        enumerate(pairwise(xs)), enumerate(pairwise(ys))
    ):
        cell = shapely.box(x, y, x_next, y_next)
        if shapely.covers(polygon, cell):
            surface.add([x, x_next], [y, y_next], lambda x, y: (x, y, 0.0), i + j)
            continue
        for piece in shapely.get_parts(shapely.intersection(polygon, cell)):
            if piece.area > SLIVER * tile * tile:
                surface.add_flat(tuple(piece.exterior.coords[:-1]), tile)


def _plane_lines(bounds: Bounds, tile: float) -> tuple[list[float], list[float]]:
    """Grid lines of a plane along x and along y, a whole number of tiles apart."""
    x_min, x_max, y_min, y_max = bounds
    nx = max(1, math.ceil((x_max - x_min) / tile))
    ny = max(1, math.ceil((y_max - y_min) / tile))
    xs = [x_min + i * tile for i in range(nx + 1)]
    ys = [y_min + j * tile for j in range(ny + 1)]
    return xs, ys


def _tile_opening(
    surface: _TiledSurface, bounds: Bounds, tile: float, opening: model.Opening
) -> None:
    """Add the plane around an opening, then its back and its four sides."""
    x_min, x_max, y_min, y_max = bounds
    left, right, low, high = opening.edges
    back = -opening.depth
    x_min = min(x_min, left)
    x_max = max(x_max, right)
    y_min = min(y_min, low)
    y_max = max(y_max, high)
    around = (
        ((x_min, left), (y_min, y_max)),
        ((right, x_max), (y_min, y_max)),
        ((left, right), (y_min, low)),
        ((left, right), (high, y_max)),
    )
    for (a, b), (c, d) in around:
        if a < b and c < d:
            xs = _lines(a, b, tile)
            ys = _lines(c, d, tile)
            surface.add(xs, ys, lambda x, y: (x, y, 0.0))
    xs = _lines(left, right, tile)
    ys = _lines(low, high, tile)
    zs = _lines(back, 0.0, tile)
    surface.add(xs, ys, lambda x, y: (x, y, back))
    surface.add(zs, ys, lambda z, y: (right, y, z))
    surface.add(ys, zs, lambda y, z: (left, y, z))
    surface.add(zs, xs, lambda z, x: (x, low, z))
    surface.add(xs, zs, lambda x, z: (x, high, z))


def _lines(first: float, last: float, tile: float) -> list[float]:
    """Positions [m] from ``first`` to ``last``, at most ``tile`` apart."""
    count = max(1, math.ceil((last - first) / tile - 1e-9))
    return [first + (last - first) * i / count for i in range(count + 1)]


def drawn_shape(shape: model.Shape) -> DrakeShape:
    """Drake's visual shape of an object.

    Its frame has the origin of G in the plane, at half height.
    """
    if isinstance(shape, model.Box):
        return Box(*shape.size)
    if isinstance(shape, model.Cylinder):
        return Cylinder(shape.radius, shape.height)
    if isinstance(shape, MeshBody):
        return drawn_mesh(shape)
    if shape.convex:
        return _convex_prism(shape.corners, shape.height)
    caps = triangles(shape.corners)
    return Mesh(_prism_mesh(shape.corners, shape.height, caps, visual=True))


def convex_shapes(shape: model.Shape) -> list[DrakeShape]:
    """Drake shapes whose union is an object, in the frame of ``drawn_shape``."""
    if isinstance(shape, MeshBody):
        return list(convex_parts(shape))
    if shape.convex:
        return [drawn_shape(shape)]
    return [
        _convex_prism(piece, shape.height) for piece in convex_pieces(shape.corners)
    ]


def softness(shape: model.Shape) -> float:
    """Thickness [m] of an object's compliant layer."""
    return 0.5 * min(shape.height, shape.breadth)


def tip_modulus(shape: model.Shape, radius: float, force: float) -> float:
    """Modulus [Pa] of an object touched by tips of ``radius`` [m] with up to ``force``
    [N].

    A force pi E radius d^2 / H presses a sphere by d into a layer of modulus E and
    thickness H. The usual modulus is therefore too soft for small tips.
    """
    depth = DEEPEST * radius
    needed = force * softness(shape) / (math.pi * radius * depth * depth)
    return max(HYDROELASTIC_MODULUS, needed)


def touched_shapes(
    shape: model.Shape,
    friction: float,
    resolution: float,
    modulus: float = HYDROELASTIC_MODULUS,
) -> list[tuple[DrakeShape, ProximityProperties]]:
    """Drake's contact shapes of an object, and their properties from
    ``compliant_properties``, in the frame of ``drawn_shape``.

    A concave object has a volume mesh, and a body from a mesh has several parts. The
    modulus of each is such that it yields as much as a convex object of the same
    thickness.
    """
    if isinstance(shape, MeshBody):
        own = softness(shape)
        return [
            (
                part.shape,
                compliant_properties(
                    friction, resolution, part.thickness / own * modulus
                ),
            )
            for part in touched_parts(shape)
        ]
    if shape.convex:
        properties = compliant_properties(friction, resolution, modulus)
        return [(drawn_shape(shape), properties)]
    outline = without_details(shape.corners)
    layered = layered_mesh(outline, shape.height)
    share = layered.depth / softness(shape)
    properties = compliant_properties(friction, resolution, share * modulus)
    return [(layered.mesh.drake(), properties)]


def without_details(corners: tuple[Point, ...]) -> tuple[Point, ...]:
    """The outline without corners that protrude by less than ``DETAIL``."""
    from shapely import Polygon

    simple = Polygon(corners).simplify(DETAIL)
    assert isinstance(simple, Polygon)
    return tuple((x, y) for x, y in simple.exterior.coords[:-1])


def _convex_prism(corners: tuple[Point, ...], height: float) -> Convex:
    """A prism on a convex polygon."""
    cap = tuple(range(len(corners)))
    return Convex(_prism_mesh(corners, height, [cap]), 1.0)


def _prism_mesh(
    corners: tuple[Point, ...],
    height: float,
    caps: Sequence[Tile],
    *,
    visual: bool = False,
) -> InMemoryMesh:
    """Surface mesh of a prism. ``caps`` are the polygons of its top, each given by
    indices of ``corners``.
    """
    n = len(corners)
    half = 0.5 * height
    vertices = [(x, y, -half) for x, y in corners] + [(x, y, half) for x, y in corners]
    faces: list[Tile] = [tuple(reversed(cap)) for cap in caps]
    faces += [tuple(n + i for i in cap) for cap in caps]
    faces += [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return obj_mesh(vertices, faces, "prism.obj", visual=visual)
