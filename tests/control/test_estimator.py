"""Estimates of the object: the default estimator, and another one in its place."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import pytest

import pushpressslide as pps
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.controller import Controller
from pushpressslide.control.estimator import (
    NO_TWIST,
    ONE_CONTACT,
    Estimate,
    EstimatorState,
    ObjectEstimator,
    Observation,
    _turn_arm,
    pose_gain,
    stamped,
)
from pushpressslide.control.following import Prediction
from pushpressslide.control.hand_eye import HandEye
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.control.state import ControllerState
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing, Task
from pushpressslide.core.wrench import Twist
from pushpressslide.identification.center import CenterState, Window
from pushpressslide.identification.online import AxleState
from pushpressslide.identification.parameter import Parameter
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
    beside = ["object.center_of_mass=[0.013, 0.007]"]
    estimator, state = seen_at(pps.load_task("rear-push-rear", beside), NOISY.start)
    for i in range(50):
        measured = Pose2(0.41 + 0.0137 * i, 0.23 - 0.0071 * i, 0.1 + 0.0311 * i)
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
    assert anew.center == before.center.carry_over(found)
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
    plan = pps.plan(pps.load_task(name, ["motion.control_period=0.01"]))
    record = run_loop(planar_cell(plan), plan, RunOptions(estimator=LowPass))
    assert record.reason == "goal_reached"
    assert LowPass.made == len(plan.placements)
    # from the touch to the end of the last placement
    assert 0 < LowPass.ticks <= len(record.arrays["time"])


def test_a_pose_is_predicted_about_the_centre_of_mass() -> None:
    """Also by a turn, and by a twist that is given of another point."""
    task = pps.load_task("rear-push-rear", ["sensing.position_noise=0.001"])
    estimator, state = seen_at(task, task.start)
    X_GB = task.object.X_GB
    X_WB = task.start.compose(X_GB)
    w = 0.5
    for about in ((0.0, 0.0), (0.05, -0.02)):
        # at the centre of mass (0.1, 0.02) m/s, whatever the point
        led = Twist(0.1 - w * about[1], 0.02 + w * about[0], w, about)
        estimate, _ = estimator.step(state, observed(DT, None, led))
        body = estimate.X_WG.compose(X_GB)
        assert body.yaw == pytest.approx(X_WB.yaw + w * DT)
        moved = X_WB.unrotate((body.x - X_WB.x, body.y - X_WB.y))
        assert moved == pytest.approx((0.1 * DT, 0.02 * DT), abs=1e-5)


def test_a_measured_yaw_corrects_by_the_same_share() -> None:
    estimator, state = seen_at(NOISY, NOISY.start)
    start = NOISY.start.compose(NOISY.object.X_GB)
    turned = Pose2(start.x, start.y, start.yaw + 0.01)
    seen = turned.compose(NOISY.object.X_GB.inverse())
    estimate, _ = estimator.step(state, observed(DT, seen))
    gain = pose_gain(NOISY.sensing)
    assert estimate.X_WG.yaw == pytest.approx(start.yaw + 0.01 * gain)


def test_the_first_estimate_is_the_pose_that_was_seen() -> None:
    for task in (NOISY, pps.load_task("rear-push-rear")):
        estimator = ObjectEstimator(task.query)
        start = estimator.start(StampedPose(0.0, NOISY.start))
        unseen, _ = estimator.step(start, observed(DT, None, FORWARD))
        assert NOISY.start == unseen.X_WG
        assert unseen.age == DT
        there = Pose2(0.3, 0.2, 0.1)
        seen, _ = estimator.step(start, observed(DT, there, FORWARD))
        assert there == seen.X_WG
        assert seen.twist == FORWARD
        assert seen.time == DT


def test_the_gain_falls_with_the_square_of_whichever_noise_is_larger() -> None:
    """A fifth of a millimetre and a twelfth of a degree of noise are left."""
    yaw = math.radians(0.16)
    assert pose_gain(Sensing(yaw_noise=yaw)) == pytest.approx(0.25)
    assert pose_gain(Sensing(yaw_noise=yaw, position_noise=5e-4)) == pytest.approx(0.16)
    assert pose_gain(Sensing(yaw_noise=yaw, position_noise=2e-4)) == pytest.approx(0.25)
    assert pose_gain(Sensing(yaw_noise=1.0)) == pytest.approx(0.1)


@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide"])
def test_only_an_object_that_is_driven_tells_of_itself(name: str) -> None:
    task = pps.load_task(name)
    plan = pps.plan(task)
    made = Controller(plan)
    (contact,) = plan.segments[0].contacts
    X_WB = plan.segments[0].body_pose(0.0)
    tip = TipState((*X_WB.apply(contact.point), 0.05), (0, 0, 0), (1.0, 0.5, -9.0))
    state = made.init(Measurement(0.0, task.start, (tip,)))
    estimator = ObjectEstimator(task.query)
    begun = estimator.start(StampedPose(0.0, task.start))
    ends = {}
    for driven in (False, True):
        known = begun
        for i in range(1, 40):
            X_WG = task.start.compose(Pose2(0.001 * i, 0.0, 0.002 * i))
            _, known = estimator.step(
                known,
                Observation(
                    i * DT,
                    StampedPose(i * DT, X_WG),
                    FORWARD,
                    driven,
                    (tip,),
                    state.following.binding,
                    state.following.prediction,
                ),
            )
        ends[driven] = (known.axle, known.center)
    assert ends[False] == (begun.axle, begun.center)
    assert ends[True] != ends[False]


def test_a_pose_has_its_own_time_or_that_of_the_measurement() -> None:
    tip = TipState((0, 0, 0), (0, 0, 0), (0, 0, 0))
    pose = Pose2(0.1, 0.2, 0.3)
    assert stamped(Measurement(5.0, pose, (tip,))) == StampedPose(5.0, pose)
    late = Measurement(5.0, pose, (tip,), pose_time=0.0)
    assert stamped(late) == StampedPose(0.0, pose)


def begun(
    made: Controller, task: Task, driven: bool = True
) -> tuple[ControllerState, Observation, EstimatorState]:
    """State of a controller at its first tick, what it observes, and the state of its
    estimator after it.
    """
    tip = TipState((0, 0, 0), (0, 0, 0), (0, 0, 0))
    state = made.init(Measurement(0.0, task.start, (tip,)))
    observation = observed(0.0)._replace(
        binding=state.following.binding, tips=(tip,), driven=driven
    )
    _, known = made.estimator.step(state.estimator, observation)
    return state, observation, known


@pytest.mark.parametrize(
    "name", ["rear-push-rear", "push-t", "press-slide", "post", "l-shape", "book"]
)
def test_a_contact_turns_an_object_as_its_planned_axle_moves(name: str) -> None:
    """The axle moves along its heading whatever the curvature of its path."""
    skewed = 0
    for segment in pps.plan(pps.load_task(name)).segments:
        if not isinstance(segment.drive, ONE_CONTACT):
            continue
        place = segment.contacts[0].point
        a, b = _turn_arm(segment, place)
        ex, ey = segment.X_BV.rotate((1.0, 0.0))
        x, y = place
        for curvature in (-3.0, 0.0, 5.0):
            dx = ex - curvature * (y - segment.X_BV.y)
            dy = ey + curvature * (x - segment.X_BV.x)
            assert a * dy - b * dx == pytest.approx(curvature)
        cx, cy = segment.drive.center
        line = math.atan2(y - cy, x - cx) + segment.drive.skew
        assert math.remainder(math.atan2(b, a) - line, 2.0 * math.pi) == pytest.approx(
            0.0, abs=1e-9
        )
        skewed += abs(segment.drive.skew) > 0.2
    assert (skewed > 0) == (name in ("post", "l-shape"))


def test_a_centre_known_across_the_push_narrows_the_line_to_it() -> None:
    """One that is known along the push does not."""
    sets = ["sensing.pose_rate=30", "sensing.position_noise=0.001"]
    task = pps.load_task("rear-push-rear", [*sets, "belief.center_error=0.02"])
    plan = pps.plan(task)
    (contact,) = plan.segments[0].contacts
    X_GB = plan.query.X_GB
    lever = math.hypot(*contact.point)
    ex, ey = X_GB.rotate((contact.point[0] / lever, contact.point[1] / lever))
    before = CenterBelief.before_run(task.scene)
    x, y = before.place
    errors = []
    for direction in (None, (ex, ey), (-ey, ex)):
        known = before
        if direction is not None:
            value = x * direction[0] + y * direction[1]
            known = before.knowing(Parameter(value, 1e-3, 0.0, direction))
        made = Controller(plan)
        made.know_center(known)
        _, _, state = begun(made, task, driven=False)
        assert state.filtered is not None
        errors.append(state.filtered.filter.line(state.filtered.state)[1])
    unknown, along, across = errors
    assert along == pytest.approx(unknown)
    assert 0.4 * unknown < across < 0.7 * unknown


@pytest.mark.parametrize("off", [(0.004, -0.003), (0.03, -0.02)])
def test_a_tip_that_pushed_is_known_where_it_is_seen_in_the_next_placement(
    off: tuple[float, float],
) -> None:
    """The object is seen beside where the tip is measured to touch it, and moves with the
    tip. One that is farther off than arm and camera may be has slid over the object.
    """
    task = pps.load_task(
        "rear-push-rear", ["sensing.pose_rate=30", "sensing.position_noise=0.001"]
    )
    plan = pps.plan(task)
    made = Controller(plan)
    first = plan.segments[0]
    (contact,) = first.contacts
    radius = task.robots[0].tip_radius
    place, _ = contact.tip_place(radius)
    X_WB = first.body_pose(0.0)
    x, y = X_WB.apply(place)
    tip = TipState((x - off[0], y - off[1], 0.05), (0, 0, 0), (1.0, 0.5, 0.0))
    state = made.init(Measurement(0.0, task.start, (tip,)))
    assert made.seen_tip(state) is None
    known = state.estimator
    for i in range(1, 500):
        ahead = 0.05 * DT * i
        X_WG = Pose2(task.start.x + ahead, task.start.y, task.start.yaw)
        moved = replace(tip, position=(x - off[0] + ahead, y - off[1], 0.05))
        _, known = made.estimator.step(
            known,
            Observation(
                i * DT,
                StampedPose(i * DT, X_WG) if i % 8 == 0 else None,
                FORWARD,
                True,
                (moved,),
                state.following.binding,
                state.following.prediction,
            ),
        )
    seen = made.seen_tip(state._replace(estimator=known))
    if not HandEye(off).plausible:
        assert seen is None
        return
    assert seen is not None
    arm, hand_eye = seen
    assert arm == contact.arm
    assert hand_eye.offset == pytest.approx(off, abs=1.5e-3)
    after = Controller(plan)
    after.know_tips({arm: hand_eye})
    begun = after.init(Measurement(0.0, task.start, (tip,)))
    estimate, _ = after.estimator.step(
        begun.estimator,
        Observation(
            DT,
            None,
            FORWARD,
            False,
            (tip,),
            begun.following.binding,
            begun.following.prediction,
        ),
    )
    assert estimate.tip_error == hand_eye.offset


@pytest.mark.parametrize("lets_go", [False, True])
def test_a_tip_touched_beside_where_it_is_followed(lets_go: bool) -> None:
    """It is followed where a replan has put its contact. Where it has touched is known
    after it has let go, as well.
    """
    sets = ["sensing.pose_rate=30", "sensing.position_noise=0.001"]
    task = pps.load_task("rear-push-rear", sets)
    plan = pps.plan(task)
    made = Controller(plan)
    _, observation, state = begun(made, task)
    filtered = state.filtered
    assert filtered is not None
    X_GB = plan.query.X_GB
    radius = task.robots[0].tip_radius
    along = X_GB.rotate((0.0, 1.0))
    assert filtered.touch_offset(along, X_GB, radius) == (0.0, 0.0)
    mean = filtered.state.mean._replace(ox=0.003 * along[0], oy=0.003 * along[1])
    filtered = filtered._replace(state=filtered.state._replace(mean=mean))
    seen = StampedPose(0.02, task.start.compose(Pose2(1e-4, 0.0, 0.0)))
    filtered = filtered.step(observation._replace(time=0.02, pose=seen), 0.02)
    before, unsure = filtered.touch_offset(along, X_GB, radius)
    assert before == pytest.approx(0.003, abs=5e-4)
    assert 0.0 < unsure < 0.005
    if lets_go:
        away = observation._replace(
            time=0.04, driven=False, disturbed=True, lets_go=True
        )
        filtered = filtered.step(away, 0.02)
        assert filtered.state.mean.ox == filtered.state.mean.oy == 0.0
    (contact,) = filtered.segment.contacts
    aside = (contact.point[0], contact.point[1] + 0.005)
    elsewhere = replace(filtered.segment, contacts=(replace(contact, point=aside),))
    off, _ = filtered._replace(segment=elsewhere).touch_offset(along, X_GB, radius)
    assert off == pytest.approx(before - 0.005)


def test_a_line_is_told_by_pictures_alone() -> None:
    """One that is known from placements before is not told again."""
    sets = ["sensing.pose_rate=30", "sensing.position_noise=0.001"]
    task = pps.load_task("rear-push-rear", [*sets, "belief.center_error=0.02"])
    plan = pps.plan(task)
    made = Controller(plan)
    center = CenterBelief.before_run(task.scene)
    made.know_center(center._replace(xx=1e-6, yy=1e-6))
    first, _, state = begun(made, task)
    filtered = state.filtered
    assert filtered is not None
    assert not filtered.tells_line
    known = first._replace(
        estimator=state._replace(center=state.center._replace(off=0.02))
    )
    assert "center_of_mass" not in made.identified(known, task.scene).parameters
    P = filtered.state.covariance.copy()
    P[3:5, 3:5] *= 0.25
    narrowed = filtered._replace(state=filtered.state._replace(covariance=P))
    assert narrowed.tells_line
    surer = state.center._replace(off=0.02)
    known = first._replace(estimator=state._replace(filtered=narrowed, center=surer))
    assert "center_of_mass" in made.identified(known, task.scene).parameters


def test_of_two_tips_one_that_has_lost_the_object_does_not_turn_it() -> None:
    task = pps.load_task("parallel-push", ["sensing.pose_rate=30"])
    made = Controller(pps.plan(task))
    first = made.segments[0]
    X_WB = first.body_pose(0.0)
    places = [c.tip_place(task.robots[c.arm].tip_radius)[0] for c in first.contacts]
    tips = [
        TipState((*X_WB.apply(place), 0.05), (0, 0, 0), (1.0, 0.0, 0.0))
        for place in places
    ]
    by_arm = [tips[0]] * len(task.robots)
    for contact, tip in zip(first.contacts, tips, strict=True):
        by_arm[contact.arm] = tip
    state = made.init(Measurement(0.0, task.start, tuple(by_arm)))
    arm = first.contacts[1].arm

    def seen(unfelt: tuple[int, ...], picture: StampedPose | None = None) -> Estimate:
        """Estimate after the second tip has gone ahead by 20 mm in half a second, and
        a picture then.
        """
        known = state.estimator
        for i in range(1, 51):
            x, y, z = tips[1].position
            ahead = 4e-4 * i
            moved = list(by_arm)
            moved[arm] = replace(tips[1], position=(x + ahead, y, z))
            estimate, known = made.estimator.step(
                known,
                Observation(
                    i * DT,
                    picture if i == 50 else None,
                    FORWARD,
                    True,
                    tuple(moved),
                    state.following.binding,
                    state.following.prediction,
                    unfelt=unfelt,
                ),
            )
        return estimate

    turned = math.atan(0.02 / math.dist(*places))
    led, unled = seen(()), seen((1,))
    assert abs(led.X_WG.yaw - task.start.yaw) == pytest.approx(turned, rel=0.2)
    assert unled.X_WG.yaw == pytest.approx(task.start.yaw, abs=1e-9)
    # it goes with the tip that is felt, if there is one
    for unfelt, gone in (((1,), 0.0), ((0,), 0.02), ((0, 1), 0.0)):
        X_WG = seen(unfelt).X_WG
        assert X_WG.x - task.start.x == pytest.approx(gone, abs=2e-3)
    # something has turned it: a picture of that is used, and does not count as wrong
    pose = replace(task.start, yaw=task.start.yaw - math.radians(4.0))
    picture = StampedPose(50 * DT, pose)
    assert seen((1,), picture).age == 0.0
    assert seen((), picture).age > 0.0
