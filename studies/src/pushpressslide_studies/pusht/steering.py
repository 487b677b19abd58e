"""Steering law: it corrects contact positions and lengths of the remaining pushes, so
that they lead from the observed pose of the T to the goal.

It repeats a damped least-squares step (Levenberg, Marquardt) on the exact kinematics of
the pushes a few times. The last push consists of two halves with separate contact
positions, so that it can reach a pose like a car.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide_studies.pusht.pushes import Push, final_pose
from pushpressslide_studies.pusht.tee import GOAL_BODY, RHO

STEPS = 6
CLOSE = 0.02  # [px] of an error that is not worth a step
SOFT = 0.005  # damping, against squared [px] per scaled change
CHANGES = (10.0, 5.0)  # [px] scale of a change of place and of length
DIFFERENCE = 1e-4  # [px] of the numerical derivative


def error(X_WB: Pose2) -> Array:
    """Error (3,) [px] of a pose from the goal, with the angle scaled by rho."""
    return _difference(GOAL_BODY, X_WB)


def miss(X_WB: Pose2) -> float:
    """Norm [px] of ``error``."""
    return miss_between(GOAL_BODY, X_WB)


def miss_between(a: Pose2, b: Pose2) -> float:
    """Distance [px] between two poses, including the angle scaled by rho."""
    return float(np.linalg.norm(_difference(a, b)))


def _difference(a: Pose2, b: Pose2) -> Array:
    return np.array([b.x - a.x, b.y - a.y, RHO * wrap_angle(b.yaw - a.yaw)])


def halved(pushes: Sequence[Push]) -> tuple[Push, ...]:
    """Pushes with the last one divided into halves, so that it can be steered."""
    *first, last = pushes
    half = replace(last, length=0.5 * last.length)
    return (*first, half, half)


def steered(X_WB: Pose2, pushes: Sequence[Push]) -> tuple[Push, ...]:
    """Pushes corrected for their start pose.

    If the last two are on one face, they stay equally long.
    """
    now = tuple(pushes)
    ties = _ties(now)
    off = error(final_pose(X_WB, now))
    for _ in range(STEPS):
        if np.linalg.norm(off) < CLOSE:
            break
        scaled = np.tile(CHANGES, len(now))[:, None] * ties
        slopes = _slopes(X_WB, now, off) @ scaled
        inverse = slopes @ slopes.T + SOFT * np.eye(3)
        change = -scaled @ (slopes.T @ np.linalg.solve(inverse, off))
        trial = _changed(now, change)
        after = error(final_pose(X_WB, trial))
        if np.linalg.norm(after) >= np.linalg.norm(off):
            break
        now = trial
        off = after
    return now


def _ties(pushes: tuple[Push, ...]) -> Array:
    """Allowed changes (2 n, k) of contact positions and lengths."""
    free = np.eye(2 * len(pushes))
    if len(pushes) < 2 or pushes[-1].face != pushes[-2].face:
        return free
    both = free[:, -1] + free[:, -3]
    return np.column_stack([free[:, :-3], free[:, -2], both])


def _slopes(X_WB: Pose2, pushes: tuple[Push, ...], off: Array) -> Array:
    """Derivatives (3, 2 n) of the error with respect to contact position and length of
    each push.
    """
    columns = []
    for index in range(2 * len(pushes)):
        change = np.zeros(2 * len(pushes))
        change[index] = DIFFERENCE
        moved = final_pose(X_WB, _added(pushes, change))
        columns.append((error(moved) - off) / DIFFERENCE)
    return np.stack(columns, axis=-1)


def _added(pushes: tuple[Push, ...], change: Array) -> tuple[Push, ...]:
    """Pushes with changes (2 n,) of contact position and length."""
    return tuple(
        replace(push, left=push.left + left, length=push.length + length)
        for push, (left, length) in zip(
            pushes, change.reshape(-1, 2).tolist(), strict=True
        )
    )


def _changed(pushes: tuple[Push, ...], change: Array) -> tuple[Push, ...]:
    """Pushes with ``change`` (2 n,) applied.

    Contacts stay on their faces, and lengths stay positive or zero.
    """
    return tuple(
        replace(
            push,
            left=push.pushed.clipped(push.left),
            length=max(push.length, 0.0),
        )
        for push in _added(pushes, change)
    )
