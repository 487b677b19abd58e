"""Worlds of the planar engine that differ from what the controller believes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import TipCommand
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, ObjectModel, Robot, Task
from pushpressslide.core.true_task import true_task
from pushpressslide.core.truth import Truth
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.ground import speed_factors
from pushpressslide.planar import cell
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planar.engine import run
from pushpressslide.planar.physics import PlanarPhysics
from pushpressslide.planar.uneven_friction import UnevenGround
from pushpressslide.planar.world import World, WorldState

DT = 0.004
MU = 0.3
MASS = 1.2
RADIUS = 0.02
REAR = Contact(0, "side", (-0.075, 0.0), (1.0, 0.0), 0.03)
PLAN = pps.plan(pps.load_task("rear-push-rear"))


def world_of(truth: Truth) -> World:
    task = Task(
        "box",
        ObjectModel(Box((0.15, 0.1, 0.1)), MASS),
        Pose2(),
        Pose2(0.2, 0.0),
        (Robot("hand", tip_radius=RADIUS),),
        truth=truth,
    )
    ground = UnevenGround.if_uneven(truth, 1)
    return World(true_task(task, 1), (REAR,), DT, ground)


def sliding(world: World, speed: float, yaw: float = 0.0) -> WorldState:
    """A box that slides along the world's x axis, without a tip."""
    pose = Pose2(0.0, 0.0, yaw)
    state = world.start(pose, pose, 1.0)
    twist = Twist(speed * math.cos(yaw), -speed * math.sin(yaw), 0.0)
    return state._replace(twist=twist)


def deceleration(
    truth: Truth, speed: float, time: float = 0.0, yaw: float = 0.0
) -> float:
    """Deceleration in a tick over that of the plain friction."""
    world = world_of(truth)
    before = sliding(world, speed, yaw)
    after = world.step(before, [None], (0.0, 0.0, 0.0), time)
    ends = [math.hypot(state.twist.vx, state.twist.vy) for state in (before, after)]
    return (ends[0] - ends[1]) / (DT * MU * GRAVITY)


@pytest.mark.parametrize("speed", [0.05, 0.1, 0.3])
@pytest.mark.parametrize("share", [0.4, -0.4])
def test_a_sliding_box_slows_down_by_the_friction_at_its_speed(
    share: float, speed: float
) -> None:
    truth = Truth(friction_speed=share)
    (factor,) = speed_factors(truth, np.array([speed]))
    assert abs(factor - 1.0) > 0.2
    assert deceleration(truth, speed) == pytest.approx(factor, rel=1e-3)
    assert deceleration(Truth(), speed) == pytest.approx(1.0, rel=1e-3)


def test_a_sliding_box_slows_down_more_each_minute() -> None:
    truth = Truth(friction_drift=0.5)
    for time, factor in ((0.0, 1.0), (60.0, 1.5)):
        assert deceleration(truth, 0.2, time) == pytest.approx(factor, rel=1e-3)


@pytest.mark.parametrize("yaw", [0.0, 0.6])
def test_a_sliding_box_slows_down_more_across_the_grain(yaw: float) -> None:
    for grain, factor in ((0.0, 0.75), (0.5 * math.pi, 1.25)):
        truth = Truth(friction_direction=0.5, grain_yaw=grain)
        slowed = deceleration(truth, 0.2, yaw=yaw)
        assert slowed == pytest.approx(factor, rel=1e-3)


def pushing(state: WorldState, force: float) -> TipCommand:
    return TipCommand(
        (force, 0.0, 0.0),
        state.tips[0].position,
        (0.0, 0.0, 0.0),
        stiffness=(0.0, 0.0, 0.0),
        damping=(500.0, 500.0, 500.0),
        normal_yaw=0.0,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=math.inf,
        progress=0.0,
    )


def least_push(truth: Truth) -> tuple[float, float]:
    """Push over friction at which a box begins to move, and below which it stops."""
    world = world_of(truth)
    state = world.start(Pose2(), Pose2(), 0.0)
    friction = MU * MASS * GRAVITY
    moved: list[float] = []
    rising = np.linspace(0.5, 2.0, 301).tolist()
    for share in rising:
        for _ in range(40):
            state = world.step(state, [pushing(state, share * friction)])
        if state.twist.vx > 1e-6:
            moved.append(share)
            break
    for share in reversed([one for one in rising if one <= moved[0]]):
        for _ in range(40):
            state = world.step(state, [pushing(state, share * friction)])
        if state.twist.vx < 1e-6:
            moved.append(share)
            break
    start, end = moved
    return start, end


def test_a_box_breaks_loose_at_the_static_friction_and_stops_below_it() -> None:
    assert least_push(Truth()) == pytest.approx((1.0, 1.0), abs=0.011)
    start, end = least_push(Truth(static_friction=1.4))
    assert start == pytest.approx(1.4, abs=0.011)
    # 500 N s/m damp it: it moves at millimetres a second, below which friction grows
    assert 1.1 < end < start - 0.05


def test_a_tilt_pulls_at_the_object_and_friction_holds_it() -> None:
    tilt = math.radians(3.0)
    world = world_of(Truth(tilt=tilt, tilt_yaw=0.5 * math.pi))
    assert world.weight == pytest.approx((0.0, MASS * GRAVITY * math.sin(tilt)))
    assert world.own_load == pytest.approx(MASS * GRAVITY * math.cos(tilt))
    state = world.start(Pose2(), Pose2(), 1.0)
    for _ in range(250):
        state = world.step(state, [None])
    assert math.hypot(*state.X_WB.position) < 1e-6
    # pushed along x, it yields along y as well
    state = world.start(Pose2(), Pose2(), 0.0)
    for _ in range(50):
        state = world.step(state, [pushing(state, 1.1 * MU * MASS * GRAVITY)])
    assert state.X_WB.x > 1e-4
    assert state.X_WB.y > 0.1 * state.X_WB.x


def test_a_sliding_box_on_a_tilt_goes_on_longer_downhill() -> None:
    tilt = math.radians(3.0)
    lost = math.cos(tilt) - math.sin(tilt) / MU
    truth = Truth(tilt=tilt)
    assert deceleration(truth, 0.2) == pytest.approx(lost, rel=1e-3)


def contact_at(truth: Truth) -> float:
    """Place [m] of the tip along x when it touches a box at rest."""
    world = world_of(truth)
    state = world.start(Pose2(), Pose2(), 0.005)
    for _ in range(2000):
        state = world.step(state, [pushing(state, 1.0)])
        if state.contacts[0] != "free":
            return state.tips[0].position[0]
    raise AssertionError


def test_a_larger_box_and_a_larger_tip_are_touched_earlier() -> None:
    plain = contact_at(Truth())
    assert plain == pytest.approx(-0.075 - RADIUS, abs=1e-5)
    larger = contact_at(Truth(size=(0.006, 0.0)))
    assert larger - plain == pytest.approx(-0.003, abs=1e-5)
    rounder = contact_at(Truth(tip_radius=0.004))
    assert rounder - plain == pytest.approx(-0.004, abs=1e-5)


def test_a_bowed_base_resists_a_turn_more_or_less() -> None:
    turned = []
    for bow in (-0.9, 0.0, 0.9):
        _, friction, _ = world_of(Truth(bow=bow)).support.under((0.0, 0.0))
        turned.append(friction.wrench((0.0, 0.0, 1.0), 1.0)[2])
    assert turned[0] < 0.85 * turned[1]
    assert turned[2] > 1.12 * turned[1]


def test_a_base_on_far_feet_resists_a_turn_more_and_on_near_ones_less() -> None:
    turned = []
    for feet in (0.3, 0.0, 0.9):
        _, friction, _ = world_of(Truth(feet=feet)).support.under((0.0, 0.0))
        turned.append(friction.wrench((0.0, 0.0, 1.0), 1.0)[2])
    assert turned[0] < 0.7 * turned[1]
    assert turned[2] > 1.2 * turned[1]


def with_truth(truth: Truth, plan: Plan = PLAN) -> Plan:
    return replace(plan, task=replace(plan.task, truth=truth))


@pytest.mark.parametrize(
    ("truth", "field"),
    [
        (Truth(obstacle_offset=0.01), r"truth\.obstacle_offset.*obstacles"),
        (Truth(ridge=0.0005), r"truth\.ridge.*heights"),
        (Truth(tilt=math.radians(20.0)), r"truth\.tilt_deg: 20.*planar"),
    ],
)
def test_what_the_engine_does_not_have_is_refused(truth: Truth, field: str) -> None:
    with pytest.raises(TaskError, match=field):
        planar_cell(with_truth(truth))


def test_the_next_placement_is_in_the_same_world() -> None:
    plan = with_truth(Truth(size=(0.01, 0.0), friction_patches=0.3))
    physics = PlanarPhysics(plan, seed=4)
    first = physics._world
    physics.hand_over(plan, frozenset())
    assert physics._world is not first
    assert physics._world.task == first.task == true_task(plan.task, 4)
    assert physics._world.ground is first.ground


def test_all_stages_are_in_one_world(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds = []

    def physics(plan: Plan, begin: object, seed: int) -> PlanarPhysics:
        seeds.append(seed)
        return PlanarPhysics(plan, begin, seed)

    monkeypatch.setattr(cell, "PlanarPhysics", physics)
    pps.run("swap", engine="planar", seed=3, overrides={"limits.time": 30})
    assert len(seeds) > 1
    assert set(seeds) == {3}


WORLDS = {
    "static friction": Truth(static_friction=1.5),
    "friction that falls": Truth(friction_speed=0.4),
    "patches": Truth(friction_patches=0.3),
    "drift": Truth(friction_drift=1.0),
    "larger": Truth(size=(0.005, 0.005)),
    "round tip": Truth(tip_radius=0.002),
    "tilt": Truth(tilt=math.radians(0.5), tilt_yaw=math.radians(60.0)),
    "rim": Truth(bow=0.8),
    "feet": Truth(feet=0.85),
}


def assert_reaches(plan: Plan) -> None:
    record = run(plan, RunOptions(seed=1))
    x, y, yaw = record.arrays["object_pose"][-1]
    goal = plan.task.goal
    tolerance = plan.task.tolerance
    assert math.dist((x, y), goal.position) < tolerance.position
    assert abs(math.remainder(yaw - goal.yaw, math.tau)) < tolerance.yaw


@pytest.mark.parametrize("name", WORLDS)
def test_a_push_still_reaches_its_goal(name: str) -> None:
    assert_reaches(with_truth(WORLDS[name]))


def test_two_tips_push_across_a_grain() -> None:
    grain = Truth(friction_direction=0.1, grain_yaw=math.radians(30.0))
    assert_reaches(with_truth(grain, pps.plan("parallel-push")))
