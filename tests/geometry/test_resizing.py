"""Shapes of another length and width."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import (
    Box,
    Compound,
    Cylinder,
    MeshSolid,
    Part,
    Prism,
)

TRIANGLE = ((0.0, 0.0), (0.2, 0.05), (0.02, 0.1))
NOTCHED = ((0.0, 0.0), (0.2, 0.0), (0.2, 0.1), (0.1, 0.04), (0.0, 0.1))
SHAPES: dict[str, Shape] = {
    "box": Box((0.2, 0.1, 0.05)),
    "triangle": Prism(TRIANGLE, 0.05),
    "notched": Prism(NOTCHED, 0.05),
    "mesh": MeshSolid("a.stl", 1.0, NOTCHED, 0.05, (0.1, 0.05)),
    "compound": Compound(
        (
            Part(Box((0.2, 0.05, 0.05)), Pose2()),
            Part(Cylinder(0.04, 0.05), Pose2(0.1, 0.0, 0.3)),
        )
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_each_side_of_the_bounds_moves_by_half_the_growth(name: str) -> None:
    shape = SHAPES[name]
    grown = shape.resized((0.01, -0.004))
    moved = np.subtract(grown.bounds(Pose2()), shape.bounds(Pose2()))
    np.testing.assert_allclose(moved, (-0.005, 0.005, 0.002, -0.002), atol=1e-4)
    assert grown.height == shape.height
    assert grown.convex == shape.convex
    back = grown.resized((-0.01, 0.004))
    area, again = (one.placed(Pose2()).area for one in (shape, back))
    assert again == pytest.approx(area, rel=5e-3)


def test_a_cylinder_stays_one() -> None:
    grown = Cylinder(0.08, 0.1).resized((0.01, 0.01))
    assert grown == Cylinder(0.085, 0.1)
    with pytest.raises(InputError, match="cylinder"):
        Cylinder(0.08, 0.1).resized((0.01, 0.0))


def test_nothing_shrinks_to_nothing() -> None:
    with pytest.raises(InputError, match="size"):
        Box((0.02, 0.1, 0.1)).resized((-0.02, 0.0))
    with pytest.raises(InputError, match="extent"):
        Prism(TRIANGLE, 0.05).resized((0.0, -0.1))


def test_a_body_with_sides_that_lean_is_refused(
    standing: Callable[[str], MeshBody],
) -> None:
    with pytest.raises(InputError, match="lean"):
        standing("chamfered").resized((0.001, 0.0))
