"""Meshes made in memory, hydroelastic properties, and surface frictions that give the asked-for friction of
each PAIR.
"""

from __future__ import annotations

import math

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

HYDROELASTIC_MODULUS = 1.0e7  # [Pa] stiff enough for sub-0.1 mm indentation at the loads of a 3 kg object
DISSIPATION = 5.0  # [s/m] Hunt-Crossley; kills the bounce of the first touch
OBJECT_FRICTION = 1.0  # of the object's own surface; its partners' follow from it


def partner_friction(pair: float, own: float = OBJECT_FRICTION) -> float:
    """Return the surface friction b that gives the pair mu = 2 a b / (a + b) against a surface of friction a
    = ``own``.

    Raises ValueError where no such surface exists (pair >= 2 own).
    """
    if not 0.0 < pair < 2.0 * own:
        raise ValueError(f"pair friction {pair} is not in (0, {2.0 * own})")
    return pair * own / (2.0 * own - pair)


def rigid_properties(friction: float, resolution: float | None = None) -> ProximityProperties:
    """Return the properties of a rigid hydroelastic surface with surface (not pair) friction ``friction``."""
    properties = ProximityProperties()
    if resolution is None:
        AddRigidHydroelasticProperties(properties)
    else:
        AddRigidHydroelasticProperties(resolution, properties)
    AddContactMaterial(
        dissipation=DISSIPATION, friction=CoulombFriction(friction, friction), properties=properties
    )
    return properties


def compliant_properties(friction: float, resolution: float) -> ProximityProperties:
    """Return the properties of a compliant hydroelastic surface with surface (not pair) friction
    ``friction``.
    """
    properties = ProximityProperties()
    AddCompliantHydroelasticProperties(resolution, HYDROELASTIC_MODULUS, properties)
    AddContactMaterial(
        dissipation=DISSIPATION, friction=CoulombFriction(friction, friction), properties=properties
    )
    return properties


def _obj_mesh(
    vertices: list[tuple[float, float, float]], faces: list[tuple[int, ...]], name: str
) -> InMemoryMesh:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return InMemoryMesh(mesh_file=MemoryFile("\n".join(lines) + "\n", ".obj", name))


def support_grid(bounds: tuple[float, float, float, float], tile: float) -> Mesh:
    """Return a flat triangle mesh in the plane z = 0, normal up, that covers x_min, x_max, y_min, y_max [m].

    Friction acts at the centroids of the contact polygons, so that ``tile`` [m], the edge of a grid cell,
    decides how well torsion is resolved: a third of the object's width gives about 1 %.
    """
    x_min, x_max, y_min, y_max = bounds
    nx, ny = max(1, math.ceil((x_max - x_min) / tile)), max(1, math.ceil((y_max - y_min) / tile))
    vertices = [(x_min + i * tile, y_min + j * tile, 0.0) for j in range(ny + 1) for i in range(nx + 1)]
    faces: list[tuple[int, ...]] = []
    for j in range(ny):
        for i in range(nx):
            a = j * (nx + 1) + i
            b, c, d = a + 1, a + nx + 2, a + nx + 1
            # alternate the diagonal, so that the grid has no handedness
            faces += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return Mesh(_obj_mesh(vertices, faces, "support_grid.obj"))


def object_shape(shape: model.Shape) -> DrakeShape:
    """Return Drake's shape of an object, its frame at G's origin in the plane and at half height."""
    if isinstance(shape, model.Box):
        return Box(*shape.size)
    if isinstance(shape, model.Cylinder):
        return Cylinder(shape.radius, shape.height)
    n, half = len(shape.polygon), 0.5 * shape.height
    vertices = [(x, y, -half) for x, y in shape.polygon] + [(x, y, half) for x, y in shape.polygon]
    faces: list[tuple[int, ...]] = [tuple(reversed(range(n))), tuple(range(n, 2 * n))]
    faces += [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return Convex(_obj_mesh(vertices, faces, "prism.obj"), 1.0)
