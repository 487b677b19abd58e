"""Meshes made in memory, hydroelastic properties, and surface frictions that give the
asked-for friction of each PAIR.
"""

from __future__ import annotations

import math
from collections.abc import Callable

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

# [Pa] stiff enough for sub-0.1 mm indentation at the loads of a 3 kg object
HYDROELASTIC_MODULUS = 1.0e7
DISSIPATION = 5.0  # [s/m] Hunt-Crossley; kills the bounce of the first touch
OBJECT_FRICTION = 1.0  # of the object's own surface; its partners' follow from it


def partner_friction(pair: float, own: float = OBJECT_FRICTION) -> float:
    """Return the surface friction b that gives the pair mu = 2 a b / (a + b) against a
    surface of friction a = ``own``.

    Raises ValueError where no such surface exists (pair >= 2 own).
    """
    if not 0.0 < pair < 2.0 * own:
        raise ValueError(f"pair friction {pair} is not in (0, {2.0 * own})")
    return pair * own / (2.0 * own - pair)


def rigid_properties(
    friction: float, resolution: float | None = None
) -> ProximityProperties:
    """Return the properties of a rigid hydroelastic surface with surface (not pair)
    friction ``friction``.
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


def compliant_properties(friction: float, resolution: float) -> ProximityProperties:
    """Return the properties of a compliant hydroelastic surface with surface (not pair)
    friction ``friction``.
    """
    properties = ProximityProperties()
    AddCompliantHydroelasticProperties(resolution, HYDROELASTIC_MODULUS, properties)
    AddContactMaterial(
        dissipation=DISSIPATION,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    return properties


def _obj_mesh(
    vertices: list[tuple[float, float, float]], faces: list[tuple[int, ...]], name: str
) -> InMemoryMesh:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return InMemoryMesh(mesh_file=MemoryFile("\n".join(lines) + "\n", ".obj", name))


def support_grid(
    bounds: tuple[float, float, float, float],
    tile: float,
    support: model.Support | None = None,
) -> Mesh:
    """Return the support's surface as a triangle mesh in the world, facing out, that
    covers x_min, x_max, y_min, y_max [m] of its frame; an opening's sides and back
    belong to it.

    Friction acts at the centroids of the contact polygons, so that ``tile`` [m], the
    edge of a grid cell, decides how well torsion is resolved: a third of the object's
    width gives about 1 %.
    """
    support = support or model.Support()
    opening = support.opening
    x_min, x_max, y_min, y_max = bounds
    vertices: list[Vector3] = []
    faces: list[tuple[int, ...]] = []

    def patch(
        us: list[float], vs: list[float], at: Callable[[float, float], Vector3]
    ) -> None:
        """Add the tiles between the lines ``us`` and ``vs``; seen from outside, v is to
        the left of u.
        """
        first = len(vertices)
        n = len(us)
        vertices.extend(at(u, v) for v in vs for u in us)
        for j in range(len(vs) - 1):
            for i in range(n - 1):
                a = first + j * n + i
                b = a + 1
                c = a + n + 1
                d = a + n
                # alternate the diagonal, so that the grid has no handedness
                faces.extend(
                    [(a, b, c), (a, c, d)]
                    if (i + j) % 2 == 0
                    else [(a, b, d), (b, c, d)]
                )

    if opening is None:
        nx = max(1, math.ceil((x_max - x_min) / tile))
        ny = max(1, math.ceil((y_max - y_min) / tile))
        xs = [x_min + i * tile for i in range(nx + 1)]
        ys = [y_min + j * tile for j in range(ny + 1)]
        patch(xs, ys, lambda x, y: (x, y, 0.0))
        # its lower edge too: Drake's convex hull of it must not be flat
        if support.kind == "wall":
            patch([x_min, x_max], [-tile, 0.0], lambda x, z: (x, y_min, z))
    else:
        w, h = opening.size
        cx, cy = opening.center
        back = -opening.depth
        left = cx - 0.5 * w
        right = cx + 0.5 * w
        low = cy - 0.5 * h
        high = cy + 0.5 * h
        x_min = min(x_min, left)
        x_max = max(x_max, right)
        y_min = min(y_min, low)
        y_max = max(y_max, high)
        inner_x = _lines(left, right, tile)
        inner_y = _lines(low, high, tile)
        inwards = _lines(back, 0.0, tile)
        around = (
            ((x_min, left), (y_min, y_max)),
            ((right, x_max), (y_min, y_max)),
            ((left, right), (y_min, low)),
            ((left, right), (high, y_max)),
        )
        for (a, b), (c, d) in around:
            if a < b and c < d:
                patch(_lines(a, b, tile), _lines(c, d, tile), lambda x, y: (x, y, 0.0))
        patch(inner_x, inner_y, lambda x, y: (x, y, back))
        patch(inwards, inner_y, lambda z, y: (right, y, z))
        patch(inner_y, inwards, lambda y, z: (left, y, z))
        patch(inwards, inner_x, lambda z, x: (x, low, z))
        patch(inner_x, inwards, lambda x, z: (x, high, z))
    frame = support.frame
    if (
        sum(
            a * b
            for a, b in zip(
                frame.spin_axis, frame.direction((0.0, 0.0, 1.0)), strict=True
            )
        )
        < 0.0
    ):
        # left-handed axes turn a face inside out
        faces = [face[::-1] for face in faces]
    return Mesh(
        _obj_mesh([frame.point(v) for v in vertices], faces, "support_grid.obj")
    )


def _lines(first: float, last: float, tile: float) -> list[float]:
    """Places from ``first`` to ``last``, at most ``tile`` apart."""
    count = max(1, math.ceil((last - first) / tile - 1e-9))
    return [first + (last - first) * i / count for i in range(count + 1)]


def object_shape(shape: model.Shape) -> DrakeShape:
    """Return Drake's shape of an object, its frame at G's origin in the plane and at
    half height.
    """
    if isinstance(shape, model.Box):
        return Box(*shape.size)
    if isinstance(shape, model.Cylinder):
        return Cylinder(shape.radius, shape.height)
    n = len(shape.corners)
    half = 0.5 * shape.height
    vertices = [(x, y, -half) for x, y in shape.corners] + [
        (x, y, half) for x, y in shape.corners
    ]
    faces: list[tuple[int, ...]] = [tuple(reversed(range(n))), tuple(range(n, 2 * n))]
    faces += [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return Convex(_obj_mesh(vertices, faces, "prism.obj"), 1.0)
