"""Collision-free joint path by RRT-Connect (Kuffner and LaValle, 2000), shortened."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pushpressslide.core.arrays import Array

Free = Callable[[Array], bool]

STRIDE = 0.4  # [rad] or [m] of any joint between two postures of a tree
CHECK_STEP = 0.05  # [rad] or [m] of any joint between two postures that are checked
ROOM = 1.2  # [rad] or [m] by which a joint may leave the range between start and goal
GROWTHS = 1000  # largest number of samples
SHORTCUTS = 80  # tried on a path


def connect(
    start: Array, goal: Array, free: Free, lower: Array, upper: Array
) -> Array | None:
    """Corners (k, n) of a free path from ``start`` (n,) to ``goal`` (n,). None if 1000
    samples do not lead to a path.

    ``free`` is True for a free posture (n,). Joints stay within ``lower`` and ``upper``
    (n,). The random seed is fixed, so that the result is reproducible.
    """
    if not (free(start) and free(goal)):
        return None
    rng = np.random.default_rng(0)
    lowest = np.maximum(lower, np.minimum(start, goal) - ROOM)
    highest = np.minimum(upper, np.maximum(start, goal) + ROOM)
    here = _Tree(start)
    there = _Tree(goal)
    for _ in range(GROWTHS):
        reached = here.grow(lowest + rng.random(len(start)) * (highest - lowest), free)
        if reached is not None:
            target = here.postures[reached]
            met = there.grow(target, free)
            while met is not None and not np.array_equal(there.postures[met], target):
                met = there.grow(target, free)
            if met is not None:
                path = here.branch(reached)[::-1] + there.branch(met)[1:]
                if here.postures[0] is not start:
                    path.reverse()
                return _shortened(path, free, rng)
        here, there = there, here
    return None


class _Tree:
    """Postures that can be reached from a root, each with its parent."""

    def __init__(self, root: Array) -> None:
        self.postures = [root]
        self._parents = [-1]

    def grow(self, target: Array, free: Free) -> int | None:
        """Extend the nearest posture by a stride towards ``target``. Returns the new
        posture's index, or None if it is not free.
        """
        near = int(np.abs(np.array(self.postures) - target).max(axis=1).argmin())
        step = target - self.postures[near]
        far = float(np.abs(step).max())
        new = target if far <= STRIDE else self.postures[near] + STRIDE / far * step
        if not _clear(self.postures[near], new, free):
            return None
        self.postures.append(new)
        self._parents.append(near)
        return len(self.postures) - 1

    def branch(self, i: int) -> list[Array]:
        """Postures from index ``i`` back to the root."""
        out = []
        while i >= 0:
            out.append(self.postures[i])
            i = self._parents[i]
        return out


def _clear(a: Array, b: Array, free: Free) -> bool:
    """Whether the straight line from ``a`` to ``b`` is free, assuming that ``a`` is."""
    count = max(1, math.ceil(float(np.abs(b - a).max()) / CHECK_STEP))
    return all(free(a + (i / count) * (b - a)) for i in range(1, count + 1))


def _shortened(path: list[Array], free: Free, rng: np.random.Generator) -> Array:
    """Path with corners cut wherever the shortcut is free."""
    for _ in range(SHORTCUTS):
        if len(path) < 3:
            break
        i, j = sorted(rng.choice(len(path), 2, replace=False))
        if j > i + 1 and _clear(path[i], path[j], free):
            del path[i + 1 : j]
    return np.stack(path)
