"""The pressure under a rigid face, against known solutions of the same potential
problem.
"""

import math

import numpy as np
import pytest

from pushpressslide.mechanics.pressure import polygon_pressure
from pushpressslide.mechanics.punch import punch_pressure
from pushpressslide.mechanics.rho import rho_pole, rho_straight

SQUARE = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
TRIANGLE = ((-0.05, -0.05), (0.1, -0.05), (-0.05, 0.1))


def circle(n: int) -> tuple[tuple[float, float], ...]:
    return tuple(
        (math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)) for i in range(n)
    )


def test_the_support_sinks_evenly_and_as_deep_as_under_a_square_plate() -> None:
    face = punch_pressure(SQUARE, resolution=5)
    # A conducting square of side 1 has the capacitance 0.36679 (times 4 pi eps0):
    # Erickson, Monkhorst 1983.
    # corners of cells
    places = np.array([(0.0, 0.0), (0.1, -0.3), (-0.3, 0.1), (0.2, 0.2)])
    depth = [
        (face.loads / np.linalg.norm(face.points - place, axis=1)).sum()
        for place in places
    ]
    assert depth == pytest.approx([1.0 / 0.36679] * 4, rel=0.03)


def test_rho_of_a_round_face_is_that_of_the_closed_form() -> None:
    face = punch_pressure(circle(16), resolution=10)
    # p ~ 1 / sqrt(1 - r^2): mean distance pi/4, variance along a line 1/3.
    assert rho_pole(face) == pytest.approx(0.25 * math.pi, rel=0.03)
    assert rho_straight(face) == pytest.approx(3**-0.5, rel=0.03)


def test_load_and_centre_are_those_asked_for() -> None:
    face = punch_pressure(TRIANGLE, 14.7)
    assert face.total_load == pytest.approx(14.7)
    assert face.cop == pytest.approx((0.0, 0.0), abs=1e-12)
    assert punch_pressure(TRIANGLE, 1.0, (0.005, -0.004)).cop == pytest.approx(
        (0.005, -0.004), abs=1e-12
    )


def test_the_rim_carries_more_than_under_an_even_load() -> None:
    face = punch_pressure(TRIANGLE)
    even = polygon_pressure(TRIANGLE)
    assert 1.15 < rho_pole(face) / rho_pole(even) < 1.3


def test_a_centre_near_the_rim_is_refused() -> None:
    with pytest.raises(ValueError, match="lifts an edge"):
        punch_pressure(SQUARE, 1.0, (0.45, 0.0))
