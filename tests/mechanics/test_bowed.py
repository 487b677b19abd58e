"""Pressure under bowed bases."""

from __future__ import annotations

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import Box, Cylinder, Prism
from pushpressslide.mechanics.bowed import FOOT, bowed
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure

CENTER = (0.01, -0.005)
SHAPES = {
    "box": Box((0.15, 0.1, 0.1)),
    "disc": Cylinder(0.08, 0.1),
    "L": Prism(
        ((0, 0), (0.16, 0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0, 0.16)), 0.06
    ),
}


def mean_square(samples: PressureSamples) -> float:
    arms = samples.points - np.array(samples.cop)
    squares = (arms**2).sum(axis=1) + samples.radii**2
    return float(squares @ samples.loads / samples.total_load)


@pytest.mark.parametrize("bow", [0.9, 0.3, -0.9])
@pytest.mark.parametrize("name", ["box", "disc"])
def test_an_even_pressure_moves_to_the_rim_or_to_the_middle(
    name: str, bow: float
) -> None:
    """Of a pressure 1 + b (2 g^2 - 1) the mean square distance is 1 + b / 3 of that of
    an even one.
    """
    even = support_pressure(SHAPES[name], 7.0)
    bent = bowed(even, SHAPES[name], (0.0, 0.0), bow)
    ratio = mean_square(bent) / mean_square(even)
    assert ratio == pytest.approx(1.0 + bow / 3.0, rel=5e-3)


@pytest.mark.parametrize("bow", [0.8, -0.8])
@pytest.mark.parametrize("name", SHAPES)
def test_load_and_centre_of_pressure_stay(name: str, bow: float) -> None:
    shape: Shape = SHAPES[name]
    x, y = shape.middle
    center = (x + CENTER[0], y + CENTER[1])
    even = support_pressure(shape, 7.0, center, (0.004, 0.003))
    bent = bowed(even, shape, center, bow)
    assert bent.total_load == pytest.approx(7.0)
    np.testing.assert_allclose(bent.cop, even.cop, atol=1e-4)
    assert (mean_square(bent) > mean_square(even)) == (bow > 0.0)


@pytest.mark.parametrize("share", [0.3, 0.9])
@pytest.mark.parametrize("name", ["box", "disc"])
def test_a_base_on_feet_rests_there_alone(name: str, share: float) -> None:
    """Four feet on the diagonals, each with a quarter of the load."""
    shape: Shape = SHAPES[name]
    even = support_pressure(shape, 8.0, resolution=12)
    carried = bowed(even, shape, (0.0, 0.0), 0.0, share)
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    corner = (0.5 * (x_max - x_min), 0.5 * (y_max - y_min))
    foot = share / shape.gauge()(*corner) * np.array(corner)
    away = np.hypot(*(np.abs(carried.points) - foot).T)
    near = away < 3.0 * FOOT * shape.breadth
    assert carried.loads[near].sum() > 0.99 * 8.0
    first = (carried.points > 0.0).all(axis=1)
    assert carried.loads[first].sum() == pytest.approx(2.0, rel=0.02)
    assert (mean_square(carried) > mean_square(even)) == (share > 0.5)
