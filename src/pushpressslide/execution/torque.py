"""Joint torque from a tip command, and the torque limits of a real arm.

Paper, eq. 26; docs/mechanics.md, section 11.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dposv, dpotrf, dsygv

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3

LIMIT_STIFFNESS = 600.0  # [N m/rad], [N m s/rad] of a joint near its limit
LIMIT_DAMPING = 10.0
# share of the buffer before a joint's limit over which turning about it fades out
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
    """Joint torques within their limits, and the commanded torques."""

    torque: Array  # (n,) [N m]
    share: float  # largest demanded torque as a share of its limit
    rate_share: float  # largest demanded change of a torque as a share of its limit


class Impedance(NamedTuple):
    """Torque of springs and dampers on an arm's joints, and its change in a tick."""

    torque: Array  # (n,) [N m] of springs and dampers, see ``Gains``
    # (n, n) [kg m^2], symmetric and positive semidefinite: h (D + h K) of all dampers D
    # and springs K, as they act on the joints, over a tick of h
    added: Array


class Unfelt(NamedTuple):
    """Part of the torques and dampers on an arm's joints that causes no force at the
    tip.
    """

    share: Array  # (n, n) of a torque
    damper: Array  # (n, n) of a damper of one: symmetric, and positive semidefinite


class Gains(NamedTuple):
    """Gains of a spring K and a damper D, for ticks of length h."""

    stiffness: float  # K [N m/rad] or [N/m]
    damping: float  # D [N m s/rad] or [N s/m]
    added: float  # h (D + h K) [kg m^2] or [kg]


def gains(stiffness: float, damping: float, period: float) -> Gains:
    """Gains of a spring and a damper, held over a tick of ``period`` [s].

    ``stiffness`` is in [N m/rad] and ``damping`` in [N m s/rad] for a revolute joint;
    for a sliding joint they are in [N/m] and [N s/m].
    """
    return Gains(stiffness, damping, period * (damping + period * stiffness))


def steady_share(late: int) -> float:
    """Share of a speed that a damper may take in a tick, if its torque is believed to act
    a number of ticks ``late``.

    A speed swings for ever if the damper acts d ticks late and takes the share 2 sin(pi /
    (2 (2 d + 1))). (Of v_(k+1) = v_k - x v_(k-d), a root reaches the unit circle.) This
    is half of that share for one tick more than is believed, and is stable for two more.
    """
    return math.sin(math.pi / (2 * (2 * (late + 1) + 1)))


def held_for_a_tick(impedance: Impedance, M: Array, largest_share: float) -> Array:
    """Torque (n,) [N m] of springs and dampers, held constant for a tick, on an arm of
    mass matrix ``M`` (n, n).

    The dampers define decoupled motions of the arm, each with a damper D and an inertia
    m. During a tick of length h, a constant torque would change the speed of such a
    motion by the fraction x = h D / m. For a light joint x may be above 1: the motion
    would reverse and gain energy. If x is above the ``largest_share``
    (``steady_share``), the torque is multiplied by that share over x. If it is below,
    as on a heavy arm that an object holds back, the torque is unchanged. (The implicit
    Euler method, 1 / (1 + x), lets that arm lag by a quarter more.) Springs add h^2 K /
    m to x.
    """
    torque, added = impedance
    added = added / largest_share
    _, exceeded = dpotrf(M - added)  # definite where every x is below the share
    if not exceeded:
        return torque
    # x / share, and the motions V: V^T M V = 1, V^T (h D + h^2 K) V = diag(x)
    taken, motions, failed = dsygv(added, M)
    if failed:  # of no arm's inertia
        return M @ np.linalg.solve(M + added, torque)
    along = (torque @ motions) / np.maximum(taken, 1.0)
    out: Array = M @ (motions @ along)
    return out


def unfelt(J: Array, JJt: Array) -> Unfelt:
    """Part of a joint torque that needs neither a force at the tip nor a large moment
    on the tool to balance it.

    ``J`` (6, n) is the Jacobian at the tip, with rows [angular; linear], in world axes;
    ``JJt`` (6, 6) is J J^T. Joints that can hardly turn the tool are included, since
    nothing else damps them. The wrench that balances a torque is (J J^T)^-1 J torque,
    and its force must be zero. The condition J_v torque = 0 would not ensure this: if
    the tip is held in place and a moment keeps the tool's attitude, the tip still
    exerts the force of this wrench.
    """
    identity = np.eye(J.shape[1])
    turning = identity - J.T @ _solved(JJt + SOFTENING, J)
    held = _solved(JJt + FULL_RANK, J)[3:]
    forceless = identity - held.T @ _solved(held @ held.T, held)
    share = forceless @ turning
    return Unfelt(share, share @ forceless)


def near_limit(q: Array, lower: Sequence[float], upper: Sequence[float]) -> bool:
    """Whether one of the joints ``q`` (n,) [rad] is within ``margins.ARM.joint_buffer``
    of its limit, ``lower`` or ``upper`` (n,) [rad].
    """
    buffer = margins.ARM.joint_buffer
    ranges = zip(q.tolist(), lower, upper, strict=True)
    return any(
        at - lowest < buffer or highest - at < buffer for at, lowest, highest in ranges
    )


def kept_inside(
    J: Array, q: Array, v: Array, lower: Array, upper: Array, period: float
) -> Impedance:
    """Impedance that keeps joints inside their limits without a force at the tip. The
    tool's attitude yields.

    ``J`` (6, n) is as in ``unfelt``; ``lower`` and ``upper`` (n,) [rad] are the limits;
    ``period`` [s] is that of a tick. The impedance is zero if all joints are farther
    than ``margins.ARM.joint_buffer`` from their limits.
    """
    buffer = margins.ARM.joint_buffer
    inside = np.minimum(q - lower, upper - q)
    below = np.maximum(lower + buffer - q, 0.0)
    above = np.maximum(q - upper + buffer, 0.0)
    held = gains(LIMIT_STIFFNESS, LIMIT_DAMPING, period)
    moved = J[3:]
    softened = moved @ moved.T + SOFTENING[3:, 3:]
    forceless = np.eye(len(q)) - moved.T @ _solved(softened, moved)
    near = forceless * (inside < buffer)  # of the joints that are
    dampers = near @ forceless
    spring: Array = forceless @ (below - above)
    torque = held.stiffness * spring - held.damping * (dampers @ v)
    return Impedance(torque, held.added * dampers)


def braked(J: Array, JJt: Array) -> Array | None:
    """Projector (n, n) on the joint motion that moves the tip least, times a factor.
    None if this motion moves the tip by ``SINGULAR`` or more.

    The factor grows from 0 to 1 as the tip's motion vanishes. ``J`` (6, n) and ``JJt``
    (6, 6) are as in ``unfelt``. Without braking, a stretched arm coasts through this
    posture and bends to the other side while its tip rests.
    """
    # definite without SINGULAR^2 along its diagonal: no eigenvalue is below that
    _, indefinite = dpotrf(JJt - BRAKED)
    if not indefinite:
        return None
    _, sizes, motions = np.linalg.svd(J, full_matrices=False)
    motion = motions[-1]
    share = (1.0 - min(float(sizes[-1]) / SINGULAR, 1.0) ** 2) ** 2
    out: Array = share * np.outer(motion, motion)
    return out


def yielding(J: Array, moment: Vector3, q: Array, lower: Array, upper: Array) -> Array:
    """Jacobian ``J`` (6, n) without the tool's rotation about the axes of joints that
    its ``moment`` (3,) [N m] presses into their limits.

    The reduction grows towards the limit. Axes are those of the world; ``lower`` and
    ``upper`` (n,) [rad] are the limits. A joint at its limit provides no moment about
    its axis. If the moment were commanded nevertheless, the other joints would provide
    it, with a force at the tip.
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


def _solved(matrix: Array, right: Array) -> Array:
    """Solution of a symmetric system, (k,) or (k, n).

    It is quick for positive definite systems, which all are apart from round-off.
    """
    _, solution, indefinite = dposv(matrix, right)
    if indefinite:
        solution = np.linalg.solve(matrix, right)
    out: Array = solution
    return out


def task_inertia(J: Array, M: Array) -> Array:
    """Task-space inertia Lambda = (J M^-1 J^T)^-1 (6, 6) of the arm at its tip.

    ``J`` (6, n) is as in ``unfelt``; ``M`` (n, n) is the mass matrix. Near a
    singularity Lambda would grow without bound. Damped least squares
    (``LEAST_MOBILITY``) then prevent the arm from being driven along directions in
    which it can hardly move.
    """
    mobility = J @ _solved(M, J.T)
    return _solved(mobility @ mobility + LEAST, mobility)


def joint_torque(
    M: Array, bias: Array, q: Array, v: Array, q_ref: Array, v_ref: Array, rate: float
) -> Array:
    """Computed torque (n,) that tracks a joint reference in free space.

    Errors decay critically damped at ``rate`` [1/s].
    """
    return M @ (rate * rate * (q_ref - q) + 2.0 * rate * (v_ref - v)) + bias


def limited(
    tau: Array, previous: Array, effort: Sequence[float], most_change: Sequence[float]
) -> LimitedTorque:
    """``tau`` clipped to ``effort`` (n,) [N m], and its change per tick to
    ``most_change`` (n,) [N m].

    ``previous`` is the torque (n,) of the previous tick. It uses plain floats, which
    for a few joints takes half the time of arrays.
    """
    torques = []
    share = 0.0
    rate_share = 0.0
    for asked, before, upper, step in zip(
        tau.tolist(), previous.tolist(), effort, most_change, strict=True
    ):
        inside = asked
        if asked > upper:
            inside = upper
        elif asked < -upper:
            inside = -upper
        change = inside - before
        applied = inside
        if change > step:
            applied = before + step
        elif change < -step:
            applied = before - step
        torques.append(applied)
        one = abs(asked) / upper
        if one > share:
            share = one
        one = abs(change) / step
        if one > rate_share:
            rate_share = one
    return LimitedTorque(np.array(torques), share, rate_share)
