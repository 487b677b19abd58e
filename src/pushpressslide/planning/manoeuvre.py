"""Three turns about points of the body that lead from one pose to another, for any choice of the points.

A turn by an angle a about the body's point c moves a body at the origin to (1 - e^{ia}) c; three of them lead
to p, turned by theta, iff e^{i a1} (c2 - c1) + e^{i (a1 + a2)} (c3 - c2) = p - c1 + e^{i theta} c3: a linkage
of two bars, whose two solutions are closed form. Dubins' and Reeds and Shepp's words are special cases; a
straight piece is a turn about a point far away.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
    senses: NDArray[np.float64],
    times: NDArray[np.float64],
    pauses: NDArray[np.float64],
    goals: Sequence[Pose2],
    count: int,
) -> list[list[Word]]:
    """Return the quickest ``count`` words of up to three turns that lead to each of ``goals``, poses of the
    body seen from its start.

    ``centers`` (n,) [m] in the body, x + iy; ``senses`` (n,) +1 or -1, the way about a centre that can be
    driven; ``times`` (n,) [s/rad]; ``pauses`` (n,) [s] that a turn takes besides.
    """
    n = len(centers)
    i, j, k = (v.ravel() for v in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    kept = (i != j) & (j != k)
    i, j, k = i[kept], j[kept], k[kept]
    bars = centers[None, :] - centers[:, None]
    lengths, headings = np.abs(bars), np.angle(bars)
    a, b, bearing, elbow = lengths[i, j], lengths[j, k], headings[i, j], headings[j, k] - headings[i, j]
    out = []
    for goal in goals:
        target = complex(goal.x, goal.y) - centers[i] + (np.exp(1j * goal.yaw) * centers)[k]
        reach = np.abs(target)
        solvable = np.flatnonzero((reach <= a + b) & (reach >= np.abs(a - b)) & (reach > 0.0))
        at = tuple(v[solvable] for v in (i, j, k))
        reach, a_, b_ = reach[solvable], a[solvable], b[solvable]
        # of the triangle with the two bars for sides: the angles at its elbow and at its start
        bend = np.arccos(_cosine((reach * reach - a_ * a_ - b_ * b_) / (2.0 * a_ * b_)))
        opening = np.arccos(_cosine((reach * reach + a_ * a_ - b_ * b_) / (2.0 * a_ * reach)))
        ahead = np.angle(target[solvable]) - bearing[solvable]
        found: list[Word] = []
        for sign in (1.0, -1.0):
            a1, a2 = ahead - sign * opening, sign * bend - elbow[solvable]
            angles = np.array([a1, a2, goal.yaw - a1 - a2])
            sides = senses[np.array(at)]
            turned = sides * _positive(sides * angles)
            sizes = np.abs(turned)
            time = (times[np.array(at)] * sizes + pauses[np.array(at)] * (sizes > NOTHING)).sum(0)
            time = np.where(sizes.max(0) <= LARGEST, time, np.inf)
            for best in _least(time, count):
                pieces = [(int(c[best]), float(turn[best])) for c, turn in zip(at, turned, strict=True)
                          if abs(turn[best]) > NOTHING]  # fmt: skip
                found.append(
                    Word(tuple(c for c, _ in pieces), tuple(turn for _, turn in pieces), float(time[best]))
                )
        out.append(sorted(found, key=lambda word: word.time)[:count])
    return out


def _least(values: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """Return the indices of up to ``count`` least values that are finite."""
    count = min(count, len(values))
    least = np.argpartition(values, count - 1)[:count] if count else np.zeros(0, dtype=np.intp)
    return least[np.isfinite(values[least])]


def _cosine(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(values, -1.0, 1.0)


def _positive(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles in [0, 2 pi); a turn short of a full one by no more than round-off is none."""
    out = np.mod(angles, TURN)
    return np.where(out > TURN - NOTHING, 0.0, out)
