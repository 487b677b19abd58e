"""Three turns about given points of the body that lead from one pose to another.

A turn by an angle a about the body's point c moves a body at the origin to (1 - e^{ia})
c. Three such turns lead to p, with a total turn of theta, iff e^{i a1} (c2 - c1) + e^{i
(a1 + a2)} (c3 - c2) = p - c1 + e^{i theta} c3. This is a linkage of two bars, whose two
solutions have closed forms. The words of Dubins and of Reeds and Shepp are special
cases. A straight line is a turn about a distant point.
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
LARGEST = 1.9 * math.pi  # largest single turn
NOTHING = 1e-5  # [rad] below which a turn is left out


@dataclass(frozen=True, slots=True)
class Word:
    """A sequence of turns."""

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
    """The quickest ``count`` words of up to three turns to each of ``goals``, which are
    poses of the body relative to its start.

    ``centers`` (n,) [m] are points of the body, x + iy. ``senses`` (n,) are +1 or -1,
    the direction in which the body can turn about each centre. ``times`` (n,) [s/rad]
    are the times per angle, ``pauses`` (n,) [s] the extra times per turn. ``swing``
    [rad] limits the rotation of the body from its start.
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
    """Times (m,) [s] of the quickest word with which each of m bodies reaches its own
    goal. Infinite for a body without such a word.

    Each body has n turns. ``goals`` (m,) [m] are x + iy, with ``yaws`` (m,) [rad]. The
    other parameters are as in ``words``, but of shape (m, n), with NaN for turns that a
    body does not have.
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
    """The two-bar linkage from the first centre through the second to the third, for
    all triples of each body's centres.
    """

    def __init__(self, centers: NDArray[np.complex128]) -> None:
        """Precompute for ``centers`` (m, n) [m]."""
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
        self._farthest = (a + b) ** 2  # squares of their reach

    def to(
        self, goals: NDArray[np.complex128], yaws: Array
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], tuple[Array, Array]]:
        """All s triples of turns that lead to ``goals`` (m,) [m] and ``yaws`` (m,)
        [rad]. The result has indices of the bodies (s,), indices of the centres (3, s),
        and angles (3, s) [rad] of both solutions.
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
    """Angles (3, s) in the drivable direction, and the times (s,). A time is infinite
    if a turn is too large.
    """
    sizes = _positive(senses * angles)
    time = (times * sizes + pauses * (sizes > NOTHING)).sum(0)
    return senses * sizes, np.where(sizes.max(0) <= LARGEST, time, np.inf)


def _lowest_indices(values: Array, count: int) -> NDArray[np.intp]:
    """Indices of the smallest finite values, at most ``count``."""
    count = min(count, len(values))
    lower = (
        np.argpartition(values, count - 1)[:count]
        if count
        else np.zeros(0, dtype=np.intp)
    )
    return lower[np.isfinite(values[lower])]


def _positive(angles: Array) -> Array:
    """Angles [rad] in [0, 2 pi). A full turn to within round-off counts as zero."""
    out = angles - TURN * np.floor(angles / TURN)
    return np.where(out > TURN - NOTHING, 0.0, out)
