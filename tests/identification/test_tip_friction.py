"""The friction of tips that slide over the top."""

from __future__ import annotations

import math

import pytest

from pushpressslide.identification.tip_friction import ROLLED, TipFriction


def test_tips_that_slide_tell_their_friction() -> None:
    forces = [(3.0, 4.0, -10.0), (0.0, -7.5, -15.0)]
    found = TipFriction.of_slide(forces, 0.0)
    assert found is not None
    assert found.value == pytest.approx(0.5)
    assert found.deviation == pytest.approx(ROLLED * 0.5)
    assert found.beside(0.7).contradicts_belief


def test_noise_of_the_forces_makes_it_less_sure() -> None:
    found = TipFriction.of_slide([(6.0, 8.0, -10.0)], 0.3)
    assert found is not None
    assert found.deviation == pytest.approx(math.hypot(0.03 * math.sqrt(2.0), ROLLED))


def test_tips_that_do_not_press_tell_nothing() -> None:
    assert TipFriction.of_slide([(1.0, 0.0, 0.0)], 0.0) is None
