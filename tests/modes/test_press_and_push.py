"""One arm pins a point of the top, the other turns the object about it: loads,
refusals, runs.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core import margins
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Point, Pose2, cross
from pushpressslide.core.record import Record
from pushpressslide.core.task import (
    Belief,
    Box,
    Motion,
    ObjectModel,
    Robot,
    Task,
    Tolerance,
)
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.jobs.sampling import varied_task
from pushpressslide.modes.base import Measured
from pushpressslide.modes.press_and_push import MODE
from pushpressslide.planar.engine import run as run_planar
from pushpressslide.planning import levers
from pushpressslide.report import series
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import PinnedDrive

CORNER = (-0.08, 0.10)  # of the small box, in B
HANDS = tuple(Robot("hand", (0.0, y, 0.2)) for y in (0.4, -0.4))


@pytest.fixture
def far_push(monkeypatch: pytest.MonkeyPatch) -> None:
    """Push the large box 0.2 m off the middle of its face."""
    monkeypatch.setattr(levers, "PLACES", [0.5 - 0.2 / 0.76])


def turned(start: Pose2, point: Point, degrees: float) -> Pose2:
    """The goal that is turned about a point of B."""
    yaw = math.radians(degrees)
    cx, cy = start.apply(point)
    x, y = Pose2(0.0, 0.0, start.yaw + yaw).rotate(point)
    return Pose2(cx - x, cy - y, start.yaw + yaw)


def pivot(point: Point = CORNER, degrees: float = 45.0, **changes) -> Task:
    """A 2 kg box in front of two arms, to be turned about ``point``."""
    start = Pose2(0.5, 0.0, 0.0)
    task = Task(
        "pivot",
        ObjectModel(Box((0.4, 0.3, 0.1)), 2.0, (0.0, 0.0)),
        start,
        turned(start, point, degrees),
        tuple(Robot("iiwa7", (0.0, y, 0.2)) for y in (0.4, -0.4)),
        contact_friction=0.8,
        tolerance=Tolerance(0.005, math.radians(1.0)),
        belief=Belief(0.3, 0.8, 2.0),
    )
    return replace(task, **changes)


def big_box(mass: float, press: float | None, support: float, contact: float) -> Task:
    """The 0.6 x 0.8 x 0.7 m box of the paper's third experiment, turned by 90 degrees
    by two free tips.
    """
    start = Pose2(0.38, -0.26, 0.0)
    press_at = (-0.11, 0.205)
    task = pivot(
        start=start, goal=turned(start, press_at, 90.0), contact_friction=contact
    )
    return replace(
        task,
        object=ObjectModel(Box((0.6, 0.8, 0.7)), mass, (0.0, 0.0)),
        robots=tuple(
            Robot("hand", (0.0, y, 0.3), tip_radius=0.03) for y in (0.75, -0.75)
        ),
        support=replace(task.support, friction=support),
        belief=Belief(support, contact, mass),
        limits=replace(task.limits, normal_force=100.0),
        motion=Motion(
            contacts=(press_at,), face=3, contact_height=0.2, press_force=press
        ),
    )


def best(task: Task) -> Choice:
    choice = MODE.choices(task.query)[0]
    assert choice.feasible, choice.reason
    return choice


def driven(of: Choice | Plan) -> PinnedDrive:
    drive = of.segments[0].drive
    assert isinstance(drive, PinnedDrive)
    return drive


def side_force(made: Plan) -> float:
    """The push [N] with which the planned twist is driven."""
    (segment,) = made.segments
    drive = driven(made)
    assert isinstance(segment.path, TwistPath)
    wrench = drive.surface.wrench(segment.path.initial_twist(drive.pin))
    mu = made.task.scene.contact_friction
    allocate = MODE.allocator(segment.contacts, mu, drive.rho, drive.center)
    return allocate(wrench.fx, wrench.fy, wrench.tau).normals[1]


def refusal(task: Task) -> str:
    choices = MODE.choices(task.query)
    assert not any(choice.feasible for choice in choices)
    return choices[0].reason


def strayed(made: Plan, record: Record) -> float:
    """How far the pressed point was from its place at most [m]."""
    point = made.contacts[0].point
    X_GB = made.task.object.X_GB
    poses = [
        Pose2(*pose).compose(X_GB).apply(point)
        for pose in record.arrays["object_pose"][::20]
    ]
    return max(math.dist(pose, poses[0]) for pose in poses)


@pytest.mark.parametrize("degrees", [45.0, -30.0])
@pytest.mark.parametrize("point", [CORNER, (0.1, -0.05), (0.0, 0.12)])
def test_the_object_turns_about_the_pressed_point(point: Point, degrees: float) -> None:
    made = pps.plan(pivot(point, degrees, robots=HANDS, modes=("press_and_push",)))
    record = run_planar(made)
    measured = result(made.task, made, record, {})
    assert measured["success"], measured["reason"]
    assert measured["final_yaw_error"] < math.radians(0.1)
    assert strayed(made, record) < 2e-4
    assert measured["slip_distance"] < 1e-4


@pytest.mark.parametrize("degrees", [50.0, -50.0])
def test_every_push_has_a_lever_to_the_right_side_the_longest_first(
    degrees: float,
) -> None:
    choices = MODE.choices(pivot(degrees=degrees, robots=HANDS).query)
    levers = []
    for choice in choices:
        press, push = choice.contacts
        assert press.kind == "top"
        assert press.point == pytest.approx(CORNER)
        assert {press.arm, push.arm} == {0, 1}
        arm = (push.point[0] - press.point[0], push.point[1] - press.point[1])
        levers.append(math.copysign(1.0, degrees) * cross(arm, push.normal))
    assert min(levers) > 0.0
    feasible = [
        lever for lever, choice in zip(levers, choices, strict=True) if choice.feasible
    ]
    assert feasible == sorted(feasible, reverse=True)


def test_the_press_is_the_least_that_is_safe() -> None:
    choice = best(pivot())
    use = driven(choice).friction_utilisation
    assert use == pytest.approx(margins.PIN_USES[0], abs=0.02)
    lighter = replace(pivot(), motion=Motion(press_force=0.8 * choice.contacts[0].load))
    assert driven(best(lighter)).friction_utilisation > margins.PIN_USES[0]


@pytest.mark.parametrize(
    "case",
    [
        (5.0, 60.0, 0.3, 0.7),
        (10.0, 80.0, 0.3, 0.7),
        (5.0, 60.0, 0.4, 0.8),
        (5.0, None, 0.3, 0.7),
    ],
)
def test_the_forces_that_a_large_box_takes_are_foreseen(case, far_push) -> None:
    made = pps.plan(replace(big_box(*case), modes=("press_and_push",)))
    record = run_planar(made)
    assert result(made.task, made, record, {})["success"]
    assert strayed(made, record) < 2e-4
    moving = series.in_phase(record, "move")
    normals, tangents = series.contact_forces(made, record)
    drive = driven(made)
    shear = float(np.median(np.linalg.norm(tangents[moving, 0], axis=1)))
    held = made.task.contact_friction * float(np.median(normals[moving, 0]))
    assert shear / held == pytest.approx(drive.friction_utilisation, rel=0.05)
    push = float(np.median(normals[moving, 1]))
    assert push == pytest.approx(side_force(made), rel=0.03)


def test_a_goal_that_is_not_turned_about_a_point_of_the_top_is_refused_with_the_distance() -> (
    None
):
    start = Pose2(0.5, 0.0, 0.0)
    why = refusal(pivot(goal=Pose2(0.5, 0.2, 0.0)))
    assert "turned by 0.0 deg, allowed from 3 deg" in why
    why = refusal(pivot(goal=turned(start, (-0.25, 0.0), 40.0)))
    assert "-50 mm inside the top, allowed from 12 mm" in why
    edge = 0.5 * 0.4 - pivot().scene.inset
    assert best(pivot(goal=turned(start, (-edge + 0.001, 0.0), 40.0))).feasible
    why = refusal(pivot(goal=turned(start, (-edge - 0.001, 0.0), 40.0)))
    assert "11 mm inside the top" in why


def test_a_given_point_that_would_have_to_move_is_refused_with_how_far() -> None:
    given = replace(pivot(), motion=Motion(contacts=(CORNER,)))
    assert best(given).contacts[0].point == pytest.approx(CORNER)
    off = replace(given, motion=Motion(contacts=((CORNER[0] - 0.04, CORNER[1]),)))
    apart = 2.0 * 0.04 * math.sin(0.5 * math.radians(45.0)) * 1e3
    assert f"start and goal have it {apart:.1f} mm apart, allowed 5 mm" in refusal(off)


def test_forces_beyond_the_limit_are_refused() -> None:
    why = refusal(replace(pivot(), motion=Motion(press_force=60.0)))
    allowed = "allowed 36 N by limits.normal_force"
    assert f"motion.press_force of 60 N, {allowed}" in why
    task = big_box(20.0, None, 0.3, 0.7)
    tight = replace(task, limits=replace(task.limits, normal_force=30.0))
    assert "a press of 27 N by limits.normal_force" in refusal(tight)


def test_no_lever_no_pivot() -> None:
    sphere = replace(pivot((0.0, 0.0)), motion=Motion(face=7))
    least = margins.LEAST_LEVER * sphere.object.radius * 1e3
    assert f"no face has a lever of {least:.0f} mm" in refusal(sphere)


def test_a_plan_made_anew_keeps_to_where_the_tips_truly_are() -> None:
    task = pivot()
    made = pps.plan(task, best(task))
    press, push = (contact.point for contact in made.contacts)
    touched = ((press[0] + 0.004, press[1] - 0.003), (push[0], push[1] + 0.005))
    X_WB = Pose2(0.503, 0.004, 0.1)
    contacts = made.segments[0].contacts
    off = Measured.touching(X_WB, contacts, touched, 1.0)
    (fresh,) = MODE.replan(task.query, made.segments, off)
    assert tuple(contact.point for contact in fresh.contacts) == touched
    assert fresh.X_BV.position == touched[0]
    length = fresh.path.length
    goal = made.object_pose(fresh, length)
    assert math.dist(goal.position, task.goal.position) < 1e-9
    scant = Measured.touching(X_WB, contacts, touched, 0.5 * length)
    assert MODE.replan(task.query, made.segments, scant) == ()


def test_a_push_cannot_turn_the_object_back() -> None:
    task = pivot()
    made = pps.plan(task, best(task))
    touched = tuple(contact.point for contact in made.contacts)
    (segment,) = made.segments
    X_WB = turned(task.start, CORNER, 50.0)
    beyond = Measured.touching(X_WB, segment.contacts, touched)
    assert MODE.retry(task.query, segment, beyond) == ()
    X_WB = turned(task.start, CORNER, 43.0)
    short = Measured.touching(X_WB, segment.contacts, touched)
    assert len(MODE.retry(task.query, segment, short)) == 1


@pytest.mark.long
@pytest.mark.parametrize("index", [None, 1])
def test_two_arms_turn_a_box_about_a_point_near_its_corner_on_drake(
    index: int | None,
) -> None:
    from pushpressslide.sim.engine import run as run_drake

    task = pivot() if index is None else varied_task(pivot(), index, seed=3)
    made = pps.plan(replace(task, modes=("press_and_push",)))
    record = run_drake(made)
    measured = result(made.task, made, record, {})
    assert measured["success"], measured["reason"]
    assert measured["torque_limit_violation_fraction"] == 0.0
    if index is None:
        assert strayed(made, record) < 2e-3
        assert measured["slip_distance"] < 5e-3


@pytest.mark.long
def test_a_large_box_turns_by_ninety_degrees_about_the_pressed_point_on_drake(
    far_push,
) -> None:
    from pushpressslide.arms.paths.joint_path import joint_path
    from pushpressslide.sim.arm_library import DRAKE
    from pushpressslide.sim.engine import run as run_drake

    made = pps.plan(replace(big_box(5.0, 60.0, 0.3, 0.7), modes=("press_and_push",)))
    paths = tuple(joint_path(DRAKE, made, arm, force=True) for arm in (0, 1))
    record = run_drake(made, paths=[paths])
    measured = result(made.task, made, record, {})
    # the arms are placed by force: how near they come to the box is not asked
    assert record.reason == "goal_reached"
    assert measured["final_position_error"] < made.task.tolerance.position
    assert measured["final_yaw_error"] < math.radians(0.5)
    assert strayed(made, record) < 2e-3
    normals, tangents = series.contact_forces(made, record)
    moving = series.in_phase(record, "move")
    drive = driven(made)
    shear = np.linalg.norm(tangents[moving, 0], axis=1)
    use = float(np.median(shear / (0.7 * normals[moving, 0])))
    assert use == pytest.approx(drive.friction_utilisation, rel=0.1)
    push = float(np.median(normals[moving, 1]))
    assert push == pytest.approx(side_force(made), rel=0.1)
