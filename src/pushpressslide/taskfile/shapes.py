"""Shapes in the task file: a kind of shape is added here alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from pushpressslide.core.entry import REQUIRED
from pushpressslide.core.polygon import convexity_fault, signed_area
from pushpressslide.core.pose import Point
from pushpressslide.core.task import Box, Cylinder, Prism, Shape
from pushpressslide.taskfile.kinds import (
    Field,
    Kind,
    array,
    nullable,
    number,
    point,
    section,
)
from pushpressslide.taskfile.place import Fault

_LENGTH = number("m", "(0, 10]")
_HEIGHT = Field(_LENGTH, "height")
_RADIUS = Field(number("m", "(0, 5]"), "radius")
_POLYGON = Field(
    array(point("m", "[-5, 5]"), 3, 64),
    "corners of the base in G: convex, in order, either sense",
)


def _prism(polygon: tuple[Point, ...], height: float) -> Prism:
    """Return the prism with its corners counter-clockwise, the first one staying so."""
    if signed_area(polygon) < 0.0:
        polygon = polygon[:1] + polygon[:0:-1]
    return Prism(polygon, height)


_BOX = replace(array(_LENGTH, 3, 3), decode=Box, encode=lambda box: list(box.size))
_PRISM = section({"polygon": _POLYGON, "height": _HEIGHT}, _prism)
_CYLINDER = section({"radius": _RADIUS, "height": _HEIGHT}, Cylinder)

_ROWS: tuple[tuple[str, type[Shape], Kind, str], ...] = (
    ("box", Box, _BOX, "full lengths along x, y and z; G at the centre"),
    ("prism", Prism, _PRISM, "upright prism; G is the polygon's own origin"),
    ("cylinder", Cylinder, _CYLINDER, "upright cylinder; G at the centre"),
)
"""Name, data, kind of the field and meaning of each kind of shape."""


def _shape(**shapes: Shape | None) -> Shape:
    (shape,) = (shape for shape in shapes.values() if shape is not None)
    return shape


_ANY = section(
    {name: Field(nullable(kind), meaning) for name, _, kind, meaning in _ROWS},
    _shape,
    lambda shape: {name: shape for name, data, *_ in _ROWS if isinstance(shape, data)},
)
_GIVEN = {"not": {"type": "null"}}
_ONE = [{"properties": {row[0]: _GIVEN}, "required": [row[0]]} for row in _ROWS]
SHAPE = replace(_ANY, absent=REQUIRED, json={**_ANY.json, "oneOf": _ONE})


def shape_faults(plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield what keeps the fields from being one shape: several, a concave polygon."""
    given = [name for name, value in plain.items() if value is not None]
    if len(given) != 1:
        yield "object.shape", given, f"allowed: exactly one of {', '.join(plain)}"
    elif plain["prism"]:
        polygon = plain["prism"]["polygon"]
        fault = convexity_fault(polygon)
        allowed = "a convex polygon of at least 3 distinct corners, in order"
        if fault is not None:
            corners = [list(corner) for corner in polygon]
            yield "object.shape.prism.polygon", corners, f"{fault}; allowed: {allowed}"
