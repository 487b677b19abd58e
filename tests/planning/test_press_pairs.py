"""Positions at which two arms press: opposite each other about the CoM, with their
assignment to arms.
"""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.planning.press_pairs import placed_pairs

TASK = load_task("bimanual-slide")


def test_chosen_pairs_lie_opposite_each_other_about_the_com_and_far_enough_apart() -> (
    None
):
    pairs = placed_pairs(TASK.query)
    assert pairs
    for pair in pairs:
        a, b = (contact.point for contact in pair.contacts)
        assert a == pytest.approx((-b[0], -b[1]))
        assert math.dist(a, b) >= margins.ARM.hand_room
        assert pair.refusal is None


def test_given_places_keep_their_arms_and_one_off_the_top_is_refused() -> None:
    a, b = (contact.point for contact in placed_pairs(TASK.query)[0].contacts)
    x, y = TASK.object.center_of_mass
    places = ((a[0] + x, a[1] + y), (b[0] + x, b[1] + y))
    task = replace(TASK, motion=replace(TASK.motion, contacts=places))
    (pair,) = placed_pairs(task.query)
    assert [contact.point for contact in pair.contacts] == [
        pytest.approx(a),
        pytest.approx(b),
    ]
    outside = ((9.0, 0.0), places[1])
    (beside,) = placed_pairs(
        replace(TASK, motion=replace(TASK.motion, contacts=outside)).query
    )
    assert beside.refusal is not None
    assert beside.refusal.code == "off_top"
