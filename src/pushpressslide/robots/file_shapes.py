"""Shapes of the links in a robot's file, whatever its format."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from pushpressslide.robots.facts import LinkShape, ShapeKind
from pushpressslide.robots.file_values import Triple, number, triple
from pushpressslide.robots.mesh_paths import MeshPaths, readable

MOST_NAMES = 3


@dataclass(frozen=True)
class Meshes:
    """Meshes of one file, and the shapes that were omitted."""

    paths: MeshPaths
    left_out: list[tuple[str, str]] = field(default_factory=list)  # reason, name

    def path(self, uri: str) -> Path | None:
        """Path of a mesh file. None, with a note, if the file is not found or cannot be
        read.
        """
        path = self.paths.find(uri)
        if path is not None and readable(path):
            return path
        reason = "not found" if path is None else "which pycollada reads"
        self.left_out.append((reason, uri))
        return None

    def notes(self) -> list[str]:
        """One note per reason for which shapes were omitted."""
        by_reason: dict[str, list[str]] = {}
        for reason, name in self.left_out:
            by_reason.setdefault(reason, []).append(name)
        return [
            f"left out: {len(names)} shapes, {reason}: {', '.join(names[:MOST_NAMES])}"
            + (", ..." if len(names) > MOST_NAMES else "")
            for reason, names in by_reason.items()
        ]


@dataclass(frozen=True)
class ShapeFormat:
    """Functions that find a shape's properties in the elements of URDF or SDF."""

    text: Callable[[Element, str], str | None]  # of a geometry, by its key
    mesh: str  # key of a mesh's path
    pose: Callable[[Element, str], tuple[Triple, Triple]]  # xyz [m], rpy [rad]
    color: Callable[[Element], Triple | None]

    def shapes(self, link: Element, meshes: Meshes) -> Iterator[LinkShape]:
        """Shapes of a link. Shapes that cannot be read are omitted."""
        name = link.attrib["name"]
        for holder in (*link.findall("collision"), *link.findall("visual")):
            geometry = holder.find("geometry")
            if geometry is None or not len(geometry):
                continue
            place = f"link {name!r}, {holder.tag}"
            shape = self._shape(geometry[0], place)
            path = None
            if shape is None:
                meshes.left_out.append(("of an unknown kind", geometry[0].tag))
                continue
            if shape[0] == "mesh":
                uri = self.text(geometry[0], self.mesh) or ""
                path = meshes.path(uri.strip())
                if path is None:
                    continue
            xyz, rpy = self.pose(holder, place)
            solid = holder.tag == "collision"
            mesh = "" if path is None else str(path)
            yield LinkShape(name, *shape, xyz, rpy, solid, mesh, self.color(holder))

    def _shape(
        self, geometry: Element, place: str
    ) -> tuple[ShapeKind, tuple[float, ...]] | None:
        """Kind and size of a geometry. None for an unknown kind."""
        kind = geometry.tag.split("}")[-1].removeprefix("drake_")

        def size(key: str) -> float:
            text = self.text(geometry, key) or ""
            return length(text, f"{place}, {key}")

        if kind == "box":
            text = self.text(geometry, "size") or ""
            return "box", triple(text, f"{place}, size")
        if kind == "sphere":
            return "sphere", (size("radius"),)
        if kind == "cylinder":
            return "cylinder", (size("radius"), size("length"))
        if kind == "capsule":
            return "capsule", (size("radius"), size("length"))
        if kind == "mesh":
            scale = self.text(geometry, "scale")
            return "mesh", triple(scale, f"{place}, scale", (1.0, 1.0, 1.0))
        return None


def length(text: str, place: str) -> float:
    """Length [m] of a shape. Raises UnfitValue for an impossible length."""
    allowed = "a number [m] above 0"
    return number(text, place, allowed, lambda value: 0.0 < value < 1e3)


@lru_cache(maxsize=128)
def read_mesh(path: str) -> Any | None:
    """Triangles in a mesh file. None if it cannot be read."""
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=False)
    except Exception:
        return None
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        return None
    return mesh
