"""From tip commands to torques: the resulting motion of an arm's tip, by its mechanics."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.arm import (
    BRAKE_SHARE,
    FREE_RATE,
    HELD_BACK,
    JOINT_DAMPING,
    POSTURE_DAMPING,
    POSTURE_STIFFNESS,
    ROTATION_DAMPING,
    ROTATION_STIFFNESS,
    SERVO_TIME,
    ArmDynamics,
    ArmExecutor,
)
from pushpressslide.execution.torque import steady_share

DT = 1e-4  # [s]: springs and dampers are those of continuous time
ZERO = (0.0, 0.0, 0.0)
NOTHING = TipCommand(
    ZERO, ZERO, ZERO, ZERO, ZERO, 0.3, 0.0, 0.0, 1e9, 0.0, catches_up=False
)
WALL = SupportFrame.of_wall((0.5, -0.2, 0.3), 0.4)
INCLINE = SupportFrame.of_incline(0.3)
FRAMES = (TABLE, INCLINE, WALL)
FAR = 100.0  # [rad] of limits that nothing comes near


def heavy(seed: int, joints: int = 7) -> ArmDynamics:
    """Return an arm at rest at the world's origin, as heavy as arms are: 5 kg or so."""
    rng = np.random.default_rng(seed)
    J = np.linalg.qr(rng.normal(size=(joints, 6)))[0].T * rng.uniform(0.8, 1.2, (6, 1))
    root = rng.normal(size=(joints, joints))
    M = 4.0 * np.eye(joints) + 0.2 * root @ root.T
    none = np.zeros(joints)
    q = rng.uniform(-1.0, 1.0, joints)
    bias = rng.uniform(-9.0, 9.0, joints)
    return ArmDynamics(q, none, ZERO, np.eye(3), ZERO, ZERO, J, M, bias, np.zeros(6))


def executor(
    joints: int = 7,
    frame: SupportFrame = TABLE,
    joint_stiffness: float = 0.0,
    yaw_offset: float = 0.0,
    dt: float = DT,
) -> ArmExecutor:
    """Return an executor without limits, of a tool that turns about the spin axis."""
    unbounded = np.full(joints, np.inf)

    def rotation(yaw: float) -> np.ndarray:
        return turned(frame.spin_axis, yaw)

    return ArmExecutor(
        np.full(joints, -FAR),
        np.full(joints, FAR),
        unbounded,
        unbounded,
        rotation,
        yaw_offset,
        joint_stiffness,
        dt,
        frame,
    )


def turned(axis: Vector3, angle: float) -> np.ndarray:
    """Return the rotation by ``angle`` [rad] about a unit vector (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K


def torque(
    one: ArmExecutor,
    arm: ArmDynamics,
    command: TipCommand = NOTHING,
    q_ref: np.ndarray | None = None,
    v_ref: np.ndarray | None = None,
) -> np.ndarray:
    """Return the torque in contact, less the bias; by default in the posture there is."""
    q_ref = arm.q if q_ref is None else q_ref
    v_ref = arm.v if v_ref is None else v_ref
    return one.contact(arm, command, q_ref, v_ref, np.zeros(len(arm.q))).torque - (
        arm.bias
    )


def wrench(
    one: ArmExecutor, arm: ArmDynamics, command: TipCommand = NOTHING
) -> np.ndarray:
    """Moment and force at the tip that balance the torque, world axes."""
    held, *_ = np.linalg.lstsq(arm.J.T, torque(one, arm, command), rcond=None)
    return held


def accelerated(one: ArmExecutor, arm: ArmDynamics, command: TipCommand) -> np.ndarray:
    """Return the acceleration of a free tip (6,), world axes."""
    return arm.J @ np.linalg.solve(arm.M, torque(one, arm, command)) + arm.drift


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("seed", range(3))
def test_a_force_that_is_commanded_is_felt_at_the_tip(
    frame: SupportFrame, seed: int
) -> None:
    force = (3.0, -2.0, -7.0)
    felt = wrench(executor(frame=frame), heavy(seed), replace(NOTHING, force=force))
    assert felt[:3] == pytest.approx(np.zeros(3), abs=1e-9)
    assert felt[3:] == pytest.approx(np.array(frame.axes) @ force)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_spring_pulls_the_tip_to_its_reference_along_each_axis(
    frame: SupportFrame,
) -> None:
    """Along the normal, across it and along the height, each with its own stiffness."""
    off = np.array([0.001, -0.002, 0.0015])
    stiffness = (1500.0, 900.0, 3000.0)
    command = replace(NOTHING, position=tuple(off), stiffness=stiffness)
    arm = heavy(1)
    arm = replace(arm, position=frame.origin)
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    along = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    wanted = np.array(frame.axes) @ along.T @ (stiffness * (along @ off))
    assert wrench(executor(frame=frame), arm, command)[3:] == pytest.approx(
        wanted, abs=1e-6
    )


@pytest.mark.parametrize("frame", FRAMES)
def test_a_damper_takes_the_speed_from_the_tip_along_each_axis(
    frame: SupportFrame,
) -> None:
    damping = np.array([150.0, 80.0, 250.0])
    command = replace(NOTHING, velocity=(0.05, 0.0, 0.0), damping=tuple(damping))
    velocity = np.array([0.01, 0.02, -0.03])
    vx, vy, vz = np.array(frame.axes) @ velocity
    arm = replace(heavy(2), velocity=(float(vx), float(vy), float(vz)))
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    along = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    error = np.array(command.velocity) - velocity
    wanted = np.array(frame.axes) @ along.T @ (damping * (along @ error))
    assert wrench(executor(frame=frame), arm, command)[3:] == pytest.approx(
        wanted, abs=1e-6
    )


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("seed", range(3))
def test_a_tip_accelerates_as_its_reference_does(
    frame: SupportFrame, seed: int
) -> None:
    """Whatever its joints' rates make of it, and with its tool, about the spin axis."""
    command = replace(NOTHING, acceleration=(0.5, -0.3, 0.2), tool_yaw_acceleration=0.7)
    drift = np.random.default_rng(seed).normal(size=6)
    arm = replace(heavy(seed), drift=drift)
    got = accelerated(executor(frame=frame), arm, command)
    wanted = [
        *(0.7 * np.array(frame.spin_axis)),
        *(np.array(frame.axes) @ command.acceleration),
    ]
    assert got == pytest.approx(np.array(wanted), abs=0.01)


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("angle", [-0.1, 0.15])
def test_a_tool_is_turned_to_the_yaw_it_is_to_have(
    frame: SupportFrame, angle: float
) -> None:
    """Which is the commanded one and the tool's offset."""
    command = replace(NOTHING, tool_yaw=0.4)
    one = executor(frame=frame, yaw_offset=0.25)
    arm = replace(heavy(3), rotation=turned(frame.spin_axis, 0.65 - angle))
    felt = wrench(one, arm, command)
    wanted = ROTATION_STIFFNESS * math.sin(angle) * np.array(frame.spin_axis)
    assert felt[:3] == pytest.approx(wanted, abs=1e-9)
    assert felt[3:] == pytest.approx(np.zeros(3), abs=1e-9)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_tool_is_damped_about_the_rate_it_is_to_have(frame: SupportFrame) -> None:
    command = replace(NOTHING, tool_yaw_rate=0.3)
    x, y, z = frame.spin_axis
    spins = (0.1 * x, 0.1 * y, 0.1 * z)
    felt = wrench(
        executor(frame=frame), replace(heavy(4), angular_velocity=spins), command
    )
    wanted = ROTATION_DAMPING * 0.2 * np.array(frame.spin_axis)
    assert felt[:3] == pytest.approx(wanted, abs=1e-9)


def test_a_tool_loses_its_error_in_tenths_of_a_second() -> None:
    """Spring and damper balance where it turns back by its error in 0.1 s."""
    error = 0.01
    one = executor()
    arm = replace(
        heavy(3),
        rotation=turned((0.0, 0.0, 1.0), NOTHING.tool_yaw - error),
        angular_velocity=(0.0, 0.0, error / 0.1),
    )
    assert wrench(one, arm)[2] == pytest.approx(
        0.0, abs=0.01 * one._rotation.stiffness * error
    )


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("mass", [0.05, 0.3, 2.0])
def test_a_light_tip_loses_a_bounded_share_of_its_speed_along_each_axis(
    frame: SupportFrame, mass: float
) -> None:
    """A damper along an axis takes h D / m of the speed there in a tick, or the share
    that is steady.
    """
    dt = 0.004
    damping = np.array([150.0, 30.0, 80.0])
    velocity = np.array([0.02, -0.01, 0.03])
    vx, vy, vz = np.array(frame.axes) @ velocity
    M = np.diag([1.0, 1.0, 1.0, mass, mass, mass])
    arm = replace(heavy(0, joints=6), J=np.eye(6), M=M)
    arm = replace(
        arm,
        v=np.array([0.0, 0.0, 0.0, vx, vy, vz]),
        velocity=(float(vx), float(vy), float(vz)),
    )
    command = replace(NOTHING, damping=tuple(damping))
    tau = torque(executor(6, frame, dt=dt), arm, command)
    after = np.array(frame.axes).T @ ([vx, vy, vz] + dt * tau[3:] / mass)
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    along = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    left = 1.0 - np.minimum(dt * damping / mass, steady_share(0))
    assert along @ after == pytest.approx(left * (along @ velocity), abs=1e-9)
    assert tau[:3] == pytest.approx(np.zeros(3), abs=1e-9)


@pytest.mark.parametrize("inertia", [0.01, 0.1])
def test_a_light_tool_loses_a_bounded_share_of_its_turning(inertia: float) -> None:
    dt = 0.004
    spin = np.array([0.1, -0.2, 0.3])
    M = np.diag([inertia, inertia, inertia, 1.0, 1.0, 1.0])
    arm = replace(heavy(0, joints=6), J=np.eye(6), M=M)
    x, y, z = spin.tolist()
    arm = replace(arm, v=np.array([x, y, z, 0.0, 0.0, 0.0]), angular_velocity=(x, y, z))
    tau = torque(executor(6, dt=dt), arm)
    after = spin + dt * tau[:3] / inertia
    added = dt * (ROTATION_DAMPING + dt * ROTATION_STIFFNESS)
    most = steady_share(0)
    taken = dt * ROTATION_DAMPING / inertia / max(1.0, added / inertia / most)
    assert after == pytest.approx((1.0 - taken) * spin)
    assert taken <= most


@pytest.mark.parametrize("seed", range(3))
def test_the_posture_turns_joints_along_what_the_tip_does_not_feel(seed: int) -> None:
    arm = heavy(seed)
    free = np.linalg.svd(arm.J)[2][-1]
    q_ref = arm.q + 0.1 * free + 0.2 * arm.J[4]
    v_ref = 0.3 * free
    got = torque(executor(), arm, q_ref=q_ref, v_ref=v_ref)
    along = float(free @ (q_ref - arm.q))
    wanted = POSTURE_STIFFNESS * along + POSTURE_DAMPING * 0.3
    assert free @ got == pytest.approx(wanted, rel=1e-3)
    assert arm.J[3:] @ got == pytest.approx(np.zeros(3), abs=0.01)


def test_an_arm_of_six_joints_has_no_posture_to_choose() -> None:
    arm = heavy(5, joints=6)
    got = torque(executor(6), arm, q_ref=arm.q + 0.1)
    assert got == pytest.approx(np.zeros(6), abs=1e-9)


def test_tracked_joints_are_felt_as_springs_and_dampers() -> None:
    """The damper is that of the joints' own speed."""
    stiffness = 25.0
    arm = heavy(6, joints=6)
    off = np.linspace(-0.1, 0.1, 6)
    speed = np.linspace(0.02, -0.04, 6)
    moving = replace(arm, v=speed)
    one = executor(6, joint_stiffness=stiffness)
    got = torque(one, moving, q_ref=arm.q + off, v_ref=np.ones(6))
    damper = JOINT_DAMPING * math.sqrt(stiffness)
    assert got == pytest.approx(stiffness * off - damper * speed)


def test_a_posture_is_not_held_by_joints_that_have_moved_on() -> None:
    """The share of the joints that a tip does not feel is that of the arm as it is."""
    one = executor()
    first = heavy(7)
    torque(one, first, q_ref=first.q + 0.1)
    other = replace(heavy(8), q=first.q + 0.01)
    got = torque(one, other, q_ref=other.q + 0.1)
    fresh = torque(executor(), other, q_ref=other.q + 0.1)
    assert got == pytest.approx(fresh)
    assert not np.allclose(fresh, torque(executor(), first, q_ref=first.q + 0.1))


def test_where_a_tool_gives_way_the_posture_has_another_share() -> None:
    """Also if the arm has hardly moved since it held its attitude."""
    arm = heavy(9)
    axis = arm.J[:3, 2] / np.linalg.norm(arm.J[:3, 2])
    buffer = margins.ARM.joint_buffer
    pressed = turned((float(axis[0]), float(axis[1]), float(axis[2])), -0.1)
    q_ref = arm.q + 0.1
    limits = {"lower": np.full(7, -FAR), "upper": np.full(7, FAR)}
    limits["upper"][2] = arm.q[2] + 0.9 * buffer
    limits["lower"][2] = limits["upper"][2] - 1.0
    near = replace(arm, rotation=pressed)
    before = replace(arm, q=arm.q - np.eye(7)[2] * 0.15 * buffer)
    one = replace(executor(), **limits)
    torque(one, before, q_ref=q_ref)
    fresh = torque(replace(executor(), **limits), near, q_ref=q_ref)
    assert torque(one, near, q_ref=q_ref) == pytest.approx(fresh)
    assert torque(executor(), near, q_ref=q_ref) != pytest.approx(fresh, abs=0.1)


def pulled(masses: tuple[float, float], yaw: float, damping: float, **command: object):
    """Return the force [N] along the table on a tip that is 0.1 m/s too slow along x,
    0.05 m/s along y, and has two ``masses`` [kg] along axes turned by ``yaw`` [rad];
    and the error of the velocity along those axes.
    """
    c = math.cos(yaw)
    s = math.sin(yaw)
    axes = np.array([[c, s], [-s, c]])
    M = np.eye(6)
    M[3:5, 3:5] = axes.T @ np.diag(masses) @ axes
    arm = replace(heavy(0, joints=6), J=np.eye(6), M=M)
    asked = replace(
        NOTHING,
        velocity=(0.1, 0.05, 0.0),
        damping=(damping, damping, 0.0),
        catches_up=True,
    )
    asked = replace(asked, **command)  # type: ignore[arg-type]
    force = torque(executor(6), arm, asked)[3:5]
    return axes @ force, axes @ [0.1, 0.05]


@pytest.mark.parametrize("yaw", [0.0, 0.4, 1.2, 2.5])
def test_a_heavy_tip_comes_to_its_velocity_in_time(
    yaw: float,
) -> None:
    damping = 200.0
    caught = damping * SERVO_TIME  # 6 kg
    force, error = pulled((5.0 * caught, 0.5 * caught), yaw, damping)
    assert force[0] == pytest.approx(5.0 * caught * error[0] / SERVO_TIME, rel=0.02)
    assert force[1] == pytest.approx(damping * error[1], rel=0.02)
    force, error = pulled((3.0 * caught, 2.0 * caught), yaw, damping)
    assert force == pytest.approx(
        np.array([3.0, 2.0]) * caught * error / SERVO_TIME, rel=0.02
    )


def test_a_tip_on_a_wall_catches_up_as_one_on_a_table() -> None:
    damping = 100.0
    mass = 20.0
    arm = replace(heavy(0, joints=6), J=np.eye(6), M=mass * np.eye(6))
    command = replace(
        NOTHING,
        velocity=(0.1, 0.05, 0.0),
        damping=(damping, damping, 0.0),
        catches_up=True,
    )
    for frame in FRAMES:
        force = torque(executor(6, frame), arm, command)[3:]
        wanted = mass / SERVO_TIME * np.array(frame.axes) @ command.velocity
        assert force == pytest.approx(wanted, rel=0.02, abs=0.1)


def test_what_catches_up_stays_inside_the_cap_of_the_servo() -> None:
    damping = 100.0
    error = math.hypot(0.1, 0.05)
    masses = (60.0, 60.0)
    cap = 2.0 * damping * error
    force, _ = pulled(masses, 0.0, damping, servo_cap=cap)
    assert math.hypot(*force) == pytest.approx(cap)
    # where its damper needs all of it nothing is left
    force, _ = pulled(masses, 0.0, damping, servo_cap=0.5 * damping * error)
    assert math.hypot(*force) == pytest.approx(0.5 * damping * error)


@pytest.mark.parametrize(
    "command",
    [
        {"catches_up": False},
        {"stiffness": (1e-3, 0.0, 0.0)},
        {"stiffness": (0.0, 1e-3, 0.0)},
    ],
)
def test_a_tip_on_a_spring_has_its_damper_alone(
    command: dict[str, object],
) -> None:
    damping = 100.0
    force, error = pulled((60.0, 60.0), 0.0, damping, **command)
    assert force == pytest.approx(damping * error, rel=1e-3)


def test_a_tip_catches_up_beside_a_spring_along_the_height() -> None:
    damping = 100.0
    force, error = pulled((60.0, 60.0), 0.0, damping, stiffness=(0.0, 0.0, 2000.0))
    assert force == pytest.approx(60.0 / SERVO_TIME * error, rel=0.05)


def test_a_tip_with_hardly_a_damper_catches_up_as_well() -> None:
    force, error = pulled((60.0, 60.0), 0.0, 0.5)
    assert force == pytest.approx(60.0 / SERVO_TIME * error, rel=0.05)


def test_a_tip_without_a_damper_does_not_catch_up() -> None:
    force, _ = pulled((60.0, 60.0), 0.0, 0.0)
    assert force == pytest.approx(np.zeros(2))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_in_contact_a_joint_at_its_limit_is_led_back(
    side: float,
) -> None:
    """Its tip feels no force of it."""
    arm = heavy(9)
    one = executor()
    one.upper[2] = arm.q[2] + (0.5 * margins.ARM.joint_buffer if side > 0.0 else FAR)
    one.lower[2] = arm.q[2] - (0.5 * margins.ARM.joint_buffer if side < 0.0 else FAR)
    one = replace(one)
    got = torque(one, arm)
    assert side * got[2] < 0.0
    assert arm.J[3:] @ got == pytest.approx(np.zeros(3), abs=0.01)
    assert torque(executor(), arm) == pytest.approx(np.zeros(7), abs=1e-9)


def rates(dt: float) -> tuple[float, float]:
    """Return acceleration of a free joint per [rad] and per [rad/s] of its error."""
    one = executor(dt=dt)
    arm = heavy(1)
    none = np.zeros(7)
    unit = np.eye(7)[3]
    spring = one.free(arm, arm.q + unit, none, none).torque - arm.bias
    damper = one.free(arm, arm.q, unit, none).torque - arm.bias
    return (
        float(np.linalg.solve(arm.M, spring)[3]),
        float(np.linalg.solve(arm.M, damper)[3]),
    )


def test_joints_in_free_space_are_tracked_with_critical_damping() -> None:
    for dt in (1e-3, 0.05):
        spring, damper = rates(dt)
        assert damper * damper == pytest.approx(4.0 * spring)
    assert rates(1e-3)[0] == pytest.approx(FREE_RATE**2)


def test_joints_are_tracked_no_faster_than_ticks_allow() -> None:
    """Four ticks are the time constant at least."""
    spring, _ = rates(0.05)
    assert math.sqrt(spring) == pytest.approx(1.0 / (4.0 * 0.05))


def test_each_joint_in_free_space_moves_by_its_own_error_alone() -> None:
    arm = heavy(2)
    error = np.linspace(-0.2, 0.3, 7)
    tau = executor().free(arm, arm.q + error, np.zeros(7), np.zeros(7)).torque
    moved = np.linalg.solve(arm.M, tau - arm.bias)
    assert moved == pytest.approx(FREE_RATE**2 * error)


EFFORT = np.array([80.0, 80.0, 60.0, 60.0, 40.0, 12.0, 12.0])
RATE = np.full(7, 500.0)  # [N m/s]
TICK = 0.004


def braking() -> ArmExecutor:
    far = np.full(7, FAR)
    return ArmExecutor(-far, far, EFFORT, RATE, lambda yaw: np.eye(3), 0.0, 0.0, TICK)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("speed", [0.05, 1.0])
def test_an_arm_that_brakes_comes_to_rest_and_never_turns_about(
    seed: int, speed: float
) -> None:
    arm = heavy(seed)
    one = braking()
    weight = 0.5 * EFFORT * np.sign(arm.bias)
    first = speed * np.random.default_rng(seed).normal(size=7)
    v = first
    held = weight
    energies = [0.5 * v @ arm.M @ v]
    for _ in range(round(4.0 / TICK)):
        limited = one.brake(replace(arm, v=v), weight, held)
        held = limited.torque
        assert (np.abs(held) < (1.0 + 1e-9) * EFFORT).all()
        v = v + TICK * np.linalg.solve(arm.M, held - weight)
        energies.append(0.5 * v @ arm.M @ v)
    assert energies[-1] < 1e-6 * energies[0]
    assert np.diff(energies).max() < 1e-3 * energies[0]


def test_a_slow_arm_that_brakes_loses_the_same_share_of_all_speeds() -> None:
    arm = heavy(1)
    v = 1e-4 * np.random.default_rng(1).normal(size=7)
    one = replace(braking(), rate=np.full(7, 1e9))
    weight = 0.2 * EFFORT
    tau = one.brake(replace(arm, v=v), weight, weight).torque
    after = v + TICK * np.linalg.solve(arm.M, tau - weight)
    assert after == pytest.approx((1.0 - BRAKE_SHARE) * v)


def test_an_arm_at_rest_that_brakes_holds_its_weight() -> None:
    weight = 0.3 * EFFORT
    assert braking().brake(heavy(1), weight, weight).torque == pytest.approx(weight)


def test_an_arm_whose_weight_takes_all_torque_has_none_to_brake_with() -> None:
    weight = np.where(np.arange(7) == 3, EFFORT, 0.0)
    moving = replace(heavy(1), v=np.ones(7))
    assert braking().brake(moving, weight, weight).torque == pytest.approx(weight)


def test_all_torques_stay_inside_their_limits_and_change_no_faster() -> None:
    one = braking()
    arm = heavy(1)
    previous = arm.bias
    for limited in (
        one.free(arm, arm.q + 50.0, np.zeros(7), previous),
        one.contact(
            arm, replace(NOTHING, force=(1e4, 0.0, 0.0)), arm.q, arm.v, previous
        ),
        one.brake(replace(arm, v=np.full(7, 90.0)), np.zeros(7), previous),
    ):
        assert (np.abs(limited.torque - previous) < RATE * TICK + 1e-9).all()
        assert limited.rate_share > 1.0


def test_a_tip_that_is_held_back_does_not_tilt_its_tool() -> None:
    """Its velocity never comes: the moment for that acceleration fades, and only the
    damper pushes.
    """
    damping = 100.0
    tick = 0.004
    arm = heavy(1)
    command = replace(
        NOTHING,
        velocity=(0.1, 0.05, 0.0),
        damping=(damping, damping, 0.0),
        catches_up=True,
    )
    damped = wrench(executor(dt=tick), arm, replace(command, catches_up=False))
    one = executor(dt=tick)
    first = wrench(one, arm, command) - damped
    assert np.abs(first[:3]).max() > 0.1  # of a mass coupled to the tool's rotation
    for _ in range(round(10.0 * HELD_BACK / tick)):
        wrench(one, arm, command)
    assert wrench(one, arm, command) == pytest.approx(damped, abs=1e-3)
    # as soon as it moves on it catches up again, whichever way
    back = replace(command, velocity=(-0.1, -0.05, 0.0))
    slowed = wrench(executor(dt=tick), arm, replace(back, catches_up=False))
    assert wrench(one, arm, back) - slowed == pytest.approx(-first, rel=1e-6)
