"""Shapes in the task file. A new kind of shape is added only in this file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import Shown, path_value
from pushpressslide.core.field_spec import REQUIRED
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import (
    Box,
    Compound,
    Cylinder,
    MeshSolid,
    Part,
    Prism,
    Shape,
)
from pushpressslide.geometry.polygon import (
    border_fault,
    counter_clockwise,
    without_straight_corners,
)
from pushpressslide.taskfile.kinds import (
    TEXT,
    Field,
    Kind,
    array,
    choice,
    nullable,
    number,
    plain_value,
    point,
    section,
    shorthand,
)
from pushpressslide.taskfile.mesh_file import read_mesh
from pushpressslide.taskfile.mesh_surface import TURNS
from pushpressslide.taskfile.place import Fault

SAME_HEIGHT = 1e-6
"""Largest difference [m] between the heights of a compound's parts, for round-off."""

_LENGTH = number("m", "(0, 10]")
_HEIGHT = Field(_LENGTH, "height")
_RADIUS = Field(number("m", "(0, 5]"), "radius")
_POLYGON = Field(
    array(point("m", "[-5, 5]"), 3, 64),
    "corners of the base in G: in order, either sense, concave too; one on a straight "
    "line is left out",
)


def _prism(polygon: tuple[Point, ...], height: float) -> Prism:
    """Prism with counter-clockwise corners. The first corner stays first."""
    return Prism(counter_clockwise(without_straight_corners(polygon)), height)


_BOX = replace(
    array(_LENGTH, 3, 3),
    decode=Box,
    encode=lambda box: plain_value(getattr(box, "size", box)),
)
_PRISM = section({"polygon": _POLYGON, "height": _HEIGHT}, _prism, data=Prism)
_CYLINDER = section({"radius": _RADIUS, "height": _HEIGHT}, Cylinder)

Row = tuple[str, type[Shape], Kind, str]

_PARTS: tuple[Row, ...] = (
    ("box", Box, _BOX, "full lengths along x, y and z; G at the centre"),
    ("prism", Prism, _PRISM, "upright prism; G is the polygon's own origin"),
    ("cylinder", Cylinder, _CYLINDER, "upright cylinder; G at the centre"),
)
"""Name, data type, kind of field and meaning of each shape that is not composed of
other shapes.
"""

_OFFSET = number("m", "[-5, 5]")
_POSE = section(
    {
        "x": Field(_OFFSET, "along x of G", 0.0),
        "y": Field(_OFFSET, "along y of G", 0.0),
        "yaw_deg": Field(number("deg", "[-360, 360]"), "from x towards y", 0.0),
    },
    Pose2,
)


def _fields(rows: Sequence[Row]) -> dict[str, Field]:
    return {name: Field(nullable(kind), meaning) for name, _, kind, meaning in rows}


def _named(rows: Sequence[Row], shape: Any) -> dict[str, Any]:
    if isinstance(shape, Mapping):
        return dict(shape)
    sizes = plain_value(shape)
    if isinstance(sizes, list) and len(sizes) == 3:
        return {"box": sizes}
    return {name: shape for name, data, *_ in rows if isinstance(shape, data)}


def one_shape(**shapes: Shape | None) -> Shape:
    """The only shape among the fields of a section."""
    (shape,) = (shape for shape in shapes.values() if shape is not None)
    return shape


def _part(pose: Pose2, **shapes: Any) -> Part:
    shape: Any = one_shape(**shapes)
    return Part(shape, pose)


_PART = section(
    {**_fields(_PARTS), "pose": Field(_POSE, "pose of the part's own frame in G")},
    _part,
    lambda part: {**_named(_PARTS, part.shape), "pose": part.pose},
    Part,
)
_ALL = array(_PART, 1, 32)
_COMPOUND = replace(
    _ALL,
    decode=lambda plain: Compound(_ALL.decode(plain)),
    encode=lambda compound: _ALL.encode(getattr(compound, "parts", compound)),
)
_MESH = shorthand(
    section(
        {
            "path": Field(
                TEXT,
                "an OBJ, STL, PLY or glTF file, or a URDF, SDF or MJCF file of an object, "
                "relative to the task file",
            ),
            "scale": Field(
                number("m", "(0, 1000]"), "one unit of the file: 0.001 for mm", 1.0
            ),
            "up": Field(choice(*TURNS), "axis of the file that points up", "z"),
        },
        read_mesh,
        lambda solid: {"path": solid.path, "scale": solid.scale, "up": solid.up},
        MeshSolid,
    ),
    "path",
)

_ROWS: tuple[Row, ...] = (
    *_PARTS,
    (
        "compound",
        Compound,
        _COMPOUND,
        "union of upright parts of one height that touch; G is that of their poses",
    ),
    (
        "mesh",
        MeshSolid,
        _MESH,
        "body in a file that stands on its base; G is the file's frame with `up` as z",
    ),
)

NAMES = tuple(row[0] for row in _ROWS)
"""Names of the kinds of shapes in the file."""


def named_shape(shape: Any) -> dict[str, Any]:
    """Shape as a mapping from the name of its kind. Three numbers are the lengths of a
    box.
    """
    return _named(_ROWS, shape)


_ANY = section(_fields(_ROWS), one_shape, named_shape, (Shape, list, tuple))
_GIVEN = {"not": {"type": "null"}}
_ONE = [{"properties": {name: _GIVEN}, "required": [name]} for name in NAMES]


def with_one_shape(holder: Kind) -> Kind:
    """Kind of a section whose JSON Schema requires exactly one shape."""
    return replace(holder, absent=REQUIRED, json={**holder.json, "oneOf": _ONE})


SHAPE = with_one_shape(_ANY)


def located(plain: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Fields that contain a shape, with the full path of its mesh."""
    mesh = plain["mesh"]
    if mesh is None:
        return dict(plain)
    path = str((folder / mesh["path"]).resolve())
    return {**plain, "mesh": {**mesh, "path": path}}


def shape_faults(field: str, plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield faults of fields that contain a shape.

    The faults are: several kinds of shape, a polygon that crosses itself, parts that
    are not connected, and a mesh without a body that can stand.
    """
    given = [name for name in NAMES if plain[name] is not None]
    if len(given) != 1:
        yield field, given, f"allowed: exactly one of {', '.join(NAMES)}"
    elif plain["prism"]:
        yield from polygon_faults(f"{field}.prism.polygon", plain["prism"]["polygon"])
    elif plain["compound"]:
        yield from _compound_faults(f"{field}.compound", plain["compound"])
    elif plain["mesh"]:
        mesh = plain["mesh"]
        try:
            read_mesh(mesh["path"], mesh["scale"], mesh["up"])
        except ValueError as error:
            allowed = "allowed: one body that stands on its base"
            yield f"{field}.mesh.path", path_value(mesh["path"]), f"{error}; {allowed}"


def mass_faults(plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield a fault for a missing mass of an object whose file gives none."""
    mesh = plain["shape"]["mesh"]
    if plain["mass"] is not None:
        return
    if mesh is not None and read_mesh(**mesh).file_mass is not None:
        return
    allowed = "a mass, or a shape.mesh in a URDF, SDF or MJCF file that gives one"
    yield "object.mass", None, f"it is missing; allowed: {allowed}"


def polygon_faults(field: str, polygon: Sequence[Point]) -> Iterator[Fault]:
    """Yield faults of corners that do not form a simple polygon."""
    fault = border_fault(tuple(polygon))
    if fault is not None:
        corners = [list(corner) for corner in polygon]
        allowed = "a polygon of at least 3 distinct corners that does not cross itself"
        yield field, corners, f"{fault}; allowed: {allowed}"


def _compound_faults(field: str, plain: Sequence[Mapping[str, Any]]) -> Iterator[Fault]:
    names = [row[0] for row in _PARTS]
    for i, part in enumerate(plain):
        given = [name for name in names if part[name] is not None]
        if len(given) != 1:
            yield f"{field}[{i}]", given, f"allowed: exactly one of {', '.join(names)}"
        elif part["prism"]:
            place = f"{field}[{i}].prism.polygon"
            yield from polygon_faults(place, part["prism"]["polygon"])
    compound: Compound = _COMPOUND.decode(plain)
    height = compound.height
    for i, placed in enumerate(compound.parts):
        if abs(placed.shape.height - height) > SAME_HEIGHT:
            allowed = f"height allowed: {height:g} m, that of the first part"
            yield f"{field}[{i}]", placed.shape.height, allowed
    try:
        _ = compound.border
    except ValueError as error:
        count = len(compound.parts)
        allowed = "parts that overlap or touch along a line, without a hole"
        yield field, Shown(f"{count} parts"), f"{error}; allowed: {allowed}"
