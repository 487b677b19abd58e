"""Joint paths along a path of the tip.

Each posture is found from the previous one, so that the arm never flips.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.robots.inverse import (
    ANGLE_TOLERANCE,
    POSITION_TOLERANCE,
    damped_step,
    limit_gradient,
    task_error,
)
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

ContinuationStatus = Literal["ok", "unreachable", "joint_limit", "jump"]

NULL_RATE = 3.0  # [rad] of elbow motion away from the limits per metre of the tip's way
YAW_ARM = 0.3  # [m] path length equivalent to a radian of tool yaw
ITERATIONS = 10  # Newton steps for one sample of the path
START_ITERATIONS = 40  # for the first one, which may start farther off
START_STEP = 0.3  # [rad] of any joint in one Newton step
# a path that misses a sample by more stays where it is: it is no near miss
LOST_ANGLE = 0.3  # [rad]
LOST_DISTANCE = 0.03  # [m]


@dataclass(frozen=True)
class Continuation:
    """A joint path of k samples.

    If the arm cannot follow the path, ``status`` says why, and the postures are the
    nearest ones found.
    """

    q: Array  # (k, n) [rad; m of slides]
    position_residual: Array  # (k,) [m]
    angle_residual: Array  # (k,) [rad]
    joint_margins: Array  # (k,) [rad] least distance to a joint limit
    conditions: Array  # (k,) condition number of the 6 x n Jacobian, in rad and m
    status: ContinuationStatus
    failed_at: int | None  # first sample that is not ok

    @property
    def ok(self) -> bool:
        """Whether the tip follows the whole path."""
        return self.status == "ok"

    @property
    def lost(self) -> bool:
        """Whether the tip is far off its path at some sample."""
        return bool(_is_lost(self.position_residual, self.angle_residual).any())

    @property
    def joint_margin(self) -> float:
        """Smallest joint margin along the path [rad]."""
        return float(self.joint_margins.min())

    @property
    def condition(self) -> float:
        """Largest condition number along the path."""
        return float(self.conditions.max())


def continuation(
    kin: ArmKinematics,
    positions: Array,
    tool_yaws: Array,
    q_start: Array,
    attitude: ToolAttitude = UPRIGHT,
    joint_margin: float = 0.0,
    largest_step: float = 0.3,
) -> Continuation:
    """Joint path of one arm along positions (k, 3) [m] and tool yaws (k,) [rad], from
    ``q_start`` (n,).

    A sample nearer to a joint limit than ``joint_margin`` [rad] fails as "joint_limit".
    A joint that moves by more than ``largest_step`` [rad] between two samples fails as
    "jump". No failure raises an exception.
    """
    return continuations(
        kin,
        positions,
        np.asarray(tool_yaws)[None],
        np.asarray(q_start)[None],
        attitude,
        joint_margin,
        largest_step,
    )[0]


def continuations(
    kin: ArmKinematics,
    positions: Array,
    tool_yaws: Array,
    q_starts: Array,
    attitude: ToolAttitude | Sequence[ToolAttitude] = UPRIGHT,
    joint_margin: float = 0.0,
    largest_step: float = 0.3,
) -> tuple[Continuation, ...]:
    """Joint paths for b yaw offsets or elbows at once, at the cost of one.

    Tool yaws are (b, k) and starts (b, n); positions are (k, 3) or (b, k, 3); there is
    one attitude, or b. Everything else is as in ``continuation``.
    """
    yaws = np.asarray(tool_yaws, dtype=np.float64)
    b, k = yaws.shape
    p = np.broadcast_to(np.asarray(positions, dtype=np.float64), (b, k, 3))
    R = _rotations(attitude, yaws)
    starts = np.asarray(q_starts, dtype=np.float64)
    path, distance, angle = _followed(kin, p, yaws, R, starts)
    margins = kin.joint_margin(path)
    conditions = np.linalg.cond(kin.jacobian(path))
    off = (distance > POSITION_TOLERANCE) | (angle > ANGLE_TOLERANCE)
    tight = margins < max(joint_margin, 1e-9)
    jumps = np.zeros((b, k), dtype=bool)
    jumps[:, 1:] = np.abs(np.diff(path, axis=1)).max(axis=-1) > largest_step
    out = []
    for j in range(b):
        figures = (path[j], distance[j], angle[j], margins[j], conditions[j])
        out.append(Continuation(*figures, *_verdict(off[j], tight[j], jumps[j])))
    return tuple(out)


def _rotations(attitude: ToolAttitude | Sequence[ToolAttitude], yaws: Array) -> Array:
    """Tool rotations (b, k, 3, 3) at yaws (b, k), for one attitude or b attitudes."""
    if isinstance(attitude, ToolAttitude):
        return attitude.rotation(yaws)
    return np.stack(
        [held.rotation(yaw) for held, yaw in zip(attitude, yaws, strict=True)]
    )


def _followed(
    kin: ArmKinematics, p: Array, yaws: Array, R: Array, q_starts: Array
) -> tuple[Array, Array, Array]:
    """Joint paths (b, k, n) and their errors, (b, k) [m] and (b, k) [rad].

    The targets are positions p (b, k, 3) and yaws (b, k), which are also given as
    rotations R (b, k, 3, 3).
    """
    b, k = yaws.shape
    travel = np.linalg.norm(np.diff(p, axis=1), axis=-1) + YAW_ARM * np.abs(
        np.diff(yaws, axis=1)
    )
    size = kin.facts.size
    q = np.clip(np.broadcast_to(q_starts, (b, size)), kin.facts.lower, kin.facts.upper)
    path = np.empty((b, k, size))
    distance = np.empty((b, k))
    angle = np.empty((b, k))
    lost = np.zeros(b, dtype=bool)
    for i in range(k):
        # The elbow moves once per sample, in proportion to the tip's way, so that
        # sampling does not matter.
        elbow = np.zeros_like(q)
        iterations = START_ITERATIONS
        if i:
            elbow = limit_gradient(kin, q) * (NULL_RATE * travel[:, i - 1, None])
            iterations = ITERATIONS
        distance[:, i], angle[:, i] = _reach_sample(
            kin, q, p[:, i], R[:, i], elbow, iterations, lost
        )
        lost |= _is_lost(distance[:, i], angle[:, i])
        path[:, i] = q
    return path, distance, angle


def _is_lost(distance: Array, angle: Array) -> NDArray[np.bool_]:
    """Whether errors [m] and [rad] of samples are too large for a near miss."""
    return (angle > LOST_ANGLE) | (distance > LOST_DISTANCE)


def _reach_sample(
    kin: ArmKinematics,
    q: Array,
    p: Array,
    R: Array,
    elbow: Array,
    iterations: int,
    lost: NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Move postures ``q`` (b, n), in place, to targets p (b, 3) and R (b, 3, 3).

    Postures that are ``lost`` (b,) stay in place. Returns the errors: (b,) [m] and (b,)
    [rad]. ``elbow`` (b, n) [rad] is the null-space motion added to the first step.
    """
    distance = np.empty(len(q))
    angle = np.empty(len(q))
    active = np.arange(len(q))
    for step in range(iterations):
        e, J = task_error(kin, q[active], p[active], R[active], R[active, :, 2])
        turn = np.linalg.norm(e[:, :3], axis=-1)
        miss = np.linalg.norm(e[:, 3:], axis=-1)
        angle[active] = turn
        distance[active] = miss
        if step:
            elbow = np.zeros_like(q)
            far = (turn >= 0.1 * ANGLE_TOLERANCE) | (miss >= 0.1 * POSITION_TOLERANCE)
        else:
            far = ~lost
        active = active[far]
        e = e[far]
        J = J[far]
        if len(active) == 0:
            break
        dq = damped_step(J, e, elbow[active])
        dq *= START_STEP / np.maximum(
            np.abs(dq).max(axis=-1, keepdims=True), START_STEP
        )
        q[active] = np.clip(q[active] + dq, kin.facts.lower, kin.facts.upper)
    return distance, angle


def _verdict(
    off: NDArray[np.bool_], tight: NDArray[np.bool_], jumps: NDArray[np.bool_]
) -> tuple[ContinuationStatus, int | None]:
    """Status of one path of k samples, and the index of the first failed sample."""
    failed = np.flatnonzero(off | tight | jumps)
    if len(failed) == 0:
        return "ok", None
    first = int(failed[0])
    if tight[first]:
        return "joint_limit", first
    if off[first]:
        return "unreachable", first
    return "jump", first
