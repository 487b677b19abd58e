"""Three turns about points of the body that lead from one pose to another, for any
choice of the points.

A turn by an angle a about the body's point c moves a body at the origin to (1 - e^{ia})
c; three of them lead to p, turned by theta, iff e^{i a1} (c2 - c1) + e^{i (a1 + a2)}
(c3 - c2) = p - c1 + e^{i theta} c3: a linkage of two bars, whose two solutions are
closed form. Dubins' and Reeds and Shepp's words are special cases; a straight piece is
a turn about a point far away.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2

TURN = 2.0 * math.pi
LARGEST = 1.9 * math.pi  # of one turn
NOTHING = 1e-5  # [rad] up to which a turn is left out


@dataclass(frozen=True, slots=True)
class Word:
    """Turns one after the other."""

    turns: tuple[int, ...]  # indices of the centres
    angles: tuple[float, ...]  # [rad], of the centre's own sense
    time: float  # [s]


def words(
    centers: NDArray[np.complex128],
    senses: Array,
    times: Array,
    pauses: Array,
    goals: Sequence[Pose2],
    count: int,
    swing: float = math.inf,
) -> list[list[Word]]:
    """Return the quickest ``count`` words of up to three turns that lead to each of
    ``goals``, poses of the body seen from its start.

    ``centers`` (n,) [m] in the body, x + iy; ``senses`` (n,) +1 or -1, the way about a
    centre that can be driven; ``times`` (n,) [s/rad]; ``pauses`` (n,) [s] that a turn
    takes besides; ``swing`` [rad]: how far the body may be turned from its start
    meanwhile.
    """
    linkage = _Linkage(centers[None])
    out = []
    for goal in goals:
        _, turns, angles = linkage.to(
            np.array([complex(goal.x, goal.y)]), np.array([goal.yaw])
        )
        found: list[Word] = []
        for solution in angles:
            turned, time = _driven(solution, senses[turns], times[turns], pauses[turns])
            upper = np.abs(np.cumsum(turned, axis=0)).max(0)
            time = np.where(upper <= swing, time, math.inf)
            for best in _lowest_indices(time, count):
                pieces = [
                    (int(c[best]), float(turn[best]))
                    for c, turn in zip(turns, turned, strict=True)
                    if abs(turn[best]) > NOTHING
                ]
                found.append(
                    Word(
                        tuple(c for c, _ in pieces),
                        tuple(turn for _, turn in pieces),
                        float(time[best]),
                    )
                )
        out.append(sorted(found, key=lambda word: word.time)[:count])
    return out


def least_times(
    centers: NDArray[np.complex128],
    senses: Array,
    times: Array,
    pauses: Array,
    goals: NDArray[np.complex128],
    yaws: Array,
) -> Array:
    """Return the time (m,) [s] of the quickest word for each of m bodies, with n turns
    each, to its own goal, at ``goals`` (m,) [m], x + iy, with ``yaws`` (m,) [rad];
    infinite where there is none.

    The rest as in ``words``, of shape (m, n); NaN for turns that a body does not have.
    """
    body, turns, angles = _Linkage(centers).to(goals, yaws)
    figures = senses[body, turns], times[body, turns], pauses[body, turns]
    lower = np.full(len(centers), math.inf)
    some, starts = np.unique(body, return_index=True)  # in order
    for solution in angles if len(some) else ():
        _, time = _driven(solution, *figures)
        lower[some] = np.minimum(lower[some], np.minimum.reduceat(time, starts))
    return lower


class _Linkage:
    """Two bars from the first centre over the second to the third, for all threes of
    each body's centres.
    """

    def __init__(self, centers: NDArray[np.complex128]) -> None:
        """Prepare for ``centers`` (m, n) [m]."""
        i, j, k = (
            v.ravel()
            for v in np.meshgrid(*[np.arange(centers.shape[1])] * 3, indexing="ij")
        )
        distinct = (i != j) & (j != k)
        self._threes = np.stack([i[distinct], j[distinct], k[distinct]])
        self._centers = centers
        bars = centers[:, None, :] - centers[:, :, None]
        self._lengths, self._headings = np.abs(bars), np.angle(bars)
        i, j, k = self._threes
        a = self._lengths[:, i, j]
        b = self._lengths[:, j, k]
        self._nearest = (a - b) ** 2
        self._farthest = (a + b) ** 2  # squares of how far they reach

    def to(
        self, goals: NDArray[np.complex128], yaws: Array
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], tuple[Array, Array]]:
        """Return body (s,), centres (3, s), and the angles (3, s) [rad] of both
        solutions, for all threes that lead to the bodies' ``goals`` (m,) [m] and
        ``yaws`` (m,) [rad].
        """
        i, j, k = self._threes
        first = goals[:, None] - self._centers
        last = np.exp(1j * yaws)[:, None] * self._centers
        target = first[:, i] + last[:, k]
        square = target.real**2 + target.imag**2
        body, three = np.nonzero(
            (square <= self._farthest) & (square >= self._nearest) & (square > 0.0)
        )
        threes = self._threes[:, three]
        i, j, k = threes
        target = target[body, three]
        a = self._lengths[body, i, j]
        b = self._lengths[body, j, k]
        reach = np.abs(target)
        # of the triangle with the two bars for sides: the angles at its elbow and at
        # its start
        cosine = (reach * reach - a * a - b * b) / (2.0 * a * b)
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        cosine = (reach * reach + a * a - b * b) / (2.0 * a * reach)
        opening = np.arccos(np.clip(cosine, -1.0, 1.0))
        bearing = self._headings[body, i, j]
        ahead = np.angle(target) - bearing
        elbow = self._headings[body, j, k] - bearing
        solutions = []
        for sign in (1.0, -1.0):
            a1 = ahead - sign * opening
            a2 = sign * bend - elbow
            solutions.append(np.stack([a1, a2, yaws[body] - a1 - a2]))
        return body, threes, (solutions[0], solutions[1])


def _driven(
    angles: Array, senses: Array, times: Array, pauses: Array
) -> tuple[Array, Array]:
    """Return the angles (3, s), turned the way that can be driven, and the times (s,),
    infinite where a turn is too large.
    """
    sizes = _positive(senses * angles)
    time = (times * sizes + pauses * (sizes > NOTHING)).sum(0)
    return senses * sizes, np.where(sizes.max(0) <= LARGEST, time, np.inf)


def _lowest_indices(values: Array, count: int) -> NDArray[np.intp]:
    """Return the indices of up to ``count`` least values that are finite."""
    count = min(count, len(values))
    lower = (
        np.argpartition(values, count - 1)[:count]
        if count
        else np.zeros(0, dtype=np.intp)
    )
    return lower[np.isfinite(values[lower])]


def _positive(angles: Array) -> Array:
    """Return angles in [0, 2 pi); a turn short of a full one by no more than round-off
    is none.
    """
    out = angles - TURN * np.floor(angles / TURN)
    return np.where(out > TURN - NOTHING, 0.0, out)
