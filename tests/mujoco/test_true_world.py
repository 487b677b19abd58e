"""Worlds in MuJoCo that differ from what the controller believes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Obstacle
from pushpressslide.core.task import Box
from pushpressslide.core.true_task import true_plan
from pushpressslide.core.truth import Truth
from pushpressslide.jobs.engines import ENGINES, ArmOptions
from pushpressslide.mechanics.ground import Ground, speed_factors
from pushpressslide.mujoco_sim.cell import MujocoPhysics
from pushpressslide.mujoco_sim.scene import build_scene

PLAN = pps.plan(pps.load_task("rear-push-rear"))
MU = PLAN.task.support.friction
TICK = PLAN.query.motion.control_period
POST = Obstacle("post", Box((0.05, 0.05, 0.2)), Pose2(0.2, -0.6))


def physics_of(truth: Truth) -> MujocoPhysics:
    task = replace(PLAN.task, truth=truth, obstacles=(POST,))
    plan = true_plan(replace(PLAN, task=task), 1)
    physics = MujocoPhysics(plan, build_scene(plan, 0.001), None, 1)
    physics.put([], None)
    return physics


def slid(truth: Truth, speed: float, ticks: int) -> np.ndarray:
    """Speeds (ticks + 1,) [m/s] along x of the object, which starts with ``speed``."""
    physics = physics_of(truth)
    physics.state.qvel[physics.scene.velocity("object")] = speed
    speeds = [speed]
    for _ in range(ticks):
        physics.advance()
        speeds.append(physics.now.twist[0])
    return np.array(speeds)


def factors_of(speeds: np.ndarray) -> np.ndarray:
    """Decelerations over that of the plain friction, in each tick."""
    return -np.diff(speeds) / (TICK * MU * GRAVITY)


@pytest.mark.parametrize("share", [0.4, -0.4])
def test_a_sliding_object_slows_down_by_the_friction_at_its_speed(share: float) -> None:
    truth = Truth(friction_speed=share)
    speeds = slid(truth, 0.25, 14)
    wanted = speed_factors(truth, speeds[:-1])
    np.testing.assert_allclose(factors_of(speeds)[6:], wanted[6:], rtol=0.02)
    plain = factors_of(slid(Truth(), 0.25, 14))
    np.testing.assert_allclose(plain[6:], 1.0, rtol=0.02)


def test_friction_is_that_of_the_patches_under_the_feet() -> None:
    truth = Truth(friction_patches=0.4, patch_size=0.05)
    physics = physics_of(truth)
    physics.state.qvel[physics.scene.velocity("object")] = 0.25
    for _ in range(6):
        physics.advance()
    before = physics.now
    feet = physics.scene.bodies["object"].points
    under = Ground.of_truth(truth, 1).under(feet, before.X_WG, before.twist, 0.0)
    loads = _loads(physics)
    physics.advance()
    mean = under @ loads / loads.sum()
    assert under.std() > 0.1
    assert abs(mean - 1.0) > 0.05
    speeds = np.array([before.twist[0], physics.now.twist[0]])
    assert factors_of(speeds)[0] == pytest.approx(mean, rel=0.03)


def loose_at(truth: Truth) -> float:
    """Force along x, over the plain friction, at which the object begins to slide."""
    physics = physics_of(truth)
    body = physics.model.body("object").id
    friction = MU * PLAN.task.object.mass * GRAVITY
    for tick in range(400):
        share = tick / 200.0
        physics.state.xfrc_applied[body, 0] = share * friction
        physics.advance()
        if physics.now.twist[0] > 3e-3:
            return share
    raise AssertionError


def test_an_object_breaks_loose_near_its_static_friction() -> None:
    assert loose_at(Truth()) == pytest.approx(1.03, abs=0.03)
    assert loose_at(Truth(static_friction=1.5)) == pytest.approx(1.45, abs=0.06)


def test_a_tilt_adds_to_the_deceleration_of_what_slides_uphill() -> None:
    tilt = math.radians(5.0)
    for yaw, sign in ((0.0, -1.0), (math.pi, 1.0)):
        factors = factors_of(slid(Truth(tilt=tilt, tilt_yaw=yaw), 0.25, 12))
        wanted = math.cos(tilt) + sign * math.sin(tilt) / MU
        np.testing.assert_allclose(factors[6:], wanted, rtol=0.02)


def test_object_tips_and_obstacles_have_their_true_sizes_and_places() -> None:
    truth = Truth(size=(0.006, 0.0), tip_radius=0.003, obstacle_offset=0.01)
    scene = physics_of(truth).scene
    size = scene.model.geom(scene.bodies["object"].parts[0]).size
    assert isinstance(PLAN.task.object.shape, Box)
    length, width, _ = PLAN.task.object.shape.size
    np.testing.assert_allclose(size[:2], (0.5 * length + 0.003, 0.5 * width))
    tip = scene.model.geom(scene.arms[0].sphere).size[0]
    assert tip == pytest.approx(PLAN.task.robots[0].tip_radius + 0.003)
    off = scene.model.geom("post_part").pos[:2] - POST.pose.position
    assert 1e-3 < np.hypot(*off) < 0.04


def test_a_bowed_base_turns_harder_on_its_rim() -> None:
    check_moments([Truth(bow=bow) for bow in (-0.9, 0.0, 0.9)])


def test_a_base_on_far_feet_turns_harder_than_on_near_ones() -> None:
    check_moments([Truth(feet=0.3), Truth(), Truth(feet=0.9)])


def test_an_object_climbs_a_ridge() -> None:
    physics = physics_of(Truth(ridge=0.002, ridge_place=0.3))
    first = physics.scene.position("object")
    freedom = physics.scene.velocity("object")
    heights = []
    for _ in range(1000):
        physics.state.qvel[freedom] = max(physics.state.qvel[freedom], 0.1)
        physics.advance()
        heights.append(physics.state.qpos[first + 2])
    assert max(heights) - heights[0] == pytest.approx(0.002, rel=0.1)


def test_a_ridge_needs_a_support_without_edges() -> None:
    region = ((-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0))
    support = replace(PLAN.task.support, region=region)
    task = replace(PLAN.task, support=support, truth=Truth(ridge=0.001))
    with pytest.raises(TaskError, match=r"truth\.ridge.*with edges"):
        build_scene(replace(PLAN, task=task), 0.001)


def check_moments(truths: Sequence[Truth]) -> None:
    """Check that each truth resists a turn more than the one before, by the loads that
    the feet carry at rest.
    """
    moments = []
    for truth in truths:
        physics = physics_of(truth)
        for _ in range(50):
            physics.advance()
        feet = physics.scene.bodies["object"]
        loads = _loads(physics)
        arms = np.hypot(*feet.points.T)
        moments.append(loads @ arms / loads.sum())
    assert moments[0] < 0.85 * moments[1]
    assert moments[2] > 1.1 * moments[1]


def _loads(physics: MujocoPhysics) -> np.ndarray:
    """Normal force [N] on each foot of the object."""
    import mujoco

    names = [pair.split(":")[1] for pair in physics.scene.bodies["object"].feet]
    feet = {physics.model.geom(name).id: i for i, name in enumerate(names)}
    loads = np.zeros(len(names))
    force = np.zeros(6)
    for i, pair in enumerate(physics.state.contact.geom.tolist()):
        for geom in pair:
            if geom in feet:
                mujoco.mj_contactForce(physics.model, physics.state, i, force)
                loads[feet[geom]] += force[0]
    return loads


def test_a_grain_is_refused() -> None:
    plan = replace(PLAN, task=replace(PLAN.task, truth=Truth(friction_direction=0.2)))
    with pytest.raises(TaskError, match=r"truth\.friction_direction.*mujoco"):
        ENGINES["mujoco"].run(plan, pps.RunOptions(), ArmOptions())


WORLDS = {
    "friction": Truth(static_friction=1.3, friction_speed=0.3, friction_patches=0.2),
    "sizes": Truth(size=(0.004, -0.004), tip_radius=0.002, bow=0.5),
    "feet": Truth(feet=0.85),
    "ridge": Truth(ridge=0.0005),
}


@pytest.mark.long
@pytest.mark.parametrize("name", WORLDS)
def test_a_push_still_reaches_its_goal(name: str) -> None:
    plan = replace(PLAN, task=replace(PLAN.task, truth=WORLDS[name]))
    record = ENGINES["mujoco"].run(plan, pps.RunOptions(seed=1), ArmOptions())
    x, y, yaw = record.arrays["object_pose"][-1]
    goal = PLAN.task.goal
    assert math.dist((x, y), goal.position) < PLAN.task.tolerance.position
    off = math.remainder(yaw - goal.yaw, math.tau)
    assert abs(off) < PLAN.task.tolerance.yaw
