"""The recorder: arrays of a few ticks, and the paths of a plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.cell import Applied, TrueState
from pushpressslide.control.limits import ArmReading
from pushpressslide.control.recording import PATH_SAMPLES, Recorder, Tick
from pushpressslide.core.control import ControlLog, Thought, TipState
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending

ZERO = (0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def two() -> Plan:
    """A plan of two placements."""
    return pps.plan(pps.load_task("pivot-and-move"))


def tick(time: float, X_WG: Pose2, applied: Applied | None = None) -> Tick:
    """A tick of two tips at rest that follow nothing."""
    tip = TipState(ZERO, ZERO, ZERO)
    log = ControlLog("move", 0.0, lambda: Thought(X_WG))
    joints = ()
    if applied is not None:
        joints = ((ArmReading(np.zeros(2), np.zeros(2)), applied),) * 2
    truth = TrueState(X_WG, (tip, tip))
    return Tick(time, truth, (None, None), log, None, joints, (0.0,) * 4)


def test_a_twist_that_nobody_knows_is_the_rate_of_the_pose(two: Plan) -> None:
    recorder = Recorder(two)
    for time in (0.0, 0.1, 0.2):
        moved = Pose2(1.0 + 0.3 * time, 2.0 - 0.2 * time, 3.1 + 0.5 * time)
        recorder.add(tick(time, moved))
    twists = recorder.arrays()["object_twist"]
    assert twists[0] == pytest.approx(ZERO)
    for twist in twists[1:]:
        assert twist == pytest.approx((0.3, -0.2, 0.5))


def test_an_arm_that_names_no_limits_uses_no_share_of_them(two: Plan) -> None:
    recorder = Recorder(two)
    recorder.add(tick(0.0, Pose2(), Applied(torque=np.array([1.0, -2.0]))))
    arrays = recorder.arrays()
    assert arrays["joint_torque_1"].tolist() == [[1.0, -2.0]]
    assert arrays["torque_share_1"].tolist() == [0.0]
    assert arrays["torque_rate_share_1"].tolist() == [0.0]


def test_what_is_left_of_a_plan_is_recorded_from_the_present_placement_on(
    two: Plan,
) -> None:
    """Each path once, of a plan with a second placement in its middle."""
    first, second = two.placements
    plan = replace(two, segments=(*first, *second, *first))
    assert len(plan.placements) == 3
    recorder = Recorder(plan)
    recorder.add(tick(0.0, Pose2())._replace(followed=first[0]))
    recorder.begin_placement(plan, 1)
    recorder.add(tick(0.1, Pose2()))
    made = recorder.record({}, Ending("interrupted"), "", 0, 0.0, plan, {})
    begins = made.arrays["plan_path"][::PATH_SAMPLES]
    wanted = [segment.path.pose(0.0) for segment in plan.segments]
    assert begins == pytest.approx(np.array([(p.x, p.y, p.yaw) for p in wanted]))
