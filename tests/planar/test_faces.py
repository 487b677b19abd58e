"""Gaps of tips to the faces that they are to touch."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.plan import Contact
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.planar.faces import face_of

RADIUS = 0.02
LOW = ObjectModel(Box((0.1, 0.1, 0.02)), 0.2)
REAR = Contact(0, "side", (-0.05, 0.0), (1.0, 0.0), 0.01)


@pytest.mark.parametrize("above", [0.0, 0.006, 0.012, 0.019])
def test_a_tip_above_the_upper_edge_meets_it_with_its_lower_side(above: float) -> None:
    """It does not pass through the face, however far it is above the edge."""
    face = face_of(LOW, REAR, RADIUS)
    reach = math.sqrt(RADIUS**2 - above**2)
    for gap in (0.01, 1e-4, -5e-4):
        place = (-0.05 - reach - gap, 0.0)
        assert face.gap(place, 0.02 + above)[0] == pytest.approx(gap)
    behind = (-0.05 - reach + 0.002, 0.0)
    assert face.gap(behind, 0.02 + above)[0] == math.inf


def test_a_tip_over_the_object_touches_no_side() -> None:
    face = face_of(LOW, REAR, RADIUS)
    assert face.gap((-0.06, 0.0), 0.02 + RADIUS)[0] == math.inf
