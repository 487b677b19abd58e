"""A moving tip needs no force for the acceleration caused by the arm's own geometry."""

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.control import TipCommand
from pushpressslide.execution.arm import ArmDynamics, ArmExecutor
from pushpressslide.execution.torque import LEAST_MOBILITY
from pushpressslide.sim.arm_model import DrakeArmModel

READY = np.array([0.3, 0.4, -0.2, -2.0, 0.5, 2.3, 0.6])
NONE = (0.0, 0.0, 0.0)
STEP = 1e-6  # [s]


@pytest.fixture(scope="module")
def arm() -> DrakeArmModel:
    return DrakeArmModel(pps.load_task("rear-push-rear").robots[0])


def turning(arm: DrakeArmModel, seed: int) -> ArmDynamics:
    return arm.state(READY, np.random.default_rng(seed).uniform(-0.5, 0.5, 7))


@pytest.mark.parametrize("seed", range(5))
def test_the_drift_is_how_the_velocity_changes_at_constant_joint_rates(
    arm: DrakeArmModel, seed: int
) -> None:
    state = turning(arm, seed)
    before = arm.state(state.q - STEP * state.v, state.v)
    after = arm.state(state.q + STEP * state.v, state.v)
    drift = (after.J @ state.v - before.J @ state.v) / (2.0 * STEP)
    np.testing.assert_allclose(state.drift, drift, atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_a_free_tip_goes_on_as_its_reference_does(
    arm: DrakeArmModel, seed: int
) -> None:
    state = turning(arm, seed)
    facts = arm.instance.facts
    executor = ArmExecutor(
        facts.lower,
        facts.upper,
        np.full(7, np.inf),
        np.full(7, np.inf),
        lambda yaw: state.rotation,
        0.0,
        0.0,
        0.004,
    )
    asked = TipCommand(
        force=NONE,
        position=state.position,
        velocity=state.velocity,
        stiffness=NONE,
        damping=NONE,
        normal_yaw=0.0,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=5.0,
        progress=0.0,
        acceleration=(0.2, -0.1, 0.0),
    )
    # the tool's own damper is another matter
    still = replace(state, angular_velocity=np.zeros(3))
    limited = executor.contact(still, asked, state.q, state.v, state.bias)
    moved = np.linalg.solve(state.M, limited.torque - state.bias)
    acceleration = state.J @ moved + state.drift
    wanted = np.concatenate([np.zeros(3), asked.acceleration])
    # along an axis of mobility m, in 1/kg, the damping leaves out e^2 / (m^2 + e^2)
    mobility = np.linalg.eigvalsh(state.J @ np.linalg.solve(state.M, state.J.T))
    left_out = (LEAST_MOBILITY / mobility[0]) ** 2
    bound = left_out * np.linalg.norm(wanted - state.drift)
    assert left_out < 0.03
    np.testing.assert_allclose(acceleration, wanted, atol=bound + 1e-9)
