"""The friction of tips that slide over the top."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.control import Vector3
from pushpressslide.identification.tip_friction import ROLLED, TipFriction


def test_of_two_tips_the_one_that_slides_tells_their_friction() -> None:
    forces = [(3.0, 4.0, -10.0), (0.0, -3.0, -15.0)]
    found = TipFriction.of_slide(forces, 10.0, 0.0)
    assert found == pytest.approx((0.5, ROLLED, 25.0, math.hypot(3.0, 1.0)))
    assert found is not None
    assert found.parameter(0.7).contradicts_belief


def test_noise_of_the_forces_makes_it_less_sure() -> None:
    found = TipFriction.of_slide([(6.0, 8.0, -10.0)], 10.0, 0.3)
    assert found is not None
    assert found.deviation == pytest.approx(math.hypot(0.03 * math.sqrt(2.0), ROLLED))
    assert TipFriction.of_slide([(6.0, 8.0, -10.0)], 10.0, 2.0) is None


@pytest.mark.parametrize(
    "force", [(3.0, 0.0, -4.0), (0.0, 0.0, -10.0), (1.0, 0.0, math.nan)]
)
def test_tips_that_hardly_press_or_do_not_drag_tell_nothing(force: Vector3) -> None:
    assert TipFriction.of_slide([force], 10.0, 0.0) is None
