"""The closed forms and model-predictive control on the same push."""

import math

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide_studies.bench import mpc


@pytest.fixture(scope="module")
def push() -> mpc.Push:
    return mpc._push("rear-push-left")


def test_a_reference_goes_straight_on_beyond_the_end(push) -> None:
    length = push.segment.path.length
    end = push.body_pose(length)
    beyond = push.body_pose(length + 0.02)
    assert beyond.yaw == pytest.approx(end.yaw)
    assert math.dist(beyond.position, end.position) == pytest.approx(0.02)


def test_the_closed_forms_bring_the_object_to_the_end(push) -> None:
    found = mpc.controlled(push, push.believed_world, mpc.closed_form(push))
    assert found.position < 0.003
    assert math.degrees(found.yaw) < 1.0
    assert len(found.times) > 100


@pytest.mark.parametrize("kind", ["ipopt", "real_time"])
def test_the_opponents_do_what_they_are_there_for(push, kind) -> None:
    """A weak opponent proves nothing: these track the path, too."""
    pytest.importorskip("casadi")
    found = mpc.controlled(push, push.believed_world, mpc.predictive(push, kind))
    assert found.position < 0.006
    assert math.degrees(found.yaw) < 2.0


def test_both_opponents_ask_for_nearly_the_same_at_first(push) -> None:
    pytest.importorskip("casadi")
    X = push.body_pose(0.0).compose(Pose2(0.0, 0.001, 0.01))
    one = mpc.predictive(push, "ipopt")
    other = mpc.predictive(push, "real_time")
    for _ in range(4):  # one step each time comes to what the other one ends at
        exact = one(X, 0.0)
        near = other(X, 0.0)
    assert exact is not None
    assert near is not None
    assert math.dist(exact, near) < 0.02 * math.hypot(*exact)
