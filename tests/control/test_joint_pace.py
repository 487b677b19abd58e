"""The pace of a followed path keeps joints below their speed limits."""

from __future__ import annotations

import numpy as np
import pytest

from pushpressslide.control.joint_pace import SHARE, joint_pace
from pushpressslide.control.limits import ArmLimits
from pushpressslide.core.plan import JointPath


def path(move: list[list[float]], arc_length: list[float]) -> JointPath:
    rest = np.array(move[:1])
    return JointPath(
        np.zeros(1), rest, np.array(arc_length), np.array(move), 0.0, 1.0, 1.0, 1.0, 0.0
    )


def limits(*velocity: float) -> ArmLimits:
    speeds = np.array(velocity)
    wide = 3.0 * np.ones_like(speeds)
    return ArmLimits(-wide, wide, speeds, 100.0 * wide, np.full_like(speeds, np.inf))


SLOW = path(
    [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0], [1.2, 0.0], [1.3, 0.1]], [0, 1, 2, 3, 4]
)


def test_the_fastest_joint_sets_the_pace_of_each_section() -> None:
    pace = joint_pace([SLOW], [limits(2.0, 1.0)])
    assert pace is not None
    assert pace.speed_at(0.5) == pytest.approx(SHARE * 20.0)
    assert pace.speed_at(2.5) == pytest.approx(SHARE * 2.0)
    assert pace.speed_at(1.5) == pace.speed_at(2.5)  # a sample before the fast one
    assert pace.speed_at(3.5) == pace.speed_at(2.5)  # and after it
    assert pace.speed_at(-1.0) == pace.speed_at(0.5)
    assert pace.speed_at(9.0) == pace.speed_at(3.5)


def test_the_slower_of_two_arms_sets_the_pace() -> None:
    quick = path([[0.0, 0.0], [0.4, 0.0]], [0.0, 4.0])
    pace = joint_pace([SLOW, quick], [limits(2.0, 1.0), limits(0.5, 0.5)])
    assert pace is not None
    assert pace.speed_at(0.5) == pytest.approx(SHARE * 5.0)
    assert pace.speed_at(2.5) == pytest.approx(SHARE * 2.0)


def test_an_arm_that_rests_sets_no_pace() -> None:
    assert joint_pace([], []) is None
    assert joint_pace([path([[0.0, 0.0]], [0.0])], [limits(1.0, 1.0)]) is None
