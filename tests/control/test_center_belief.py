"""What is believed of a centre of mass, from one coordinate after the other."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.center_belief import CenterBelief, beside_center
from pushpressslide.identification.parameter import Parameter

TASK = pps.load_task("rear-push-rear", ["belief.center_error=0.02"])
PLACEMENT = pps.plan(TASK)
BEFORE = CenterBelief.before_run(TASK.scene)


def seen(value: float, direction: tuple[float, float]) -> Parameter:
    return Parameter(value, 0.001, 0.0, direction)


def test_nothing_is_learnt_from_nothing() -> None:
    assert BEFORE.knowing(None) == BEFORE
    assert BEFORE.error == pytest.approx(0.02)


def test_two_coordinates_tell_the_place() -> None:
    """One alone leaves it as unsure as before across it."""
    x, y = BEFORE.place
    one = BEFORE.knowing(seen(x + 0.01, (1.0, 0.0)))
    assert one.place == pytest.approx((x + 0.01, y), abs=1e-4)
    assert one.error == pytest.approx(0.02)
    assert one.deviation((1.0, 0.0)) == pytest.approx(0.001, rel=0.01)
    c = math.sqrt(0.5)
    both = one.knowing(seen(c * (x + 0.01) + c * (y - 0.005), (c, c)))
    assert both.place == pytest.approx((x + 0.01, y - 0.005), abs=3e-4)
    assert both.error < 0.003


def test_a_coordinate_at_its_bound_leaves_the_belief_as_unsure() -> None:
    x, y = BEFORE.place
    value = x + 0.01
    unsure = Parameter(value, BEFORE.deviation((1.0, 0.0)), 0.0, (1.0, 0.0), True)
    moved = BEFORE.knowing(unsure)
    assert moved.place == pytest.approx((x + 0.005, y))
    assert moved.error == pytest.approx(BEFORE.error)
    assert moved.knowing(unsure).x == pytest.approx(x + 0.0075)


def test_a_placement_may_push_beside_the_centre() -> None:
    x, y = BEFORE.place
    sure = BEFORE._replace(xx=1e-6, yy=1e-6)
    assert not beside_center(PLACEMENT, sure)
    across = sure._replace(x=x, y=y + 0.01)
    ahead = sure._replace(x=x + 0.01, y=y)
    nx, ny = PLACEMENT.query.X_GB.rotate(PLACEMENT.contacts[0].normal)
    assert (abs(nx), abs(ny)) == pytest.approx((1.0, 0.0), abs=0.1)
    assert beside_center(PLACEMENT, across)
    assert not beside_center(PLACEMENT, ahead)
    assert not beside_center(PLACEMENT, across._replace(yy=4e-4))


def test_two_contacts_do_not_push_through_a_centre() -> None:
    parallel = pps.plan(pps.load_task("parallel-push"))
    sure = replace(parallel.task.scene, center_error=0.02)
    center = CenterBelief.before_run(sure)._replace(y=0.05, xx=1e-6, yy=1e-6)
    assert not beside_center(parallel, center)
