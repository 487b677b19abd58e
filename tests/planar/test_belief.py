"""The planar engine with a wrong belief of the centre of mass."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.control import PHASES
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Belief, Robot, Task
from pushpressslide.core.twist_path import integrate
from pushpressslide.identification.online import AxleState
from pushpressslide.modes import MODES
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planning.pressed.vehicle import press_of
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import SpinDrive

OFF = 0.01  # [m]
ERRORS = [(OFF, 0.0), (0.0, OFF), (0.0, -OFF)]


def mistaken(task: Task, error: tuple[float, float]) -> Task:
    """Return ``task`` with its true centre of mass ``error`` [m] from the believed one."""
    x, y = task.object.center_of_mass
    there = (x + error[0], y + error[1])
    return replace(
        task,
        object=replace(task.object, center_of_mass=there),
        belief=Belief(center_of_mass=(x, y)),
    )


def handled(name: str) -> Task:
    task = pps.load_task(name)
    hands = tuple(Robot("hand", robot.base) for robot in task.robots)
    return replace(task, robots=hands)


@pytest.mark.parametrize("error", ERRORS)
def test_the_plan_knows_nothing_of_the_error(error: tuple[float, float]) -> None:
    task = handled("rear-push-rear")
    assert pps.plan(mistaken(task, error)).segments == pps.plan(task).segments


@pytest.mark.parametrize("error", ERRORS)
def test_tips_touch_the_object_where_they_are_planned_to(
    error: tuple[float, float],
) -> None:
    task = handled("rear-push-rear")
    tips = [
        planar_cell(pps.plan(each)).arms[0].read().tip.position
        for each in (task, mistaken(task, error))
    ]
    assert tips[0] == pytest.approx(tips[1])


def test_a_push_through_the_believed_centre_turns_the_object_about_the_true_one() -> (
    None
):
    task = handled("rear-push-rear")
    ahead = task.start.compose(Pose2(0.15, 0.0, 0.0))
    task = replace(task, goal=ahead)
    turns = []
    for error in ((0.0, OFF), (0.0, -OFF)):
        record = pps.run(pps.plan(mistaken(task, error)), engine="planar")
        yaw = record.arrays["object_pose"][:, 2]
        move = record.arrays["phase"] == 2
        turns.append(yaw[move][60] - yaw[move][0])
    # a centre to the left is turned to the left: the push passes on its right
    assert turns[0] > math.radians(0.05)
    assert turns[1] < -math.radians(0.05)


def run(task: Task) -> dict[str, Any]:
    """Return the result of a planar run."""
    plan = pps.plan(task)
    return result(task, plan, pps.run(plan, engine="planar"), {})


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("rear-push-rear", (OFF, 0.0)),
        ("rear-push-rear", (0.0, OFF)),
        ("rear-push-rear", (0.0, -OFF)),
        ("press-slide", (OFF, 0.0)),
        ("press-slide", (0.0, OFF)),
        ("press-slide-forklift", (0.0, OFF)),
        ("parallel-push", (0.0, -OFF)),
    ],
)
def test_the_goal_is_reached_all_the_same(
    name: str, error: tuple[float, float]
) -> None:
    found = run(mistaken(handled(name), error))
    assert found["final_position_error"] < 0.01
    assert found["final_yaw_error"] < math.radians(2.0)


def spun(wrong: float) -> tuple[Task, float]:
    """Return a turn of 90 degrees about the pivot that follows from ``wrong`` times the
    true rho, and how far the true pivot is from there [m].
    """
    task = handled("press-slide-pivot")
    (contact,) = pps.plan(task).contacts
    press = press_of(task.scene, contact)
    there = press.pivot(left=True)
    rho = wrong * math.sqrt(math.dist(there, press.cop) * press.lever)
    believed = replace(press, rho=rho).pivot(left=True)
    pivot = Pose2(*believed, 0.0)
    goal = task.start.compose(pivot).compose(Pose2(0.0, 0.0, 0.5 * math.pi))
    goal = goal.compose(pivot.inverse())
    told = replace(task, goal=goal, belief=Belief(rho=rho))
    return told, math.dist(believed, there)


@pytest.mark.parametrize("wrong", [0.7, 1.3])
def test_a_turn_on_the_spot_with_a_wrong_rho_finds_it_out_and_ends_at_its_goal(
    wrong: float,
) -> None:
    task, off = spun(wrong)
    (planned,) = pps.plan(task).segments
    assert isinstance(planned.drive, SpinDrive)
    assert off > 0.07
    assert run(task)["final_position_error"] < 0.015


@pytest.mark.parametrize("rho", [0.075, 0.15])
def test_a_wrong_rho_of_a_press_is_found_out_on_the_way(rho: float) -> None:
    known = handled("press-slide")
    task = replace(known, belief=Belief(rho=rho))
    axles = [pps.plan(each).segments[-1].X_BV for each in (task, known)]
    # the first plan has it wrong
    assert math.dist(axles[0].position, axles[1].position) > 0.015
    found = run(task)
    assert found["final_position_error"] < 0.005
    assert found["final_yaw_error"] < math.radians(1.0)


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_a_wrong_rho_of_a_push_is_found_out_on_the_way(share: float) -> None:
    known = handled("rear-push-rear")
    car = pps.plan(known).segments[0].drive.car
    friction = (1.9 - share) * known.support.friction
    task = replace(known, belief=Belief(rho=share * car.rho, support_friction=friction))
    first = pps.plan(task).segments[0]
    assert first.drive.car.rho == share * car.rho
    record = pps.run(task, engine="planar")
    assert record.reason == "goal_reached"
    assert len(record.meta["events"]) <= 2


def test_what_identifies_a_push_finds_the_rho_that_turns_it() -> None:
    """Twists and forces of a push on an ellipsoid, with a rho that is twice the told."""
    rho = 0.06
    task = replace(handled("rear-push-rear"), belief=Belief(rho=0.5 * rho))
    (segment,) = pps.plan(task).segments
    identifier = MODES["rear_push"].identifier(task.query, segment)
    assert identifier is not None
    known = replace(task, belief=Belief())
    assert MODES["rear_push"].identifier(known.query, segment) is None
    car = replace(segment.drive.car, rho=rho)
    X = Pose2()
    state = AxleState()
    dt = 0.004
    for i in range(800):
        steering = 0.3 * math.sin(2.0 * i * dt)
        force = car.force(steering, 3.0)
        state = identifier.step(state, i * dt, X, force)
        lever = -car.lever * (car.axis[0] * force[1] - car.axis[1] * force[0])
        twist = (0.03 * force[0], 0.03 * force[1], 0.03 * lever / rho**2)
        X = integrate(X, twist, dt)
    found = identifier.identified(state)
    assert found is not None
    assert found.rho == pytest.approx(rho, rel=0.05)
    assert found.axle == pytest.approx(rho**2 / car.lever, rel=0.1)


@pytest.mark.parametrize("name", ["press-slide", "rear-push-rear"])
@pytest.mark.parametrize("share", [0.65, 1.5])
def test_a_support_far_rougher_or_smoother_than_believed_is_made_up_for(
    name: str, share: float
) -> None:
    task = handled(name)
    believed = task.support.friction
    rough = replace(task.support, friction=share * believed)
    told = replace(task.full_belief, support_friction=believed)
    record = pps.run(replace(task, support=rough, belief=told), engine="planar")
    assert record.reason == "goal_reached"


@pytest.mark.parametrize("share", [0.55, 1.8])
@pytest.mark.parametrize("name", ["parallel-push", "orthogonal-push", "bimanual-slide"])
def test_two_tips_push_with_what_they_feel_the_support_resist_with(
    name: str, share: float
) -> None:
    task = handled(name)
    believed = task.support.friction
    rough = replace(task.support, friction=share * believed)
    told = replace(task.full_belief, support_friction=believed)
    record = pps.run(replace(task, support=rough, belief=told), engine="planar")
    assert record.reason == "goal_reached"
    moves = np.flatnonzero(record.arrays["phase"] == PHASES.index("move"))
    late = moves[len(moves) // 2 : -len(moves) // 5]
    commanded, felt = (
        np.linalg.norm(record.arrays[name][late, :, :2].sum(axis=1).mean(axis=0))
        for name in ("command_force", "measured_force")
    )
    assert commanded == pytest.approx(felt, rel=0.15)


@pytest.mark.parametrize("off", [-0.03, 0.03])
@pytest.mark.parametrize("name", ["parallel-push", "orthogonal-push"])
def test_two_pushes_tell_the_centre_of_mass_across_their_force(
    name: str, off: float
) -> None:
    task = handled(name)
    plan = pps.plan(task)
    (segment,) = plan.segments
    (nx, ny) = (
        math.fsum(contact.normal[i] for contact in segment.contacts) for i in (0, 1)
    )
    size = math.hypot(nx, ny)
    task = mistaken(task, (-off * ny / size, off * nx / size))
    unsure = replace(task.belief, center_error=0.045)
    camera = replace(task.sensing, pose_rate=30.0, position_noise=1e-3)
    record = pps.run(replace(task, belief=unsure, sensing=camera), engine="planar")
    assert record.reason == "goal_reached"
    told = record.figures["parameters"]["center_of_mass"]
    x, y = task.object.center_of_mass
    ex, ey = told["direction"]
    assert told["value"] == pytest.approx(x * ex + y * ey, abs=0.006)
