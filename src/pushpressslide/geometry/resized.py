"""A shape of another length and width."""

from __future__ import annotations

from dataclasses import replace

from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import Box, Compound, Cylinder, MeshSolid, Prism


def resized(shape: Shape, growth: Point) -> Shape:
    """The shape stretched about the middle of its bounds, so that these grow by
    ``growth`` [m] along x and y of G. A compound becomes a prism.

    Raises InputError for a body from a mesh with sides that lean, for a cylinder that
    would be no cylinder, and for a shape that would vanish.
    """
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    dx, dy = growth
    if dx <= x_min - x_max or dy <= y_min - y_max:
        raise InputError(f"growth {growth!r} m; must be more than minus the extent")
    middle = (0.5 * (x_min + x_max), 0.5 * (y_min + y_max))
    factors = (1.0 + dx / (x_max - x_min), 1.0 + dy / (y_max - y_min))
    if isinstance(shape, Box):
        length, width, height = shape.size
        return Box((length + dx, width + dy, height))
    if isinstance(shape, Cylinder):
        if dx != dy:
            raise InputError(f"growth {growth!r} m of a cylinder; must be equal")
        return Cylinder(shape.radius + 0.5 * dx, shape.height)
    if isinstance(shape, Prism):
        return Prism(_stretched(shape.corners, middle, factors), shape.height)
    if isinstance(shape, MeshSolid):
        corners = _stretched(shape.corners, middle, factors)
        (center,) = _stretched((shape.center,), middle, factors)
        return replace(shape, polygon=corners, center=center)
    if isinstance(shape, Compound):
        outline = _stretched(shape.outline(), middle, factors)
        return Prism(outline, shape.height)
    raise InputError("growth of a body with sides that lean; must be (0, 0)")


def _stretched(
    points: tuple[Point, ...], middle: Point, factors: Point
) -> tuple[Point, ...]:
    """Points [m] stretched about ``middle`` [m]."""
    x, y = middle
    kx, ky = factors
    return tuple((x + kx * (px - x), y + ky * (py - y)) for px, py in points)
