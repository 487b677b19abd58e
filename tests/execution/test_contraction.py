"""In free space an arm comes to rest at its reference, however light its links are."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.execution.arm import ArmDynamics, ArmExecutor

FREE = ((1500.0, 1500.0, 3000.0), (150.0, 150.0, 250.0))
MOVE = ((0.0, 0.0, 2000.0), (400.0, 400.0, 300.0))
PRESS = ((0.0, 0.0, 0.0), (1000.0, 1000.0, 150.0))
GAINS = (FREE, MOVE, PRESS)
STEP = 1e-6  # [rad], [rad/s] of the difference quotients
FAR = 100.0  # [rad] of limits that nothing comes near
REST = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class RandomArm:
    """A chain of links and rotors with its tip at the end of the last link."""

    axes: np.ndarray  # (n, 3) unit vectors in each joint's own frame
    links: np.ndarray  # (n, 3) [m] from each joint to the next
    masses: np.ndarray  # (n,) [kg] in the middle of each link
    rotors: np.ndarray  # (n,) [kg m^2]

    @property
    def size(self) -> int:
        return len(self.axes)

    def state(self, q: np.ndarray, v: np.ndarray) -> ArmDynamics:
        """Return the arm's state, of which gravity and Coriolis forces are no part."""
        R = np.eye(3)
        place = np.zeros(3)
        joints = []
        middles = []
        for axis, link, angle in zip(self.axes, self.links, q, strict=True):
            joints.append((R @ axis, place))
            R = R @ rotation(axis, angle)
            middles.append(place + 0.5 * R @ link)
            place = place + R @ link
        J = jacobian(joints, place)
        M = np.diag(self.rotors)
        for i, (mass, middle) in enumerate(zip(self.masses, middles, strict=True)):
            inertia = np.diag([mass * self.links[i] @ self.links[i] / 6.0] * 3)
            moved = np.zeros((6, self.size))
            moved[:, : i + 1] = jacobian(joints[: i + 1], middle)
            M = M + mass * moved[3:].T @ moved[3:] + moved[:3].T @ inertia @ moved[:3]
        wx, wy, wz, vx, vy, vz = (J @ v).tolist()
        px, py, pz = place.tolist()
        zero = np.zeros(self.size)
        return ArmDynamics(
            q, v, (px, py, pz), R, (vx, vy, vz), (wx, wy, wz), J, M, zero, np.zeros(6)
        )


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def jacobian(
    joints: list[tuple[np.ndarray, np.ndarray]], point: np.ndarray
) -> np.ndarray:
    columns = [(*axis, *np.cross(axis, point - origin)) for axis, origin in joints]
    return np.array(columns).T


def drawn(seed: int) -> tuple[RandomArm, np.ndarray, float]:
    """Return an arm of 6 or 7 joints, a posture (n,) [rad], and a period [s]."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(6, 8))
    axes = rng.normal(size=(n, 3))
    arm = RandomArm(
        axes / np.linalg.norm(axes, axis=1, keepdims=True),
        rng.uniform(-0.4, 0.4, (n, 3)),
        10.0 ** rng.uniform(-3.0, 1.0)
        * np.geomspace(1.0, 10.0 ** rng.uniform(-3, 0), n),
        10.0 ** rng.uniform(-4.0, 1.0, n),
    )
    return arm, rng.uniform(-np.pi, np.pi, n), float(rng.uniform(1e-3, 8e-3))


@dataclass(frozen=True)
class Loop:
    """An arm that is to rest at a posture, in ticks."""

    arm: RandomArm
    posture: np.ndarray  # (n,) [rad]
    period: float  # [s]
    gains: tuple[Vector3, Vector3]
    room: float = FAR  # [rad] of the first joint to its limit
    joint_stiffness: float = 0.0

    def __call__(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return joints and rates at the end of a tick."""
        state = self.arm.state(q, v)
        tau = self._executor.contact(
            state, self._command, self.posture, np.zeros_like(v), np.zeros_like(v)
        ).torque
        after = v + self.period * np.linalg.solve(state.M, tau)
        return q + self.period * after, after

    @cached_property
    def _executor(self) -> ArmExecutor:
        n = self.arm.size
        upper = np.full(n, FAR)
        upper[0] = self.posture[0] + self.room
        held = self.arm.state(self.posture, np.zeros(n)).rotation
        unbounded = np.full(n, np.inf)
        return ArmExecutor(
            np.full(n, -FAR),
            upper,
            unbounded,
            unbounded,
            lambda yaw: held,
            0.0,
            self.joint_stiffness,
            self.period,
        )

    @property
    def _command(self) -> TipCommand:
        stiffness, damping = self.gains
        place = self.arm.state(self.posture, np.zeros(self.arm.size)).position
        return TipCommand(
            REST, place, REST, stiffness, damping, 0.3, 0.0, 0.0, 25.0, 0.0
        )

    def linearised(self) -> np.ndarray:
        """Return the matrix (2 n, 2 n) that takes small errors through a tick."""
        n = self.arm.size
        columns = []
        for i in range(2 * n):
            ends = []
            for sign in (1.0, -1.0):
                x = np.concatenate([self.posture, np.zeros(n)])
                x[i] += sign * STEP
                ends.append(np.concatenate(self(x[:n], x[n:])))
            columns.append((ends[0] - ends[1]) / (2.0 * STEP))
        return np.array(columns).T


def radius(loop: Loop) -> float:
    return float(np.abs(np.linalg.eigvals(loop.linearised())).max())


seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.sampled_from(GAINS))
@settings(max_examples=30, deadline=None)
def test_small_errors_never_grow(seed: int, gains: tuple[Vector3, Vector3]) -> None:
    arm, posture, period = drawn(seed)
    assert radius(Loop(arm, posture, period, gains)) < 1.0 + 1e-6


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_small_errors_never_grow_where_joints_are_tracked_too(seed: int) -> None:
    arm, posture, period = drawn(seed)
    loop = Loop(arm, posture, period, MOVE, joint_stiffness=20.0)
    assert radius(loop) < 1.0 + 1e-6


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_an_arm_that_is_held_comes_back_to_its_place(seed: int) -> None:
    """All eigenvalues are inside the circle: errors of place and speed die out."""
    arm, posture, period = drawn(seed)
    assert radius(Loop(arm, posture, period, FREE)) < 1.0


@given(seeds)
@settings(max_examples=10, deadline=None)
def test_a_joint_at_its_limit_is_led_back_and_rests(seed: int) -> None:
    arm, posture, period = drawn(seed)
    loop = Loop(arm, posture, period, FREE, room=0.01)
    q = posture
    v = np.zeros(arm.size)
    fastest = []
    for _ in range(round(0.5 / period)):
        q, v = loop(q, v)
        fastest.append(np.abs(v).max())
    assert max(fastest) < 2.5  # [rad/s]: no kick
    assert fastest[-1] < 0.5 * max(fastest)


@given(seeds)
@settings(max_examples=10, deadline=None)
def test_a_moving_arm_is_brought_to_rest(seed: int) -> None:
    arm, posture, period = drawn(seed)
    loop = Loop(arm, posture, period, FREE)
    q = posture
    v = np.random.default_rng(seed).uniform(-0.2, 0.2, arm.size)
    first = arm.state(q, v)
    energy = 0.5 * v @ first.M @ v
    for _ in range(round(0.4 / period)):
        q, v = loop(q, v)
    assert 0.5 * v @ arm.state(q, v).M @ v < 0.5 * energy


@pytest.mark.parametrize("gains", GAINS)
def test_the_law_is_that_of_a_continuous_damper_where_ticks_are_short(
    gains: tuple[Vector3, Vector3],
) -> None:
    arm, posture, _ = drawn(7)
    heavy = replace(arm, rotors=np.full(arm.size, 5.0))
    v = np.random.default_rng(3).uniform(-0.01, 0.01, heavy.size)
    changes = []
    for period in (1e-5, 1e-6):
        _, after = Loop(heavy, posture, period, gains)(posture, v)
        changes.append((after - v) / period)
    assert np.linalg.norm(changes[0] - changes[1]) < 0.01 * np.linalg.norm(changes[1])
