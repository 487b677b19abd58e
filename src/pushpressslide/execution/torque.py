"""Joint torque from a tip command, and the torque limits of a real arm.

Paper, eq. 26; docs/mechanics.md, section 11.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dposv, dpotrf

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array, least
from pushpressslide.core.control import Vector3

LIMIT_STIFFNESS = 600.0  # [N m/rad], [N m s/rad] of a joint near its limit
LIMIT_DAMPING = 10.0
# of the buffer before a joint's limit, in which the tool ceases to be turned about it
YIELDING = 0.2
# squares, (6, 6) with nothing beside the diagonal, of the singular values below which
# the tool's rotation, and the tip's motion, are left to the posture
SOFTENING = np.diag((2e-2, 2e-2, 2e-2, 1e-6, 1e-6, 1e-6))
# [1/kg], [1/(kg m^2)]: an arm that weighs more at its tip is hardly driven there
LEAST_MOBILITY = 0.003
LEAST = LEAST_MOBILITY**2 * np.eye(6)
# singular value of the Jacobian, below which the joints are braked that then hardly move
# the tip: neither its servo nor the posture holds them
SINGULAR = 0.06
BRAKED = SINGULAR**2 * np.eye(6)
# added to those squares, so that a singular posture has an inverse
FULL_RANK = 1e-6 * np.eye(6)


class LimitedTorque(NamedTuple):
    """Joint torques inside their limits, and what was asked for."""

    torque: Array  # (n,) [N m]
    share: float  # largest demanded torque as a share of its limit
    rate_share: float  # largest demanded change of a torque as a share of its limit


def task_torque(J: Array, wrench: Array, posture: Array, bias: Array) -> Array:
    """Return tau (n,) = J^T ``wrench`` + null-space ``posture`` torque + ``bias``.

    ``J`` (6, n) at the tip, rows [angular; linear], world axes; ``wrench`` (6,) likewise
    [moment; force]. ``posture`` (n,) [N m] is that of a joint-space spring and damper,
    projected so that no force at the tip is needed to hold it, and next to no moment
    but where the arm can hardly turn the tool: there the posture says how it is held,
    since nothing else damps those joints. ``bias`` (n,) [N m] gravity and Coriolis
    compensation.
    """
    tau: Array = J.T @ wrench + bias
    if J.shape[1] > 6:
        JJt = J @ J.T
        unfelt = _unfelt(J, posture, JJt + SOFTENING)
        tau += _forceless(J, unfelt, JJt + FULL_RANK)
    return tau


def near_limit(q: Array, lower: Array, upper: Array) -> bool:
    """Return whether one of the joints ``q`` (n,) is nearer to its limit, ``lower`` or
    ``upper`` (n,) [rad], than ``margins.ARM.joint_buffer``.
    """
    inside = np.minimum(q - lower, upper - q)
    return least(inside) < margins.ARM.joint_buffer


def kept_inside(J: Array, q: Array, v: Array, lower: Array, upper: Array) -> Array:
    """Return the torque (n,) that keeps joints inside their limits, without a force at
    the tip: the tool's attitude gives way.

    ``J`` (6, n) as in ``task_torque``; ``lower``, ``upper`` (n,) [rad]. Zero where all
    joints are farther inside than ``margins.ARM.joint_buffer``.
    """
    buffer = margins.ARM.joint_buffer
    inside = np.minimum(q - lower, upper - q)
    below = np.maximum(lower + buffer - q, 0.0)
    above = np.maximum(q - upper + buffer, 0.0)
    near = inside < buffer
    spring: Array = LIMIT_STIFFNESS * (below - above) - LIMIT_DAMPING * v * near
    moved = J[3:]
    return _unfelt(moved, spring, moved @ moved.T + SOFTENING[3:, 3:])


def braked(J: Array, damping: Array) -> Array:
    """Return what of a ``damping`` torque (n,) acts on the joints' motion that moves
    the tip least; nothing where that moves it by ``SINGULAR`` or more.

    ``J`` (6, n) as in ``task_torque``. An arm that is stretched out coasts through that
    posture, and bends to the other side, while its tip rests.
    """
    # definite without SINGULAR^2 along its diagonal: no eigenvalue is below that
    _, indefinite = dpotrf(J @ J.T - BRAKED)
    if not indefinite:
        return np.zeros(len(damping))
    _, sizes, motions = np.linalg.svd(J, full_matrices=False)
    motion = motions[-1]
    share = (1.0 - min(float(sizes[-1]) / SINGULAR, 1.0) ** 2) ** 2
    out: Array = share * float(motion @ damping) * motion
    return out


def yielding(J: Array, moment: Vector3, q: Array, lower: Array, upper: Array) -> Array:
    """Return ``J`` (6, n) for a tool that is no longer turned about the axes of joints
    which its ``moment`` (3,) [N m] presses into their limits: the less, the nearer.

    World axes; ``lower``, ``upper`` (n,) [rad]. Such a joint gives no moment about its
    axis. Asked for all the same, it comes from the other joints, with a force at the
    tip.
    """
    buffer = margins.ARM.joint_buffer
    inside = np.minimum(q - lower, upper - q)
    out = J.copy()
    for j in np.flatnonzero(inside < buffer):
        axis = J[:3, j]
        outwards = 2.0 * q[j] - lower[j] - upper[j]
        if outwards * float(axis @ moment) > 0.0:
            share = min(1.0, (1.0 - inside[j] / buffer) / YIELDING)
            out[:3] -= share * np.outer(axis, axis @ out[:3])
    return out


def _unfelt(J: Array, torque: Array, softened: Array) -> Array:
    """Return what of a ``torque`` (n,) is not felt along the rows of ``J`` (k, n): I -
    J^T S^-1 J, applied to it; S (k, k) is J J^T, ``softened`` along its diagonal.
    """
    out: Array = torque - J.T @ _solved(softened, J @ torque)
    return out


def _solved(matrix: Array, right: Array) -> Array:
    """Return the solution of a symmetric system, (k,) or (k, n); quickly of one that is
    positive definite, as all are but for rounding errors.
    """
    _, solution, indefinite = dposv(matrix, right)
    if indefinite:
        solution = np.linalg.solve(matrix, right)
    out: Array = solution
    return out


def _forceless(J: Array, torque: Array, JJt: Array) -> Array:
    """Return what of a ``torque`` (n,) a moment on the tool holds alone, without a force
    at the tip; ``J`` (6, n), and J J^T (6, 6), which has an inverse.

    The wrench that holds the torque is (J J^T)^-1 J torque. That J_v torque = 0 is not
    enough: a tip that is held where it is while a moment keeps the tool's attitude
    feels the force of this wrench.
    """
    held = _solved(JJt, J)[3:]
    out: Array = torque - held.T @ _solved(held @ held.T, held @ torque)
    return out


def task_inertia(J: Array, M: Array) -> Array:
    """Return Lambda = (J M^-1 J^T)^-1 (6, 6), the inertia that the arm has at its tip.

    ``J`` (6, n) as in ``task_torque``; ``M`` (n, n) mass matrix. Near a singularity,
    where it grows without bound, the arm is not to be driven along what it can hardly
    move: damped least squares, by ``LEAST_MOBILITY``.
    """
    mobility = J @ _solved(M, J.T)
    return _solved(mobility @ mobility + LEAST, mobility)


def joint_torque(
    M: Array, bias: Array, q: Array, v: Array, q_ref: Array, v_ref: Array, rate: float
) -> Array:
    """Return the computed torque (n,) that tracks a joint reference in free space,
    critically damped at ``rate`` [1/s].
    """
    return M @ (rate * rate * (q_ref - q) + 2.0 * rate * (v_ref - v)) + bias


def limited(
    tau: Array, previous: Array, effort: Sequence[float], most_change: Sequence[float]
) -> LimitedTorque:
    """Return ``tau`` held inside ``effort`` (n,) [N m], and inside ``most_change`` (n,)
    [N m] from one tick to the next; ``previous`` is the torque (n,) of the tick before.

    In plain floats: of few joints, in half the time of arrays.
    """
    torques = []
    share = 0.0
    rate_share = 0.0
    for asked, before, most, step in zip(
        tau.tolist(), previous.tolist(), effort, most_change, strict=True
    ):
        change = clamped(asked, most) - before
        torques.append(before + clamped(change, step))
        share = max(share, abs(asked) / most)
        rate_share = max(rate_share, abs(change) / step)
    return LimitedTorque(np.array(torques), share, rate_share)


def clamped(value: float, most: float) -> float:
    """Return ``value``, no farther from zero than ``most``."""
    if value > most:
        return most
    return max(value, -most)
