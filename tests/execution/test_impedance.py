"""Impedance of a tip: springs and dampers, and the moment on the tool."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand
from pushpressslide.execution.impedance import (
    rotation_error,
    servo,
    tip_force,
    tip_moment,
)

STIFFNESS = 30.0
DAMPING = 2.0
REST = (0.0, 0.0, 0.0)


def turned(angle: float) -> np.ndarray:
    """Return the rotation by ``angle`` [rad] about z."""
    c = math.cos(angle)
    s = math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def moment(angle: float, spin: float = 0.0) -> float:
    """Return the moment about z of a tool off by ``angle`` [rad], at ``spin`` [rad/s]."""
    w = np.array([0.0, 0.0, spin])
    got = tip_moment(turned(angle), np.eye(3), REST, w, STIFFNESS, DAMPING)
    assert got[:2] == pytest.approx([0.0, 0.0])
    return float(got[2])


@pytest.mark.parametrize("angle", [-0.15, 0.05, 0.19])
def test_a_tool_a_little_off_is_turned_by_a_spring(angle: float) -> None:
    assert moment(angle) == pytest.approx(STIFFNESS * math.sin(angle))


@pytest.mark.parametrize("angle", [0.3, 1.2, 2.5])
def test_a_tool_far_off_is_turned_no_harder(angle: float) -> None:
    assert moment(angle) == pytest.approx(STIFFNESS * margins.ARM.attitude)
    assert moment(-angle) == pytest.approx(-STIFFNESS * margins.ARM.attitude)


def test_a_tool_that_spins_is_braked_however_far_off_it_is() -> None:
    assert moment(2.0, spin=5.0) == pytest.approx(
        STIFFNESS * margins.ARM.attitude - 5.0 * DAMPING
    )


def command(yaw: float = 0.0, cap: float = 1e9, **fields: object) -> TipCommand:
    zero = (0.0, 0.0, 0.0)
    still = TipCommand(zero, zero, zero, zero, zero, yaw, 0.0, 0.0, cap, 0.0)
    return replace(still, **fields)  # type: ignore[arg-type]


STIFF = (1500.0, 800.0, 3000.0)
DAMP = (150.0, 60.0, 250.0)


@pytest.mark.parametrize("yaw", [0.0, 0.5, 2.0, -2.6])
def test_springs_and_dampers_act_along_normal_face_and_height(yaw: float) -> None:
    reference = np.array([0.003, -0.002, 0.001])
    moving = np.array([0.02, 0.03, -0.04])
    place = np.array([0.001, 0.002, -0.003])
    velocity = np.array([-0.01, 0.02, 0.01])
    asked = command(
        yaw,
        position=tuple(reference),
        velocity=tuple(moving),
        stiffness=STIFF,
        damping=DAMP,
    )
    c = math.cos(yaw)
    s = math.sin(yaw)
    axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    along = STIFF * (axes @ (reference - place)) + DAMP * (axes @ (moving - velocity))
    got = servo(asked, tuple(place), tuple(velocity))
    assert got.force == pytest.approx(axes.T @ along)


@pytest.mark.parametrize("period", [0.001, 0.004])
def test_springs_and_dampers_weigh_what_they_take_in_a_tick(period: float) -> None:
    """h (D + h K) along each axis."""
    got = servo(command(stiffness=STIFF, damping=DAMP), REST, REST, period)
    weights = [period * (b + period * k) for k, b in zip(STIFF, DAMP, strict=True)]
    assert got.added == pytest.approx(weights)
    assert not got.isotropic
    alike = servo(command(stiffness=(9.0, 9.0, 1.0)), REST, REST, period)
    assert alike.isotropic


def test_a_servo_at_its_cap_keeps_its_direction() -> None:
    """Along the support together, along the height by itself."""
    asked = command(
        0.4, 5.0, position=(0.03, 0.01, 0.0001), stiffness=STIFF, damping=DAMP
    )
    free = replace(asked, servo_cap=1e9)
    capped = servo(asked, REST, REST, 0.004)
    whole = servo(free, REST, REST, 0.004)
    size = math.hypot(*whole.force[:2])
    assert math.hypot(*capped.force[:2]) == pytest.approx(5.0)
    share = 5.0 / size
    assert capped.force[:2] == pytest.approx([share * f for f in whole.force[:2]])
    assert capped.added[:2] == pytest.approx([share * m for m in whole.added[:2]])
    assert capped.force[2] == whole.force[2]
    assert capped.added[2] == whole.added[2]
    for side in (-1.0, 1.0):
        high = servo(replace(asked, position=(0.0, 0.0, side * 0.1)), REST, REST, 0.004)
        assert high.force == pytest.approx((0.0, 0.0, side * 5.0))
        assert high.added[2] == pytest.approx(whole.added[2] * 5.0 / 300.0)
        assert high.added[:2] == whole.added[:2]


def test_a_servo_just_below_its_cap_is_left_whole() -> None:
    asked = command(0.0, 5.0, position=(0.004, 0.0, 0.0), stiffness=(1000.0, 0.0, 0.0))
    assert servo(asked, REST, REST).force[0] == pytest.approx(4.0)


def test_a_tip_exerts_its_force_and_that_of_its_servo() -> None:
    asked = command(
        0.3, force=(1.0, 2.0, -3.0), position=(0.001, 0.002, 0.003), stiffness=STIFF
    )
    added = servo(asked, REST, REST).force
    got = tip_force(asked, REST, REST)
    assert got == pytest.approx(np.add(added, asked.force))


@pytest.mark.parametrize("seed", range(6))
def test_the_error_of_a_rotation_turns_one_into_the_other(seed: int) -> None:
    """To first order: the sine of the angle along the axis, in the world."""
    rng = np.random.default_rng(seed)
    R = Rotation.random(random_state=seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    angle = rng.uniform(0.0, 1.5)
    wanted = Rotation.from_rotvec(angle * axis) * R
    got = rotation_error(wanted.as_matrix(), R.as_matrix())
    assert got == pytest.approx(math.sin(angle) * axis)


@pytest.mark.parametrize("axis", range(3))
def test_a_tool_is_damped_about_every_axis(
    axis: int,
) -> None:
    wanted = np.zeros(3)
    w = np.zeros(3)
    wanted[axis] = 0.5
    w[axis] = 0.2
    eye = np.eye(3)
    got = tip_moment(eye, eye, tuple(wanted), tuple(w), STIFFNESS, DAMPING)
    assert got == pytest.approx(DAMPING * (wanted - w))


@pytest.mark.parametrize("seed", range(4))
def test_a_tool_is_turned_about_the_axis_that_it_is_off_by(seed: int) -> None:
    axis = np.random.default_rng(seed).normal(size=3)
    axis /= np.linalg.norm(axis)
    for angle, size in ((0.1, math.sin(0.1)), (1.0, margins.ARM.attitude)):
        R = Rotation.from_rotvec(angle * axis).as_matrix()
        got = tip_moment(R, np.eye(3), REST, REST, STIFFNESS, DAMPING)
        assert got == pytest.approx(STIFFNESS * size * axis)


def test_outside_of_a_tick_springs_and_dampers_weigh_nothing() -> None:
    assert servo(command(stiffness=STIFF, damping=DAMP), REST, REST).added == REST
