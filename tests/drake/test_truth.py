"""Arms in Drake that differ from the controller's model of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.model import at_rest
from pushpressslide.control.cell import Cell
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.truth import Truth
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.sim.arm_library import joint_paths_of
from pushpressslide.sim.arm_model import DrakeArmModel
from pushpressslide.sim.cell import DrakePhysics, drake_cell
from pushpressslide.sim.engine import run
from pushpressslide.sim.station import Station

PLAN = pps.plan(pps.load_task("rear-push-rear"))
PATHS = joint_paths_of(PLAN)
ROBOT = PLAN.task.robots[0]


def with_truth(truth: Truth) -> Plan:
    return replace(PLAN, task=replace(PLAN.task, truth=truth))


def cell_of(truth: Truth) -> Cell:
    plan = with_truth(truth)
    return drake_cell(plan, Station(plan), PATHS)


def run_of(truth: Truth) -> Record:
    return run(with_truth(truth), RunOptions(seed=1), paths=PATHS)


def tips(cell: Cell) -> tuple[np.ndarray, np.ndarray]:
    """Measured and true position [m] of the tip at the start."""
    measured = cell.arms[0].read().tip.position
    assert cell.witness is not None
    (true,) = cell.witness.observe().tips
    return np.array(measured), np.array(true.position)


def in_the_world(cell: Cell) -> np.ndarray:
    """Position (3,) [m] of the tip's body in the plant."""
    assert isinstance(cell.clock, DrakePhysics)
    station = cell.clock.station
    frame = station.scene.robots[0].tip_frame
    return frame.CalcPoseInWorld(station.plant_context).translation()


def test_a_tip_is_measured_where_it_is_believed_and_is_elsewhere() -> None:
    exact, same = tips(cell_of(Truth()))
    np.testing.assert_array_equal(exact, same)
    truth = Truth((0.004, 0.003), math.radians(0.5), (0.001, 0.002, 0.003))
    cell = cell_of(truth)
    measured, true = tips(cell)
    np.testing.assert_allclose(measured, exact, atol=1e-9)
    np.testing.assert_allclose(true, in_the_world(cell), atol=1e-9)
    q = PATHS[0][0][0].approach[0]
    R, p = arm_kinematics(ROBOT).tip_pose(q)
    c, s = math.cos(truth.arm_base_yaw), math.sin(truth.arm_base_yaw)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    offset = p + R @ truth.tip_offset
    np.testing.assert_allclose(true, turn @ offset + [0.004, 0.003, 0.0], atol=1e-9)


def test_encoders_show_the_start_of_the_path() -> None:
    cell = cell_of(Truth(encoder_bias=math.radians(0.1)))
    (arm,) = cell.arms
    measured, true = tips(cell)
    assert isinstance(arm, JointArm)
    np.testing.assert_allclose(arm.state.q, PATHS[0][0][0].approach[0], atol=1e-12)
    assert 1e-4 < np.linalg.norm(true - measured) < 0.01
    np.testing.assert_allclose(true, in_the_world(cell), atol=1e-9)


def test_masses_change_the_weight_of_the_arm_and_not_that_of_its_model() -> None:
    factor = 1.3
    home = at_rest(arm_kinematics(ROBOT).facts.home)
    believed = DrakeArmModel(ROBOT).state_at(home)
    true = DrakeArmModel(ROBOT, Truth(link_mass=factor)).state_at(home)
    np.testing.assert_allclose(true.bias, factor * believed.bias, atol=1e-9)
    cell = cell_of(Truth(link_mass=factor))
    (arm,) = cell.arms
    assert isinstance(arm, JointArm)
    arm.read()
    np.testing.assert_allclose(arm.model.state_at(home).bias, believed.bias)
    assert isinstance(cell.clock, DrakePhysics)
    plant = cell.clock.station.plant
    context = cell.clock.station.plant_context
    instance = cell.clock.station.scene.robots[0].model_instance
    plant.SetPositions(context, instance, home[: arm.model.size])
    weight = -plant.CalcGravityGeneralizedForces(context)
    weight = plant.GetVelocitiesFromArray(instance, weight)
    np.testing.assert_allclose(weight, factor * believed.bias, atol=1e-9)


def test_drakes_own_models_have_no_other_masses() -> None:
    plan = with_truth(Truth(link_mass=1.1))
    with pytest.raises(TaskError, match=r"truth\.link_mass: 1\.1"):
        Station(plan, models="drake_models")


FAULTS: dict[str, Callable[[], Truth]] = {
    "masses": lambda: Truth(link_mass=1.2),
    "friction": lambda: Truth(coulomb_friction=0.03, viscous_friction=0.05),
    "motors": lambda: Truth(torque_scale=0.1),
    "lateness": lambda: Truth(command_delay=0.008),
}


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param(name, marks=() if name == "masses" else pytest.mark.long)
        for name in FAULTS
    ],
)
def test_a_push_reaches_its_goal_with_an_arm_not_as_believed(fault: str) -> None:
    record = run_of(FAULTS[fault]())
    x, y, yaw = record.arrays["object_pose"][-1]
    goal = PLAN.task.goal
    assert record.reason == "goal_reached"
    assert math.dist((x, y), goal.position) < 0.002
    assert abs(yaw - goal.yaw) < math.radians(0.5)
    assert record.meta["clearance_driven"] > 0.0
