"""One tick of the motion: track, allocate, regulate."""

from __future__ import annotations

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.adaptation import Adaptation
from pushpressslide.control.controller import Controller
from pushpressslide.control.law import CATCH_UP, Decision
from pushpressslide.control.state import Instant, tip_position
from pushpressslide.core import margins
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2

STILL = (0.0, 0.0, 0.0)
USUAL = Adaptation()
PROGRESS = 0.05  # [m] of the object on its path


def decided(
    name: str,
    adaptation: Adaptation = USUAL,
    aside: float = 0.0,
    time: float = 1.0,
) -> Decision:
    """What a tick comes to in a shipped task, with the object ``aside`` [m] of its path
    at a ``time`` [s] after the motion began.
    """
    task = pps.load_task(name)
    plan = pps.plan(task)
    controller = Controller(plan)
    segment = plan.segments[0]
    X_WB = segment.body_pose(PROGRESS).compose(Pose2(0.0, aside, 0.0))
    tips = tuple(
        TipState(
            tip_position(contact, X_WB, task.robots[contact.arm].tip_radius),
            STILL,
            STILL,
        )
        for contact in sorted(segment.contacts, key=lambda contact: contact.arm)
    )
    X_WG = X_WB.compose(controller.X_BG)
    state = controller.init(Measurement(0.0, X_WG, tips))
    return controller.law.step(
        state.following._replace(progress=PROGRESS),
        Instant(time, task.motion.control_period, X_WG, X_WB, tips),
        adaptation,
        state.phase.tips,
        lambda: 0.0,
    )


@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide", "parallel-push"])
def test_a_tick_is_a_function_of_what_it_is_given(name: str) -> None:
    assert decided(name) == decided(name)


@pytest.mark.parametrize("name", ["rear-push-rear", "parallel-push"])
def test_contact_forces_that_are_commanded_grow_with_the_effort(name: str) -> None:
    once = decided(name)
    harder = decided(name, Adaptation(force_scale=1.5))
    assert harder.allocation == once.allocation
    for command, before in zip(harder.commands, once.commands, strict=True):
        assert command.force[:2] == pytest.approx([1.5 * f for f in before.force[:2]])


def test_contact_forces_follow_the_drag_that_is_measured() -> None:
    (segment,) = pps.plan(pps.load_task("rear-push-rear")).segments
    planned = segment.drive.max_friction
    once = decided("rear-push-rear")
    (command,) = decided("rear-push-rear", Adaptation(drag=1.2 * planned)).commands
    ratio = margins.drag_ratio(1.2 * planned, planned)
    assert ratio > 1.0
    assert command.force[0] == pytest.approx(ratio * once.commands[0].force[0])


def test_an_object_beside_its_path_is_steered_back_with_the_grip_there_is() -> None:
    left, right = (decided("rear-push-rear", aside=y) for y in (0.1, -0.1))
    assert left.guidance.steering * right.guidance.steering < 0.0
    eased = decided("rear-push-rear", Adaptation(steering_scale=0.4), aside=0.1)
    share = eased.guidance.steering / left.guidance.steering
    assert 0.0 < share < 0.6


def test_an_object_behind_its_time_is_led_faster() -> None:
    task = pps.load_task("rear-push-rear")
    (segment,) = pps.plan(task).segments
    controller = Controller(pps.plan(task))
    resting = Measurement(0.0, task.start, (TipState(STILL, STILL, STILL),))
    following = controller.init(resting).following
    late = segment.profile.duration / 2.0
    there = segment.profile.state_at(late)[0]
    on_time = controller.law.speed(following._replace(progress=there), late)
    behind = controller.law.speed(following._replace(progress=there - 0.01), late)
    assert on_time < behind <= 1.5 * segment.profile.speed


def test_a_goal_at_which_an_object_is_held_is_waited_at() -> None:
    task = pps.load_task("rear-push-rear")
    controller = Controller(pps.plan(task))
    resting = Measurement(0.0, task.start, (TipState(STILL, STILL, STILL),))
    following = controller.init(resting).following
    segment = following.binding.segment
    end = following._replace(progress=segment.path.length)
    law = controller.law
    assert law.speed(end, segment.profile.duration) == law.floor_speed
    waiting = replace(law, waits=True)
    assert waiting.speed(end, segment.profile.duration) == 0.0


def test_times_of_a_tick_are_taken_before_and_after_each_part() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    controller = Controller(plan)
    task = plan.task
    resting = Measurement(0.0, task.start, (TipState(STILL, STILL, STILL),))
    state = controller.init(resting)
    X_WB = plan.segments[0].body_pose(0.0)
    instant = Instant(0.0, 0.004, task.start, X_WB, resting.tips)
    times = iter([10.0, 11.0, 14.0])
    decision = controller.law.step(
        state.following, instant, USUAL, state.phase.tips, lambda: next(times)
    )
    assert decision.wall_times == (1.0, 3.0)


def test_the_speed_follows_the_profile_and_catches_up_in_proportion() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    controller = Controller(plan)
    (segment,) = plan.segments
    resting = Measurement(0.0, plan.task.start, (TipState(STILL, STILL, STILL),))
    following = controller.init(resting).following._replace(clock_start=7.0)
    law = controller.law
    profile = segment.profile
    middle = 0.5 * profile.duration
    there, planned = profile.state_at(middle)
    for behind in (-0.004, 0.0, 0.004):
        speed = law.speed(following._replace(progress=there - behind), 7.0 + middle)
        assert speed == pytest.approx(planned + CATCH_UP * behind)
    assert 0.5 < CATCH_UP < 5.0  # [1/s]
    far = law.speed(following._replace(progress=0.0), 7.0 + middle)
    assert far == pytest.approx(1.5 * profile.speed)
    late = law.speed(following._replace(progress=there + 9.0), 7.0 + middle)
    assert late == law.floor_speed
    assert law.floor_speed == margins.FLOOR_SPEED * plan.task.motion.speed


@pytest.mark.parametrize(("share", "waits"), [(0.9, True), (1.1, False)])
def test_a_goal_is_waited_at_only_where_the_last_path_ends(
    share: float, waits: bool
) -> None:
    plan = pps.plan(pps.load_task("press-slide-car"))
    controller = Controller(plan)
    resting = Measurement(0.0, plan.task.start, (TipState(STILL, STILL, STILL),))
    following = controller.init(resting).following
    law = replace(controller.law, waits=True)
    length = following.binding.segment.path.length
    duration = following.binding.segment.profile.duration
    end = following._replace(progress=length - share * margins.ARM.stop)
    last = end._replace(ahead=())
    assert law.speed(end, duration) > 0.0
    assert (law.speed(last, duration) < 1e-3) == waits


def test_two_pushing_tips_are_held_at_their_contacts_by_a_servo() -> None:
    plan = pps.plan(pps.load_task("parallel-push"))
    controller = Controller(plan)
    (segment,) = plan.segments
    X_WB = segment.body_pose(PROGRESS)
    task = plan.task
    places = {}
    for contact in segment.contacts:
        radius = task.robots[contact.arm].tip_radius
        x, y, z = tip_position(contact, X_WB, radius)
        nx, ny, _ = contact.direction(X_WB)
        # slid far along its face
        places[contact.arm] = (x - 0.02 * ny, y + 0.02 * nx, z)
    tips = tuple(TipState(places[arm], STILL, STILL) for arm in sorted(places))
    X_WG = X_WB.compose(controller.X_BG)
    state = controller.init(Measurement(0.0, X_WG, tips))
    following = state.following._replace(progress=PROGRESS)
    instant = Instant(1.0, 0.004, X_WG, X_WB, tips)

    def velocities(servo: bool) -> list[float]:
        law = replace(controller.law, servo=servo)
        made = law.step(following, instant, USUAL, state.phase.tips, lambda: 0.0)
        along = []
        for contact, command in zip(segment.contacts, made.commands, strict=True):
            nx, ny, _ = contact.direction(X_WB)
            along.append(command.velocity[1] * nx - command.velocity[0] * ny)
        return along

    for led, alone in zip(velocities(True), velocities(False), strict=True):
        assert led < alone
