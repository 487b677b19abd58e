"""Arms that are not as the controller believes, on a few lines of NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.arms.command_line import CommandLine, random_streams
from pushpressslide.arms.faults import (
    CROSSING,
    FaultyDrives,
    dry_friction,
    joint_faults,
)
from pushpressslide.arms.model import at_rest
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.truth import Truth
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.execution.torque_error import (
    FILTER_TIME,
    RESOLUTION,
    TorqueErrorObserver,
)
from pushpressslide.robots.facts import load_facts

DT = 0.004
FACTS = load_facts("panda")
N = FACTS.size
EFFORT = FACTS.effort_limit
NOTHING = (0.0, 0.0, 0.0)
M = np.diag(np.linspace(2.0, 0.2, N)) + 0.1


def arm_at(x: Array) -> ArmDynamics:
    """Joints that are coupled by their inertia, with a tip on the first three."""
    J = np.zeros((6, N))
    J[3:, :3] = np.eye(3)
    zero = np.zeros(N)
    return ArmDynamics(
        x[:N], x[N:], NOTHING, np.eye(3), NOTHING, NOTHING, J, M, zero, zero[:6]
    )


class Model:
    facts = FACTS
    size = N

    def state_at(self, x: Array) -> ArmDynamics:
        return arm_at(x)


class Drives:
    time = 0.0

    def __init__(self) -> None:
        self.torque = np.zeros(N)

    def joints(self) -> Array:
        return at_rest(np.linspace(0.1, 0.7, N))

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        return (1.0, 2.0, 3.0)

    def drive(self, torque: Array) -> None:
        self.torque = torque


def faulty(truth: Truth, seed: int = 1) -> tuple[FaultyDrives, Drives]:
    encoders, motors, _ = random_streams(seed, 0)
    own = Drives()
    faults = joint_faults(truth, EFFORT, encoders, motors)
    return FaultyDrives(own, Model(), faults, DT), own


def torque_of(truth: Truth, seed: int = 1) -> Array:
    """Torques that come of one newton metre for each joint."""
    drives, own = faulty(truth, seed)
    drives.tip_force(arm_at(drives.joints()))
    drives.drive(np.ones(N))
    return own.torque


def test_encoders_are_off_by_a_constant_of_the_seed_and_the_joint() -> None:
    truth = Truth(encoder_bias=0.01)
    drives, own = faulty(truth)
    off = drives.joints() - own.joints()
    assert (np.abs(off[:N]) > 0.0).all()
    assert (off[N:] == 0.0).all()
    np.testing.assert_array_equal(drives.joints() - own.joints(), off)
    np.testing.assert_array_equal(faulty(truth)[0].joints(), drives.joints())
    assert (faulty(truth, 2)[0].joints()[:N] != drives.joints()[:N]).all()
    drawn = [random_streams(seed, 0)[0].normal(size=N) for seed in range(300)]
    assert np.std(drawn) == pytest.approx(1.0, rel=0.1)


def test_one_fault_more_leaves_the_draws_of_the_others() -> None:
    alone, _ = faulty(Truth(encoder_bias=0.01))
    both, _ = faulty(Truth(encoder_bias=0.01, torque_scale=0.1))
    np.testing.assert_array_equal(alone.encoder_bias, both.encoder_bias)


def test_a_force_is_measured_in_the_tool_and_turns_with_the_believed_one() -> None:
    drives, _ = faulty(Truth(arm_base_yaw=0.5))
    believed = arm_at(drives.joints())
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    measured = drives.tip_force(replace(believed, rotation=turn))
    assert measured == pytest.approx((-2.0, 1.0, 3.0))
    assert drives.force == (1.0, 2.0, 3.0)


def test_motors_are_off_by_a_factor_and_by_a_ripple_within_their_shares() -> None:
    assert torque_of(Truth()) == pytest.approx(1.0, abs=0.0)
    assert torque_of(Truth(torque_scale=0.1)) == pytest.approx(
        torque_of(Truth(torque_scale=0.2)) / 2.0 + 0.5
    )
    off = torque_of(Truth(torque_ripple=0.05)) - 1.0
    assert (np.abs(off) <= 0.05).all()
    assert len(set(off.round(9))) == N


def test_a_motor_crosses_the_play_of_its_gear_without_torque_on_the_link() -> None:
    play = 3.0 * CROSSING * DT
    drives, own = faulty(Truth(backlash=play))
    true = own.joints()[:N]
    for torque, led, passed in (
        (1.0, 0.5, 1.0),
        (-1.0, 1.0 / 6.0, 0.0),
        (-1.0, -1.0 / 6.0, 0.0),
        (-1.0, -0.5, 0.0),
        (-1.0, -0.5, -1.0),
    ):
        drives.joints()
        drives.drive(torque * np.ones(N))
        assert own.torque == pytest.approx(passed)
        assert drives.joints()[:N] - true == pytest.approx(led * play)


def test_dry_friction_holds_a_joint_below_it_and_opposes_its_motion_above() -> None:
    most = 0.03 * EFFORT
    rest = arm_at(at_rest(np.zeros(N)))
    weak = 0.9 * most
    held = dry_friction(rest, weak, NOTHING, most, DT)
    assert held == pytest.approx(-weak, abs=1e-3)
    strong = 1e3 * np.ones(N)
    assert dry_friction(rest, strong, NOTHING, most, DT) == pytest.approx(-most)
    falling = arm_at(np.concatenate([np.zeros(N), -np.ones(N)]))
    assert dry_friction(falling, weak, NOTHING, most, DT) == pytest.approx(most)


def test_dry_friction_bears_a_contact_force() -> None:
    most = 0.03 * EFFORT
    rest = arm_at(at_rest(np.zeros(N)))
    held = dry_friction(rest, np.zeros(N), (1.0, 0.0, 0.0), most, DT)
    assert held == pytest.approx([1.0, *np.zeros(N - 1)], abs=1e-3)


def test_a_command_arrives_ticks_later_and_in_order() -> None:
    truth = Truth(command_delay=3 * DT)
    line: CommandLine[int] = CommandLine(truth, np.random.default_rng(0), DT)
    assert [line.through(i) for i in range(8)] == [0, 0, 0, 0, 1, 2, 3, 4]


def test_of_missed_commands_the_last_one_is_repeated() -> None:
    truth = Truth(missed_ticks=0.3)
    line: CommandLine[int] = CommandLine(truth, np.random.default_rng(0), DT)
    count = 4000
    out = np.array([line.through(i) for i in range(count)])
    missed = out != np.arange(count)
    assert out[0] == 0
    assert missed.mean() == pytest.approx(0.3, abs=0.03)
    assert (out[1:][missed[1:]] == out[:-1][missed[1:]]).all()


def followed(unknown: Array, time: float) -> tuple[TorqueErrorObserver, float]:
    """Observer of joints that ``unknown`` torques (n,) [N m] accelerate for a time [s],
    and their largest speed then.
    """
    observer = TorqueErrorObserver(EFFORT)
    x = at_rest(np.zeros(N))
    for _ in range(round(time / DT)):
        arm = arm_at(x)
        observer.observe(arm, DT)
        torque = observer.corrected(arm).bias - 20.0 * M @ arm.v
        observer.acted(arm, torque, np.zeros(3))
        v = x[N:] + DT * np.linalg.solve(M, torque + unknown)
        x = np.concatenate([x[:N] + DT * v, v])
    return observer, float(np.abs(x[N:]).max())


def test_unexplained_torques_are_found_and_compensated() -> None:
    unknown = 0.05 * EFFORT
    observer, speed = followed(unknown, 10.0 * FILTER_TIME)
    assert observer.awake
    assert observer.estimate == pytest.approx(unknown, rel=1e-2)
    assert speed < 0.01


def test_an_arm_that_is_as_believed_is_not_corrected() -> None:
    observer, _ = followed(0.5 * RESOLUTION * EFFORT, 10.0 * FILTER_TIME)
    assert not observer.awake
    arm = arm_at(at_rest(np.zeros(N)))
    assert observer.corrected(arm) is arm


def test_a_measured_contact_force_is_not_unexplained() -> None:
    observer = TorqueErrorObserver(EFFORT)
    arm = arm_at(at_rest(np.zeros(N)))
    force = np.array([3.0, -2.0, 5.0])
    for _ in range(50):
        observer.observe(arm, DT)
        observer.acted(arm, arm.J[3:].T @ force, force)
    assert observer.estimate == pytest.approx(0.0, abs=1e-12)
