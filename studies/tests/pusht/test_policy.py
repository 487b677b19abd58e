"""The policy on the forward model, which needs no package."""

import math

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide_studies.pusht.forward import predicted
from pushpressslide_studies.pusht.game import STEP_LIMIT
from pushpressslide_studies.pusht.policy import Observation, State, act
from pushpressslide_studies.pusht.servo import Pusher
from pushpressslide_studies.pusht.tee import GOAL_BODY, WORLD, overlap


def played(start: Pose2, place: tuple[float, float]) -> list[float]:
    """Return the overlaps of an episode after each action."""
    X_WB = start
    pusher = Pusher(place, (0.0, 0.0))
    state = State()
    overlaps: list[float] = []
    while len(overlaps) < STEP_LIMIT:
        action, state = act(Observation(pusher.position, X_WB), state)
        assert all(0.0 <= part <= WORLD for part in action)
        X_WB = predicted(X_WB, pusher, action)
        pusher = pusher.after(action)
        assert state.velocity == pytest.approx(pusher.velocity)
        overlaps.append(overlap(X_WB))
        if overlaps[-1] > 0.95:
            break
    return overlaps


@pytest.mark.parametrize("seed", range(8))
def test_the_t_is_brought_to_the_goal_by_a_last_stride(seed: int) -> None:
    random = np.random.default_rng(seed)
    x, y = random.uniform(150.0, 360.0, size=2).tolist()
    start = Pose2(x, y, random.uniform(-math.pi, math.pi))
    overlaps = played(start, (40.0, 470.0))
    assert len(overlaps) < 100
    assert overlaps[-1] > 0.97


def test_a_small_miss_is_mended_too() -> None:
    near = Pose2(GOAL_BODY.x + 4.0, GOAL_BODY.y - 3.0, GOAL_BODY.yaw + 0.05)
    assert played(near, (450.0, 100.0))[-1] > 0.95


def test_a_policy_without_a_plan_waits() -> None:
    # nowhere about the T can the pusher be sent
    outside = Pose2(-300.0, -300.0, 0.0)
    action, state = act(Observation((100.0, 100.0), outside), State())
    assert action == pytest.approx((100.0, 100.0))
    assert state.plan.pushes == ()


def test_the_same_observation_and_state_give_the_same_action() -> None:
    observed = Observation((90.0, 400.0), Pose2(280.0, 200.0, 2.0))
    assert act(observed, State()) == act(observed, State())
