"""Three turns about points of the body that lead from one pose to another, for any choice of the points.

A turn by an angle a about the body's point c moves a body at the origin to (1 - e^{ia}) c; three of them lead
to p, turned by theta, iff e^{i a1} (c2 - c1) + e^{i (a1 + a2)} (c3 - c2) = p - c1 + e^{i theta} c3: a linkage
of two bars, whose two solutions are closed form. Dubins' and Reeds and Shepp's words are special cases; a
straight piece is a turn about a point far away.
"""

from __future__ import annotations

import math
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
    goal: Pose2,
    count: int,
) -> list[Word]:
    """Return the quickest ``count`` words of up to three turns that lead to ``goal``, a pose of the body seen
    from its start.

    ``centers`` (n,) [m] in the body, x + iy; ``senses`` (n,) +1 or -1, the way about a centre that can be
    driven; ``times`` (n,) [s/rad]; ``pauses`` (n,) [s] that a turn takes besides.
    """
    n = len(centers)
    i, j, k = (v.ravel() for v in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    kept = (i != j) & (j != k)
    i, j, k = i[kept], j[kept], k[kept]
    p, theta = complex(goal.x, goal.y), goal.yaw
    first, second = centers[j] - centers[i], centers[k] - centers[j]
    a, b = np.abs(first), np.abs(second)
    target = p - centers[i] + np.exp(1j * theta) * centers[k]
    reach = np.abs(target)
    cosine = (reach * reach - a * a - b * b) / np.maximum(2.0 * a * b, 1e-12)
    solvable = np.flatnonzero(np.abs(cosine) <= 1.0)
    i, j, k, first, second, target = (v[solvable] for v in (i, j, k, first, second, target))
    a, b, bend = a[solvable], b[solvable], np.arccos(cosine[solvable])
    found: list[Word] = []
    for sign in (1.0, -1.0):
        a1 = np.angle(target / (a + b * np.exp(1j * sign * bend))) - np.angle(first)
        a2 = sign * bend - np.angle(second) + np.angle(first)
        turned = [senses[c] * _positive(senses[c] * angle) for c, angle in
                  ((i, a1), (j, a2), (k, theta - a1 - a2))]  # fmt: skip
        sizes = np.abs(np.array(turned))
        time = sum(
            times[c] * size + pauses[c] * (size > NOTHING) for c, size in zip((i, j, k), sizes, strict=True)
        )
        time = np.where(sizes.max(0) <= LARGEST, time, np.inf)
        for at in np.argsort(time)[:count]:
            if math.isfinite(time[at]):
                pieces = [(int(c[at]), float(angle[at])) for c, angle in zip((i, j, k), turned, strict=True)
                          if abs(angle[at]) > NOTHING]  # fmt: skip
                found.append(
                    Word(tuple(c for c, _ in pieces), tuple(angle for _, angle in pieces), float(time[at]))
                )
    return sorted(found, key=lambda word: word.time)[:count]


def _positive(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles in [0, 2 pi); a turn short of a full one by no more than round-off is none."""
    out = np.mod(angles, TURN)
    return np.where(out > TURN - NOTHING, 0.0, out)
