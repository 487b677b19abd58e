"""Joint paths from one placement to the next, and of two arms that keep apart."""

import math
from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.paths import all_arms, joint_path
from pushpressslide.arms.paths.all_arms import (
    APART,
    ROOMY,
    ArmPath,
    drawn_back,
    joint_paths,
)
from pushpressslide.arms.paths.approach import CAREFUL, LEAST_GAP
from pushpressslide.arms.paths.capsules import least_distance
from pushpressslide.arms.paths.clearance import CLEARANCE, LOOK
from pushpressslide.core import margins
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    Motion,
    ObjectModel,
    Obstacle,
    Robot,
    Task,
)
from pushpressslide.jobs.sampling import random_task
from pushpressslide.planning import levers
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.clearance import DrakeClearance
from pushpressslide.sim.outline import arm_capsules


def check_way_back(plan: Plan, arm: int, path: JointPath) -> None:
    """Hold the way back from a contact to what is asked of it: as long as it says,
    inside the joint limits, clear of the object and the rest.
    """
    if path.back is None:
        return
    np.testing.assert_allclose(path.back[0], path.move[-1], atol=1e-5)
    kin = arm_kinematics(plan.task.robots[arm])
    ends = kin.tip_pose(path.back[[0, -1]])[1]
    assert math.dist(*ends) == pytest.approx(path.max_retreat, abs=1e-5)
    assert path.max_retreat <= margins.ARM.retreat + 1e-9
    assert (kin.joint_margin(path.back[1:]) >= margins.ARM.joint_buffer).all()
    end = [plan.segments[-1].goal] * len(path.back)
    gap = DrakeClearance(plan, arm).min_distance(path.back, end, touching=True)
    assert gap.distance >= CLEARANCE, gap.pair


def check(
    plan: Plan,
    paths: tuple[ArmPath, ...],
    postures: tuple[np.ndarray, ...],
    moving: Collection[int] = (0, 1),
) -> None:
    """Hold the ways of the moving arms from ``postures`` to the object to what is asked
    of them.
    """
    for arm, ((path, _), posture) in enumerate(zip(paths, postures, strict=True)):
        if arm not in moving:
            continue
        np.testing.assert_array_equal(path.approach[0], posture)
        gap = DrakeClearance(plan, arm).min_distance(
            path.approach, [plan.task.start] * len(path.approach), touching=False
        )
        assert gap.distance >= CLEARANCE, gap.pair
        assert np.abs(np.diff(path.approach, axis=0)).max() < 0.1
        assert (np.diff(path.approach_time) > 0.0).all()
        check_way_back(plan, arm, path)


def keep_apart(plan: Plan, paths: tuple[ArmPath, ...]) -> None:
    (left, _), (right, _) = paths
    times = np.linspace(0.0, max(left.approach_time[-1], right.approach_time[-1]), 500)
    ways = [
        np.column_stack(
            [np.interp(times, path.approach_time, column) for column in path.approach.T]
        )
        for path in (left, right)
    ]
    one, other = (arm_capsules(robot, i) for i, robot in enumerate(plan.task.robots))
    assert least_distance(one, other, *ways, LOOK) > APART - 2e-3
    assert least_distance(one, other, left.move, right.move, LOOK) >= APART
    if left.back is not None and right.back is not None:
        assert least_distance(one, other, left.back, right.back, LOOK) >= APART


def turned(start: Pose2, point: Point, degrees: float) -> Pose2:
    """The goal that is turned about a point of B."""
    yaw = math.radians(degrees)
    cx, cy = start.apply(point)
    x, y = Pose2(0.0, 0.0, start.yaw + yaw).rotate(point)
    return Pose2(cx - x, cy - y, start.yaw + yaw)


def along_contacts(plan: Plan) -> float:
    """Least distance [m] of the two arms of ``plan`` along their contacts."""
    (left, _), (right, _) = joint_paths(DRAKE, plan)
    one, other = (arm_capsules(robot, i) for i, robot in enumerate(plan.task.robots))
    return least_distance(one, other, left.move, right.move, LOOK)


@pytest.mark.long
def test_arms_have_more_room_beside_an_object_that_may_leave_its_plan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    base = pps.load_task("bimanual-slide", ["modes=null", "tolerance.position=0.01"])
    plan = pps.plan(random_task(replace(base, obstacles=()), 1, 6006, "any"))
    unsure = replace(plan.task, belief=Belief(friction_error=0.01))
    assert APART <= along_contacts(plan) < ROOMY
    assert along_contacts(replace(plan, task=unsure)) >= ROOMY
    # where there is none, they are as near as those beside a sure one
    monkeypatch.setattr(all_arms, "ROOMY", 2.0 * LOOK)
    assert along_contacts(replace(plan, task=unsure)) >= APART


def test_an_arm_goes_from_the_top_to_the_rear_face() -> None:
    press = pps.plan(pps.load_task("press-slide"))
    first = joint_paths(DRAKE, press)
    postures = drawn_back(first)
    kin = arm_kinematics(press.task.robots[0])
    above, contact = (
        np.asarray(kin.tip_pose(q)[1]) for q in (postures[0], first[0][0].move[-1])
    )
    np.testing.assert_allclose(
        above - contact, (0.0, 0.0, margins.ARM.retreat), atol=1e-5
    )
    start = press.segments[-1].goal
    push = pps.plan(
        replace(
            press.task,
            start=start,
            goal=start.compose(Pose2(0.15, 0.0, 0.0)),
            modes=("rear_push",),
            motion=Motion(),
        )
    )
    check(push, joint_paths(DRAKE, push, postures=postures), postures)


def test_an_arm_that_holds_keeps_its_posture_and_the_other_goes_round_it() -> None:
    start = Pose2(0.5, 0.0, 0.0)
    point = (-0.08, 0.10)
    there = Task(
        "there",
        ObjectModel(Box((0.4, 0.3, 0.1)), 2.0, (0.0, 0.0)),
        start,
        turned(start, point, 25.0),
        tuple(Robot("iiwa7", (0.0, y, 0.2)) for y in (0.4, -0.4)),
        contact_friction=0.8,
        belief=Belief(0.3, 0.8, 2.0),
        motion=Motion(contacts=(point,)),
        modes=("press_and_push",),
    )
    turn = pps.plan(there)
    on = pps.plan(
        replace(there, name="on", start=there.goal, goal=turned(start, point, 50.0))
    )
    first = joint_paths(DRAKE, turn)
    postures = drawn_back(first, frozenset({0}))
    np.testing.assert_array_equal(postures[0], first[0][0].move[-1])
    paths = joint_paths(DRAKE, on, postures=postures, holding=frozenset({0}))
    held, _ = paths[0]
    assert (held.approach == postures[0]).all()
    np.testing.assert_allclose(held.move[0], postures[0], atol=1e-5)
    check(on, paths, postures, {1})
    keep_apart(on, paths)


@pytest.mark.long
def test_two_arms_turn_a_large_box_and_push_it_into_a_slot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The paper's third experiment: the right arm turns with the face, which only
    refinement makes possible, then both go round to the rear.
    """
    start = Pose2(0.38, -0.26, 0.0)
    point = (-0.11, 0.205)
    goal = turned(start, point, 90.0)
    size = (0.6, 0.8, 0.7)
    monkeypatch.setattr(levers, "PLACES", [0.5 - 0.2 / 0.76])
    slot = tuple(
        Obstacle(f"slot_{i}", Box(size), Pose2(1.385, goal.y + i * 0.62, 0.5 * math.pi))
        for i in (1, -1)
    )
    stands = ((0.75, -0.30), (-0.75, -0.35))
    task = Task(
        "turn",
        ObjectModel(Box(size), 5.0, (0.0, 0.0)),
        start,
        goal,
        tuple(
            Robot("iiwa7", (0.0, y, 0.3), yaw, tip_radius=0.03, tip_length=0.12)
            for y, yaw in stands
        ),
        contact_friction=0.7,
        belief=Belief(0.3, 0.7, 5.0),
        obstacles=slot,
        modes=("press_and_push",),
        motion=Motion(contacts=(point,), face=3, contact_height=0.2),
    )
    turn = pps.plan(task)
    push = pps.plan(
        replace(
            task,
            name="push",
            start=goal,
            goal=Pose2(goal.x + 0.55, goal.y, goal.yaw),
            modes=("parallel_push",),
            motion=Motion(contact_height=0.45),
        )
    )
    with monkeypatch.context() as grid_alone:
        grid_alone.setattr(joint_path, "REFINED", 0)
        with pytest.raises(InfeasibleTaskError, match="and object come as near as"):
            joint_paths(DRAKE, turn)
    first = joint_paths(DRAKE, turn)
    keep_apart(turn, first)
    postures = drawn_back(first)
    second = joint_paths(DRAKE, push, postures=postures)
    keep_apart(push, second)
    check(push, second, postures)


def drawn(name: str, index: int, seed: int) -> Plan:
    """Return the plan of a random task of one motion."""
    task = random_task(pps.load_task(name, ["limits.legs=1"]), index, seed, "any")
    return pps.plan(task)


@pytest.mark.long
def test_tips_are_drawn_back_no_farther_than_the_arms_keep_apart() -> None:
    plan = drawn("orthogonal-push", 60, 1203)
    paths = joint_paths(DRAKE, plan)
    assert all(path.max_retreat < margins.ARM.retreat for path, _ in paths)
    check(plan, paths, tuple(path.approach[0] for path, _ in paths))
    keep_apart(plan, paths)


@pytest.mark.long
def test_an_arm_feels_for_its_contact_from_where_it_is_not_stretched() -> None:
    plan = drawn("parallel-push", 170, 1202)
    for arm, (path, _) in enumerate(joint_paths(DRAKE, plan)):
        kin = arm_kinematics(plan.task.robots[arm])
        assert path.touch is not None
        conditions = np.linalg.cond(kin.jacobian(path.touch))
        assert conditions.max() <= max(CAREFUL.condition, conditions[-1])
        assert LEAST_GAP <= path.gap <= plan.task.motion.approach_distance
