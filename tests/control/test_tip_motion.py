"""What counts as a lost contact on the way, and how a tip is kept at its own."""

from __future__ import annotations

from itertools import pairwise

import pytest

from pushpressslide.control.state import TipContext, TipMemory
from pushpressslide.control.tip_motion import (
    HEIGHT_EASING,
    HEIGHT_SLACK,
    TURNABOUT,
    Felt,
    TipHold,
    TipMover,
    TipTask,
    eased_height,
    missing,
)
from pushpressslide.core import margins
from pushpressslide.core.control import TipState
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.normal_force import NormalForceRegulator

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
    """Return the velocity [m/s] that one of two pushing tips at ``place`` [m] is led
    with beside its ``speed`` [m/s] ahead, in the axes of its contact; it feels
    ``force`` [N].
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
    task = TipTask(ahead, tip, (0.5, 0.0), 0.5, None, TipHold(tip, 0.4))
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
