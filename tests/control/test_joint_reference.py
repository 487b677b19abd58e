"""Joint references: continuous, inside their samples, and at rest at the end."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.control.joint_reference import approach_reference, path_reference
from pushpressslide.core.plan import JointPath

TIMES = np.array([0.0, 0.5, 0.7, 2.0])
PATH = JointPath(
    approach_time=TIMES,
    approach=np.array([[0.0, 1.0], [1.0, 1.0], [0.5, -1.0], [0.4, 2.0]]),
    arc_length=np.array([0.0, 0.1, 0.4]),
    move=np.array([[0.4, 2.0], [0.6, 1.0], [0.0, 0.0]]),
    tool_yaw_offset=0.0,
    joint_margin=1.0,
    condition=1.0,
    clearance=1.0,
    gap=0.01,
)
times = st.floats(-1.0, 3.0)


def test_the_approach_passes_through_its_samples() -> None:
    for time, q in zip(TIMES, PATH.approach, strict=True):
        assert approach_reference(PATH, time)[0] == pytest.approx(q)


@given(times)
def test_the_approach_stays_between_its_samples(time: float) -> None:
    position, _ = approach_reference(PATH, time)
    assert (position >= PATH.approach.min(axis=0)).all()
    assert (position <= PATH.approach.max(axis=0)).all()


@given(st.floats(0.001, 1.998))
def test_the_velocity_is_the_slope_of_the_position(time: float) -> None:
    step = 1e-4
    if np.abs(TIMES - time).min() < 2.0 * step:
        return
    before, velocity = approach_reference(PATH, time - step)
    after, _ = approach_reference(PATH, time + step)
    assert (after - before) / (2.0 * step) == pytest.approx(velocity, abs=1e-6)


def test_after_the_approach_the_arm_rests() -> None:
    for time in (2.0, 2.1, 100.0):
        position, velocity = approach_reference(PATH, time)
        assert position.tolist() == PATH.approach[-1].tolist()
        assert velocity.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(("progress", "row"), [(-0.2, 0), (0.1, 1), (0.4, 2), (9.0, 2)])
def test_beyond_its_ends_the_path_keeps_its_nearer_end(
    progress: float, row: int
) -> None:
    assert path_reference(PATH, progress) == pytest.approx(PATH.move[row])


def test_beyond_the_end_of_the_path_the_arm_draws_back_as_planned() -> None:
    drawn = np.array([[0.0, 0.0], [0.2, -0.4], [0.4, -0.4]])
    path = replace(PATH, back=drawn, max_retreat=0.06)
    for i in range(3):
        assert path_reference(path, 0.4 + 0.03 * i) == pytest.approx(drawn[i])
    assert path_reference(path, 0.415) == pytest.approx(drawn[:2].mean(axis=0))
    assert path_reference(path, 9.0) == pytest.approx(drawn[-1])
    assert path_reference(path, 0.1) == pytest.approx(PATH.move[1])


def test_an_arm_that_cannot_draw_back_stays_at_the_end() -> None:
    stuck = replace(PATH, back=PATH.move[-1:], max_retreat=0.0)
    assert path_reference(stuck, 0.43) == pytest.approx(PATH.move[-1])


def test_a_path_that_leads_nowhere_keeps_its_start() -> None:
    still = JointPath(
        TIMES, PATH.approach, np.zeros(2), PATH.move[:2], 0.0, 1.0, 1.0, 1.0, 0.0
    )
    assert path_reference(still, 0.3).tolist() == PATH.move[0].tolist()


@given(st.floats(0.0, 0.4))
def test_on_the_path_joints_lie_on_the_line_between_two_samples(s: float) -> None:
    wanted = [np.interp(s, PATH.arc_length, PATH.move[:, joint]) for joint in range(2)]
    assert path_reference(PATH, s) == pytest.approx(wanted, abs=1e-12)


@given(times)
def test_on_the_approach_joints_lie_on_the_line_between_two_samples(
    time: float,
) -> None:
    wanted = [np.interp(time, TIMES, PATH.approach[:, joint]) for joint in range(2)]
    assert approach_reference(PATH, time)[0] == pytest.approx(wanted, abs=1e-12)


def test_before_the_touch_joints_are_those_of_the_way_that_is_left() -> None:
    before = np.array([[0.1, 0.3], [0.2, 0.5], [0.4, 2.0]])
    path = replace(PATH, touch=before)
    assert path_reference(path, -0.01) == pytest.approx(before[0])
    assert path_reference(path, -0.005) == pytest.approx(before[1])
    assert path_reference(path, -0.0075) == pytest.approx(before[:2].mean(axis=0))
    assert path_reference(path, -9.0) == pytest.approx(before[0])
    assert path_reference(path, 0.1) == pytest.approx(PATH.move[1])
    assert path_reference(path, 0.0) == pytest.approx(PATH.move[0])


def test_a_touch_needs_two_samples_to_be_a_line() -> None:
    before = np.array([[0.1, 0.3], [0.4, 2.0]])
    path = replace(PATH, touch=before)
    assert path_reference(path, -0.005) == pytest.approx(before.mean(axis=0))
    alone = replace(PATH, touch=before[:1])
    assert path_reference(alone, -0.005) == pytest.approx(PATH.move[0])
    drawn = np.array([[0.0, 0.0], [0.2, -0.4]])
    back = replace(PATH, back=drawn, max_retreat=0.06)
    assert path_reference(back, 0.43) == pytest.approx(drawn.mean(axis=0))


def test_a_path_of_two_samples_is_followed_from_one_to_the_other() -> None:
    path = replace(PATH, arc_length=np.array([0.0, 0.4]), move=PATH.move[[0, 2]])
    assert path_reference(path, 0.1) == pytest.approx(0.75 * PATH.move[0])
    assert path_reference(path, 0.4) == pytest.approx(PATH.move[2])
