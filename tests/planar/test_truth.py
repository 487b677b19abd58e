"""Tips in the plane that are not where their arms say, and late commands."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.core.truth import Truth
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planar.engine import run
from pushpressslide.planar.misplaced_tip import misplacement

PLAN = pps.plan(pps.load_task("rear-push-rear"))
BASE_YAW = Truth(arm_base=(0.003, -0.004), arm_base_yaw=math.radians(0.5))


def with_truth(truth: Truth, plan: Plan = PLAN) -> Plan:
    return replace(plan, task=replace(plan.task, truth=truth))


def test_a_base_turns_and_shifts_the_tip_about_itself() -> None:
    base = (0.1, 0.2, 0.0)
    off = misplacement(BASE_YAW, base, TABLE)
    assert off.place(base) == pytest.approx((0.103, 0.196, 0.0))
    x, y, z = off.place((1.1, 0.2, 0.3))
    assert (x, y, z) == pytest.approx(
        (0.103 + math.cos(BASE_YAW.arm_base_yaw), 0.196 + 0.0087265, 0.3), abs=1e-6
    )
    assert off.inverse.place((x, y, z)) == pytest.approx((1.1, 0.2, 0.3))
    assert off.inverse.turned(off.turned((1.0, 2.0, 3.0))) == pytest.approx((1, 2, 3))


def test_a_tip_is_off_in_the_frame_of_a_tool_that_points_down() -> None:
    off = misplacement(Truth(tip_offset=(0.001, 0.002, 0.003)), (0.0, 0.0, 0.0), TABLE)
    assert off.place((0.0, 0.0, 0.0)) == pytest.approx((0.001, -0.002, -0.003))


def test_a_turn_of_the_base_leaves_a_wall_as_it_is() -> None:
    wall = SupportFrame.of_wall((1.0, 0.0, 0.0), math.pi)
    off = misplacement(Truth(arm_base_yaw=0.1), (0.2, 0.3, 1.0), wall)
    assert off.place((0.5, 0.6, 0.0)) == pytest.approx((0.5, 0.6, 0.0))


def test_the_measured_tip_starts_as_believed_and_the_true_one_is_off() -> None:
    believed = planar_cell(PLAN).arms[0].read().tip
    cell = planar_cell(with_truth(BASE_YAW))
    assert cell.arms[0].read().tip.position == pytest.approx(believed.position)
    assert cell.witness is not None
    (true,) = cell.witness.observe().tips
    off = misplacement(BASE_YAW, PLAN.query.scene.bases[0], TABLE)
    assert true.position == pytest.approx(off.place(believed.position))
    assert math.dist(true.position, believed.position) > 0.002


def test_a_delay_of_less_than_half_a_tick_changes_nothing() -> None:
    """The wrapped tips are the tips, to the bit."""
    exact = run(PLAN).arrays
    wrapped = run(with_truth(Truth(command_delay=1e-6))).arrays
    for name in ("object_pose", "tip_position", "measured_force", "command_force"):
        np.testing.assert_array_equal(exact[name], wrapped[name])


def test_commands_are_executed_ticks_later() -> None:
    period = PLAN.query.motion.control_period
    exact = run(PLAN).arrays["tip_position"]
    ticks = 5
    late = run(with_truth(Truth(command_delay=ticks * period))).arrays["tip_position"]
    moving = slice(100, 200)  # before the touch
    shifted = slice(100 + ticks, 200 + ticks)
    gone = exact[moving][-1] - exact[moving][0]
    assert np.linalg.norm(gone) > 0.005
    np.testing.assert_allclose(late[shifted], exact[moving], atol=3e-4)


def test_a_push_survives_a_base_and_late_commands() -> None:
    truth = replace(BASE_YAW, command_delay=0.008, missed_ticks=0.05)
    plan = with_truth(truth)
    record = run(plan, RunOptions(seed=1))
    end = record.arrays["object_pose"][-1]
    goal = plan.task.goal
    assert math.dist(end[:2], goal.position) < plan.task.tolerance.position


@pytest.mark.parametrize(
    ("field", "value", "shown"),
    [
        ("encoder_bias", 0.01, "truth.encoder_bias_deg"),
        ("link_mass", 1.1, "truth.link_mass"),
        ("coulomb_friction", 0.03, "truth.coulomb_friction"),
        ("viscous_friction", 0.03, "truth.viscous_friction"),
        ("torque_scale", 0.1, "truth.torque_scale"),
        ("torque_ripple", 0.1, "truth.torque_ripple"),
        ("backlash", 0.001, "truth.backlash_deg"),
    ],
)
def test_what_only_joints_have_is_refused_and_can_be_dropped(
    field: str, value: float, shown: str
) -> None:
    truth = replace(BASE_YAW, **{field: value})
    with pytest.raises(TaskError, match=shown):
        planar_cell(with_truth(truth))
    planar_cell(with_truth(truth.for_tips()))
