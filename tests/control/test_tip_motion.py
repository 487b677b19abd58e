"""Detection of a contact lost during the motion, and how a tip is kept at its own."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from pushpressslide.control.insertion import braking
from pushpressslide.control.state import TipContext, TipMemory, averaged
from pushpressslide.control.tip_motion import (
    HEIGHT_EASING,
    HEIGHT_SLACK,
    PRESS_DAMPING,
    PUSH_SHARE,
    RETURN_RATE,
    TIP_ACCELERATION,
    TOOL_ACCELERATION,
    TURNABOUT,
    ContactKeeping,
    Felt,
    TipMover,
    TipTask,
    eased_height,
    missing,
)
from pushpressslide.core import margins
from pushpressslide.core.control import TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.impedance import tip_force
from pushpressslide.execution.normal_force import (
    NormalForceRegulator,
    NormalForceState,
)

SIDES = tuple(
    Contact(i, "side", (-0.1, y), (1.0, 0.0), 0.05) for i, y in enumerate((0.1, -0.1))
)
TOPS = tuple(
    Contact(i, "top", (0.0, y), (0.0, 0.0), 0.1, 5.0) for i, y in enumerate((0.1, -0.1))
)
SPEED = 0.05  # [m/s]
RADIUS = 0.02
GONE = Felt(True, 0.0)
THERE = Felt(False, 0.5)


@pytest.mark.parametrize(
    ("share", "lost"),
    [
        (0.0, False),
        (margins.LEAST_SHARE - 0.01, False),
        (margins.LEAST_SHARE + 0.01, True),
        (0.5, True),
    ],
)
def test_a_push_is_missed_by_its_share(share: float, lost: bool) -> None:
    assert missing((GONE, THERE), SIDES, (3.0 * share, 3.0 * (1.0 - share))) is lost
    assert not missing((THERE, THERE), SIDES, (3.0 * share, 3.0 * (1.0 - share)))


def test_a_push_alone_and_any_press_are_missed() -> None:
    assert missing((GONE,), SIDES[:1], (0.2,))
    assert missing((THERE, GONE), TOPS, (20.0, 2.0))


def test_a_tip_that_sticks_off_its_height_is_left_there() -> None:
    """It is held where it is at first, and again after it has stuck elsewhere."""
    wanted, dt = 0.04, 0.004
    height = eased_height(None, 0.0401, wanted, dt)
    assert height == pytest.approx(0.0401)
    for _ in range(round(5.0 * HEIGHT_EASING / dt)):
        height = eased_height(height, 0.0395, wanted, dt)
    assert height == pytest.approx(0.0395, abs=1e-5)


def led(
    place: tuple[float, float], force: float, speed: float = SPEED
) -> tuple[float, float]:
    """Commanded velocity [m/s] of one of two pushing tips, minus its ``speed`` [m/s]
    ahead, in B.

    The tip is at ``place`` [m] and feels ``force`` [N].
    """
    contact = SIDES[0]
    X_WB = Pose2(0.5, 0.1, 0.7)
    tip, height = contact.tip_place(RADIUS)
    x, y = X_WB.apply(place)
    push = contact.direction(X_WB)
    state = TipState(
        (x, y, height), (0.0, 0.0, 0.0), (force * push[0], force * push[1], 0.0)
    )
    context = TipContext(contact, state, X_WB, 1.0, 0.004, 0.0, X_WB.yaw)
    mover = TipMover(500.0, 0.7, 0.2, 0.0, NormalForceRegulator(), (RADIUS,))
    ahead = Twist(speed, 0.0, 0.0)
    task = TipTask(ahead, tip, (0.5, 0.0), 0.5, None, ContactKeeping(tip, 0.4))
    memory = TipMemory((x, y, height), velocity=X_WB.rotate((speed, 0.0)))
    command, _, _ = mover.step(memory, context, task)
    vx, vy, _ = command.velocity
    on, along = X_WB.unrotate((vx, vy))
    return (on - speed, along)


def test_a_tip_that_parts_is_led_on_into_its_face() -> None:
    tip, _ = SIDES[0].tip_place(RADIUS)
    assert led(tip, 0.4) == pytest.approx((0.0, 0.0))
    assert led(tip, 0.0) == pytest.approx((margins.ARM.led_on, 0.0))
    on, across = led(tip, 0.2)
    assert 0.0 < on < margins.ARM.led_on
    assert across == pytest.approx(0.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tip_that_slides_is_led_back_along_its_face(side: float) -> None:
    x, y = SIDES[0].tip_place(RADIUS)[0]
    assert led((x, y + side * margins.ARM.slid_side), 1.0) == pytest.approx((0.0, 0.0))
    on, along = led((x, y + side * 2.0 * margins.ARM.slid_side), 1.0)
    assert on == pytest.approx(0.0)
    assert along * side < 0.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("speed", [0.0, 0.005, SPEED])
def test_a_tip_is_led_back_by_a_share_of_its_speed_and_not_where_it_stands(
    side: float, speed: float
) -> None:
    x, y = SIDES[0].tip_place(RADIUS)[0]
    on, along = led((x, y + side * 0.05), 1.0, speed)
    assert on == pytest.approx(0.0)
    assert abs(along) == pytest.approx(margins.ARM.return_share * speed)


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("fed", [5.0, 30.0, 39.0])
@pytest.mark.parametrize("moves", [0.0, 0.04, 0.3])
def test_a_push_stays_within_the_force_limit_and_may_always_be_held_back(
    fed: float, moves: float, noise: float
) -> None:
    """Also where the object does not move as it should: a tip that moves with
    ``moves`` [m/s] and is fed ``fed`` [N].
    """
    contact = SIDES[0]
    X_WB = Pose2(0.5, 0.1, 0.7)
    tip, height = contact.tip_place(RADIUS)
    push = contact.direction(X_WB)
    velocity = (moves * push[0], moves * push[1], 0.0)
    felt = (fed * push[0], fed * push[1], 0.0)
    state = TipState((*X_WB.apply(tip), height), velocity, felt)
    context = TipContext(contact, state, X_WB, 1.0, 0.004, 0.0, X_WB.yaw)
    limit = 40.0
    regulator = NormalForceRegulator(f_max=limit)
    mover = TipMover(500.0, 0.7, 0.2, noise, regulator, (RADIUS,))
    task = TipTask(Twist(SPEED, 0.01, 0.0), tip, (fed, 0.0), fed)
    memory = TipMemory(state.position, velocity=X_WB.rotate((SPEED, 0.01)))
    command, _, _ = mover.step(memory, context, task)
    total = tip_force(command, state.position, state.velocity)
    on = total[0] * push[0] + total[1] * push[1]
    assert on <= max(PUSH_SHARE * (limit - noise), fed) + 1e-9
    ahead, along = X_WB.unrotate(command.velocity[:2])
    assert along == pytest.approx(0.01)
    if moves > SPEED:
        assert ahead == pytest.approx(SPEED)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tip_is_not_led_far_from_its_height(side: float) -> None:
    height = None
    for i in range(1000):
        height = eased_height(height, 0.04 + side * 1e-5 * i, 0.04, 0.004)
    assert height == pytest.approx(0.04 + side * HEIGHT_SLACK)


@pytest.mark.long
def test_a_push_that_is_asked_for_little_does_not_stop_the_other() -> None:
    """One of two pushes has 8 % of the force: its contact fades, and taking it again
    would shake the box.
    """
    from pushpressslide.jobs.run import simulate
    from pushpressslide.jobs.sampling import random_task
    from pushpressslide.report.metrics import result
    from pushpressslide.taskfile.load import load_task

    task = random_task(load_task("parallel-push"), 36, 1)
    plan, record, _ = simulate(task)
    found = result(task, plan, record, {})
    assert found["success"]
    assert found["final_position_error"] < 0.003


def test_the_drag_of_a_press_turns_about_in_its_time_and_not_in_a_jump() -> None:
    """A jump by twice the friction shakes the arm, and the normal force by a third."""
    above = Contact(0, "top", (0.02, 0.0), (0.0, 0.0), 0.06, 50.0)
    X_WB = Pose2(0.5, 0.1, 0.7)
    tip, height = above.tip_place(RADIUS)
    x, y = X_WB.apply(tip)
    state = TipState((x, y, height), (0.0, 0.0, 0.0), (0.0, 0.0, -50.0))
    friction = 0.7
    mover = TipMover(
        500.0, friction, 0.2, 0.0, NormalForceRegulator(f_max=90.0), (RADIUS,)
    )
    drag = 0.8 * friction * 50.0
    memory = TipMemory((x, y, height), drag=X_WB.rotate((drag, 0.0)))
    dt = 0.004
    forces = []
    for i in range(round(TURNABOUT / dt) + 1):
        context = TipContext(above, state, X_WB, i * dt, dt, 0.0, X_WB.yaw)
        task = TipTask(Twist(-SPEED, 0.0, 0.0), tip, (-drag, 0.0), 50.0)
        command, memory, _ = mover.step(memory, context, task)
        forces.append(X_WB.unrotate(command.force[:2])[0])
    steps = [b - a for a, b in pairwise([drag, *forces])]
    most = 2.0 * friction * 50.0 * dt / TURNABOUT
    assert min(steps) >= -most - 1e-9
    assert forces[-1] == pytest.approx(-drag)
    assert forces[len(forces) // 2] > -0.5 * drag


ZERO = (0.0, 0.0, 0.0)
DT = 0.004
TURNED = Pose2(0.5, 0.1, 0.7)
PUSH = Contact(0, "side", (-0.1, 0.02), (1.0, 0.0), 0.05)
PRESS = Contact(0, "top", (0.02, -0.03), (0.0, 0.0), 0.1, 40.0)


def mover(noise: float = 0.0, radii: tuple[float, ...] = (RADIUS,)) -> TipMover:
    return TipMover(500.0, 0.7, 0.2, noise, NormalForceRegulator(f_max=90.0), radii)


def at(
    contact: Contact, force: Vector3 = ZERO, lower: float = 0.0, dt: float = DT
) -> TipContext:
    """Context of a tip at its contact.

    It feels ``force`` [N] in the contact's frame (n, t, out of the object along the
    height), and is ``lower`` [m] than planned.
    """
    (x, y), height = contact.tip_place(RADIUS)
    px, py = TURNED.apply((x, y))
    fx, fy = TURNED.rotate(force[:2])
    tip = TipState((px, py, height - lower), (0.0, 0.0, -0.01), (fx, fy, force[2]))
    return TipContext(contact, tip, TURNED, 1.0, dt, 0.3, 0.9)


def task(contact: Contact, **fields: object) -> TipTask:
    tip, _ = contact.tip_place(RADIUS)
    usual = TipTask(Twist(0.0, 0.0, 0.0), tip, (0.0, 0.0), contact.load)
    return usual._replace(**fields)  # type: ignore[arg-type]


def start(contact: Contact, **fields: object) -> TipMemory:
    memory = TipMemory(at(contact).tip.position)
    return memory._replace(**fields)  # type: ignore[arg-type]


@pytest.mark.parametrize(("share", "lost"), [(0.99, True), (1.01, False)])
@pytest.mark.parametrize("contact", [PUSH, PRESS])
def test_a_contact_is_lost_below_its_share_of_what_it_has(
    contact: Contact, share: float, lost: bool
) -> None:
    """A push below what is felt for sure, a press below a share of its load."""
    least = margins.KEPT_SHARE * 0.2
    force: Vector3 = (share * least, 0.0, 0.0)
    if contact is PRESS:
        force = (0.0, 0.0, -share * margins.LOSS_SHARE * 40.0)
    _, _, felt = mover().step(start(contact), at(contact, force), task(contact))
    assert felt.lost == lost


def test_a_push_too_weak_to_be_felt_is_not_missed() -> None:
    light = replace(mover(), unfelt=True)
    for contact, lost in ((PUSH, False), (PRESS, True)):
        *_, felt = light.step(start(contact), at(contact), task(contact))
        assert felt.lost == lost


def test_a_push_is_not_felt_below_a_share_of_the_force_that_is_detected() -> None:
    least = margins.KEPT_SHARE * 0.2
    for force, absent in ((0.99 * least, True), (1.01 * least, False)):
        context = at(PUSH, (force, 0.0, 0.0))
        *_, felt = mover().step(start(PUSH), context, task(PUSH))
        assert felt.absent == absent
    light = replace(mover(), unfelt=True)
    *_, felt = light.step(start(PUSH), at(PUSH), task(PUSH))
    assert not felt.absent


def test_a_light_press_is_lost_as_a_push_is() -> None:
    light = replace(PRESS, load=0.01)
    for force, lost in ((0.09, True), (0.11, False)):
        context = at(light, (0.0, 0.0, -force))
        assert mover().step(start(light), context, task(light))[2].lost == lost


def test_a_press_that_has_sunk_beside_the_object_is_lost() -> None:
    pressing = (0.0, 0.0, -40.0)
    for lower, lost in ((1.1, True), (0.9, False)):
        context = at(PRESS, pressing, lower * margins.ARM.sunk)
        assert mover().step(start(PRESS), context, task(PRESS))[2].lost == lost


def test_noise_is_averaged_over_as_many_measurements_as_it_takes() -> None:
    """So that a false loss is as rare as LOSS_SIGMAS says."""
    for contact in (PUSH, PRESS):
        count = mover(0.05).samples(contact)
        drop = margins.KEPT_SHARE * 0.2
        if contact is PRESS:
            drop = (1.0 - margins.LOSS_SHARE) * 40.0
        sure = margins.LOSS_SIGMAS * 0.05
        # a running mean of weights 1/n has the variance of 2 n - 1 measurements
        assert sure / math.sqrt(2 * count - 1) <= drop * (1.0 + 1e-9)
        assert count == 1 or sure / math.sqrt(2 * count - 3) > drop
    assert mover(0.0).samples(PUSH) == 1
    assert mover(1e-6).samples(PRESS) == 1


def test_the_running_mean_has_the_variance_of_as_many_measurements() -> None:
    count = 5
    mean = averaged(None, (0.0, 0.0, 0.0), count)
    weights = []
    for k in range(200):  # the response to one measurement, ever later
        mean = averaged(mean, (1.0 if k == 0 else 0.0, 0.0, 0.0), count)
        weights.append(mean[0])
    assert math.fsum(weights) == pytest.approx(1.0)
    squares = math.fsum(w * w for w in weights)
    assert squares == pytest.approx(1.0 / (2 * count - 1))


def test_a_loss_is_judged_by_the_mean_of_what_is_measured() -> None:
    made = mover(0.05)
    count = made.samples(PUSH)
    assert count > 3
    push = 1.0
    _, memory, _ = made.step(start(PUSH), at(PUSH, (push, 0.0, 0.0)), task(PUSH))
    least = margins.KEPT_SHARE * 0.2
    ticks = math.ceil(math.log(least / push) / math.log(1.0 - 1.0 / count))
    lost = []
    for _ in range(2 * ticks):
        _, memory, felt = made.step(memory, at(PUSH), task(PUSH))
        lost.append(felt.lost)
    assert lost == [False] * (ticks - 1) + [True] * (ticks + 1)


def test_the_friction_that_is_used_is_shear_over_what_the_normal_allows() -> None:
    def used(contact: Contact, force: Vector3) -> float:
        context = at(contact, force)
        return mover().step(start(contact), context, task(contact))[2][1]

    assert used(PUSH, (2.0, 0.7, 0.0)) == pytest.approx(0.7 / (0.7 * 2.0))
    assert used(PUSH, (2.0, -0.7, 5.0)) == pytest.approx(0.7 / (0.7 * 2.0))
    assert used(PRESS, (3.0, 4.0, -40.0)) == pytest.approx(5.0 / (0.7 * 40.0))
    # of a contact that is hardly felt, over what counts as one
    assert used(PUSH, (0.0, 0.07, 0.0)) == pytest.approx(0.07 / (0.7 * 0.2))


def test_a_tip_moves_as_its_place_on_the_object_does() -> None:
    """Also by the object's turn."""
    twist = Twist(0.02, -0.01, 0.3)
    (x, y), _ = PUSH.tip_place(RADIUS)
    wanted = TURNED.rotate((0.02 - 0.3 * y, -0.01 + 0.3 * x))
    context = at(PUSH, (2.0, 0.0, 0.0), dt=1.0)
    command, memory, _ = mover().step(start(PUSH), context, task(PUSH, twist=twist))
    assert command.velocity == pytest.approx((*wanted, 0.0))
    assert memory.velocity == pytest.approx(wanted)
    assert memory.turn == pytest.approx(0.3)
    assert command.tool_yaw_rate == pytest.approx(0.3)
    assert command.tool_yaw == 0.9
    assert command.progress == 0.3
    assert command.damping[:2] == (500.0, 500.0)
    assert command.stiffness[:2] == (0.0, 0.0)


@pytest.mark.parametrize("contact", [PUSH, PRESS])
def test_a_reference_that_changes_is_approached_at_its_acceleration(
    contact: Contact,
) -> None:
    """And the arm is told of it; a press takes it quicker than a push."""
    most = TIP_ACCELERATION[contact.kind]
    before = TURNED.rotate((0.03, 0.0))
    memory = start(contact, velocity=before)
    twist = Twist(-0.05, 0.0, 0.0)
    command, _, _ = mover().step(memory, at(contact), task(contact, twist=twist))
    along = TURNED.unrotate(command.velocity[:2])
    assert along == pytest.approx((0.03 - most * DT, 0.0))
    assert TURNED.unrotate(command.acceleration[:2]) == pytest.approx((-most, 0.0))
    assert 0.2 < most < 1.5  # [m/s^2]
    # nothing changes in no time
    still, _, _ = mover().step(memory, at(contact, dt=0.0), task(contact, twist=twist))
    assert still.velocity[:2] == pytest.approx(before)
    assert still.acceleration == ZERO
    assert still.tool_yaw_acceleration == 0.0
    # nor the velocity that is wanted
    same, _, _ = mover().step(
        memory, at(contact), task(contact, twist=Twist(0.03, 0.0, 0.0))
    )
    assert same.acceleration == pytest.approx(ZERO, abs=1e-9)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tool_is_turned_faster_and_slower_at_its_acceleration(side: float) -> None:
    most = TOOL_ACCELERATION * DT
    memory = start(PUSH, turn=0.1)
    for wanted, turn in ((0.1 + 0.5 * most, 0.1 + 0.5 * most), (9.0, 0.1 + most)):
        off = side * (wanted - 0.1)
        twist = Twist(0.0, 0.0, 0.1 + off)
        command, after, _ = mover().step(memory, at(PUSH), task(PUSH, twist=twist))
        expected = 0.1 + side * (turn - 0.1)
        assert command.tool_yaw_rate == pytest.approx(expected)
        assert after.turn == pytest.approx(expected)
        assert command.tool_yaw_acceleration == pytest.approx((expected - 0.1) / DT)


def test_a_push_has_a_force_and_a_spring_along_its_height() -> None:
    command, memory, _ = mover().step(
        start(PUSH), at(PUSH, (2.0, 0.0, 0.0), 0.001), task(PUSH, force=(3.0, -1.0))
    )
    assert TURNED.unrotate(command.force[:2]) == pytest.approx((3.0, -1.0))
    assert command.force[2] == 0.0
    assert command.stiffness[2] > 0.0
    assert command.damping[2] > 0.0
    assert command.position[2] == pytest.approx(PUSH.height - 0.001)
    assert memory.height == command.position[2]
    assert command.catches_up
    assert command.normal_yaw == pytest.approx(TURNED.yaw)


def test_a_press_is_regulated_to_its_load_and_pushes_into_the_support() -> None:
    made = mover()
    memory = start(PRESS, regulator=NormalForceState(1.0, 40.0))
    context = at(PRESS, (0.0, 0.0, -30.0), 0.001)
    command, after, _ = made.step(memory, context, task(PRESS))
    push, state = made.regulator.step(memory.regulator, 40.0, 30.0, DT)
    assert command.force[2] == pytest.approx(-push)
    assert after.regulator == state
    assert command.stiffness == ZERO
    assert command.damping[2] == PRESS_DAMPING
    assert command.position == context.tip.position
    assert command.servo_cap == push
    light = task(PRESS, load=5.0)
    command, _, _ = made.step(
        start(PRESS, regulator=NormalForceState(0.0, 5.0)), context, light
    )
    assert command.servo_cap == 25.0


def test_an_object_that_drops_in_is_slowed_by_a_damper() -> None:
    """Its load is borne at that speed, and it is braked where it is as fast."""
    speed = 0.01
    context = at(PRESS, (0.0, 0.0, -30.0))
    command, memory, felt = mover().step(
        start(PRESS), context, task(PRESS, entry_speed=speed, force=(50.0, 0.0))
    )
    assert command.force[2] == -40.0
    assert command.damping[2] * speed == pytest.approx(40.0)
    assert command.stiffness == ZERO
    # the tip goes down at 0.01 m/s, all that is allowed
    assert command.acceleration[2] == pytest.approx(braking(0.01, speed))
    assert command.acceleration[2] > 0.0
    assert command.position == context.tip.position
    assert not command.catches_up
    assert felt == Felt(False, 0.0)
    assert memory.regulator == start(PRESS).regulator
    # along the face no more than friction holds
    along = TURNED.unrotate(command.force[:2])
    assert along == pytest.approx((0.7 * 30.0, 0.0))
    command, _, _ = mover().step(
        start(PRESS), context, task(PRESS, entry_speed=speed, force=(5.0, 2.0))
    )
    assert TURNED.unrotate(command.force[:2]) == pytest.approx((5.0, 2.0))
    pulled, _, _ = mover().step(
        start(PRESS),
        at(PRESS, (0.0, 0.0, 3.0)),
        task(PRESS, entry_speed=speed, force=(5.0, 2.0)),
    )
    assert pulled.force[:2] == pytest.approx((0.0, 0.0))


def test_the_drag_of_a_press_changes_by_a_share_a_tick() -> None:
    made = mover()
    most = 2.0 * 0.7 * 40.0 * DT / TURNABOUT
    context = at(PRESS, (0.0, 0.0, -40.0))
    for size in (0.9 * most, 1.1 * most, 20.0):
        wanted = task(PRESS, force=(0.0, size))
        command, memory, _ = made.step(start(PRESS), context, wanted)
        along = TURNED.unrotate(command.force[:2])
        assert along == pytest.approx((0.0, min(size, most)))
        assert memory.drag == command.force[:2]
    assert 0.05 < TURNABOUT < 0.5


def test_only_tips_that_push_together_are_held_at_their_contacts() -> None:
    made = mover(radii=(RADIUS, 0.01))
    one = replace(SIDES[0], arm=1)
    two = replace(SIDES[1], arm=0)
    assert made.holds(SIDES[:1], [3.0]) == [None]
    assert made.holds([SIDES[0], TOPS[1]], [3.0, 1.0]) == [None, None]
    holds = made.holds([one, two], [9.0, 1.0])
    least = margins.HELD_SHARE * 10.0
    assert holds == [
        ContactKeeping(one.tip_place(0.01)[0], pytest.approx(least)),
        ContactKeeping(two.tip_place(RADIUS)[0], pytest.approx(least)),
    ]
    # at least what counts as a contact
    assert made.holds([one, two], [0.5, 0.1])[0] == ContactKeeping(
        one.tip_place(0.01)[0], 0.2
    )


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tip_that_slid_a_little_is_led_back_at_a_rate(side: float) -> None:
    """In a fifth of a second or so."""
    x, y = SIDES[0].tip_place(RADIUS)[0]
    beyond = 1e-4
    _, along = led((x, y + side * (margins.ARM.slid_side + beyond)), 1.0)
    assert along == pytest.approx(-side * RETURN_RATE * beyond)
    assert 1.0 < RETURN_RATE < 20.0


def test_a_tip_that_feels_too_much_is_not_led_off_its_face() -> None:
    tip, _ = SIDES[0].tip_place(RADIUS)
    assert led(tip, 5.0) == pytest.approx((0.0, 0.0))
    # nor is one that is pulled led on faster
    assert led(tip, -5.0) == pytest.approx((margins.ARM.led_on, 0.0))


def test_a_height_relaxes_by_the_share_of_a_tick() -> None:
    height = eased_height(0.040, 0.041, 0.04, DT)
    assert height == pytest.approx(0.040 + 0.001 * DT / HEIGHT_EASING)
    assert eased_height(0.040, 0.041, 0.04, 10.0) == pytest.approx(0.041)
    assert eased_height(0.040, 0.9, 0.04, 10.0) == pytest.approx(0.04 + HEIGHT_SLACK)
    assert eased_height(0.040, -0.9, 0.04, 10.0) == pytest.approx(0.04 - HEIGHT_SLACK)
    assert 0.1 < HEIGHT_EASING < 1.0
    assert 0.0 < HEIGHT_SLACK < 0.005


def test_a_contact_at_its_least_share_is_missed() -> None:
    share = margins.LEAST_SHARE * 10.0
    assert missing((GONE, THERE), SIDES, (share, 10.0 - share))
    assert not missing((THERE, GONE), SIDES, (10.0 - 0.9 * share, 0.9 * share))
    assert missing((GONE, THERE), (TOPS[0], SIDES[1]), (0.0, 10.0))
