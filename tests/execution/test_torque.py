"""Laws that keep joints inside their limits, and the tip's inertia."""

import numpy as np
import pytest

from pushpressslide.core import margins
from pushpressslide.execution import torque
from pushpressslide.execution.torque import (
    LEAST_MOBILITY,
    LIMIT_DAMPING,
    LIMIT_STIFFNESS,
    SINGULAR,
    Impedance,
    braked,
    gains,
    held_for_a_tick,
    joint_torque,
    kept_inside,
    limited,
    steady_share,
    task_inertia,
    unfelt,
    yielding,
)

N = 7
LOWER = np.full(N, -2.0)
UPPER = np.full(N, 2.0)
REST = np.zeros(N)
PERIOD = 0.004


def jacobian(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(6, N))


def near_limit(joint: int, side: float, left: float) -> np.ndarray:
    q = np.zeros(N)
    q[joint] = side * (2.0 - left)
    return q


def test_joints_well_inside_their_limits_are_left_alone() -> None:
    q = near_limit(3, 1.0, margins.ARM.joint_buffer + 1e-6)
    kept = kept_inside(jacobian(0), q, REST + 1.0, LOWER, UPPER, PERIOD)
    assert not kept.torque.any()
    assert not kept.added.any()


def test_a_joint_at_the_edge_of_its_buffer_is_left_alone() -> None:
    buffer = margins.ARM.joint_buffer
    q = np.full(N, 1.0)
    q[2] = buffer
    kept = kept_inside(jacobian(0), q, REST + 1.0, REST, UPPER, PERIOD)
    assert not kept.torque.any()
    assert not kept.added.any()
    assert not torque.near_limit(q, REST.tolist(), UPPER.tolist())
    np.testing.assert_array_equal(
        yielding(jacobian(0), np.ones(3), q, REST, UPPER), jacobian(0)
    )


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_near_its_limit_is_pushed_back_without_a_force_at_the_tip(
    seed: int, side: float
) -> None:
    J = jacobian(seed)
    joint = seed % N
    q = near_limit(joint, side, 0.01)
    tau = kept_inside(J, q, REST, LOWER, UPPER, PERIOD).torque
    # the power against the joint's way out is positive: it is led back
    assert side * tau[joint] < 0.0
    # no motion of the joints by this torque moves the tip along any axis
    assert J[3:] @ tau == pytest.approx(np.zeros(3), abs=1e-4)


def test_the_nearer_the_limit_the_harder() -> None:
    J = jacobian(1)
    sizes = []
    for left in (0.025, 0.02, 0.01, 0.0):
        q = near_limit(2, 1.0, left)
        kept = kept_inside(J, q, REST, LOWER, UPPER, PERIOD)
        sizes.append(np.linalg.norm(kept.torque))
    assert sizes == sorted(sizes)
    assert sizes[0] > 0.0


def test_a_joint_on_its_way_out_is_braked() -> None:
    J = jacobian(2)
    q = near_limit(4, 1.0, 0.02)
    out = np.zeros(N)
    out[4] = 0.5
    still = kept_inside(J, q, REST, LOWER, UPPER, PERIOD)
    moving = kept_inside(J, q, out, LOWER, UPPER, PERIOD)
    assert moving.torque[4] < still.torque[4]


def turning_jacobian(seed: int) -> np.ndarray:
    """Return the Jacobian of seven turning joints: their axes are unit vectors."""
    J = jacobian(seed)
    J[:3] /= np.linalg.norm(J[:3], axis=0)
    return J


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tool_is_not_turned_by_a_joint_at_its_limit(seed: int, side: float) -> None:
    J = turning_jacobian(seed)
    joint = seed % N
    axis = J[:3, joint]
    q = near_limit(joint, side, 0.01)
    held = yielding(J, side * axis, q, LOWER, UPPER)
    np.testing.assert_allclose(held.T @ [*axis, 0.0, 0.0, 0.0], 0.0, atol=1e-12)
    # about all other axes, and along all, it is held as before
    across = np.cross(axis, [0.3, -0.5, 0.8])
    wrench = [*across, 1.0, 2.0, 3.0]
    np.testing.assert_allclose(held.T @ wrench, J.T @ wrench, atol=1e-12)
    # a moment that leads the joint back in is given in full
    assert yielding(J, -side * axis, q, LOWER, UPPER) is not J
    np.testing.assert_array_equal(yielding(J, -side * axis, q, LOWER, UPPER), J)


def test_a_tool_gives_way_smoothly() -> None:
    J = turning_jacobian(3)
    buffer = margins.ARM.joint_buffer
    gaps = [
        np.abs(yielding(J, J[:3, 2], near_limit(2, 1.0, left), LOWER, UPPER) - J).max()
        for left in (buffer, 0.95 * buffer, 0.9 * buffer, 0.8 * buffer, 0.5 * buffer)
    ]
    assert gaps[0] == 0.0
    assert 0.0 < gaps[1] < gaps[2] < gaps[3]
    assert gaps[4] == pytest.approx(gaps[3])


def squeezed(seed: int, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a Jacobian whose least singular value is ``least``, and the motion (n,) of
    the joints that belongs to it.
    """
    U, s, Vt = np.linalg.svd(jacobian(seed), full_matrices=False)
    s[-1] = least
    return U @ np.diag(s) @ Vt, Vt[-1]


@pytest.mark.parametrize("seed", range(5))
def test_an_arm_is_braked_along_what_hardly_moves_its_tip(seed: int) -> None:
    J, motion = squeezed(seed, 1e-2 * SINGULAR)
    brake = braked(J, J @ J.T)
    assert brake is not None
    # along that motion alone, by next to all of the damping
    assert brake == pytest.approx(np.outer(motion, motion), abs=1e-3)


def test_an_arm_with_all_its_motions_is_not_braked() -> None:
    sizes = []
    for share in (0.5, 0.9, 0.999):
        J, motion = squeezed(4, share * SINGULAR)
        brake = braked(J, J @ J.T)
        assert brake is not None
        sizes.append(float(motion @ brake @ motion))
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[2] < 1e-4
    J, _ = squeezed(4, 1.001 * SINGULAR)
    assert braked(J, J @ J.T) is None


@pytest.mark.parametrize("seed", range(5))
def test_the_posture_makes_no_force_at_the_tip_and_little_moment(seed: int) -> None:
    J = jacobian(seed)
    posture = np.random.default_rng(seed + 10).normal(size=N)
    tau = unfelt(J, J @ J.T).share @ posture
    # tau = J^T w + what moves neither tip nor tool: w is what holds the posture
    held, *_ = np.linalg.lstsq(J.T, tau, rcond=None)
    assert held[3:] == pytest.approx(np.zeros(3), abs=1e-4)
    assert np.linalg.norm(J[:3] @ tau) < 0.1 * np.linalg.norm(J[:3] @ posture)


def test_where_the_arm_can_hardly_turn_the_tool_the_posture_holds_the_joints() -> None:
    """Two joints turn the tool about nearly one axis: what they do against each other
    moves neither tip nor tool, and only the posture damps it.
    """
    J = np.eye(6, N)
    J[:, 6] = J[:, 0]
    J[1, 6] = 0.03  # the axes differ by 2 degrees
    against = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0])
    tau = unfelt(J, J @ J.T).share @ against
    assert tau @ against > 0.9 * (against @ against)


@pytest.mark.parametrize("seed", range(5))
def test_the_nearer_a_singularity_the_less_the_arm_is_driven_out_of_it(
    seed: int,
) -> None:
    J = jacobian(seed)
    u, s, vt = np.linalg.svd(J, full_matrices=False)
    forces = []
    # of a mass matrix of ones the mobility along an axis is its singular value squared
    for share in (1.0, 0.1, 0.01, 0.0):
        s[5] = np.sqrt(share * LEAST_MOBILITY)
        J = (u * s) @ vt
        along = vt[5] @ J.T @ task_inertia(J, np.eye(N)) @ u[:, 5]
        forces.append(along)
    assert forces == sorted(forces, reverse=True)
    assert forces[0] == pytest.approx(0.5 / np.sqrt(LEAST_MOBILITY))
    assert forces[-1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_the_posture_is_felt_by_a_symmetric_share_of_itself(seed: int) -> None:
    """So that its damper takes energy from the joints, never gives any."""
    J = jacobian(seed)
    free = np.linalg.svd(J)[2][-1]
    share, projector = unfelt(J, J @ J.T)
    assert projector == pytest.approx(projector.T, abs=1e-9)
    # a posture that nothing holds is left whole
    assert share @ free == pytest.approx(free, abs=1e-6)
    assert projector @ free == pytest.approx(free, abs=1e-6)
    shares = np.linalg.eigvalsh(projector)
    assert shares.min() > -1e-9
    assert shares.max() < 1.0 + 1e-9


@pytest.mark.parametrize("inertia", [1e-4, 1e-2, 1.0, 10.0])
@pytest.mark.parametrize("period", [0.001, 0.004, 0.008])
def test_a_damper_brings_an_inertia_nearer_to_rest_and_not_past_it(
    inertia: float, period: float
) -> None:
    damping = 14.0
    speed = 2.0
    impedance = Impedance(np.array([-damping * speed]), np.array([[period * damping]]))
    most = 0.8
    torque = held_for_a_tick(impedance, np.array([[inertia]]), most)
    after = speed + period * float(torque[0]) / inertia
    share = period * damping / inertia  # that a damper held constant would take
    assert after == pytest.approx(speed * (1.0 - min(share, most)), abs=1e-9)


@pytest.mark.parametrize("late", range(5))
def test_a_damper_stops_a_light_inertia_also_two_ticks_later_than_believed(
    late: int,
) -> None:
    most = steady_share(late)
    impedance = Impedance(np.array([-14.0]), np.array([[0.004 * 14.0]]))
    inertia = 1e-3
    torque = held_for_a_tick(impedance, np.array([[inertia]]), most)
    assert -0.004 * torque[0] / inertia == pytest.approx(most)
    for more in (0, 1, 2):
        assert late_speeds(most, late + more) < 0.1
    assert late_speeds(1.98 * most, late + 1) < 0.5
    assert late_speeds(2.02 * most, late + 1) > 2.0


def late_speeds(share: float, late: int) -> float:
    """Largest of the last speeds after one of 1, of which a damper takes a ``share`` in
    each tick, ``late``.
    """
    speeds = [1.0] * (late + 1)
    for _ in range(300 * (late + 1)):
        speeds.append(speeds[-1] - share * speeds[-1 - late])
    return max(abs(speed) for speed in speeds[-10 * (late + 1) :])


@pytest.mark.parametrize("seed", range(5))
def test_springs_and_dampers_at_the_end_of_a_tick_never_act_harder(seed: int) -> None:
    """In the energy that they give an arm at rest."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(N, N))
    M = root @ root.T + 1e-4 * np.eye(N)
    J = jacobian(seed)
    added = J.T @ J
    torque = J.T @ rng.normal(size=6)
    at_end = held_for_a_tick(Impedance(torque, added), M, 1.0)
    given = at_end @ np.linalg.solve(M, at_end)
    assert given < (1.0 + 1e-9) * torque @ np.linalg.solve(M, torque)
    assert at_end @ np.linalg.solve(M, torque) > 0.0


def test_a_spring_and_a_damper_weigh_what_a_tick_takes() -> None:
    spring, damper, added = gains(200.0, 6.0, 0.004)
    assert (spring, damper) == (200.0, 6.0)
    # of a speed v a tick takes h D v / m, and the spring of the way h v then h^2 K v / m
    assert added == pytest.approx(0.004 * 6.0 + 0.004**2 * 200.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("joint", [0, N - 1])
def test_one_joint_within_the_buffer_makes_an_arm_near_its_limit(
    side: float, joint: int
) -> None:
    buffer = margins.ARM.joint_buffer
    lower = LOWER.tolist()
    upper = UPPER.tolist()
    assert torque.near_limit(near_limit(joint, side, 0.99 * buffer), lower, upper)
    assert not torque.near_limit(near_limit(joint, side, 1.01 * buffer), lower, upper)
    # a joint beyond its limit is nearer still
    assert torque.near_limit(near_limit(joint, side, -0.1), lower, upper)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_in_its_buffer_has_a_spring_and_a_damper(side: float) -> None:
    """In a direction that moves no tip, by how deep it is and how fast."""
    J = np.eye(6, N)
    J[:3, 6] = 0.0
    left = 0.4 * margins.ARM.joint_buffer
    deep = margins.ARM.joint_buffer - left
    q = near_limit(6, side, left)
    v = np.zeros(N)
    v[6] = 0.3
    kept = kept_inside(J, q, v, LOWER, UPPER, PERIOD)
    wanted = -side * LIMIT_STIFFNESS * deep - LIMIT_DAMPING * 0.3
    assert kept.torque[6] == pytest.approx(wanted)
    assert kept.torque[:6] == pytest.approx(np.zeros(6))
    weight = PERIOD * (LIMIT_DAMPING + PERIOD * LIMIT_STIFFNESS)
    assert kept.added[6, 6] == pytest.approx(weight)


@pytest.mark.parametrize("seed", range(4))
def test_what_keeps_joints_inside_takes_energy_and_moves_no_tip(seed: int) -> None:
    J = jacobian(seed)
    q = near_limit(seed, 1.0, 0.01)
    still = kept_inside(J, q, REST, LOWER, UPPER, PERIOD)
    v = np.random.default_rng(seed).normal(size=N)
    moving = kept_inside(J, q, v, LOWER, UPPER, PERIOD)
    damped = moving.torque - still.torque
    assert v @ damped < 0.0
    assert J[3:] @ damped == pytest.approx(np.zeros(3), abs=1e-3)
    assert np.linalg.eigvalsh(moving.added).min() > -1e-9


@pytest.mark.parametrize("seed", range(5))
def test_the_inertia_at_a_tip_is_its_inverse_mobility(seed: int) -> None:
    J = jacobian(seed)
    root = np.random.default_rng(seed).normal(size=(N, N))
    M = root @ root.T + np.eye(N)
    mobility = J @ np.linalg.inv(M) @ J.T
    least = np.linalg.eigvalsh(mobility)[0]
    wanted = np.linalg.inv(mobility)
    error = np.abs(task_inertia(J, M) - wanted).max() / np.abs(wanted).max()
    # of an axis of mobility s, a share 1 / (1 + (least mobility / s)^2) is left
    assert error < 1.01 * (LEAST_MOBILITY / least) ** 2 + 1e-9


def test_a_joint_torque_makes_the_joints_accelerate_as_asked() -> None:
    rng = np.random.default_rng(1)
    root = rng.normal(size=(N, N))
    M = root @ root.T + np.eye(N)
    bias, q, v, q_ref, v_ref = rng.normal(size=(5, N))
    tau = joint_torque(M, bias, q, v, q_ref, v_ref, 12.0)
    moved = np.linalg.solve(M, tau - bias)
    assert moved == pytest.approx(144.0 * (q_ref - q) + 24.0 * (v_ref - v))


@pytest.mark.parametrize("seed", range(10))
def test_torques_are_held_inside_their_limits_first_and_their_change_then(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    effort = rng.uniform(1.0, 10.0, N)
    change = rng.uniform(0.5, 3.0, N)
    previous = rng.uniform(-1.0, 1.0, N) * effort
    asked = 2.0 * rng.normal(size=N) * effort
    got = limited(asked, previous, effort.tolist(), change.tolist())
    inside = np.clip(asked, -effort, effort)
    wanted = np.clip(inside, previous - change, previous + change)
    assert got.torque == pytest.approx(wanted)
    assert got.share == pytest.approx((np.abs(asked) / effort).max())
    assert got.rate_share == pytest.approx((np.abs(inside - previous) / change).max())


def test_torques_that_nothing_limits_are_given_to_the_bit() -> None:
    asked = np.array([1.0, -2.0, 0.5])
    got = limited(asked, np.zeros(3), (2.0, 2.0, 2.0), (2.0, 2.0, 2.0))
    assert got.torque.tolist() == asked.tolist()
    assert (got.share, got.rate_share) == (1.0, 1.0)


def test_torques_below_their_limits_are_shares_of_them() -> None:
    asked = np.array([1.0, -2.0, 0.5])
    got = limited(asked, np.zeros(3), (4.0, 4.0, 4.0), (8.0, 8.0, 8.0))
    assert (got.share, got.rate_share) == (0.5, 0.25)


@pytest.mark.parametrize("share", [0.01, 0.3, 0.7])
def test_an_arm_is_braked_the_more_the_less_its_tip_moves(share: float) -> None:
    """By (1 - share^2)^2: from nothing at the singular value, and smoothly there."""
    J, motion = squeezed(2, share * SINGULAR)
    brake = braked(J, J @ J.T)
    assert brake is not None
    assert motion @ brake @ motion == pytest.approx((1.0 - share**2) ** 2, abs=1e-6)
    others = np.eye(N) - np.outer(motion, motion)
    assert others @ brake == pytest.approx(np.zeros((N, N)), abs=1e-9)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_limits_that_are_not_about_zero_tell_which_end_is_near(side: float) -> None:
    J = turning_jacobian(1)
    lower = LOWER + 50.0
    upper = UPPER + 50.0
    q = near_limit(1, side, 0.01) + 50.0
    axis = J[:3, 1]
    given = yielding(J, side * axis, q, lower, upper)
    assert not np.array_equal(given, J)
    np.testing.assert_array_equal(yielding(J, -side * axis, q, lower, upper), J)
