"""Smallest distance of two arms, by closed-form distances of their capsules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.robots.kinematics import ArmKinematics


@dataclass(frozen=True)
class ArmCapsules:
    """The m capsules that enclose one arm, from base to tip."""

    kinematics: ArmKinematics
    links: Sequence[str]  # the link of each
    ends: Array  # (m, 2, 3) [m] of its axis, in the link's frame
    radii: Array  # (m,) [m]

    def segments(self, postures: Array) -> Array:
        """Ends (k, m, 2, 3) [m] of the capsule axes in postures (k, n)."""
        poses = self.kinematics.link_poses(postures)
        R, p = (
            np.stack([poses[link][i] for link in self.links], axis=1) for i in (0, 1)
        )
        out: Array = self.ends @ np.swapaxes(R, -1, -2) + p[:, :, None]
        return out


def least_distance(
    one: ArmCapsules, other: ArmCapsules, postures: Array, others: Array, look: float
) -> float:
    """Smallest distance [m] of two arms over postures (k, n), or (1, n) of an arm that
    stands still.

    It is at most ``look``, and negative if the arms intersect.
    """
    a = one.segments(postures)
    b = other.segments(others)
    return float(_distances(a, b, one.radii, other.radii, look).min())


def pair_distances(
    one: ArmCapsules, other: ArmCapsules, postures: Array, others: Array, look: float
) -> Array:
    """Distances (k, j) [m], at most ``look``, between each of one arm's postures (k, n)
    and each of the other's (j, n).
    """
    a = np.repeat(one.segments(postures), len(others), axis=0)
    b = np.tile(other.segments(others), (len(postures), 1, 1, 1))
    out = _distances(a, b, one.radii, other.radii, look)
    return out.reshape(len(postures), len(others))


def _distances(
    one: Array, other: Array, radii: Array, other_radii: Array, look: float
) -> Array:
    """Smallest distances (k,) [m], at most ``look``, between two arms' capsules with
    axes (k, m, 2, 3).

    Either arm may have a single posture, which is used for all k.
    """
    a, b = np.broadcast_arrays(one[:, :, None], other[:, None])
    reach = radii[:, None] + other_radii
    separation = (
        np.linalg.norm((a - b).mean(axis=-2), axis=-1) - reach
    )  # of the middles
    separation -= 0.5 * sum(
        np.linalg.norm(c[..., 1, :] - c[..., 0, :], axis=-1) for c in (a, b)
    )
    near = separation < look
    distances = np.full(near.shape, look)
    exact = (
        _segment_distance(a[near], b[near]) - np.broadcast_to(reach, near.shape)[near]
    )
    distances[near] = np.minimum(exact, look)
    out: Array = distances.min(axis=(-2, -1))
    return out


def _segment_distance(a: Array, b: Array) -> Array:
    """Distances (...) [m] between segments (..., 2, 3), not both of zero length
    (Ericson, Real-Time Collision Detection, 5.1.9).
    """
    u = a[..., 1, :] - a[..., 0, :]
    v = b[..., 1, :] - b[..., 0, :]
    w = a[..., 0, :] - b[..., 0, :]
    uu = (u * u).sum(-1)
    vv = (v * v).sum(-1)
    uv = (u * v).sum(-1)
    uw = (u * w).sum(-1)
    vw = (v * w).sum(-1)
    tiny = 1e-12
    s = np.clip((uv * vw - uw * vv) / np.maximum(uu * vv - uv * uv, tiny), 0.0, 1.0)
    t = np.clip((uv * s + vw) / np.maximum(vv, tiny), 0.0, 1.0)
    s = np.clip((uv * t - uw) / np.maximum(uu, tiny), 0.0, 1.0)
    gap = w + s[..., None] * u - t[..., None] * v
    out: Array = np.sqrt((gap * gap).sum(-1))
    return out
