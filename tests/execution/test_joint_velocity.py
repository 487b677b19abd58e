"""Joint velocities of an arm that takes positions or velocities."""

from typing import NamedTuple

import numpy as np
import pytest

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.execution.joint_velocity import (
    RAMP_TIME,
    SINGULAR,
    SPEED_SHARE,
    JointVelocities,
)
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.kinematics import ArmKinematics

DT = 0.004
PANDA = arm_kinematics(Robot("panda"))
UR5E = arm_kinematics(Robot("ur5e"))
ARMS = [PANDA, UR5E]


def joints_of(kin: ArmKinematics) -> JointVelocities:
    facts = kin.facts
    return JointVelocities(facts.lower, facts.upper, facts.velocity_limit)


class Case(NamedTuple):
    q: Array
    J: Array
    twist: Array


def cases(kin: ArmKinematics, smallest: float) -> list[Case]:
    """Postures away from limits, whose Jacobian has a ``smallest`` singular value."""
    rng = np.random.default_rng(1)
    facts = kin.facts
    found = []
    while len(found) < 50:
        q = facts.lower + rng.uniform(0.1, 0.9, facts.size) * (
            facts.upper - facts.lower
        )
        J = kin.tip_and_jacobian(q)[2]
        if np.linalg.svd(J)[1][-1] > smallest:
            found.append(Case(q, J, 0.02 * rng.normal(size=6)))
    return found


def of_tip(kin: ArmKinematics, case: Case, posture: Array | None = None) -> Array:
    still = np.zeros(kin.facts.size)
    at = case.q if posture is None else posture
    return joints_of(kin).of_tip(case.J, case.twist, case.q, at, still)


@pytest.mark.parametrize("kin", ARMS, ids=lambda kin: kin.facts.name)
def test_the_tip_moves_as_wanted_away_from_limits(kin: ArmKinematics) -> None:
    for case in cases(kin, 0.15):
        done = case.J @ of_tip(kin, case)
        least = np.linalg.svd(case.J)[1][-1]
        share = SINGULAR / (least**2 + SINGULAR)  # what the damping leaves undone
        off = np.linalg.norm(done - case.twist)
        assert off <= share * np.linalg.norm(case.twist) + 1e-12
        assert share < 0.05


def test_a_spare_joint_follows_the_posture_and_the_tip_stays() -> None:
    for case in cases(PANDA, 0.15)[:10]:
        rest = case._replace(twist=np.zeros(6))
        idle = np.linalg.svd(case.J)[2][-1]  # moves no tip
        velocity = of_tip(PANDA, rest, case.q + 0.02 * idle)
        assert np.linalg.norm(case.J @ velocity) < 1e-9
        assert velocity @ idle > 0.02


@pytest.mark.parametrize("kin", ARMS, ids=lambda kin: kin.facts.name)
def test_a_wish_beyond_the_speeds_is_slowed_as_a_whole(kin: ArmKinematics) -> None:
    joints = joints_of(kin)
    rng = np.random.default_rng(2)
    middle = 0.5 * (joints.lower + joints.upper)
    for _ in range(50):
        wanted = 10.0 * rng.normal(size=kin.facts.size)
        out = joints.limited(wanted, middle)
        assert np.abs(out / joints.speed).max() == pytest.approx(SPEED_SHARE)
        assert out / np.linalg.norm(out) == pytest.approx(
            wanted / np.linalg.norm(wanted)
        )
        slow = 0.1 * out
        assert joints.limited(slow, middle) == pytest.approx(slow)


def test_no_joint_moves_beyond_its_limit() -> None:
    joints = joints_of(PANDA)
    for limit, sign in ((joints.lower, -1.0), (joints.upper, 1.0)):
        out = sign * np.full(7, 0.1)
        assert joints.limited(out, limit) == pytest.approx(0.0)
        assert joints.limited(-out, limit) == pytest.approx(-out)


def test_at_a_limit_the_other_joints_move_the_tip() -> None:
    case = cases(PANDA, 0.15)[0]
    q = case.q.copy()
    q[3] = PANDA.facts.upper[3]
    J = PANDA.tip_and_jacobian(q)[2]
    wanted = 0.02 * J[:, 3]  # what this joint alone would do
    velocity = of_tip(PANDA, Case(q, J, wanted))
    assert velocity[3] == pytest.approx(0.0)
    assert np.linalg.norm(J @ velocity - wanted) < 0.1 * np.linalg.norm(wanted)


def test_velocities_do_not_jump_as_a_joint_comes_to_its_limit() -> None:
    case = cases(PANDA, 0.15)[0]
    upper = PANDA.facts.upper[3]
    buffer = margins.ARM.joint_buffer
    made = []
    for q3 in np.linspace(upper - 1.5 * buffer, upper, 200):
        q = case.q.copy()
        q[3] = q3
        J = PANDA.tip_and_jacobian(q)[2]
        made.append(of_tip(PANDA, Case(q, J, np.array([0, 0, 0, 0.02, 0, 0]))))
    steps = np.abs(np.diff(made, axis=0))
    spread = np.ptp(made, axis=0).max()
    assert steps.max() < 0.2 * spread


def test_a_stretched_arm_is_not_torn() -> None:
    """Its elbow is nearly straight: the joints hardly move the tip outwards."""
    facts = UR5E.facts
    q = np.array([0.0, -0.5, 0.01, -1.0, -1.57, 0.0])
    J = UR5E.tip_and_jacobian(q)[2]
    left, sizes, _ = np.linalg.svd(J)
    assert sizes[-1] < 1e-2
    outwards = 0.05 * left[:, -1]
    torn = np.linalg.pinv(J) @ outwards
    damped = joints_of(UR5E).of_tip(J, outwards, q, q, np.zeros(facts.size))
    assert np.abs(damped).max() < 0.05 / (2.0 * np.sqrt(SINGULAR)) + 1e-9
    assert np.abs(torn).max() > 3.0 * np.abs(damped).max()


def test_velocities_change_by_ramps() -> None:
    joints = joints_of(PANDA)
    before = np.zeros(7)
    wanted = SPEED_SHARE * joints.speed
    ticks = 0
    while not np.allclose(before, wanted):
        after = joints.ramped(wanted, before, DT)
        assert (np.abs(after - before) <= DT / RAMP_TIME * joints.speed + 1e-12).all()
        before = after
        ticks += 1
    assert ticks == pytest.approx(SPEED_SHARE * RAMP_TIME / DT, abs=1.0)
