"""What pictures tell of their delay, and of where tips touch."""

from __future__ import annotations

import math

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.sightings import (
    BETWEEN,
    Estimated,
    PictureComparison,
    Sightings,
)
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Point, Pose2

PLAN = pps.plan(pps.load_task("rear-push-rear"))
QUERY = PLAN.query
AWAY = TipState((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
BINDING = (
    Controller(PLAN).init(Measurement(0.0, QUERY.start, (AWAY,))).following.binding
)
(CONTACT,) = BINDING.segment.contacts
(CENTER,) = BINDING.tip_points  # in B, of a tip that touches
X_WG = Pose2(0.5, -0.2, 0.7)
X_WB = X_WG.compose(QUERY.X_GB)
PRESSING = 3.0  # [N]


def compared(
    offset: Point, force: float = PRESSING, before: Sightings | None = None
) -> Sightings:
    """Comparison with a tip that is off its place at the face by ``offset`` [m] in B."""
    x, y, _ = CONTACT.direction(X_WB)
    tip = TipState((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (force * x, force * y, 0.0))
    place = X_WB.apply((CENTER[0] + offset[0], CENTER[1] + offset[1]))
    picture = StampedPose(1.0, X_WG)
    return PictureComparison(QUERY).step(
        before or Sightings(), picture, Estimated(X_WG), (place,), BINDING, (tip,)
    )


def test_the_depth_is_how_far_a_tip_is_off_along_the_normal() -> None:
    nx, ny = CONTACT.normal
    off = (0.002 * nx - 0.001 * ny, 0.002 * ny + 0.001 * nx)
    (depth,) = compared(off).depths
    assert depth.samples == 1
    assert depth.mean == pytest.approx(0.002)


def test_a_tip_that_is_not_felt_is_not_compared() -> None:
    (depth,) = compared((0.0, 0.0), force=0.0).depths
    assert depth.samples == 0


def test_a_tip_beyond_the_face_is_not_compared() -> None:
    nx, ny = CONTACT.normal
    (depth,) = compared((-ny, nx)).depths
    assert depth.samples == 0


def test_pictures_are_compared_once_in_a_while() -> None:
    comparison = PictureComparison(QUERY)
    before = compared((0.0, 0.0))
    assert comparison.due(Sightings(), StampedPose(0.0, X_WG))
    assert not comparison.due(before, StampedPose(1.0 + 0.5 * BETWEEN, X_WG))
    assert comparison.due(before, StampedPose(1.0 + 1.1 * BETWEEN, X_WG))


def test_a_picture_of_an_object_that_nothing_drives_ends_the_drive() -> None:
    before = compared((0.0, 0.0))
    assert before.turns.last is not None
    picture = StampedPose(2.0, X_WG)
    estimated = Estimated(Pose2())
    after = PictureComparison(QUERY).step(
        before, picture, estimated, (), BINDING, (AWAY,)
    )
    assert after.turns.last is None
    assert after.depths == before.depths


def test_the_delay_is_that_of_arrivals_after_stamps() -> None:
    seen = Sightings().arrived(1.0, 1.05).arrived(2.0, 2.07)
    assert seen.delay.mean == pytest.approx(0.06)
    assert math.isfinite(seen.delay.error)
