"""Joint paths along a path of the tip: each posture is found from the one before it, so
it never flips.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

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
YAW_ARM = 0.3  # [m] the way that a radian of tool yaw counts for
ITERATIONS = 10  # Newton steps for one sample of the path
START_ITERATIONS = 40  # for the first one, which may start farther off
START_STEP = 0.3  # [rad] of any joint in one Newton step


@dataclass(frozen=True)
class Continuation:
    """A joint path of k samples; where it fails it says so and holds the nearest
    postures found.
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
    def joint_margin(self) -> float:
        """Least margin along the path [rad]."""
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
    """Return one arm's joint path along positions (k, 3) [m] and tool yaws (k,) [rad],
    from q_start (n,).

    joint_margin: [rad] a sample nearer to a limit fails as "joint_limit"; largest_step:
    [rad] a joint that moves more between two samples fails as "jump". Never raises.
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
    """Return b joint paths at once, for tool yaws (b, k) and starts (b, n); positions
    (k, 3) or (b, k, 3); one attitude or b.

    For trying several tool yaw offsets or elbows, at hardly more cost than one. Else as
    ``continuation``.
    """
    yaws = np.asarray(tool_yaws, dtype=np.float64)
    b, k = yaws.shape
    p = np.broadcast_to(np.asarray(positions, dtype=np.float64), (b, k, 3))
    if isinstance(attitude, ToolAttitude):
        R = attitude.rotation(yaws)
    else:
        R = np.stack(
            [held.rotation(yaw) for held, yaw in zip(attitude, yaws, strict=True)]
        )
    way = np.linalg.norm(np.diff(p, axis=1), axis=-1) + YAW_ARM * np.abs(
        np.diff(yaws, axis=1)
    )
    lower = kin.facts.lower
    upper = kin.facts.upper
    q = np.clip(
        np.broadcast_to(np.asarray(q_starts, dtype=np.float64), (b, kin.facts.size)),
        lower,
        upper,
    )
    path = np.empty((b, k, kin.facts.size))
    distance = np.empty((b, k))
    angle = np.empty((b, k))
    for i in range(k):
        # The elbow moves once per sample, in proportion to the tip's way, so that
        # sampling does not matter.
        free = (
            limit_gradient(kin, q) * (NULL_RATE * way[:, i - 1, None])
            if i
            else np.zeros_like(q)
        )
        open_ = np.arange(b)
        for step in range(ITERATIONS if i else START_ITERATIONS):
            e, J = task_error(
                kin, q[open_], p[open_, i], R[open_, i], R[open_, i, :, 2]
            )
            off_by = (
                np.linalg.norm(e[:, :3], axis=-1),
                np.linalg.norm(e[:, 3:], axis=-1),
            )
            angle[open_, i], distance[open_, i] = off_by
            if step:
                far = (off_by[0] >= 0.1 * ANGLE_TOLERANCE) | (
                    off_by[1] >= 0.1 * POSITION_TOLERANCE
                )
                open_ = open_[far]
                e = e[far]
                J = J[far]
                if len(open_) == 0:
                    break
            dq = damped_step(
                J, e, free if step == 0 else np.zeros((len(open_), q.shape[1]))
            )
            dq *= START_STEP / np.maximum(
                np.abs(dq).max(axis=-1, keepdims=True), START_STEP
            )
            q[open_] = np.clip(q[open_] + dq, lower, upper)
        path[:, i] = q
    margins = kin.joint_margin(path)
    conditions = np.linalg.cond(kin.jacobian(path))
    off = (distance > POSITION_TOLERANCE) | (angle > ANGLE_TOLERANCE)
    tight = margins < max(joint_margin, 1e-9)
    jumps = np.zeros((b, k), dtype=bool)
    jumps[:, 1:] = np.abs(np.diff(path, axis=1)).max(axis=-1) > largest_step
    out = []
    for j in range(b):
        failed = np.flatnonzero(off[j] | tight[j] | jumps[j])
        at = int(failed[0]) if len(failed) else None
        status: ContinuationStatus = "ok"
        if at is not None:
            status = (
                "joint_limit"
                if tight[j, at]
                else "unreachable"
                if off[j, at]
                else "jump"
            )
        out.append(
            Continuation(
                path[j], distance[j], angle[j], margins[j], conditions[j], status, at
            )
        )
    return tuple(out)
