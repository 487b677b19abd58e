"""Feet of a base carry it as its uniform pressure does."""

from collections.abc import Callable

import numpy as np
import pytest
import shapely

from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import Box, Compound, Cylinder, Part, Prism
from pushpressslide.mujoco_sim.feet import MOST_CELLS, feet_of

SHAPES = {
    "cube": Box((0.15, 0.15, 0.15)),
    "bar": Box((0.60, 0.05, 0.10)),
    "disc": Cylinder(0.08, 0.10),
    "triangle": Prism(((-0.07, -0.08), (0.11, -0.02), (-0.05, 0.10)), 0.10),
    "L": Prism(
        ((0, 0), (0.16, 0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0, 0.16)), 0.06
    ),
    "compound": Compound(
        (
            Part(Box((0.2, 0.05, 0.05)), Pose2()),
            Part(Cylinder(0.04, 0.05), Pose2(0.1, 0.0)),
        )
    ),
}


def assert_feet_carry(shape: Shape, base: shapely.Geometry) -> None:
    points, shares = feet_of(shape)
    assert 15 < len(points) <= 2 * MOST_CELLS**2
    assert shares.sum() == pytest.approx(1.0)
    assert shares.min() > 0.0
    fine, areas = shape.base_rule(30)
    center = areas @ fine / areas.sum()
    np.testing.assert_allclose(shares @ points, center, atol=2e-3 * shape.breadth)
    exact = np.hypot(*(fine - center).T) @ areas / areas.sum()
    assert np.hypot(*(points - center).T) @ shares == pytest.approx(exact, rel=1e-3)
    # no foot is far outside, where the base has no material
    away = shapely.distance(base, shapely.points(points))
    assert away.max() < 0.05 * shape.breadth


@pytest.mark.parametrize("name", SHAPES)
def test_feet_have_the_moments_of_the_pressure(name: str) -> None:
    shape = SHAPES[name]
    assert_feet_carry(shape, shape.placed(Pose2()))


@pytest.mark.parametrize("name", ["chamfered", "ring", "stool", "mug"])
def test_a_mesh_stands_on_its_base_alone(
    name: str, standing: Callable[[str], MeshBody]
) -> None:
    body = standing(name)
    assert_feet_carry(body, body.base)
