"""Travels of a tip that drags an object under a press."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.identification.pressed_travel import (
    LEAST,
    LONGEST,
    MOST,
    PressedPicture,
    PressedTravels,
    without_repeats,
)

PLACE = (0.03, -0.02)  # of the tip in G
LOAD = 12.0
FORCE = 5.0
DEVIATION = 0.01


def picture(
    X_WG: Pose2, place: Point = PLACE, load: float = LOAD, force: float = FORCE
) -> PressedPicture:
    return PressedPicture(X_WG, DEVIATION, X_WG.apply(place), load, force)


def told(*pictures: PressedPicture) -> PressedTravels:
    out = PressedTravels()
    for one in pictures:
        out = out.including(one)
    return out


@pytest.mark.parametrize("yaw", [0.4, 3.1])
def test_a_travel_is_along_the_axes_of_the_object(yaw: float) -> None:
    before, after = Pose2(0.5, 0.1, yaw), Pose2(0.51, 0.12, yaw + 0.1)
    (travel,) = told(picture(before), picture(after, force=7.0)).travels
    first, last = before.apply(PLACE), after.apply(PLACE)
    off = (last[0] - first[0], last[1] - first[1])
    assert travel.displacement == pytest.approx(
        Pose2(0.0, 0.0, yaw + 0.05).unrotate(off)
    )
    assert travel.length == pytest.approx(math.hypot(*off))
    assert travel.turn == pytest.approx(0.1)
    assert travel.place == pytest.approx(PLACE)
    assert travel.deviation == pytest.approx(math.sqrt(2.0) * DEVIATION)
    assert (travel.load, travel.force) == (LOAD, 7.0)
    assert travel.tells


def test_parts_in_one_direction_are_one_travel() -> None:
    poses = [Pose2(0.5 + 0.01 * i, 0.1, 0.02 * i) for i in range(4)]
    forces = (0.0, 4.0, 5.0, 9.0)
    pictures = (picture(X, force=f) for X, f in zip(poses, forces, strict=True))
    (travel,) = told(*pictures).travels
    assert travel.turn == pytest.approx(0.06)
    assert travel.length == pytest.approx(0.03, rel=0.05)
    assert travel.force == pytest.approx(6.0)
    assert travel.pictures == 3


def test_another_direction_another_load_or_a_long_way_is_another_travel() -> None:
    first, second = Pose2(0.5, 0.1, 0.0), Pose2(0.52, 0.1, 0.0)
    straight, aside = Pose2(0.54, 0.1, 0.0), Pose2(0.52, 0.12, 0.0)
    begun = [picture(first), picture(second)]
    assert len(told(*begun, picture(straight)).travels) == 1
    assert len(told(*begun, picture(aside)).travels) == 2
    assert len(told(*begun, picture(straight, load=20.0)).travels) == 2
    far = Pose2(0.52 + LONGEST, 0.1, 0.0)
    assert len(told(*begun, picture(far)).travels) == 2


def test_what_moves_the_object_while_the_tip_is_away_does_not_count() -> None:
    before = told(picture(Pose2(0.5, 0.1, 0.0)), picture(Pose2(0.52, 0.1, 0.1)))
    paused = before.paused()
    assert paused.paused() is paused
    after = paused.including(picture(Pose2(0.8, 0.3, 1.0)))
    assert after.travels == before.travels


def test_a_short_way_or_a_tip_that_slides_tells_nothing() -> None:
    begun = picture(Pose2(0.5, 0.1, 0.0))
    near = told(begun, picture(Pose2(0.5 + 0.9 * LEAST, 0.1, 0.0)))
    assert near.travels
    assert not near.telling
    # the tip goes 20 mm, the object 10
    away = (PLACE[0] + 0.01, PLACE[1])
    assert not told(begun, picture(Pose2(0.51, 0.1, 0.0), place=away)).telling


def test_the_last_travels_are_remembered() -> None:
    out = PressedTravels()
    for i in range(2 * MOST):
        out = out.including(picture(Pose2(0.5 + 0.02 * (i % 2), 0.1, 0.0)))
    assert len(out.travels) == MOST


def test_a_tip_at_rest_leaves_what_was_told_before() -> None:
    """Pictures of an object at rest are shorter than a travel, and end none."""
    out = told(picture(Pose2(0.5, 0.1, 0.0)), picture(Pose2(0.52, 0.1, 0.1)))
    (before,) = out.telling
    for i in range(2 * MOST):
        out = out.including(picture(Pose2(0.52, 0.1 + 1e-3 * (i % 2), 0.1)))
    (after,) = out.telling
    assert after.turn == pytest.approx(before.turn)
    assert after.length == pytest.approx(before.length)
    assert len(out.travels) <= 3


def test_travels_that_tell_the_same_are_one() -> None:
    out = told(*(picture(Pose2(0.5 + 0.04 * i, 0.1, 0.1 * i)) for i in range(6)))
    assert len(out.telling) > 1
    (together,) = without_repeats(out.telling)
    assert together.turn == pytest.approx(0.5)
    assert together.length == pytest.approx(0.2, rel=0.05)
    deviations = [travel.deviation for travel in out.telling]
    assert together.deviation == pytest.approx(math.hypot(*deviations))
    # not under another load, elsewhere on the object, or in another direction
    other = out.telling[0]._replace(load=LOAD + 1.0)
    assert len(without_repeats((*out.telling, other))) == 2
    far = other._replace(load=LOAD, began=(0.1, 0.0), ended=(0.1, 0.0))
    assert len(without_repeats((*out.telling, far))) == 2
    across = other._replace(load=LOAD, displacement=(0.0, 0.04))
    assert len(without_repeats((*out.telling, across))) == 2
