"""Shapes, masses and inertias of an MJCF file's geoms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.robots.facts import LinkFacts, LinkShape, ShapeKind
from pushpressslide.robots.file_data import rpy_of
from pushpressslide.robots.file_shapes import Meshes, length, read_mesh
from pushpressslide.robots.file_values import (
    Triple,
    mass,
    moment,
    number,
    product,
    vector,
)
from pushpressslide.robots.mjcf_model import MAIN, Body, Model, Part, Pose, rotation_to

WATER = 1000.0  # [kg/m^3] density by default
SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
KINDS: dict[str, ShapeKind] = {
    "sphere": "sphere",
    "capsule": "capsule",
    "cylinder": "cylinder",
    "box": "box",
    "mesh": "mesh",
}
INFINITE = ("plane", "hfield", "sdf")


@dataclass(frozen=True)
class MeshAsset:
    """A mesh used by geoms."""

    path: Path
    scale: Triple


@dataclass(frozen=True)
class Geom:
    """A geom with a volume, or a mesh."""

    kind: str
    size: tuple[float, ...]  # [m] radius, half length; half sides; none of a mesh
    X: Pose  # in the body's frame
    values: Mapping[str, str]
    place: str
    asset: MeshAsset | None = None

    @property
    def shape(self) -> LinkShape | None:
        """Shape of a link. None for an ellipsoid."""
        size = self.size
        if self.kind == "box":
            size = tuple(2.0 * half for half in size)
        elif self.kind in ("cylinder", "capsule"):
            size = (size[0], 2.0 * size[1])
        elif self.kind == "ellipsoid":
            return None
        R, p = self.X
        touches = [self.values.get(key, "1") for key in ("contype", "conaffinity")]
        solid = touches != ["0", "0"]
        mesh = ""
        if self.asset is not None:
            mesh = str(self.asset.path)
            size = self.asset.scale
        kind = KINDS[self.kind]
        return LinkShape("", kind, size, triple_of(p), rpy_of(R), solid, mesh)

    @property
    def inertial(self) -> tuple[float, Array, Array]:
        """Mass [kg], centre of mass (3,) [m], and inertia (3, 3) [kg m^2] about the
        centre of mass, in the body's frame.
        """
        volume, center, unit = self._solid()
        text = self.values.get("mass")
        if text is not None:
            own = mass(text, f"{self.place}, mass")
        else:
            text = self.values.get("density", repr(WATER))
            own = volume * number(text, f"{self.place}, density", "0 or more")
        R, p = self.X
        return own, p + R @ center, own * R @ unit @ R.T

    def _solid(self) -> tuple[float, Array, Array]:
        """Volume [m^3], centre (3,) [m], and inertia (3, 3) [m^2] per unit mass."""
        if self.asset is not None:
            return _mesh_solid(self.asset)
        squares = np.square(self.size)
        if self.kind == "sphere":
            volume = 4.0 / 3.0 * np.pi * self.size[0] ** 3
            diagonal = np.full(3, 0.4 * squares[0])
        elif self.kind in ("box", "ellipsoid"):
            share = 3.0 if self.kind == "box" else 5.0
            factor = 8.0 if self.kind == "box" else 4.0 / 3.0 * np.pi
            volume = factor * math.prod(self.size)
            diagonal = (squares.sum() - squares) / share
        else:
            radius, half = self.size
            volume, diagonal = _round_solid(radius, half, self.kind == "capsule")
        return volume, np.zeros(3), np.diag(diagonal)


def _round_solid(r: float, half: float, capped: bool) -> tuple[float, Array]:
    """Volume [m^3], and principal inertias [m^2] per unit mass, of a cylinder. It has
    hemispherical ends if ``capped``.
    """
    body = 2.0 * np.pi * r * r * half
    caps = 4.0 / 3.0 * np.pi * r**3 if capped else 0.0
    across = body * (r * r / 4.0 + half * half / 3.0)
    across += caps * (0.4 * r * r + half * half + 0.75 * half * r)
    along = body * r * r / 2.0 + caps * 0.4 * r * r
    total = body + caps
    return total, np.array([across, across, along]) / total


def _mesh_solid(asset: MeshAsset) -> tuple[float, Array, Array]:
    """Volume [m^3], centre [m], and inertia [m^2] per unit mass, of a mesh, or of its
    hull if the mesh is open.
    """
    mesh = read_mesh(str(asset.path))
    if mesh is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    mesh = mesh.copy()
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    mesh.apply_scale(asset.scale)
    if not mesh.is_volume:
        mesh = mesh.convex_hull
    volume = float(mesh.volume)
    return volume, np.array(mesh.center_mass), np.array(mesh.moment_inertia) / volume


def mesh_assets(model: Model, meshes: Meshes) -> dict[str, MeshAsset]:
    """Meshes that can be read, by name."""
    folder = model.compiler.get("meshdir") or model.compiler.get("assetdir", "")
    out = {}
    for element in model.root.findall("asset/mesh"):
        values = model.values(element, MAIN)
        file = values.get("file", "")
        name = values.get("name") or Path(file).stem
        path = meshes.path(str(Path(folder) / file))
        if path is not None:
            place = f"mesh {name!r}, scale"
            scale = vector(values.get("scale"), 3, place, (1.0, 1.0, 1.0))
            out[name] = MeshAsset(path, triple_of(scale))
    return out


def geom_of(
    part: Part, model: Model, assets: Mapping[str, MeshAsset], meshes: Meshes
) -> Geom | None:
    """The geom of an element. None if it has no volume or is not supported."""
    values = part.values
    kind = values.get("type", "sphere")
    if kind in INFINITE:
        return None
    if "mesh" in values:
        asset = assets.get(values["mesh"])
        if kind != "mesh":
            meshes.left_out.append(("fitted to a mesh", part.place))
            return None
        if asset is None:
            return None  # its file is left out
        return Geom(kind, (), part.X, values, part.place, asset)
    if kind not in SIZES:
        meshes.left_out.append(("of an unknown kind", kind))
        return None
    words = values.get("size", "").split()
    X = part.X
    count = SIZES[kind]
    ends = values.get("fromto")
    sizes = [length(word, f"{part.place}, size") for word in words[:count]]
    if ends is not None:
        a, b = np.split(np.array(vector(ends, 6, f"{part.place}, fromto")), 2)
        X = (rotation_to(b - a), 0.5 * (a + b))
        half = 0.5 * float(np.linalg.norm(b - a))
        sizes = [*sizes[:1], *([sizes[0]] if count == 3 else []), half]
    if len(sizes) < count:
        # raises an error that names the fault
        vector(values.get("size"), count, f"{part.place}, size")
    return Geom(kind, tuple(sizes), X, values, part.place)


def link_of(body: Body, model: Model, geoms: Sequence[Geom]) -> LinkFacts:
    """The body as a link. Mass and inertia are as given, or computed from the geoms."""
    given = body.parts_of_kind("inertial")
    source = model.compiler.get("inertiafromgeom", "auto")
    if given and source != "true":
        return _given(body.name, given[0])
    if source == "false":
        return LinkFacts(body.name)
    groups = model.compiler.get("inertiagrouprange", "0 5")
    low, high = vector(groups, 2, "compiler, inertiagrouprange")
    solids = [
        geom.inertial
        for geom in geoms
        if low <= float(geom.values.get("group", "0")) <= high
    ]
    total = sum(own for own, _, _ in solids)
    if total == 0.0:
        return LinkFacts(body.name)
    center = np.sum([own * c for own, c, _ in solids], axis=0) / total
    matrix = np.zeros((3, 3))
    for own, c, inertia in solids:
        d = c - center
        matrix += inertia + own * (d @ d * np.eye(3) - np.outer(d, d))
    return LinkFacts(body.name, total, triple_of(center), inertia=_six(matrix))


def _given(name: str, part: Part) -> LinkFacts:
    """A link with the values of an ``inertial`` element."""
    values = part.values
    place = f"body {name!r}"
    R, p = part.X
    own = mass(values.get("mass", ""), f"{place}, mass")
    if "fullinertia" in values:
        words = values["fullinertia"].split()
        six = [moment(word, f"{place}, fullinertia") for word in words[:3]]
        six += [product(word, f"{place}, fullinertia") for word in words[3:]]
        xx, yy, zz, xy, xz, yz = six
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        text = values.get("diaginertia", "0 0 0")
        matrix = np.diag([moment(v, f"{place}, diaginertia") for v in text.split()])
    return LinkFacts(name, own, triple_of(p), inertia=_six(R @ matrix @ R.T))


def _six(matrix: Array) -> tuple[float, ...]:
    """Moments and products of an inertia matrix (3, 3)."""
    out = matrix[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    return tuple(map(float, out))


def triple_of(values: Array | Sequence[float]) -> Triple:
    """Three numbers as a tuple."""
    x, y, z = values
    return (float(x), float(y), float(z))
