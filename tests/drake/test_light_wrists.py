"""Arms with nearly massless wrists, as in most robot files, and the stop of one that
runs away nevertheless.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.record import Record
from pushpressslide.execution import arm as execution

BARE = (
    f"{{model: {Path(__file__).parent / 'ur5e.urdf'}, tip_frame: tcp, "
    "rotor_inertia: [0, 0, 0, 0, 0, 0]}"
)
UR5E = f"{{model: {Path(__file__).parent / 'ur5e.urdf'}, tip_frame: tcp}}"
FASTEST = 3.1416  # [rad/s] of its joints
STOPPED = 0.1  # [s] that it may take
AT_REST = 0.02  # of a joint's speed limit

NEAR = [
    "object.shape.box=[0.12, 0.12, 0.10]",
    "object.mass=0.5",
    "start={x: 0.45, y: 0.12}",
    "goal={x: 0.50, y: -0.12, yaw_deg: -20}",
    "motion={}",
]


def run(task: str, robot: str, *sets: str) -> Record:
    return pps.run(pps.load_task(task, [f"robots=[{robot}]", *sets]), engine="drake")


@pytest.mark.long
@pytest.mark.parametrize("task", ["rear-push-rear", "press-slide"])
def test_a_ur5e_does_what_the_shipped_arms_do(task: str) -> None:
    record = run(task, UR5E, "motion.recoveries=0")
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 2e-3
    assert record.figures["final_yaw_error"] < np.radians(1.0)
    share = record.figures["max_joint_speed_share"]
    assert share < 1.0


def stopped_in(record: Record) -> float:
    """Time [s] from the first tick at which a joint is too fast, or from the start of
    the stop, until all joints rest.
    """
    times = record.arrays["time"]
    fastest = np.abs(record.arrays["joint_velocity_0"]).max(axis=1)
    moving = np.flatnonzero(fastest > AT_REST * FASTEST)
    stop = float(record.reason_text.split("(at ")[1].split(" s")[0])
    return float(times[moving[-1]]) - stop


@pytest.mark.parametrize("factor", [1.0, -5.0], ids=["as it was", "turned about"])
@pytest.mark.parametrize("robot", [BARE, "{model: panda}"], ids=["ur5e", "panda"])
def test_an_arm_that_runs_away_is_stopped_before_it_touches_anything(
    robot: str, factor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Springs and dampers held constant over a tick, and with the wrong sign."""
    if factor > 0.0 and "panda" in robot:
        pytest.skip("its joints are heavy enough for that law")
    monkeypatch.setattr(
        execution, "held_for_a_tick", lambda impedance, *_: factor * impedance.torque
    )
    record = run("rear-push-rear", robot, *NEAR)
    # one that passes its speed limit on the way breaks that first
    assert record.reason in ("runaway", "joint_limit")
    assert re.fullmatch(
        r"arm 0 runs away: joint .* s, touch\)|"
        r"arm 0: joint .* rad/s \(.* s, touch\); then an arm ran away",
        record.reason_text,
    )
    assert stopped_in(record) < STOPPED
    assert record.meta["events"] == []  # nothing was planned from there
    pose = record.arrays["object_pose"]
    assert np.ptp(pose, axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    height = record.arrays["tip_position"][:, 0, 2]
    assert height.min() > 0.0
