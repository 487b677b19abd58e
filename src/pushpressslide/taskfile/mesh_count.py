"""Number of triangles in a mesh file, determined before the mesh is loaded."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

MOST_TRIANGLES = 200_000
"""Largest number of triangles in a mesh."""
MOST_BYTES = 64_000_000
"""Largest size [bytes] of a file with its buffers: that of ``MOST_TRIANGLES`` triangles
as text, with a margin.
"""
STL_HEAD = 84
STL_TRIANGLE = 50
"""Bytes per triangle in a binary STL file. The header ends with the number of
triangles.
"""
PLY_HEAD = 65_536
"""Bytes within which the header of a PLY file ends."""
GLB_HEAD = 20
"""Bytes before the JSON text of a GLB file. The last eight are its length and type."""
GLTF_TRIANGLES = 4
"""Mode of a glTF primitive in which every three corners form a triangle. It is the
default.
"""


def check_count(file: Path) -> None:
    """Raise ValueError for a file with too many triangles or bytes, before the mesh is
    loaded.
    """
    check_triangles(_COUNTS[file.suffix.lower()](file))
    _check_bytes(file.stat().st_size)


def check_triangles(count: int) -> None:
    """Raise ValueError for too many triangles."""
    if count > MOST_TRIANGLES:
        raise ValueError(f"it has {count} triangles, allowed up to {MOST_TRIANGLES}")


def _check_bytes(size: int) -> None:
    if size > MOST_BYTES:
        found = f"it is of {size / 1e6:.0f} MB"
        raise ValueError(f"{found}, allowed up to {MOST_BYTES / 1e6:g} MB")


def _head(file: Path, size: int) -> bytes:
    with file.open("rb") as content:
        return content.read(size)


def _text(file: Path) -> bytes:
    """Content of a file. Raises ValueError if the file is too long."""
    _check_bytes(file.stat().st_size)
    return file.read_bytes()


def _obj(file: Path) -> int:
    """Number of faces. Each is at least one triangle."""
    return _text(file).count(b"\nf ")


def _stl(file: Path) -> int:
    """Number of triangles: from the header of a binary file, otherwise from the facets
    in the text.
    """
    head = _head(file, STL_HEAD)
    count = int.from_bytes(head[-4:], "little")
    if file.stat().st_size == STL_HEAD + STL_TRIANGLE * count:
        return count
    return _text(file).count(b"endfacet")


def _ply(file: Path) -> int:
    """Number of faces according to the header. Each is at least one triangle."""
    head = _head(file, PLY_HEAD).partition(b"end_header")[0]
    found = re.search(rb"element\s+face\s+(\d{1,18})\b", head)
    return int(found[1]) if found else 0


def _glb(file: Path) -> int:
    """Number of triangles that the JSON text at the start of a GLB file declares."""
    length = int.from_bytes(_head(file, GLB_HEAD)[-8:-4], "little")
    _check_bytes(length)
    return _declared(_head(file, GLB_HEAD + length)[GLB_HEAD:])


def _gltf(file: Path) -> int:
    return _declared(_text(file))


def _declared(text: bytes) -> int:
    """Number of triangles that a glTF text declares.

    Raises ValueError for a damaged text, and for buffers that are too long.
    """
    try:
        tree = json.loads(text)
        size = sum(int(buffer["byteLength"]) for buffer in tree.get("buffers", ()))
        triangles: list[int] = [
            sum(_of_primitive(part, tree) for part in mesh["primitives"])
            for mesh in tree.get("meshes", ())
        ]
        nodes = [node for node in tree.get("nodes", ()) if "mesh" in node]
        count: int = sum(triangles[node["mesh"]] for node in nodes)
    except Exception as error:  # whatever a broken text makes its reader raise
        raise ValueError("it cannot be read: its glTF text is damaged") from error
    _check_bytes(size)
    return count


def _of_primitive(part: Mapping[str, Any], tree: Mapping[str, Any]) -> int:
    """Number of triangles in one primitive of a glTF mesh, or an upper bound in modes
    with shared corners.
    """
    corners = part.get("indices", part["attributes"]["POSITION"])
    count = int(tree["accessors"][corners]["count"])
    in_threes = part.get("mode", GLTF_TRIANGLES) == GLTF_TRIANGLES
    return count // 3 if in_threes else count


_COUNTS: Mapping[str, Callable[[Path], int]] = {
    ".obj": _obj,
    ".stl": _stl,
    ".ply": _ply,
    ".glb": _glb,
    ".gltf": _gltf,
}
SUFFIXES = tuple(_COUNTS)
