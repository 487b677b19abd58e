"""The controller's phases on scripted measurements: touch, and drawing back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.execution import Execution
from pushpressslide.control.state import (
    ControllerState,
    Failure,
    contact_yaw,
    enter_phase,
    ramp_time,
    smooth,
    tip_position,
)
from pushpressslide.core import margins
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import (
    ControlLog,
    Measurement,
    TipCommand,
    TipState,
    Vector3,
)
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing

ZERO = (0.0, 0.0, 0.0)
DT = 0.004
PUSH = "rear-push-rear"
PRESS = "press-slide"
PAIR = "parallel-push"
FAILURE: Failure = ("joint_limit", "near")


@cache
def made(name: str) -> Controller:
    return Controller(pps.plan(pps.load_task(name)))


def tips_of(
    controller: Controller,
    pressing: Sequence[float],
    gap: float = 0.0,
    pose: Pose2 | None = None,
) -> tuple[TipState, ...]:
    """Return the tips ``gap`` [m] before their contacts, each ``pressing`` [N]; of the
    contacts in their order.
    """
    query = controller.placement.query
    X_WB = (pose or query.start).compose(controller.X_GB)
    contacts = controller.segments[0].contacts
    robots = query.scene.robots
    tips = [TipState(ZERO, ZERO, ZERO)] * len(robots)
    for contact, force in zip(contacts, pressing, strict=True):
        radius = robots[contact.arm].tip_radius
        place = tip_position(contact, X_WB, radius, gap)
        x, y, z = contact.direction(X_WB)
        tips[contact.arm] = TipState(place, ZERO, (force * x, force * y, force * z))
    return tuple(tips)


def measured(
    name: str, time: float, *pressing: float, pose: Pose2 | None = None
) -> Measurement:
    controller = made(name)
    there = pose or controller.placement.query.start
    return Measurement(time, there, tips_of(controller, pressing, pose=pose))


def stepped(
    controller: Controller, state: ControllerState, now: Measurement
) -> tuple[tuple[TipCommand | None, ...], ControlLog, ControllerState]:
    """Return commands, log and next state of a tick, with its event decided on."""
    step = controller.step(state, now)
    if step.event is None:
        return step.commands, step.log, step.state
    return step.commands, step.log, controller.supervisor.step(step.event)


def touching(name: str) -> ControllerState:
    count = len(made(name).segments[0].contacts)
    return made(name).init(measured(name, 0.0, *[0.0] * count))


@pytest.mark.parametrize("quiet", [None, 0, 1])
def test_a_motion_begins_when_all_tips_have_touched(quiet: int | None) -> None:
    pressing = [3.0, 3.0]
    if quiet is not None:
        pressing[quiet] = 0.0
    state = touching(PAIR)
    names = []
    for i in range(1, 700):
        _, log, state = stepped(made(PAIR), state, measured(PAIR, i * DT, *pressing))
        names.append(log.phase)
    assert ("move" in names) == (quiet is None)
    if quiet is None:
        assert state.following.began is not None


def test_of_two_tips_one_that_feels_nothing_leads_no_more() -> None:
    state = touching(PAIR)
    time = 0.0
    while state.phase.name != "move":
        time += DT
        _, _, state = stepped(made(PAIR), state, measured(PAIR, time, 3.0, 3.0))
    for pressing, unfelt in (((3.0, 3.0), ()), ((3.0, 0.02), (1,))):
        time += DT
        state = made(PAIR).step(state, measured(PAIR, time, *pressing)).state
        assert state.watches.unfelt == unfelt
    again = enter_phase(state, "touch", measured(PAIR, time, 3.0, 0.0))
    assert again.watches.unfelt == ()


def test_tips_stop_at_once_where_a_limit_is_broken_and_else_slow_down() -> None:
    controller = made(PAIR)
    state = touching(PAIR)
    time = 0.0
    for _ in range(600):
        time += DT
        _, _, state = stepped(controller, state, measured(PAIR, time, 3.0, 3.0))
    now = measured(PAIR, time, 3.0, 3.0)
    commanded = [memory.velocity for memory in state.phase.tips]
    tips = list(now.tips)
    for contact, velocity in zip(
        controller.segments[0].contacts, commanded, strict=True
    ):
        assert velocity is not None
        assert math.hypot(*velocity) > 0.01
        tips[contact.arm] = replace(tips[contact.arm], velocity=(*velocity, 0.0))
    now = replace(now, tips=tuple(tips))
    stopped = controller.stop(state, now, FAILURE)
    assert not stopped.phase.slows
    failed = enter_phase(state, "release", now, FAILURE)
    slowly, at_once = (
        controller.step(one, replace(now, time=time + DT)).commands
        for one in (failed, stopped)
    )
    for contact, velocity in zip(
        controller.segments[0].contacts, commanded, strict=True
    ):
        one, other = slowly[contact.arm], at_once[contact.arm]
        assert isinstance(one, TipCommand)
        assert isinstance(other, TipCommand)
        assert one.velocity[:2] == pytest.approx(velocity, rel=0.05)
        assert other.velocity == ZERO


def test_a_touch_of_one_tip_that_fails_ends_the_attempt() -> None:
    state = touching(PAIR)
    for i in range(1, 3000):
        now = measured(PAIR, i * DT, 3.0, 0.0)
        _, _, state = stepped(made(PAIR), state, now)
        if state.phase.name != "touch":
            break
    assert state.phase.name == "release"
    assert state.phase.failure is not None
    assert state.phase.failure[0] == "contact_lost"
    assert state.following.began is None


def test_tips_line_up_together_however_far_each_has_to_go() -> None:
    controller = made(PAIR)
    first, second = controller.segments[0].contacts
    near = list(tips_of(controller, (0.0, 0.0), 0.05))
    x, y, z = near[second.arm].position
    near[second.arm] = replace(near[second.arm], position=(x - 0.2, y, z))
    pose = controller.placement.query.start
    state = controller.init(Measurement(0.0, pose, tuple(near)))
    long = ramp_time(0.2)
    commands, _, _ = stepped(
        controller, state, Measurement(0.9 * long, pose, tuple(near))
    )
    for contact in (first, second):
        command = commands[contact.arm]
        assert command is not None
        assert command.velocity == ZERO
    commands, _, _ = stepped(
        controller, state, Measurement(2.0 * long, pose, tuple(near))
    )
    for contact in (first, second):
        command = commands[contact.arm]
        assert command is not None
        assert math.hypot(*command.velocity) == pytest.approx(margins.ARM.touch_speed)


def test_tools_turn_with_the_object_while_their_tips_line_up() -> None:
    """From the yaw that was planned to the one that is seen."""
    controller = made(PUSH)
    task = controller.placement.query
    turned = Pose2(task.start.x, task.start.y, task.start.yaw + 0.2)
    tips = tips_of(controller, (0.0,), 0.05)
    state = controller.init(Measurement(0.0, task.start, tips))
    aligned = 10.0
    yaws = []
    for time in (0.0, 0.02, 0.05, 0.1, aligned):
        (command,), _, _ = stepped(controller, state, Measurement(time, turned, tips))
        assert command is not None
        yaws.append(command.tool_yaw)
    assert yaws[0] == pytest.approx(task.start.yaw)
    assert yaws[-1] == pytest.approx(turned.yaw)
    assert yaws == sorted(yaws)
    # one in mid-way has followed the object already
    midway = state._replace(following=state.following.begun(0.0))
    (command,), _, _ = stepped(controller, midway, Measurement(0.0, turned, tips))
    assert command is not None
    assert command.tool_yaw == turned.yaw
    # a touch that goes on from where the tips are keeps to the object
    again = state._replace(phase=state.phase._replace(align=False))
    (command,), _, _ = stepped(controller, again, Measurement(0.0, turned, tips))
    assert command is not None
    assert command.tool_yaw == turned.yaw
    # and advances at once
    assert math.hypot(*command.velocity) == pytest.approx(margins.ARM.touch_speed)


@pytest.mark.parametrize("name", [PUSH, PRESS, PAIR])
def test_normal_forces_are_those_along_the_contacts(name: str) -> None:
    controller = made(name)
    count = len(controller.segments[0].contacts)
    pressing = [3.0, 5.0][:count]
    now = measured(name, 1.0, *pressing)
    forces = controller.normal_forces(touching(name), now)
    by_contact = [forces[c.arm] for c in controller.segments[0].contacts]
    assert by_contact == pytest.approx(pressing)


def test_shear_is_no_part_of_a_normal_force() -> None:
    now = measured(PRESS, 1.0, 30.0)
    (tip,) = now.tips
    sheared = replace(tip, force=(9.0, -9.0, tip.force[2]))
    found = made(PRESS).normal_forces(touching(PRESS), replace(now, tips=(sheared,)))
    assert found == pytest.approx([30.0])


@pytest.mark.parametrize(
    ("moved", "turned", "missed"),
    [(0.0, 0.0, False), (0.96, 0.0, False), (0.98, 0.0, True), (0.0, -0.98, True)],
)
def test_a_goal_is_missed_by_nearly_its_tolerance(
    moved: float, turned: float, missed: bool
) -> None:
    task = made(PUSH).placement.last
    goal = task.goal
    pose = Pose2(
        goal.x + moved * task.tolerance.position,
        goal.y,
        goal.yaw + turned * task.tolerance.yaw,
    )
    ending = made(PUSH).missed(touching(PUSH), pose)
    assert (ending is not None) == missed
    if ending is not None:
        off = 1e3 * moved * task.tolerance.position
        degrees = math.degrees(abs(turned) * task.tolerance.yaw)
        assert ending.code == "goal_missed"
        assert ending.text == f"{off:.1f} mm and {degrees:.1f} deg off"


def failed(name: str) -> ControllerState:
    """Return the state in which the tips stop and draw back after a failure."""
    count = len(made(name).segments[0].contacts)
    state = enter_phase(touching(name), "move", measured(name, 0.0, *[3.0] * count))
    now = measured(name, 0.0, *[3.0] * count)
    return made(name).stop(state, now, FAILURE)


def heights(name: str, state: ControllerState, *times: float) -> list[float]:
    """Distances [m] by which the first tip is commanded off its contact at several
    times [s].
    """
    controller = made(name)
    contact = controller.segments[0].contacts[0]
    count = len(controller.segments[0].contacts)
    X_WB = controller.placement.query.start.compose(controller.X_GB)
    x, y, z = contact.direction(X_WB)
    ways = []
    for time in times:
        now = measured(name, time, *[0.0] * count)
        commands, _, _ = stepped(controller, state, now)
        command = commands[contact.arm]
        assert command is not None
        start = now.tips[contact.arm].position
        off = [a - b for a, b in zip(command.position, start, strict=True)]
        ways.append(-(off[0] * x + off[1] * y + off[2] * z))
        assert math.hypot(*off) == pytest.approx(abs(ways[-1]))
    return ways


@pytest.mark.parametrize("name", [PUSH, PRESS, PAIR])
def test_tips_draw_back_along_what_they_pushed_smoothly(name: str) -> None:
    """After a failure they stand still at first."""
    retreat = margins.ARM.retreat
    duration = ramp_time(retreat)
    count = len(made(name).segments[0].contacts)
    calm = enter_phase(touching(name), "release", measured(name, 0.0, *[3.0] * count))
    shares = (0.0, 0.25, 0.5, 0.9, 1.0, 1.3)
    ways = [retreat * smooth(share) for share in shares]
    times = [share * duration for share in shares]
    assert heights(name, calm, *times) == pytest.approx(ways)
    rest = margins.ARM.rest_time
    late = [rest + time for time in times]
    assert heights(name, failed(name), 0.0, *late) == pytest.approx([0.0, *ways])


def test_a_way_back_is_told_with_its_velocity_and_acceleration() -> None:
    controller = made(PRESS)
    state = enter_phase(touching(PRESS), "release", measured(PRESS, 0.0, 30.0))
    h = 1e-4
    for time in (0.2, 0.5, 0.9):
        at = []
        for t in (time - h, time, time + h):
            (command,), _, _ = stepped(controller, state, measured(PRESS, t, 0.0))
            assert command is not None
            at.append(command)
        slope = (at[2].position[2] - at[0].position[2]) / (2.0 * h)
        change = (at[2].velocity[2] - at[0].velocity[2]) / (2.0 * h)
        assert at[1].velocity[2] == pytest.approx(slope, abs=1e-6)
        assert at[1].acceleration[2] == pytest.approx(change, abs=1e-5)


def ends(name: str, state: ControllerState, speed: float = 0.0) -> float:
    """Return when [s] a release is done, whose tips move at a ``speed`` [m/s]."""
    count = len(made(name).segments[0].contacts)
    for i in range(1, 3000):
        now = measured(name, i * DT, *[0.0] * count)
        tips = [replace(tip, velocity=(0.0, speed, 0.0)) for tip in now.tips]
        _, _, after = stepped(made(name), state, replace(now, tips=tuple(tips)))
        if after.phase.name == "done":
            return i * DT
    return math.inf


@pytest.mark.parametrize("name", [PUSH, PAIR])
def test_a_release_is_over_when_the_tips_have_drawn_back(name: str) -> None:
    """After a failure once they rest too, or have had long enough."""
    drawn = ramp_time(margins.ARM.retreat)
    count = len(made(name).segments[0].contacts)
    calm = enter_phase(touching(name), "release", measured(name, 0.0, *[3.0] * count))
    assert drawn < ends(name, calm) < drawn + 0.5
    assert ends(name, calm, 1.0) == ends(name, calm)
    after = ends(name, failed(name))
    rest = margins.ARM.rest_time
    assert drawn + rest < after < drawn + rest + 0.5
    still = margins.ARM.at_rest
    assert ends(name, failed(name), 0.9 * still) == after
    longest = margins.ARM.longest_stop
    assert ends(name, failed(name), 1.1 * still) == pytest.approx(longest, abs=2 * DT)


def test_all_tips_have_to_rest_before_a_release_is_over() -> None:
    state = failed(PAIR)
    for moving in range(2):
        now = measured(PAIR, 3.0, 0.0, 0.0)
        tips = list(now.tips)
        tips[moving] = replace(tips[moving], velocity=(0.1, 0.0, 0.0))
        _, _, after = stepped(made(PAIR), state, replace(now, tips=tuple(tips)))
        assert after.phase.name == "release"
    _, _, after = stepped(made(PAIR), state, measured(PAIR, 3.0, 0.0, 0.0))
    assert after.phase.name == "done"


def test_tips_that_were_drawing_back_stay_where_a_stop_finds_them() -> None:
    state = failed(PUSH)
    now = measured(PUSH, 1.0, 0.0)
    again = made(PUSH).stop(state, now, ("force_limit", "hard"))
    assert again.phase.failure == ("force_limit", "hard")
    assert heights(PUSH, again, 1.0, 2.0, 3.0) == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize("keeps", [False, True])
@pytest.mark.parametrize("fails", [False, True])
def test_an_arm_that_keeps_its_contact_presses_on_unless_something_failed(
    keeps: bool, fails: bool
) -> None:
    controller = Controller(pps.plan(pps.load_task(PRESS)))
    controller.kept_arms = frozenset({0} if keeps else ())
    state = enter_phase(touching(PRESS), "release", measured(PRESS, 0.0, 30.0))
    if fails:
        state = failed(PRESS)
    time = margins.ARM.rest_time + ramp_time(margins.ARM.retreat)
    (command,), _, _ = stepped(controller, state, measured(PRESS, time, 30.0))
    assert command is not None
    (contact,) = controller.segments[0].contacts
    start = measured(PRESS, 0.0, 30.0).tips[0].position
    if keeps and not fails:
        assert command.position == start
        assert command.force == (0.0, 0.0, -contact.load)
        assert command.stiffness[2] == 0.0
    else:
        assert command.position[2] > start[2] + 0.05
        assert command.force == ZERO


def test_after_a_failure_tips_draw_back_as_far_as_there_is_room() -> None:
    """What the arms can reach counts for what was planned alone."""
    plan = pps.plan(pps.load_task(PRESS))
    near = Controller(plan, back=0.02)
    late = margins.ARM.rest_time + ramp_time(margins.ARM.retreat)
    calm = enter_phase(touching(PRESS), "release", measured(PRESS, 0.0, 30.0))
    start = measured(PRESS, 0.0, 30.0).tips[0].position[2]
    for state, way in ((calm, 0.02), (failed(PRESS), margins.ARM.retreat)):
        (command,), _, _ = stepped(near, state, measured(PRESS, late, 0.0))
        assert command is not None
        assert command.position[2] - start == pytest.approx(way)


def test_joints_are_led_on_beyond_the_end_as_the_tips_draw_back() -> None:
    state = enter_phase(touching(PRESS), "release", measured(PRESS, 0.0, 30.0))
    for share in (0.0, 0.5, 1.0):
        time = share * ramp_time(margins.ARM.retreat)
        (command,), _, _ = stepped(made(PRESS), state, measured(PRESS, time, 0.0))
        assert command is not None
        way = margins.ARM.retreat * smooth(share)
        assert command.progress == pytest.approx(way)
    time = margins.ARM.rest_time + ramp_time(margins.ARM.retreat)
    (command,), _, _ = stepped(made(PRESS), failed(PRESS), measured(PRESS, time, 0.0))
    assert command is not None
    assert command.progress == 0.0


def test_a_tip_halted_twice_stays_where_it_was_halted_first() -> None:
    state = failed(PUSH)
    rest = margins.ARM.rest_time
    half = made(PUSH).halted(state, measured(PUSH, rest + 0.4, 0.0))
    assert 0.0 < half.phase.retreat_fraction < 1.0
    later = made(PUSH).halted(half, measured(PUSH, rest + 0.6, 0.0))
    assert later.phase.retreat_fraction == half.phase.retreat_fraction
    way = margins.ARM.retreat * half.phase.retreat_fraction
    assert heights(PUSH, half, rest + 0.4, 3.0) == pytest.approx([way, way])


def test_a_tick_is_logged_with_what_was_planned_for_its_time() -> None:
    controller = made(PUSH)
    segment = controller.segments[0]
    state = touching(PUSH)
    _, log, _ = stepped(controller, state, measured(PUSH, 5.0, 0.0))
    start = controller.placement.query.start
    assert log.thought().reference.position == pytest.approx(start.position)
    moving = enter_phase(state, "move", measured(PUSH, 5.0, 3.0))
    following = moving.following.begun(5.0)._replace(clock_start=5.0)
    moving = moving._replace(following=following)
    time = 5.0 + 0.4 * segment.profile.duration
    _, log, _ = stepped(controller, moving, measured(PUSH, time, 3.0))
    way = segment.profile.state_at(time - 5.0)[0]
    planned = segment.body_pose(way).compose(controller.X_BG)
    assert log.phase == "move"
    assert log.thought().reference.position == pytest.approx(planned.position)
    assert log.thought().reference.yaw == pytest.approx(planned.yaw)
    assert all(wall > 0.0 for wall in log.wall_times)


def test_patience_is_that_of_the_contact_and_of_its_measurements() -> None:
    """A press is missed sooner than a push; noise takes measurements to be sure."""
    arm = margins.ARM
    for name, least in ((PUSH, arm.push_loss_time), (PRESS, arm.press_loss_time)):
        patience = made(name).supervisor.patience
        assert patience == pytest.approx(
            least + made(name).placement.query.motion.control_period
        )
    task = pps.load_task(PRESS)
    noisy = replace(task, sensing=replace(Sensing(), force_noise=2.0))
    plan = pps.plan(task)
    there = Controller(replace(plan, task=noisy))
    (contact,) = there.segments[0].contacts
    samples = there.law.mover.samples(contact)
    assert samples > 1
    period = task.motion.control_period
    assert there.supervisor.patience == pytest.approx(
        arm.press_loss_time + samples * period
    )


def test_a_touch_presses_with_a_share_of_what_would_move_the_object() -> None:
    """Of which each of two tips has its part, and that is felt for sure."""
    for name, tips in ((PUSH, 1), (PAIR, 2)):
        drag = made(name).segments[0].drive.max_friction
        for touch in made(name).touches:
            share = margins.TOUCH_SHARE * drag / tips
            assert touch.push == pytest.approx(max(0.6, share))
            assert touch.push < drag
            assert touch.push > touch.threshold


def test_the_contact_frame_of_commands_is_that_of_the_object_as_seen() -> None:
    controller = made(PUSH)
    (contact,) = controller.segments[0].contacts
    start = controller.placement.query.start
    turned = Pose2(start.x, start.y, start.yaw + 0.3)
    now = measured(PUSH, 0.1, 0.0, pose=turned)
    (command,), _, _ = stepped(controller, touching(PUSH), now)
    assert command is not None
    X_WB = turned.compose(controller.X_GB)
    assert command.normal_yaw == pytest.approx(contact_yaw(contact, X_WB))


def moving(
    controller: Controller, name: str, aside: float, turned: float = 0.0
) -> tuple[ControllerState, Measurement]:
    """Return a state at the start of a motion, and what is measured with the object
    ``aside`` [m] and ``turned`` [rad] of its path.
    """
    X_WB = controller.segments[0].body_pose(0.05).compose(Pose2(0.0, aside, turned))
    pose = X_WB.compose(controller.X_BG)
    count = len(controller.segments[0].contacts)
    now = Measurement(0.5, pose, tips_of(controller, [3.0] * count, pose=pose))
    state = enter_phase(touching(name), "move", now)
    following = state.following.begun(0.0)._replace(progress=0.05)
    return state._replace(following=following), now


@pytest.mark.parametrize("name", [PUSH, PAIR])
@pytest.mark.parametrize(("aside", "turned"), [(0.0, 0.0), (0.04, 0.3), (-0.04, -0.3)])
def test_the_wrench_that_is_logged_is_that_of_the_forces_commanded(
    name: str, aside: float, turned: float
) -> None:
    """In the object's axes, about its centre of mass."""
    controller = made(name)
    state, now = moving(controller, name, aside, turned)
    commands, log, _ = stepped(controller, state, now)
    X_WB = now.object_pose.compose(controller.X_GB)
    total = [0.0, 0.0, 0.0]
    for contact in controller.segments[0].contacts:
        command = commands[contact.arm]
        assert command is not None
        fx, fy = X_WB.unrotate(command.force[:2])
        x, y = contact.point
        total = [total[0] + fx, total[1] + fy, total[2] + x * fy - y * fx]
    assert log.thought().allocated_wrench == pytest.approx(total, abs=1e-6)


def test_an_experiment_without_a_servo_pushes_by_its_force_alone() -> None:
    plan = pps.plan(pps.load_task(PUSH))
    usual = Controller(plan).law
    alone = Controller(plan, execution=Execution(servo=False)).law
    factor = Controller(plan, execution=Execution(force_gain=1.1)).law
    joints = Controller(plan, execution=Execution(joint_stiffness=0.5)).law
    assert (usual.servo, alone.servo, factor.servo) == (True, False, False)
    damping = plan.task.motion.servo_damping
    assert [law.mover.damping for law in (usual, alone, factor)] == [
        damping,
        0.0,
        damping,
    ]
    assert [law.tracks_joints for law in (usual, joints)] == [False, True]
    assert (usual.force_gain, factor.force_gain) == (1.0, 1.1)


def test_arms_that_have_not_let_go_go_on_with_their_commands() -> None:
    controller = made(PAIR)
    now = measured(PAIR, 0.0, 0.0, 0.0)
    (command, *_), _, _ = stepped(controller, touching(PAIR), now)
    state = controller.init(now, (command, None))
    held = {
        contact.arm: memory.held_command
        for contact, memory in zip(
            controller.segments[0].contacts, state.phase.tips, strict=True
        )
    }
    assert held == {0: command, 1: None}
    assert [memory.held_command for memory in controller.init(now).phase.tips] == [
        None,
        None,
    ]


def touched_at(name: str, *, lost: float | None, begun: bool) -> ControllerState:
    """Return the state after a touch that ends at 9 s or so, and the motion's clock."""
    controller = made(name)
    state = touching(name)
    following = state.following
    if begun:
        following = following.begun(2.0)._replace(clock_start=2.0)
    state = state._replace(
        following=following, watches=state.watches._replace(lost=lost)
    )
    state = state._replace(phase=state.phase._replace(since=8.0, align=False))
    for i in range(1000):
        now = measured(name, 8.0 + i * DT, 3.0)
        _, _, state = stepped(controller, state, now)
        if state.phase.name == "move":
            break
    assert state.phase.name == "move"
    return state


def test_a_motion_is_planned_anew_from_where_the_touch_ends() -> None:
    state = touched_at(PUSH, lost=None, begun=False)
    following = state.following
    assert following.clock_start == following.began
    assert following.began is not None
    assert 8.0 < following.began < 12.0
    again = touched_at(PUSH, lost=7.0, begun=True).following
    assert again.began == 2.0
    assert again.clock_start > 8.0


def test_a_motion_that_cannot_be_planned_anew_goes_on_by_its_clock(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Which stood still from when the contact was lost."""
    replanner = type(made(PUSH).placement.replanner)
    monkeypatch.setattr(replanner, "replan", lambda *_: ())
    first = touched_at(PUSH, lost=None, begun=False).following
    assert first.clock_start == first.began
    assert first.binding.segment is made(PUSH).segments[0]
    ends = first.began
    assert ends is not None
    again = touched_at(PUSH, lost=7.0, begun=True).following
    assert again.clock_start == pytest.approx(2.0 + ends - 7.0)
    unknown = touched_at(PUSH, lost=None, begun=True).following
    assert unknown.clock_start == 2.0


def test_the_most_used_contact_decides_how_much_is_steered() -> None:
    """One of two tips near the edge of its cone eases the steering."""
    controller = made(PAIR)
    state, now = moving(controller, PAIR, 0.0)
    calm = stepped(controller, state, now)[2].adaptation.steering_scale
    for slipping in range(2):
        tips = list(now.tips)
        x, y, _ = tips[slipping].force
        tips[slipping] = replace(tips[slipping], force=(x - 3.0 * y, y + 3.0 * x, 0.0))
        eased = replace(now, tips=tuple(tips))
        assert stepped(controller, state, eased)[2].adaptation.steering_scale < calm


def test_tips_that_do_not_follow_push_harder_where_a_servo_leads_them() -> None:
    plan = pps.plan(pps.load_task(PUSH))
    for servo, harder in ((True, True), (False, False)):
        controller = Controller(plan, execution=Execution(servo=servo))
        state, now = moving(controller, PUSH, 0.0)
        state = state._replace(
            estimate=state.estimate._replace(time=now.time - DT),
        )
        _, _, after = stepped(controller, state, now)
        assert (after.adaptation.force_scale > 1.0) == harder


def test_an_object_that_nothing_else_carries_is_held_after_a_failure() -> None:
    """On a wall it is pressed on; where it stands on a ledge the tips draw back."""
    name = "press-fit"
    controller = made(name)
    task = controller.placement.query
    carried = task.start
    falls = Pose2(carried.x, carried.y + 0.4, carried.yaw)
    scene = controller.placement.scene
    assert scene.carried(carried)
    assert not scene.carried(falls)
    late = margins.ARM.rest_time + ramp_time(margins.ARM.retreat)
    for pose, holds in ((carried, False), (falls, True)):
        now = measured(name, 0.0, 60.0, 60.0, pose=pose)
        state = enter_phase(touching(name), "move", now)
        estimate = state.estimate._replace(X_WG=pose)
        state = controller.stop(state._replace(estimate=estimate), now, FAILURE)
        later = replace(now, time=late)
        commands, _, _ = stepped(controller, state, later)
        for contact in controller.segments[0].contacts:
            command = commands[contact.arm]
            assert command is not None
            start = now.tips[contact.arm].position
            if holds:
                assert command.position == start
                assert command.force == (0.0, 0.0, -contact.load)
            else:
                assert command.position[2] > start[2] + 0.03
                assert command.force == ZERO


def test_an_object_on_a_wall_is_held_while_it_is_looked_at() -> None:
    name = "press-fit"
    plan = pps.plan(pps.load_task(name))
    lifted = replace(plan, segments=plan.segments[:1])  # off its ledge
    controller = Controller(lifted)
    assert controller.placement.holds
    goal = controller.placement.last.goal
    now = measured(name, 0.0, 60.0, 60.0, pose=goal)
    state = enter_phase(touching(name), "done", now)
    state = state._replace(estimate=state.estimate._replace(X_WG=goal))
    for late in (DT, 0.5, 2.0):
        commands, _, state = stepped(controller, state, replace(now, time=late))
        assert state.phase.name == "done"
        for contact in controller.segments[0].contacts:
            command = commands[contact.arm]
            assert command is not None
            assert command.position == now.tips[contact.arm].position
            assert command.force == (0.0, 0.0, -contact.load)


def test_a_failure_on_a_ledge_lets_go_though_the_goal_is_on_the_wall() -> None:
    name = "press-fit"
    plan = pps.plan(pps.load_task(name))
    controller = Controller(replace(plan, segments=plan.segments[:1]))
    assert controller.placement.holds
    now = measured(name, 0.0, 60.0, 60.0)  # at its start
    state = enter_phase(touching(name), "touch", now)
    state = controller.stop(state, now, FAILURE)
    late = margins.ARM.rest_time + ramp_time(margins.ARM.retreat)
    commands, _, _ = stepped(controller, state, replace(now, time=late))
    for contact in controller.segments[0].contacts:
        command = commands[contact.arm]
        assert command is not None
        assert command.position[2] > now.tips[contact.arm].position[2] + 0.03
        assert command.force == ZERO


def test_a_tip_that_loses_its_touch_moves_no_other_one() -> None:
    controller = made(PAIR)
    query = controller.placement.query
    lined_up = tips_of(controller, [0.0, 0.0], query.motion.approach_distance)
    state = controller.init(Measurement(0.0, query.start, lined_up))
    first, second = (contact.arm for contact in controller.segments[0].contacts)
    before: Vector3 | None = None
    resumed = False
    for i in range(1, 900):
        pressing = [0.0, 0.0]
        if 50 < i < 200:
            pressing[first] = 5.0
        commands, _, state = stepped(
            controller, state, measured(PAIR, i * DT, *pressing)
        )
        if state.phase.name != "touch":
            break
        resumed = resumed or state.phase.tips[0].resumed is not None
        command = commands[second]
        assert command is not None
        if before is not None:
            assert math.dist(before, command.position) < 1e-3
        before = command.position
    assert resumed


def test_a_release_that_was_planned_lets_go_of_an_object() -> None:
    """Without a failure the tips draw back, whatever carries the object."""
    name = "press-fit"
    controller = made(name)
    start = controller.placement.query.start
    falls = Pose2(start.x, start.y + 0.4, start.yaw)
    now = measured(name, 0.0, 60.0, 60.0, pose=falls)
    state = enter_phase(touching(name), "release", now)
    later = replace(now, time=ramp_time(margins.ARM.retreat))
    commands, _, _ = stepped(controller, state, later)
    for command, tip in zip(commands, now.tips, strict=True):
        assert command is not None
        assert command.position[2] > tip.position[2] + 0.03


def test_an_object_that_goes_into_an_opening_takes_its_tips_along() -> None:
    """They are not said to have slid off its top; elsewhere they are."""
    for name, most in (("press-fit", math.inf), (PRESS, margins.ARM.sunk)):
        assert {touch.sunk for touch in made(name).touches} == {most}
        assert made(name).law.mover.sunk == most


def test_what_contacts_cannot_give_is_missing_from_the_log() -> None:
    controller = made(PUSH)
    state, now = moving(controller, PUSH, 0.0)
    binding = state.following.binding
    lacking = (0.1, 0.2, 0.03)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        return binding.allocate(fx, fy, tau)._replace(residual=lacking)

    short = replace(binding, allocate=allocate)
    state = state._replace(following=state.following._replace(binding=short))
    _, log, _ = stepped(controller, state, now)
    X_WB = now.object_pose.compose(controller.X_GB)
    path = binding.segment.path
    x, y = binding.tracker.step(path, X_WB, 0.05, 0.05, 1.0).wrench.about
    thought = log.thought()
    pairs = zip(thought.wanted_wrench, thought.allocated_wrench, strict=True)
    off = [a - b for a, b in pairs]
    assert off == pytest.approx((0.1, 0.2, 0.03 + x * 0.2 - y * 0.1))


def test_a_light_object_is_touched_only_while_it_is_seen() -> None:
    """Its touch is noticed by its motion, in pictures."""
    unseen = Sensing(force_noise=1.0, position_noise=0.0035, pose_rate=10.0)
    for mass, waits in ((0.05, True), (10.0, False)):
        task = pps.load_task(PUSH, [f"object.mass={mass}"])
        task = replace(task, sensing=unseen)
        controller = Controller(pps.plan(task))
        state = controller.init(measured(PUSH, 0.0, 0.0))
        since = [state.phase.since]
        for i in range(1, 200):  # the last picture is that of the start
            now = replace(measured(PUSH, i * DT, 0.0), pose_seen=False, pose_time=0.0)
            _, _, state = stepped(controller, state, now)
            since.append(state.phase.since)
        blind = 200 * DT - controller.longest_blind
        assert (since[-1] > 0.9 * blind) == waits
        if not waits:
            assert since[-1] == since[0]
