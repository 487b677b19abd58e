"""The virtual axle of one press: exact against closed forms, and the paper's formula with its sign slip."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.task import Box, Cylinder, ObjectModel
from pushpressslide.mechanics.press_axle import PressedObject

LENGTH, WIDTH = 0.6, 0.2
loads = st.floats(2.0, 20.0)


def bar(load: float = 8.0, height: float = 0.1, contact=(0.2, 0.0), mu: float = 0.3) -> PressedObject:
    body = ObjectModel(Box((LENGTH, WIDTH, height)), 0.3, (0.0, 0.0))
    return PressedObject(body, mu, contact, load)


def variance(cop: float) -> float:
    """Of the pressure along the bar (docs/mechanics.md, 1.2)."""
    if cop <= LENGTH / 6.0:
        return LENGTH**2 / 12.0 - cop**2
    return 0.5 * (0.5 * LENGTH - cop) ** 2


@given(loads, st.floats(0.02, 0.12), st.sampled_from([(0.0, 1.0), (math.pi, -1.0)]))
def test_near_straight_motion_has_the_closed_form_with_height(load, height, way) -> None:
    angle, sign = way
    thing = bar(load, height)
    shifted = thing.cop[0] + sign * height * thing.friction
    expected = shifted - variance(abs(shifted)) / thing.lever
    assert thing.axle(angle) == pytest.approx(expected, abs=2e-4)


@given(loads, st.floats(0.1, 1.5))
def test_without_height_pulling_and_pushing_turn_about_the_same_axle(load, angle) -> None:
    thing = bar(load)
    assert thing.axle(angle, 0.0) == pytest.approx(thing.axle(math.pi - angle, 0.0), abs=1e-6)


@given(st.floats(0.1, 3.0), st.floats(-3.0, 3.0))
def test_the_axle_goes_with_the_contact_round_a_cylinder(angle, bearing) -> None:
    body = ObjectModel(Cylinder(0.2, 0.05), 1.0, (0.0, 0.0))
    ahead = PressedObject(body, 0.3, (0.1, 0.0), 8.0)
    turned = PressedObject(body, 0.3, (0.1 * math.cos(bearing), 0.1 * math.sin(bearing)), 8.0)
    assert turned.axle(angle) == pytest.approx(ahead.axle(angle), abs=1e-3)


@given(loads)
def test_the_paper_is_off_by_twice_the_centre_of_pressure(load) -> None:
    thing = bar(load)
    assert thing.paper_printed() + thing.paper_axle() == pytest.approx(2.0 * thing.cop[0])
    assert thing.paper_axle() == pytest.approx(thing.cop[0] - 0.36 * 0.1 / thing.lever)


def test_a_drag_that_tips_the_object_is_refused() -> None:
    with pytest.raises(ValueError, match="outline of the base"):
        bar(height=0.6).axle(0.0)


@pytest.mark.parametrize(
    ("fields", "words"), [({"load": 0.0}, "load 0.0 N"), ({"contact": (0.0, 0.0)}, "at the CoM")]
)
def test_no_press_and_no_lever_are_refused(fields, words) -> None:
    with pytest.raises(ValueError, match=words):
        bar(**fields)
