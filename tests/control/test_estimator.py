"""What is known of the object: our estimator, and another one in its place."""

from __future__ import annotations

import math
from typing import NamedTuple

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.estimator import (
    NO_TWIST,
    Estimate,
    EstimatorState,
    ObjectEstimator,
    Observation,
    pose_gain,
)
from pushpressslide.control.following import Prediction
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing, Task
from pushpressslide.core.wrench import Twist
from pushpressslide.identification.center import CenterState, Window
from pushpressslide.identification.online import AxleState
from pushpressslide.modes import MODES
from pushpressslide.planar.cell import planar_cell

DT = 0.01
NOISY = pps.load_task("rear-push-rear", ["sensing.position_noise=0.001"])
PLAN = pps.plan(NOISY)
STATE = Controller(PLAN).init(
    Measurement(0.0, NOISY.start, (TipState((0, 0, 0), (0, 0, 0), (0, 0, 0)),))
)
FORWARD = Twist(0.1, 0.0, 0.0)


def observed(
    time: float,
    pose: Pose2 | None = None,
    led: Twist = NO_TWIST,
    prediction: Prediction | None = None,
) -> Observation:
    """What is observed in the touch: of an object that nothing drives."""
    return Observation(
        time,
        None if pose is None else StampedPose(time, pose),
        led,
        False,
        (),
        STATE.following.binding,
        prediction or STATE.following.prediction,
    )


def seen_at(task: Task, pose: Pose2) -> tuple[ObjectEstimator, EstimatorState]:
    """Our estimator after one tick at time 0."""
    estimator = ObjectEstimator(task.query)
    state = estimator.start(StampedPose(0.0, pose))
    estimate, state = estimator.step(state, observed(0.0, pose))
    assert pose == estimate.X_WG
    return estimator, state


def test_without_noise_a_measured_pose_is_the_estimate_to_the_bit() -> None:
    estimator, state = seen_at(pps.load_task("rear-push-rear"), NOISY.start)
    measured = Pose2(0.41, 0.23, 0.1)
    estimate, _ = estimator.step(state, observed(DT, measured, FORWARD))
    assert measured == estimate.X_WG


def test_with_noise_a_share_of_what_is_off_corrects_the_predicted_pose() -> None:
    start = NOISY.start
    estimator, state = seen_at(NOISY, start)
    there = Pose2(start.x + 0.001, start.y + 0.002, start.yaw)
    estimate, _ = estimator.step(state, observed(DT, there, FORWARD))
    # it was led to x + 0.001
    gain = pose_gain(NOISY.sensing)
    assert 0.0 < gain < 1.0
    assert estimate.X_WG.x == pytest.approx(there.x)
    assert estimate.X_WG.y == pytest.approx(start.y + gain * 0.002)


def test_a_pose_that_nobody_saw_is_where_the_object_was_led_and_grows_old() -> None:
    start = NOISY.start
    estimator, state = seen_at(NOISY, start)
    for tick in (1, 2, 3):
        estimate, state = estimator.step(state, observed(tick * DT, None, FORWARD))
        assert estimate.age == pytest.approx(tick * DT)
        assert estimate.X_WG.x == pytest.approx(start.x + tick * DT * FORWARD.vx)
    estimate, _ = estimator.step(state, observed(4 * DT, start))
    assert estimate.age == 0.0


def test_the_gain_falls_with_the_noise_to_a_least_one() -> None:
    assert pose_gain(Sensing()) == 1.0
    gains = [pose_gain(Sensing(position_noise=noise)) for noise in (2e-4, 4e-4, 1.0)]
    assert gains == pytest.approx([1.0, 0.25, 0.1])


def test_a_new_prediction_of_the_axle_forgets_it_but_not_the_drag() -> None:
    task = pps.load_task("press-slide")
    plan = pps.plan(task)
    segment = plan.segments[0]
    first, second = (
        Prediction(MODES[segment.mode].identifier(task.query, segment))
        for _ in range(2)
    )
    estimator, state = seen_at(task, task.start)
    axle = AxleState(task.start, ww=1.0, drag=3.0)
    state = state._replace(axle=axle, prediction=first)
    _, kept = estimator.step(state, observed(DT, task.start, prediction=first))
    assert kept.axle == axle
    estimate, anew = estimator.step(state, observed(DT, task.start, prediction=second))
    assert anew.axle == AxleState(drag=3.0)
    assert estimate.parameters.drag == 3.0


def test_a_new_prediction_of_the_centre_keeps_what_was_found() -> None:
    estimator, state = seen_at(NOISY, NOISY.start)
    before = state.prediction
    assert before.center is not None
    windows = (Window((-0.075, 0.0), (0.05, 0.001, 0.0)),) * 9
    found = CenterState((0.0, 0.01), windows, off=0.01)
    state = state._replace(center=found)
    (segment,) = PLAN.segments
    center = MODES[segment.mode].center_identifier(PLAN.query, segment, found.center)
    other = before._replace(center=center, followed_center=found.center)
    estimate, anew = estimator.step(state, observed(DT, NOISY.start, prediction=other))
    assert anew.center == before.center.onward(found)
    assert estimate.parameters.center == found.center


class Smoothed(NamedTuple):
    """The state of a low-pass."""

    pose: Pose2
    ticks: int = 0


class LowPass:
    """Another estimator: it knows nothing of sensors, plans or pushes."""

    made = 0
    ticks = 0

    def __init__(self, task: Task) -> None:
        LowPass.made += 1

    def start(self, pose: StampedPose) -> Smoothed:
        return Smoothed(pose.X_WG)

    def step(
        self, state: Smoothed, observation: Observation
    ) -> tuple[Estimate, Smoothed]:
        pose = state.pose
        seen = observation.pose
        if seen is not None:
            new = seen.X_WG
            pose = Pose2(
                0.5 * (pose.x + new.x),
                0.5 * (pose.y + new.y),
                pose.yaw + 0.5 * math.remainder(new.yaw - pose.yaw, math.tau),
            )
        LowPass.ticks = state.ticks + 1
        return Estimate(observation.time, pose), Smoothed(pose, LowPass.ticks)


@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide"])
def test_another_estimator_runs_a_shipped_task(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(LowPass, "made", 0)
    monkeypatch.setattr(LowPass, "ticks", 0)
    plan = pps.plan(pps.load_task(name))
    record = run_loop(planar_cell(plan), plan, RunOptions(estimator=LowPass))
    assert record.reason == "goal_reached"
    assert LowPass.made == len(plan.placements)
    # from the touch to the end of the last placement
    assert 0 < LowPass.ticks <= len(record.arrays["time"])
