"""The turns of a pressed object, against the exact surface one force at a time."""

import math

import numpy as np
import pytest

from pushpressslide.core.task import Box, Cylinder, ObjectModel, Prism
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.pressed.turns import (
    STEERING,
    STEP,
    pressed_turns,
    steering_of,
)

SPEED = 0.05  # [m/s]
TRIANGLE = Prism(((0.1, 0.0), (-0.05, 0.0866), (-0.05, -0.0866)), 0.12)
BODIES = [
    (ObjectModel(Box((0.2, 0.12, 0.12)), 1.0, (0.0, 0.0)), (0.05, 0.01)),
    (ObjectModel(TRIANGLE, 1.0, (0.0, 0.0)), (0.02, 0.0)),
    (ObjectModel(Cylinder(0.1, 0.12), 1.0, (0.0, 0.0)), (0.04, 0.0)),
]


@pytest.mark.parametrize(("body", "contact"), BODIES)
def test_many_forces_at_a_time_slide_the_object_as_one_does(
    body: ObjectModel, contact
) -> None:
    press = Press(body, 0.25, contact, 15.0)
    angles = [math.radians(a) for a in (20.0, 60.0, 90.0, 120.0, 160.0)]
    n = len(angles)
    forces = np.array([press.along(angle) for angle in angles])
    slid = DraggedBase(body, press.shift).slide(
        np.tile(press.cop, (n, 1)), np.tile(contact, (n, 1)), forces
    )
    for angle, (vx, vy, w), share in zip(angles, slid.twists, slid.shares, strict=True):
        exact = press.twist(angle)
        assert (-vy / w, vx / w) == pytest.approx(
            (-exact.vy / exact.w, exact.vx / exact.w), abs=6e-3
        )
        assert 0.5 < share <= 1.0


def test_a_low_object_is_a_unicycle_pulled_and_pushed_with_the_axle_of_the_closed_form() -> (
    None
):
    press = Press(
        ObjectModel(Box((0.6, 0.2, 0.02)), 0.3, (0.0, 0.0)), 0.3, (0.25, 0.0), 8.0
    )
    for backward in (False, True):
        straight = [
            t
            for t in pressed_turns(press, SPEED)
            if abs(t.angle) == (math.pi if backward else 0.0)
        ]
        ahead, reach = press.steered(0.0, backward)
        assert straight[0].X_BV.x - press.cop[0] == pytest.approx(ahead, abs=5e-3)
        assert abs(straight[0].effective_wheelbase) == pytest.approx(reach, rel=0.05)
        assert steering_of(press, backward, SPEED) == pytest.approx(STEERING * STEP)


def test_where_the_drag_moves_the_axle_beyond_the_contact_it_is_not_pulled() -> None:
    """Pulled, the contact's motion does not tell how the object turns; pushed, it does."""
    press = Press(
        ObjectModel(Box((0.105, 0.241, 0.194)), 1.14, (0.0, 0.0)),
        0.327,
        (0.0, -0.043),
        7.6,
    )
    ahead, _ = press.steered(0.0, False)
    assert ahead > press.lever
    assert steering_of(press, False, SPEED) == 0.0
    assert steering_of(press, True, SPEED) > 0.0
