"""Worlds in Drake that differ from what the controller believes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.model import at_rest
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Obstacle
from pushpressslide.core.task import Box
from pushpressslide.core.true_task import true_task
from pushpressslide.core.truth import Truth
from pushpressslide.mechanics.ground import Ground, speed_factors
from pushpressslide.planar.support import Support
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.sim.arm_library import joint_paths_of
from pushpressslide.sim.arm_model import DrakeArmModel
from pushpressslide.sim.cell import drake_cell
from pushpressslide.sim.convert import planar_pose_from_positions, planar_twist
from pushpressslide.sim.engine import run
from pushpressslide.sim.station import Station

PLAN = pps.plan(pps.load_task("rear-push-rear"))
SHAPE = PLAN.task.object.shape
TICK = 0.004
POST = Obstacle("post", Box((0.05, 0.05, 0.2)), Pose2(0.2, -0.6))


def station_of(truth: Truth, friction: float = 0.3, **changes: object) -> Station:
    support = replace(PLAN.task.support, friction=friction)
    changed = replace(PLAN.task, truth=truth, support=support, **changes)
    return Station(replace(PLAN, task=changed), time_step=0.001, seed=1)


def slid(station: Station, speed: float, ticks: int, begin: float = 0.0) -> np.ndarray:
    """Speeds (ticks + 1,) [m/s] along x of the object, which starts with ``speed``."""
    plant = station.plant
    body = station.scene.object
    first = body.floating_positions_start()
    velocity = body.floating_velocities_start_in_v()
    v = plant.GetVelocities(station.plant_context)
    v[velocity + 3] = speed
    plant.SetVelocities(station.plant_context, v)
    station.simulator.Initialize()
    start = plant.num_positions() + velocity
    speeds = []
    for tick in range(ticks + 1):
        x = station.state_vector().tolist()
        pose = planar_pose_from_positions(x[first : first + 7])
        speeds.append(planar_twist(x[start : start + 6])[0])
        station.disturb(x, pose, begin + tick * TICK)
        station.simulator.AdvanceTo((tick + 1) * TICK)
    return np.array(speeds)


def factors_of(speeds: np.ndarray) -> np.ndarray:
    """Decelerations over that of a friction of 0.3, in each tick."""
    return -np.diff(speeds) / (TICK * 0.3 * GRAVITY)


@pytest.mark.parametrize("share", [0.4, -0.4])
def test_a_sliding_object_slows_down_by_the_friction_at_its_speed(share: float) -> None:
    truth = Truth(friction_speed=share)
    speeds = slid(station_of(truth), 0.25, 12)
    wanted = speed_factors(truth, speeds[:-1])
    np.testing.assert_allclose(factors_of(speeds)[1:], wanted[1:], rtol=0.02)
    plain = factors_of(slid(station_of(Truth()), 0.25, 12))
    np.testing.assert_allclose(plain[1:], 1.0, rtol=0.02)


def test_friction_drifts_and_is_the_mean_of_the_patches_under_the_object() -> None:
    truth = Truth(friction_drift=0.5)
    factors = factors_of(slid(station_of(truth), 0.25, 10, begin=60.0))
    np.testing.assert_allclose(factors[1:], 1.5, rtol=0.02)
    truth = Truth(friction_patches=0.4, patch_size=0.03)
    factors = factors_of(slid(station_of(truth), 0.25, 6))
    points, areas = SHAPE.base_rule(8)
    ground = Ground.of_truth(truth, 1)
    start = PLAN.true_start
    under = ground.under(points, start, (0.0, 0.0, 0.0), 0.0)
    mean = under @ areas / areas.sum()
    assert abs(mean - 1.0) > 0.03
    np.testing.assert_allclose(factors[1:3], mean, rtol=0.03)


def test_a_tilt_moves_what_friction_does_not_hold() -> None:
    tilt = math.radians(10.0)
    ticks = 30
    net = math.sin(tilt) - 0.15 * math.cos(tilt)
    (*_, down) = slid(station_of(Truth(tilt=tilt), 0.15), 0.0, ticks)
    assert down == pytest.approx(ticks * TICK * GRAVITY * net, rel=0.03)
    (*_, up) = slid(station_of(Truth(tilt=tilt, tilt_yaw=math.pi), 0.15), 0.0, ticks)
    assert up == pytest.approx(-down, rel=1e-3)
    held = Truth(tilt=tilt, static_friction=1.5)
    (*_, still) = slid(station_of(held, 0.15), 0.0, ticks)
    assert abs(still) < 2e-4
    (*_, loose) = slid(station_of(replace(held, static_friction=1.1), 0.15), 0.0, ticks)
    assert loose > 0.7 * down


def test_object_tips_and_obstacles_have_their_true_sizes_and_places() -> None:
    truth = Truth(size=(0.006, 0.0), tip_radius=0.003, obstacle_offset=0.01)
    station = station_of(truth, obstacles=(POST,))
    inspector = station.scene.scene_graph.model_inspector()
    plant = station.plant

    def shape_of(name: str):
        (found,) = (
            one
            for one in inspector.GetAllGeometryIds()
            if inspector.GetName(one).split("::")[-1] == name
            and inspector.GetProximityProperties(one)
        )
        return found, inspector.GetShape(found)

    _, box = shape_of("object")
    assert box.width() == pytest.approx(SHAPE.size[0] + 0.006)
    assert box.depth() == pytest.approx(SHAPE.size[1])
    tip = inspector.GetShape(station.scene.robots[0].tip_geometry)
    assert tip.radius() == pytest.approx(PLAN.task.robots[0].tip_radius + 0.003)
    post, _ = shape_of("post")
    X = inspector.GetPoseInFrame(post).translation()
    task = replace(PLAN.task, truth=truth, obstacles=(POST,))
    true = true_task(task, 1).obstacles[0].pose
    np.testing.assert_allclose(X[:2], true.position, atol=1e-9)
    assert math.dist(true.position, POST.pose.position) > 1e-3
    assert plant.num_bodies() > 0


def spun(truth: Truth) -> float:
    """Mean deceleration [rad/s^2] of an object that spins on the spot."""
    station = station_of(truth)
    plant = station.plant
    first = station.scene.object.floating_velocities_start_in_v()
    station.simulator.AdvanceTo(0.1)
    v = plant.GetVelocities(station.plant_context)
    v[first + 2] = 4.0
    plant.SetVelocities(station.plant_context, v)
    station.simulator.AdvanceTo(0.136)
    return (4.0 - plant.GetVelocities(station.plant_context)[first + 2]) / 0.036


def test_a_bowed_base_resists_a_turn_as_the_planar_engine_has_it() -> None:
    even = spun(Truth())
    support = Support(SHAPE, PLAN.task.object.center_of_mass)
    for bow in (0.9, -0.9):
        bent = Support(SHAPE, PLAN.task.object.center_of_mass, bow)
        moments = [
            one.under((0.0, 0.0))[1].wrench((0.0, 0.0, 1.0), 1.0)[2]
            for one in (bent, support)
        ]
        ratio = moments[0] / moments[1]
        assert abs(ratio - 1.0) > 0.15
        assert spun(Truth(bow=bow)) / even == pytest.approx(ratio, abs=0.02)


def test_an_object_climbs_a_ridge_and_leans_on_it() -> None:
    for height in (0.0005, 0.002):
        station = station_of(Truth(ridge=height, ridge_place=0.3))
        plant = station.plant
        first = station.scene.object.floating_positions_start()
        velocity = station.scene.object.floating_velocities_start_in_v()
        rises, leans = [], []
        for tick in range(1000):
            v = plant.GetVelocities(station.plant_context)
            v[velocity + 3] = max(v[velocity + 3], 0.1)
            plant.SetVelocities(station.plant_context, v)
            station.simulator.AdvanceTo((tick + 1) * TICK)
            _, qx, qy, _, _, _, z = station.state_vector()[first : first + 7]
            rises.append(z - 0.5 * SHAPE.height)
            leans.append(2.0 * math.hypot(qx, qy))
        # least: it lies on the ridge and on its own far edge
        least = math.atan(height / math.hypot(*SHAPE.size[:2]))
        assert max(rises) == pytest.approx(height, rel=0.15)
        assert least < max(leans) < 4.0 * least


def test_a_ridge_has_the_friction_of_its_support_and_obstacles_their_own() -> None:
    bridge = replace(POST, name="bridge")
    truth = Truth(ridge=0.002, ridge_place=0.3, friction_drift=0.5)
    station = station_of(truth, obstacles=(bridge,))
    graph = station.scene.scene_graph
    inspector = graph.model_inspector()
    before = coefficients(inspector)
    station.disturb(station.state_vector().tolist(), PLAN.true_start, 60.0)
    context = graph.GetMyContextFromRoot(station.context)
    after = coefficients(graph.get_query_output_port().Eval(context).inspector())
    changed = {name for name in before if after[name] != before[name]}
    assert changed == {"support", "support_ridge"}


def coefficients(inspector) -> dict[str, float]:
    """Friction of each contact surface of the world."""
    return {
        inspector.GetName(one).split("::")[-1]: inspector.GetProximityProperties(one)
        .GetProperty("material", "coulomb_friction")
        .static_friction()
        for one in inspector.GetGeometries(inspector.world_frame_id())
        if inspector.GetProximityProperties(one)
    }


def test_feet_are_refused() -> None:
    with pytest.raises(TaskError, match=r"truth\.feet.*engine drake"):
        station_of(Truth(feet=0.8))


def test_a_grain_is_refused() -> None:
    with pytest.raises(TaskError, match=r"truth\.friction_direction.*engine drake"):
        station_of(Truth(friction_direction=0.2))


@pytest.mark.parametrize(
    "truth",
    [Truth(friction_patches=0.2), Truth(bow=0.5), Truth(ridge=0.0005)],
    ids=["patches", "bow", "ridge"],
)
def test_a_support_with_edges_is_even(truth: Truth) -> None:
    region = ((-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0))
    edged = replace(PLAN.task.support, region=region)
    task = replace(PLAN.task, support=edged, truth=truth)
    with pytest.raises(TaskError, match="with edges"):
        Station(replace(PLAN, task=task))


WORLDS = {
    "friction": Truth(static_friction=1.3, friction_speed=0.3, friction_patches=0.2),
    "sizes": Truth(size=(0.004, -0.004), tip_radius=0.002, bow=0.5),
    "tilt": Truth(tilt=math.radians(0.5), tilt_yaw=math.radians(60.0)),
    "backlash": Truth(backlash=math.radians(0.05)),
    "ridge": Truth(ridge=0.0005, ridge_angle=math.radians(20.0)),
}


@pytest.mark.long
@pytest.mark.parametrize("name", WORLDS)
def test_a_push_still_reaches_its_goal(name: str) -> None:
    plan = replace(PLAN, task=replace(PLAN.task, truth=WORLDS[name]))
    record = run(plan, RunOptions(seed=1), paths=joint_paths_of(PLAN))
    x, y, yaw = record.arrays["object_pose"][-1]
    goal = PLAN.task.goal
    assert math.dist((x, y), goal.position) < PLAN.task.tolerance.position
    off = math.remainder(yaw - goal.yaw, math.tau)
    assert abs(off) < PLAN.task.tolerance.yaw


def test_the_true_arm_leans_with_the_support_and_its_model_does_not() -> None:
    home = at_rest(arm_kinematics(PLAN.task.robots[0]).facts.home)
    robot = PLAN.task.robots[0]
    believed = DrakeArmModel(robot).state_at(home).bias
    truth = Truth(tilt=math.radians(2.0))
    true = DrakeArmModel(robot, truth).state_at(home).bias
    assert np.abs(true - believed).max() > 0.5
    plan = replace(PLAN, task=replace(PLAN.task, truth=truth))
    cell = drake_cell(plan, Station(plan), joint_paths_of(PLAN))
    (arm,) = cell.arms
    assert isinstance(arm, JointArm)
    arm.read()
    np.testing.assert_array_equal(arm.model.state_at(home).bias, believed)
