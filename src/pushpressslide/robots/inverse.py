"""Inverse kinematics of many postures at once, by damped least squares.

Null-space motion keeps the joints away from their limits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

POSITION_TOLERANCE = 1e-6  # [m] of a solution
ANGLE_TOLERANCE = 1e-6  # [rad]
SHARPNESS = 8.0  # [1/rad] of the smooth minimum over the joints' margins
NEARLY = 0.01  # [rad; m] error below which a posture is near its target
LARGEST_STEP = 0.4  # [rad] of any joint in one iteration
POLISHING = 8  # last iterations, without regard to the margin
# the home posture with its elbow and its wrist varied, and with the wrist turned over
STRUCTURED_SEEDS = 11
RANDOM_SEEDS = 4  # postures drawn within the limits, besides the structured ones


@dataclass(frozen=True)
class IkSolution:
    """The best posture found for each of m targets."""

    q: Array  # (m, n) [rad; m of slides]
    position_residual: Array  # (m,) [m]
    angle_residual: Array  # (m,) [rad]
    joint_margin: Array  # (m,) [rad] least distance to a joint limit
    converged: NDArray[np.bool_]  # (m,) target met and the wanted margin kept

    def or_else(self, other: IkSolution) -> IkSolution:
        """The solution, completed by that of ``other`` for targets that are not met."""
        own = self.converged
        return IkSolution(
            np.where(own[:, None], self.q, other.q),
            np.where(own, self.position_residual, other.position_residual),
            np.where(own, self.angle_residual, other.angle_residual),
            np.where(own, self.joint_margin, other.joint_margin),
            own | other.converged,
        )


@dataclass(frozen=True)
class IkSearch:
    """Limits on the effort of a search for postures."""

    iterations: int = 60
    # take the first posture found for a target, whatever its margin
    first_found: bool = False
    # after so many iterations, how many starts of each target are followed further
    stages: tuple[tuple[int, int], ...] = ((12, 6), (24, 3))


THOROUGH = IkSearch()


@dataclass(frozen=True)
class _Targets:
    """Targets of k tips. If no rotations are given, the tip may turn freely about its
    axis.
    """

    positions: Array  # (k, 3) [m]
    axes: Array  # (k, 3) unit vectors of the tool
    rotations: Array | None  # R_WT (k, 3, 3)

    def __getitem__(self, rows: NDArray[np.intp]) -> _Targets:
        rotations = None if self.rotations is None else self.rotations[rows]
        return _Targets(self.positions[rows], self.axes[rows], rotations)

    def error(self, kin: ArmKinematics, q: Array) -> tuple[Array, Array]:
        """Errors and Jacobians of postures (k, n), as in ``task_error``."""
        return task_error(kin, q, self.positions, self.rotations, self.axes)


def orientation_error(R: Array, R_wanted: Array) -> Array:
    """Rotation vectors (..., 3) [rad], world axes, that turn R into R_wanted (..., 3,
    3).
    """
    D = R_wanted @ np.swapaxes(R, -1, -2)
    v = 0.5 * np.stack(
        [
            D[..., 2, 1] - D[..., 1, 2],
            D[..., 0, 2] - D[..., 2, 0],
            D[..., 1, 0] - D[..., 0, 1],
        ],
        axis=-1,
    )
    s = np.linalg.norm(v, axis=-1, keepdims=True)
    c = 0.5 * (np.trace(D, axis1=-2, axis2=-1)[..., None] - 1.0)
    angle = np.arctan2(s, c)
    # Half a turn off, the axis is lost in v: any axis will do to get moving.
    axis = np.where(
        (s > 1e-9) | (c > 0.0), v / np.maximum(s, 1e-300), np.array([1.0, 0.0, 0.0])
    )
    out: Array = axis * angle
    return out


def _cross(a: Array, b: Array) -> Array:
    """Cross product a x b (..., 3). For a few vectors np.cross takes several times as
    long.
    """
    ax, ay, az, bx, by, bz = (v[..., i] for v in (a, b) for i in range(3))
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def axis_error(z: Array, z_wanted: Array) -> Array:
    """Rotation vectors (..., 3) [rad] of the shortest turn from unit vectors z to
    z_wanted, (3,) or (..., 3).
    """
    v = _cross(z, z_wanted)
    s = np.sqrt((v * v).sum(axis=-1, keepdims=True))
    c = (z * z_wanted).sum(axis=-1, keepdims=True)
    axis = v / np.maximum(s, 1e-300)
    opposite = (s <= 1e-9) & (c <= 0.0)
    if opposite.any():
        other = _cross(
            z_wanted, np.roll(z_wanted, 1, axis=-1) + np.array([0.1, 0.2, 0.3])
        )
        axis = np.where(
            opposite, other / np.linalg.norm(other, axis=-1, keepdims=True), axis
        )
    out: Array = axis * np.arctan2(s, c)
    return out


def limit_gradient(kin: ArmKinematics, q: Array, relevant: float = 0.8) -> Array:
    """Gradient (..., n) of the smooth minimum joint margin.

    It fades to zero for margins above ``relevant`` [rad].
    """
    below = q - kin.facts.lower
    above = kin.facts.upper - q
    margin = np.minimum(below, above)
    lower = margin.min(axis=-1, keepdims=True)
    weight = np.exp(-SHARPNESS * (margin - lower))
    weight /= weight.sum(axis=-1, keepdims=True)
    out: Array = np.where(below < above, weight, -weight) * np.clip(
        2.0 * (1.0 - lower / relevant), 0.0, 1.0
    )
    return out


def task_error(
    kin: ArmKinematics, q: Array, p: Array, R_wanted: Array | None, axis: Array
) -> tuple[Array, Array]:
    """Error (..., 6) [rad; m] and Jacobian (..., 6, n) of a task.

    The task places the tip at p, with the rotation R_wanted or with the tool along an
    axis. If the yaw is free, the rotation about ``axis``, (3,) or (..., 3), is removed
    from both results.
    """
    R, p_now, J = kin.tip_and_jacobian(q)
    if R_wanted is None:
        turn = axis_error(R[..., :, 2], axis)
        along = axis[..., :, None]
        J[..., :3, :] -= along * (along * J[..., :3, :]).sum(axis=-2, keepdims=True)
    else:
        turn = orientation_error(R, R_wanted)
    return np.concatenate([turn, p - p_now], axis=-1), J


def damped_step(J: Array, e: Array, secondary: Array) -> Array:
    """Step dq (..., n) by damped least squares for e (..., 6), plus ``secondary`` in
    the null space of J.
    """
    damping = 0.05 * (e * e).sum(axis=-1) + 1e-10
    A = J @ np.swapaxes(J, -1, -2) + damping[..., None, None] * np.eye(6)
    wanted = e - (J @ secondary[..., None])[..., 0]
    out: Array = (
        secondary
        + (np.swapaxes(J, -1, -2) @ np.linalg.solve(A, wanted[..., None]))[..., 0]
    )
    return out


def default_seeds(kin: ArmKinematics, p: Array) -> Array:
    """Starting postures (m, s, n) for targets p (m, 3).

    They are turned towards the targets, with elbow and wrist varied. For an arm with
    ``home_first`` they are the ready posture and postures spread over the joint ranges.
    """
    facts = kin.facts
    m = len(p)
    n = facts.size
    rng = np.random.default_rng(0)
    span = np.minimum(facts.upper, 3.0) - np.maximum(facts.lower, -3.0)
    count = RANDOM_SEEDS + STRUCTURED_SEEDS
    random = np.maximum(facts.lower, -3.0) + span * (0.1 + 0.8 * rng.random((count, n)))
    if facts.home_first:
        seeds = np.concatenate([facts.home[None], random[1:]])
    else:
        seeds = np.concatenate([_structured_seeds(kin), random[:RANDOM_SEEDS]])
    out: Array = np.broadcast_to(seeds, (m, *seeds.shape)).copy()
    if facts.moving[0].kind == "revolute":
        azimuth = (
            np.arctan2(p[:, 1] - kin.base[1], p[:, 0] - kin.base[0]) - kin.base_yaw
        )
        turned = 1 if facts.home_first else STRUCTURED_SEEDS
        sense = kin.turning or 1.0
        out[:, :turned, 0] += sense * (
            np.remainder(azimuth + math.pi, 2.0 * math.pi)[:, None] - math.pi
        )
    out = np.clip(out, facts.lower, facts.upper)
    return out


def _structured_seeds(kin: ArmKinematics) -> Array:
    """Variants of the home posture (STRUCTURED_SEEDS, n) for an arm with 7 joints,
    otherwise copies of it.
    """
    facts = kin.facts
    structured = np.tile(facts.home, (STRUCTURED_SEEDS, 1))
    if facts.size == 7 and facts.moving[0].kind == "revolute":
        for i, (elbow, wrist) in enumerate(
            (a, b) for a in (0.0, 0.7, -0.7) for b in (0.0, 1.4, -1.4)
        ):
            structured[i, 0] += elbow
            structured[i, 2] -= elbow
            structured[i, 6] += wrist
        for i, side in ((-2, 1.0), (-1, -1.0)):  # for places close to the base
            structured[i] += (0.0, 0.8, 0.0, -0.4, 2.6 * side, 2.0, 1.4 * side)
    return structured


def solve_ik(
    kin: ArmKinematics,
    target_p: Array,
    attitude: ToolAttitude | Array = UPRIGHT,
    tool_yaw: Array | float | None = None,
    q_seed: Array | None = None,
    joint_margin: float = 0.0,
    search: IkSearch = THOROUGH,
) -> IkSolution:
    """Posture with the largest joint margin for each target.

    ``target_p`` (3,) or (m, 3) [m] is the tip's centre in the world. ``attitude`` is
    one tool attitude for all targets, with a ``tool_yaw`` [rad] that is a scalar, (m,),
    or None for any yaw. It may also be an array with one element per target: tool axes
    (m, 3) or rotations R_WT (m, 3, 3). ``q_seed`` is (n,), (s, n) or (m, s, n), or None
    for ``default_seeds``. Every joint keeps ``joint_margin`` [rad] from its limits.
    """
    p = np.atleast_2d(np.asarray(target_p, dtype=np.float64))
    m = len(p)
    seeds = default_seeds(kin, p) if q_seed is None else _seeds(q_seed, m)
    s = seeds.shape[1]
    starts = seeds.reshape(m * s, kin.facts.size).copy()
    targets = _targets(p, attitude, tool_yaw, s)
    q, errors = _descent(kin, targets, starts, joint_margin, search, s)
    angle = np.linalg.norm(errors[:, :3], axis=-1)
    distance = np.linalg.norm(errors[:, 3:], axis=-1)
    margin = kin.joint_margin(q)
    ok = _solved(errors) & (margin >= joint_margin - 1e-9)
    score = np.where(ok, margin, -10.0 - angle - distance).reshape(m, s)
    best = np.arange(m) * s + score.argmax(axis=1)
    return IkSolution(q[best], distance[best], angle[best], margin[best], ok[best])


def _seeds(q_seed: Array, m: int) -> Array:
    """Given starting postures (n,), (s, n) or (m, s, n), broadcast to (m, s, n)."""
    given = np.asarray(q_seed, dtype=np.float64)
    return np.broadcast_to(
        given if given.ndim > 1 else given[None],
        (m, *np.atleast_2d(given).shape[-2:]),
    )


def _targets(
    p: Array,
    attitude: ToolAttitude | Array,
    tool_yaw: Array | float | None,
    start_count: int,
) -> _Targets:
    """Targets of ``solve_ik``, each repeated once per starting posture."""
    m = len(p)
    R = None
    if isinstance(attitude, ToolAttitude):
        axes = np.broadcast_to(attitude.axis, (m * start_count, 3))
        if tool_yaw is not None:
            yaws = np.broadcast_to(np.asarray(tool_yaw, dtype=np.float64), (m,))
            R = np.repeat(attitude.rotation(yaws), start_count, axis=0)
    elif attitude.ndim == 3:
        axes = np.repeat(attitude[..., 2], start_count, axis=0)
        R = np.repeat(attitude, start_count, axis=0)
    else:
        axes = np.repeat(attitude, start_count, axis=0)
    return _Targets(np.repeat(p, start_count, axis=0), axes, R)


def _descent(
    kin: ArmKinematics,
    targets: _Targets,
    q: Array,
    joint_margin: float,
    search: IkSearch,
    start_count: int,
) -> tuple[Array, Array]:
    """Postures (k, n) and their errors (k, 6) after damped steps from ``q``.

    ``start_count`` consecutive rows belong to one target.
    """
    slack = 0.5 * (kin.facts.upper - kin.facts.lower)
    inset = np.minimum(joint_margin, 0.99 * slack)
    lower = kin.facts.lower + inset
    upper = kin.facts.upper - inset
    climbing = 0 if search.first_found else max(search.iterations - POLISHING, 0)
    e, J = targets.error(kin, q)
    errors = e
    active = np.arange(len(q))
    kept = {} if search.first_found else dict(search.stages)
    for i in range(search.iterations):
        if kept.get(i, start_count) < start_count:
            best = _best(
                kin, q[active], e, len(active) * start_count // len(q), kept[i]
            )
            active = active[best]
            e = e[best]
            J = J[best]
        if search.first_found:
            met = np.repeat(
                _solved(errors).reshape(-1, start_count).any(axis=1), start_count
            )
            unmet = ~met[active]
            if not unmet.any():
                break
            active = active[unmet]
            e = e[unmet]
            J = J[unmet]
        free = np.zeros((len(active), kin.facts.size))
        if i < climbing:
            free = 0.15 * limit_gradient(kin, q[active])
        dq = damped_step(J, e, free)
        dq *= LARGEST_STEP / np.maximum(
            np.abs(dq).max(axis=-1, keepdims=True), LARGEST_STEP
        )
        q[active] = np.clip(q[active] + dq, lower, upper)
        e, J = targets[active].error(kin, q[active])
        errors[active] = e
    return q, errors


def _best(
    kin: ArmKinematics, q: Array, e: Array, start_count: int, count: int
) -> NDArray[np.intp]:
    """Rows of the best ``count`` postures of each target.

    If some postures reach the target, the best are those farthest from the joint
    limits; otherwise the best are those nearest to the target. ``start_count``
    consecutive rows belong to one target.
    """
    off = np.linalg.norm(e, axis=-1)
    score = np.where(off < NEARLY, kin.joint_margin(q), -off)
    order = np.argsort(-score.reshape(-1, start_count), axis=1, kind="stable")
    best = np.sort(order[:, :count], axis=1)
    out: NDArray[np.intp] = (best + start_count * np.arange(len(best))[:, None]).ravel()
    return out


def _solved(e: Array) -> NDArray[np.bool_]:
    angle = np.linalg.norm(e[:, :3], axis=-1)
    distance = np.linalg.norm(e[:, 3:], axis=-1)
    out: NDArray[np.bool_] = (angle < ANGLE_TOLERANCE) & (distance < POSITION_TOLERANCE)
    return out
