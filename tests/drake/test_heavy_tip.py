"""A nearly stretched arm has a large tip inertia, and still follows its reference's
velocity.
"""

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.control import TipCommand
from pushpressslide.execution.arm import (
    POSTURE_DAMPING,
    POSTURE_STIFFNESS,
    ROTATION_DAMPING,
    ROTATION_STIFFNESS,
    SERVO_TIME,
    ArmDynamics,
    ArmExecutor,
)
from pushpressslide.execution.torque import (
    LEAST_MOBILITY,
    Impedance,
    gains,
    held_for_a_tick,
    steady_share,
    task_inertia,
    unfelt,
)
from pushpressslide.sim.arm_model import DrakeArmModel

NONE = (0.0, 0.0, 0.0)
DAMPING = 1000.0  # [N s/m]
CAP = 25.0  # [N]
PERIOD = 0.004  # [s]
BENT = np.array([0.0, 0.4, 0.0, -2.0, 0.0, 2.3, 0.6])
STRETCHED = np.array([0.0, 1.2, 0.0, -1.0, 0.0, 1.6, 0.6])


@pytest.fixture(scope="module")
def arm() -> DrakeArmModel:
    return DrakeArmModel(pps.load_task("rear-push-rear").robots[0])


def torque(
    arm: DrakeArmModel,
    state: ArmDynamics,
    error: np.ndarray,
    stiffness: float = 0.0,
    catches_up: bool = True,
) -> np.ndarray:
    """Return the torque (n,) beside gravity's where the tip lacks ``error`` [m/s], held
    by a spring of ``stiffness`` [N/m] where it is.
    """
    facts = arm.instance.facts
    free = np.full(7, np.inf)
    executor = ArmExecutor(
        facts.lower,
        facts.upper,
        free,
        free,
        lambda yaw: state.rotation,
        0.0,
        0.0,
        PERIOD,
    )
    asked = TipCommand(
        force=NONE,
        position=state.position,
        velocity=(float(error[0]), float(error[1]), 0.0),
        stiffness=(stiffness, stiffness, 0.0),
        damping=(DAMPING, DAMPING, DAMPING),
        normal_yaw=0.0,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=CAP,
        progress=0.0,
        catches_up=catches_up,
    )
    limited = executor.contact(state, asked, state.q, state.v, state.bias)
    return limited.torque - state.bias


def damped(state: ArmDynamics, force: np.ndarray, share: float = 1.0) -> np.ndarray:
    """Torque (n,) of a tip's damper over a tick, with the velocity that results.

    It is ``force`` (3,) [N] at first. A cap leaves a ``share`` of the damper along the
    table.
    """
    turning = ROTATION_DAMPING + PERIOD * ROTATION_STIFFNESS
    along = share * DAMPING
    added = PERIOD * np.diag([turning] * 3 + [along, along, DAMPING])
    posture = gains(POSTURE_STIFFNESS, POSTURE_DAMPING, PERIOD).added
    J = state.J
    growth = J.T @ added @ J + posture * unfelt(J, J @ J.T).damper
    impedance = Impedance(J[3:].T @ force, growth)
    return held_for_a_tick(impedance, state.M, steady_share(0))


def radial(state: ArmDynamics) -> tuple[np.ndarray, float]:
    """Return the direction along the table in which the tip weighs most, and how much
    it does [kg].
    """
    inertia = task_inertia(state.J, state.M)[3:5, 3:5]
    mass, axes = np.linalg.eigh(inertia)
    return axes[:, -1], float(mass[-1])


def test_beside_the_damper_a_heavy_tip_is_moved_as_one_body_in_the_servos_time(
    arm: DrakeArmModel,
) -> None:
    state = arm.state(STRETCHED, np.zeros(7))
    axis, mass = radial(state)
    quick = DAMPING * SERVO_TIME  # [kg] that the damper alone moves in that time
    assert mass > 2.0 * quick
    error = 1e-4
    damper = damped(state, np.array([*(DAMPING * error * axis), 0.0]))
    beside = torque(arm, state, error * axis) - damper
    moved = state.J @ np.linalg.solve(state.M, beside)
    wanted = (1.0 - quick / mass) * error / SERVO_TIME
    # what the damped inverse leaves out along the axis of least mobility
    mobility = np.linalg.eigvalsh(state.J @ np.linalg.solve(state.M, state.J.T))[0]
    bound = (LEAST_MOBILITY / mobility) ** 2 * wanted
    assert bound < 0.15 * wanted
    expected = np.concatenate([np.zeros(3), wanted * axis, [0.0]])
    assert moved == pytest.approx(expected, abs=bound)


def test_a_light_tip_feels_its_damper_alone(arm: DrakeArmModel) -> None:
    state = arm.state(BENT, np.zeros(7))
    _, mass = radial(state)
    assert mass < DAMPING * SERVO_TIME
    error = np.array([1e-3, 2e-3])
    force = np.array([*(DAMPING * error), 0.0])
    assert torque(arm, state, error) == pytest.approx(damped(state, force), abs=1e-9)


def test_a_light_tip_that_lacks_much_feels_its_damper_up_to_the_cap(
    arm: DrakeArmModel,
) -> None:
    """There is nothing to make up for, and nothing is left for it."""
    state = arm.state(BENT, np.zeros(7))
    force = np.array([CAP, 0.0, 0.0])
    lacking = torque(arm, state, np.array([1.0, 0.0]))
    expected = damped(state, force, share=CAP / DAMPING)
    assert lacking == pytest.approx(expected, abs=1e-9)


def test_a_heavy_tip_that_is_not_to_catch_up_feels_its_damper_alone(
    arm: DrakeArmModel,
) -> None:
    state = arm.state(STRETCHED, np.zeros(7))
    error = np.array([1e-3, 2e-3])
    force = np.array([*(DAMPING * error), 0.0])
    alone = torque(arm, state, error, catches_up=False)
    assert alone == pytest.approx(damped(state, force), abs=1e-9)


@pytest.mark.parametrize("speed", [0.01, 0.03, 0.1, 1.0])
def test_the_servos_force_stays_below_its_cap_however_heavy_the_arm(
    arm: DrakeArmModel, speed: float
) -> None:
    state = arm.state(STRETCHED, np.zeros(7))
    axis, _ = radial(state)
    tau = torque(arm, state, speed * axis)
    wrench = np.linalg.lstsq(state.J.T, tau, rcond=None)[0]
    assert np.linalg.norm(wrench[3:5]) <= CAP + 1e-9


def test_a_tip_that_is_as_fast_as_its_reference_feels_nothing(
    arm: DrakeArmModel,
) -> None:
    state = arm.state(STRETCHED, np.zeros(7))
    still = replace(state, velocity=NONE)
    assert torque(arm, still, np.zeros(2)) == pytest.approx(np.zeros(7), abs=1e-9)


def test_a_tip_that_a_spring_leads_feels_spring_and_damper_alone(
    arm: DrakeArmModel,
) -> None:
    """Its reference may move while its velocity is said to be zero, as on the way back
    from a contact."""
    state = arm.state(STRETCHED, np.zeros(7))
    error = np.array([1e-3, 2e-3])
    # by which the spring adds to the damper's part in a tick
    share = (DAMPING + PERIOD * 1500.0) / DAMPING
    force = np.array([*(DAMPING * error), 0.0])
    led = torque(arm, state, error, stiffness=1500.0)
    assert led == pytest.approx(damped(state, force, share), abs=1e-9)
