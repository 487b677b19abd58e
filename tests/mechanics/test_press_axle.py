"""The virtual axle of one press: exact against closed forms, and the paper's formula
with its sign slip.
"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.task import Box, Cylinder, ObjectModel
from pushpressslide.mechanics.press_axle import Press

LENGTH = 0.6
WIDTH = 0.2
loads = st.floats(2.0, 20.0)


def bar(
    load: float = 8.0, height: float = 0.1, contact=(0.2, 0.0), mu: float = 0.3
) -> Press:
    body = ObjectModel(Box((LENGTH, WIDTH, height)), 0.3, (0.0, 0.0))
    return Press(body, mu, contact, load)


def variance(cop: float) -> float:
    """Of the pressure along the bar (docs/mechanics.md, 1.2)."""
    if cop <= LENGTH / 6.0:
        return LENGTH**2 / 12.0 - cop**2
    return 0.5 * (0.5 * LENGTH - cop) ** 2


@given(loads, st.floats(0.02, 0.12), st.sampled_from([(0.0, 1.0), (math.pi, -1.0)]))
def test_near_straight_motion_has_the_closed_form_with_height(
    load, height, way
) -> None:
    angle, sign = way
    thing = bar(load, height)
    shifted = thing.cop[0] + sign * height * thing.friction
    expected = shifted - variance(abs(shifted)) / thing.lever
    assert thing.axle(angle) == pytest.approx(expected, abs=2e-4)


@given(loads, st.floats(0.1, 1.5))
def test_without_height_pulling_and_pushing_turn_about_the_same_axle(
    load, angle
) -> None:
    thing = bar(load)
    assert thing.axle(angle, 0.0) == pytest.approx(
        thing.axle(math.pi - angle, 0.0), abs=1e-6
    )


@given(st.floats(0.1, 3.0), st.floats(-3.0, 3.0))
def test_the_axle_goes_with_the_contact_round_a_cylinder(angle, bearing) -> None:
    body = ObjectModel(Cylinder(0.2, 0.05), 1.0, (0.0, 0.0))
    ahead = Press(body, 0.3, (0.1, 0.0), 8.0)
    turned = Press(body, 0.3, (0.1 * math.cos(bearing), 0.1 * math.sin(bearing)), 8.0)
    assert turned.axle(angle) == pytest.approx(ahead.axle(angle), abs=1e-3)


@given(loads)
def test_the_paper_is_off_by_twice_the_centre_of_pressure(load) -> None:
    thing = bar(load)
    assert thing.paper_printed() + thing.paper_axle() == pytest.approx(
        2.0 * thing.cop[0]
    )
    assert thing.paper_axle() == pytest.approx(thing.cop[0] - 0.36 * 0.1 / thing.lever)


def test_the_axle_of_near_straight_sliding_is_the_closed_form() -> None:
    """docs/mechanics.md, section 4: +0.034 m forward, -0.198 m backward from the CoM."""
    for backward, wanted in ((False, 0.034), (True, -0.198)):
        ahead, reach = bar().steered(0.0, backward)
        assert bar().cop[0] + ahead == pytest.approx(wanted, abs=5e-4)
        near, nearly = bar().steered(math.radians(2.0), backward)
        assert near == pytest.approx(ahead, abs=1e-3)
        assert nearly == pytest.approx(reach, rel=0.02)


def test_the_pivot_is_off_the_axis_to_the_side_of_the_force() -> None:
    left = bar().pivot(True)
    right = bar().pivot(False)
    assert left[1] > 0.02
    assert right == pytest.approx((left[0], -left[1]), abs=1e-6)


def test_drag_at_the_top_of_a_high_object_leaves_its_base() -> None:
    high = Press(
        ObjectModel(Box((0.1, 0.1, 0.2)), 1.0, (0.0, 0.0)), 0.4, (0.03, 0.0), 10.0
    )
    assert high.room(0.0) < 0.0
    assert high.room(math.pi) > high.room(0.0)
    with pytest.raises(ValueError, match="outline"):
        high.steered(math.radians(20.0), backward=False)


def test_a_drag_that_tips_the_object_is_refused() -> None:
    with pytest.raises(ValueError, match="outline of the base"):
        bar(height=0.6).axle(0.0)


@pytest.mark.parametrize(
    ("fields", "words"),
    [({"load": 0.0}, "load 0.0 N"), ({"contact": (0.0, 0.0)}, "at the CoM")],
)
def test_no_press_and_no_lever_are_refused(fields, words) -> None:
    with pytest.raises(ValueError, match=words):
        bar(**fields)
