"""Three pushes that join two poses, in closed form.

Source: studies/docs/gym-pusht.md. A push with a fixed contact turns the T about a point
fixed in the body, away from the centre of mass. The start pose determines where the
first centre of rotation is in the world, and the goal determines the last one. The
middle centre keeps its distances in the body from both, so it is at an intersection of
two circles. For pushes on one face, the solutions are the Dubins words of three arcs.
All triples of contacts are solved at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2, turned_left
from pushpressslide_studies.pusht.pushes import Push, curvature
from pushpressslide_studies.pusht.tee import FACES

SPACING = 10.0  # [px] between the contacts that are tried
INSET = 5.0  # [px] from the ends of a face, left for steering
STRAIGHT = 0.25  # [px] off the centre's line, in place of a straight push
SAME = 1e-6  # [px] between centres of rotation that count as one
FULL_TURN = 2.0 * math.pi


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """The m contacts that are tried."""

    faces: Array  # (m,) indices into FACES
    lefts: Array  # (m,) [px]
    curvatures: Array  # (m,) [rad/px]
    centers: Array  # (m, 2) [px] centres of rotation in B
    distances: Array  # (m, m) [px] between the centres
    bearings: Array  # (m, m) [rad] in B from a centre to another

    def push(self, index: int, length: float) -> Push:
        """Push at the contact with index ``index``."""
        return Push(int(self.faces[index]), float(self.lefts[index]), length)


@dataclass(frozen=True, slots=True, eq=False)
class Joins:
    """The t triples of pushes that join two poses."""

    triples: Array  # (t, 3) indices into the contacts
    lengths: Array  # (t, 3) [px]


@cache
def contacts() -> Contacts:
    """Contacts at equal spacing on every face."""
    indices = []
    lefts = []
    curvatures = []
    centers = []
    for index, face in enumerate(FACES):
        low = face.right + INSET
        high = face.left - INSET
        count = max(2, 1 + round((high - low) / SPACING))
        across = turned_left(face.normal)
        for left in np.linspace(low, high, count).tolist():
            moved = left if abs(left) > STRAIGHT else STRAIGHT
            bend = curvature(face, moved)
            indices.append(index)
            lefts.append(moved)
            curvatures.append(bend)
            centers.append((across[0] / bend, across[1] / bend))
    at = np.array(centers)
    between = at[None, :, :] - at[:, None, :]
    return Contacts(
        np.array(indices),
        np.array(lefts),
        np.array(curvatures),
        at,
        np.hypot(between[..., 0], between[..., 1]),
        np.arctan2(between[..., 1], between[..., 0]),
    )


def joins(start: Pose2, goal: Pose2) -> Joins:
    """All triples of contacts and lengths that lead from ``start`` to ``goal``, both
    X_WB.

    Each push turns the T by less than a full turn.
    """
    tried = contacts()
    triples = _triples(tried)
    first = _placed(start, tried.centers)[triples[:, 0]]
    end = _placed(goal, tried.centers)[triples[:, 2]]
    near = tried.distances[triples[:, 0], triples[:, 1]]
    far = tried.distances[triples[:, 1], triples[:, 2]]
    line = end - first
    distance = np.hypot(line[:, 0], line[:, 1])
    meet = (distance <= near + far) & (distance >= np.abs(near - far)) & (distance > 0)
    triples = triples[meet]
    bearing = np.arctan2(line[meet, 1], line[meet, 0])
    distance = distance[meet]
    near = near[meet]
    far = far[meet]
    opening = _angle(near, distance, far)
    closing = _angle(far, distance, near)
    both = [
        _lengths(
            tried,
            triples,
            (start, goal),
            bearing + side * opening,
            bearing - side * closing,
        )
        for side in (1.0, -1.0)
    ]
    return Joins(np.concatenate([triples, triples]), np.concatenate(both))


def _triples(tried: Contacts) -> Array:
    """All triples (t, 3) of contacts in which consecutive contacts turn the T about
    different points.
    """
    count = len(tried.lefts)
    first, middle, last = np.indices((count, count, count)).reshape(3, -1)
    apart = (tried.distances[first, middle] > SAME) & (
        tried.distances[middle, last] > SAME
    )
    return np.stack([first[apart], middle[apart], last[apart]], axis=-1)


def _placed(X_WB: Pose2, points: Array) -> Array:
    """Points (m, 2) in W, from their positions in B."""
    c = math.cos(X_WB.yaw)
    s = math.sin(X_WB.yaw)
    placed: Array = points @ np.array([[c, s], [-s, c]])
    placed += np.array(X_WB.position)
    return placed


def _angle(adjacent: Array, other: Array, opposite: Array) -> Array:
    """Angle [rad] between the sides ``adjacent`` and ``other`` of a triangle."""
    cosine = (adjacent**2 + other**2 - opposite**2) / (2.0 * adjacent * other)
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def _lengths(
    tried: Contacts,
    triples: Array,
    ends: tuple[Pose2, Pose2],
    bearing_near: Array,
    bearing_far: Array,
) -> Array:
    """Lengths (t, 3) [px] of the pushes that join two poses.

    ``bearing_near`` [rad] is the bearing from the first centre of rotation to the
    middle one, ``bearing_far`` [rad] that from the middle one to the last.
    """
    start, goal = ends
    after_first = bearing_near - tried.bearings[triples[:, 0], triples[:, 1]]
    after_middle = bearing_far - tried.bearings[triples[:, 1], triples[:, 2]]
    turns = np.stack(
        [
            after_first - start.yaw,
            after_middle - after_first,
            goal.yaw - after_middle,
        ],
        axis=-1,
    )
    curvatures = tried.curvatures[triples]
    forward = np.mod(np.sign(curvatures) * turns, FULL_TURN)
    lengths: Array = forward / np.abs(curvatures)
    return lengths
