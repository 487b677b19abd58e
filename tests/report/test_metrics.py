"""Laws of the figures, on runs whose figures are known."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.report import series
from pushpressslide.report.metrics import result
from pushpressslide.robots.facts import load_facts


def figures(run):
    return result(run.task, run.plan, run.record, {"python": "3"})


def test_a_perfect_run_has_no_errors(run):
    out = figures(run)
    assert out["success"] is True
    assert out["reason"]["code"] == "goal_reached"
    for name in (
        "final_position_error",
        "final_yaw_error",
        "rms_position_error",
        "rms_yaw_error",
        "rms_end_effector_error",
        "contact_loss_time",
        "cone_violation_fraction",
        "slip_distance",
    ):
        assert out[name] == pytest.approx(0.0, abs=1e-9), name
    assert out["path_rms_error"] < 1e-6  # of the chords between the path's samples
    assert out["path_length"] == pytest.approx(0.3, rel=1e-5)
    assert out["max_normal_force"] == pytest.approx(3.0)
    assert out["duration"] == pytest.approx(4.49)
    assert out["motion_duration"] == pytest.approx(3.99)
    assert out["realtime_factor"] == pytest.approx(4.49 / 0.5)


def test_a_constant_offset_is_its_own_rms(run):
    pose = run.record.arrays["object_pose"] + (0.003, -0.004, 0.02)
    out = figures(run.with_arrays(object_pose=pose))
    assert out["rms_position_error"] == pytest.approx(0.005)
    assert out["max_position_error"] == pytest.approx(0.005)
    assert out["rms_yaw_error"] == pytest.approx(0.02)
    assert out["final_position_error"] == pytest.approx(0.005)
    assert out["final_yaw_error"] == pytest.approx(0.02)
    assert math.hypot(*out["final_error_xy"]) == pytest.approx(0.005)


def test_whole_turns_of_yaw_are_no_error(run):
    pose = run.record.arrays["object_pose"] + (0.0, 0.0, 2.0 * math.pi)
    task = replace(
        run.task,
        goal=Pose2(run.task.goal.x, run.task.goal.y, run.task.goal.yaw - 4.0 * math.pi),
    )
    out = figures(replace(run.with_arrays(object_pose=pose), task=task))
    assert out["success"]
    assert out["rms_yaw_error"] == pytest.approx(0.0, abs=1e-9)
    assert -math.pi < out["final_pose"][2] <= math.pi


def test_a_tip_that_is_off_shows_in_the_end_effector_error_alone(run):
    tip = run.record.arrays["tip_position"] + (0.0, 0.002, 0.0)
    out = figures(run.with_arrays(tip_position=tip))
    assert out["rms_end_effector_error"] == pytest.approx(0.002)
    assert out["rms_position_error"] == pytest.approx(0.0, abs=1e-12)


def test_the_path_error_ignores_where_along_the_path_the_object_is(run):
    late = np.roll(run.record.arrays["object_pose"], 5, axis=0)
    late[:5] = run.record.arrays["object_pose"][0]
    out = figures(run.with_arrays(object_pose=late))
    assert out["rms_position_error"] > 1e-3
    assert out["path_rms_error"] < 1e-6


def test_a_goal_that_is_reached_outside_the_tolerance_is_missed(run):
    pose = run.record.arrays["object_pose"] + (0.0, 0.0213, 0.0)
    out = figures(run.with_arrays(object_pose=pose))
    assert out["success"] is False
    assert out["reason"]["code"] == "goal_missed"
    assert "21.3 mm" in out["reason"]["text"]
    assert "10 mm" in out["reason"]["text"]


def test_a_run_that_ended_early_keeps_its_reason_even_at_the_goal(run):
    out = figures(
        run.with_record(reason="time_limit", reason_text="limits.time of 4 s is over")
    )
    assert out["success"] is False
    assert out["reason"] == {"code": "time_limit", "text": "limits.time of 4 s is over"}


def test_nan_becomes_null_and_the_result_is_strict_json(run):
    pose = run.record.arrays["object_pose"].copy()
    pose[-1] = np.nan
    out = figures(
        run.with_arrays(object_pose=pose).with_record(reason="diverged", wall_time=0.0)
    )
    assert out["final_position_error"] is None
    assert out["realtime_factor"] is None
    assert out["success"] is False
    json.dumps(out, allow_nan=False)


def test_a_run_without_a_contact_phase_has_null_figures(run):
    out = figures(
        run.with_arrays(phase=np.zeros(len(run.record.arrays["time"]))).with_record(
            reason="interrupted"
        )
    )
    assert out["rms_position_error"] is None
    assert out["motion_duration"] == 0.0
    json.dumps(out, allow_nan=False)


def test_a_record_without_ticks_has_every_field_all_the_same(run):
    kept = {name: run.record.arrays[name] for name in ("plan_path", "plan_stretch")}
    out = figures(
        replace(run, record=replace(run.record, arrays=kept, reason="interrupted"))
    )
    assert set(figures(run)) == set(out)
    assert out["success"] is False
    json.dumps(out, allow_nan=False)


def test_planar_runs_have_no_joint_figures(run):
    out = figures(run)
    assert out["torque_limit_violation_fraction"] is None
    assert out["max_torque_share"] is None
    assert out["joint_limit_margin"] is None
    assert out["max_tilt_deg"] is None
    assert out["tick_us"]["execute"] is None
    assert out["tick_us"]["track"]["median"] == pytest.approx(10.0)


def test_ticks_that_take_longer_than_their_period_are_counted(run):
    total = np.zeros(len(run.record.arrays["time"]))
    period = run.plan.task.motion.control_period
    assert figures(run.with_arrays(tick_total=total))["late_ticks"] == 0
    total[[0, 3]] = 1.01 * period
    assert figures(run.with_arrays(tick_total=total))["late_ticks"] == 2


def test_joint_figures_are_held_to_the_makers_limits(arm_run):
    facts = load_facts("panda")
    out = figures(arm_run)
    assert out["torque_limit_violation_fraction"] == pytest.approx(0.1)
    assert out["max_torque_share"] == arm_run.record.arrays["torque_share_0"].max()
    margin = np.minimum(facts.home - facts.lower, facts.upper - facts.home).min()
    assert out["joint_limit_margin"] == pytest.approx(margin)
    assert out["max_tilt_deg"] == pytest.approx(0.0, abs=1e-5)


def test_every_body_that_can_move_is_listed_with_its_displacement(arm_run):
    bodies = figures(arm_run)["bodies"]
    assert set(bodies) == {"object", "post"}
    assert bodies["post"]["displacement"] == pytest.approx(0.05)
    assert bodies["post"]["final_pose"] == pytest.approx([0.33, 0.34, 0.3])


def test_lost_contact_is_counted_in_seconds_and_regained_contact_too(run):
    force = run.record.arrays["measured_force"].copy()
    (at,) = np.nonzero(run.move)
    force[at[100:130]] = 0.0
    assert figures(run.with_arrays(measured_force=force))[
        "contact_loss_time"
    ] == pytest.approx(0.30)
    phase = run.record.arrays["phase"].copy()
    phase[at[110:130]] = 1  # the controller went back to touch
    assert figures(run.with_arrays(measured_force=force, phase=phase))[
        "contact_loss_time"
    ] == pytest.approx(0.30)


@pytest.mark.parametrize(("share", "outside"), [(0.99, 0.0), (1.01, 0.0), (1.03, 0.25)])
def test_the_cone_is_that_of_the_true_friction_within_two_percent(run, share, outside):
    force = run.record.arrays["measured_force"].copy()
    (at,) = np.nonzero(run.move)
    for k in at[: len(at) // 4]:
        yaw = run.record.arrays["object_pose"][k, 2]
        force[k, 0, :2] = Pose2(0.0, 0.0, yaw).rotate(
            (3.0, share * run.task.contact_friction * 3.0)
        )
    assert figures(run.with_arrays(measured_force=force))[
        "cone_violation_fraction"
    ] == pytest.approx(outside)


def test_a_fixed_contact_that_jitters_does_not_slip(run):
    noise = np.random.default_rng(1).uniform(
        -4e-5, 4e-5, run.record.arrays["tip_position"].shape
    )
    out = figures(
        run.with_arrays(tip_position=run.record.arrays["tip_position"] + noise)
    )
    assert out["slip_distance"] < 1e-4


def test_a_steady_slide_along_the_face_is_measured_but_for_the_play(run):
    tip = run.record.arrays["tip_position"].copy()
    (at,) = np.nonzero(run.move)
    for share, k in zip(np.linspace(0.0, 1.0, len(at)), at, strict=True):
        yaw = run.record.arrays["object_pose"][k, 2]
        tip[k, 0, :2] += Pose2(0.0, 0.0, yaw).rotate((0.0, 0.01 * share))
    assert figures(run.with_arrays(tip_position=tip))["slip_distance"] == pytest.approx(
        0.01, abs=1.5e-4
    )


def test_where_the_tip_lands_after_a_loss_is_no_slip(run):
    tip = run.record.arrays["tip_position"].copy()
    force = run.record.arrays["measured_force"].copy()
    (at,) = np.nonzero(run.move)
    force[at[200:210]] = 0.0
    tip[at[205:]] += (0.0, 0.01, 0.0)
    out = figures(run.with_arrays(tip_position=tip, measured_force=force))
    assert (
        out["slip_distance"] < 5e-3
    )  # the offset is constant in the world, so it turns a little in the object


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.01))
def test_travel_with_play_never_exceeds_the_way_that_was_gone(seed, play):
    points = np.cumsum(np.random.default_rng(seed).normal(0.0, 1e-3, (60, 2)), axis=0)
    assert np.all(series.travel(points, play) <= series.travel(points) + 1e-12)
    assert np.all(np.diff(series.travel(points, play)) >= 0.0)


def test_the_distance_to_a_polyline_is_that_to_its_nearest_point():
    line = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    points = np.array([[0.5, 0.2], [1.3, 0.5], [-0.3, 0.4], [1.0, 1.5], [0.9, 0.1]])
    assert series.distance_to_polyline(points, line) == pytest.approx(
        [0.2, 0.3, 0.5, 0.5, 0.1]
    )


def test_a_press_is_measured_downwards(run):
    contact = replace(
        run.plan.contacts[0], kind="top", point=(0.0, 0.0), normal=(0.0, 0.0)
    )
    plan = run.with_contacts(contact).plan
    force = run.record.arrays["measured_force"].copy()
    force[run.move, 0] = (1.0, 2.0, -10.0)
    normals, tangents = series.contact_forces(
        plan, run.with_arrays(measured_force=force).record
    )
    assert normals[run.move, 0] == pytest.approx(10.0)
    assert np.linalg.norm(tangents[run.move, 0], axis=1) == pytest.approx(
        math.sqrt(5.0)
    )


def test_segments_are_held_each_to_its_own_path_and_tracking_point(pressed):
    out = figures(pressed)
    assert out["success"]
    assert out["path_rms_error"] < 1e-6
    # to turn on the spot is no way
    assert out["path_length"] == pytest.approx(0.3, rel=1e-5)
    assert out["planned"]["path_length"] == pytest.approx(0.3)
    assert out["planned"]["motion_duration"] == sum(
        p.profile.duration for p in pressed.plan.segments
    )
    assert out["planned"]["friction_margin"] == 0.05  # the least of its segments
    swapped = 1.0 - pressed.record.arrays["stretch"]
    assert figures(pressed.with_arrays(stretch=swapped))["path_rms_error"] > 0.01


def test_each_press_is_measured_by_its_own_arm(pressed, presses):
    for contact, (arm, _, load, shear) in zip(
        figures(pressed)["contacts"], presses, strict=True
    ):
        assert (contact["arm"], contact["kind"], contact["load"]) == (arm, "top", load)
        assert contact["max_normal_force"] == pytest.approx(load)
        assert contact["mean_normal_force"] == pytest.approx(load)
        mu = pressed.task.contact_friction
        assert contact["mean_friction_use"] == pytest.approx(
            math.hypot(*shear) / (mu * load)
        )
        assert contact["slip_distance"] == pytest.approx(0.0, abs=1e-9)
    out = figures(pressed)
    assert out["max_normal_force"] == pytest.approx(10.0)
    assert out["contact_loss_time"] == 0.0
    assert out["rms_end_effector_error"] == pytest.approx(0.0, abs=1e-9)


def test_a_force_above_its_limit_is_a_fault_unless_the_arms_stopped(pressed):
    limit = pressed.task.limits.normal_force
    force = pressed.record.arrays["measured_force"].copy()
    (at,) = np.nonzero(pressed.move)
    force[at[-25:], 0, 2] = -1.1 * limit
    broken = pressed.with_arrays(measured_force=force)
    out = figures(broken)
    assert not out["success"]
    assert out["reason"]["code"] == "force_limit"
    assert out["max_force_without_stop"] == pytest.approx(1.1 * limit)
    noticed = float(pressed.record.arrays["time"][at[-25]]) + 0.02
    breach = {"time": noticed, "code": "force_limit", "text": ""}
    stopped = replace(broken.record, meta={"breaches": [breach]})
    out = result(broken.task, broken.plan, stopped)
    assert out["success"]
    assert out["max_force_without_stop"] < limit
    assert out["max_mean_normal_force"] == pytest.approx(1.1 * limit)


def test_what_one_arm_loses_is_not_put_down_to_the_other(pressed):
    force = pressed.record.arrays["measured_force"].copy()
    (at,) = np.nonzero(pressed.move)
    force[at[100:130], 0] = 0.0
    force[at[:40], 1, 2] = -1.0  # pressed too lightly for its shear
    out = figures(pressed.with_arrays(measured_force=force))
    one, nought = out["contacts"]
    assert (one["contact_loss_time"], nought["contact_loss_time"]) == pytest.approx(
        (0.0, 0.3)
    )
    assert (
        one["cone_violation_fraction"],
        nought["cone_violation_fraction"],
    ) == pytest.approx((0.1, 0.0))


def test_an_arm_without_a_contact_counts_for_nothing(pressed):
    one = pressed.with_contacts(pressed.plan.contacts[0])
    rng = np.random.default_rng(2)
    changed = {
        n: one.record.arrays[n].copy()
        for n in ("measured_force", "tip_position", "command_force")
    }
    for values in changed.values():
        values[:, 0] = rng.normal(0.0, 50.0, values[:, 0].shape)
    changed["command_force"][:, 0] = np.nan
    assert [contact["arm"] for contact in figures(one)["contacts"]] == [1]
    assert figures(one.with_arrays(**changed)) == figures(one)


def test_a_press_that_slides_on_the_top_slips_in_the_objects_frame(pressed):
    tip = pressed.record.arrays["tip_position"].copy()
    (at,) = np.nonzero(pressed.move)
    for share, k in zip(np.linspace(0.0, 1.0, len(at)), at, strict=True):
        yaw = pressed.record.arrays["object_pose"][k, 2]
        tip[k, 1, :2] += Pose2(0.0, 0.0, yaw).rotate((0.006 * share, 0.008 * share))
    slips = [
        c["slip_distance"]
        for c in figures(pressed.with_arrays(tip_position=tip))["contacts"]
    ]
    assert slips == pytest.approx([0.01, 0.0], abs=1.5e-4)
