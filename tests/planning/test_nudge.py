"""Short pushes that end within the goal's tolerances."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from pushpressslide.control.placement import share_of_tolerance
from pushpressslide.core import margins
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.pose import Pose2
from pushpressslide.planning.nudge import BENDS, Nudge, nudge

TOLERANCE = Tolerance(0.01, math.radians(2.0))
X_VG = Pose2(-0.03, 0.002, 0.4)
TIGHTEST = 12.0  # [1/m]
LONGEST = 0.07  # [m]


def nudged(start: Pose2, goal: Pose2, touch: float = 0.0) -> Nudge:
    limits = (-TIGHTEST, TIGHTEST)
    X_WV = start.compose(X_VG.inverse())
    return nudge(X_WV, goal, X_VG, limits, TOLERANCE, LONGEST, touch)


def starts() -> list[tuple[Pose2, Pose2]]:
    rng = np.random.default_rng(3)
    out = []
    for _ in range(40):
        goal = Pose2(*rng.uniform(-0.5, 0.5, 2).tolist(), rng.uniform(-3.0, 3.0))
        dx, dy = rng.uniform(-0.008, 0.008, 2).tolist()
        turn = math.radians(rng.uniform(-5.0, 5.0))
        out.append((Pose2(goal.x + dx, goal.y + dy, goal.yaw + turn), goal))
    return out


@pytest.mark.parametrize(("start", "goal"), starts())
def test_the_path_ends_as_far_from_the_goal_as_it_says(
    start: Pose2, goal: Pose2
) -> None:
    one = nudged(start, goal)
    assert one.path.start.position == pytest.approx(
        start.compose(X_VG.inverse()).position
    )
    end = one.path.end.compose(X_VG)
    assert share_of_tolerance(end, goal, TOLERANCE) == pytest.approx(one.off, abs=1e-6)
    assert all(
        abs(curvature) <= TIGHTEST + 1e-9 and 0.0 < length <= LONGEST
        for curvature, length in one.path.sections
    )


def test_most_errors_of_a_few_degrees_end_within_the_tolerances() -> None:
    """An object has several faces to push; here only one."""
    ends = [nudged(start, goal).off for start, goal in starts()]
    within = sum(off <= margins.NUDGED_WITHIN for off in ends)
    assert within > len(ends) / 3


def test_of_two_paths_that_are_good_enough_the_shorter_is_taken() -> None:
    goal = Pose2(0.0, 0.0, 0.0)
    heading = X_VG.inverse().yaw
    lengths = []
    for back in (0.005, 0.01, 0.02, 0.03):
        x, y = -back * math.cos(heading), -back * math.sin(heading)
        one = nudged(Pose2(x, y, 0.0), goal)
        assert one.off <= margins.NUDGED + 1e-6
        assert one.path.length <= back
        lengths.append(one.path.length)
    assert all(shorter < longer for shorter, longer in pairwise(lengths))


def test_a_touch_moves_the_object_at_the_middle_curvature() -> None:
    touch = 0.012
    start = Pose2.deg(0.01, 0.0, 4.0)
    one = nudge(
        start.compose(X_VG.inverse()),
        Pose2(),
        X_VG,
        (4.0, 20.0),
        TOLERANCE,
        LONGEST,
        touch,
    )
    curvature, length = one.path.sections[0]
    assert curvature == pytest.approx(np.linspace(4.0, 20.0, BENDS)[BENDS // 2])
    assert length > touch
