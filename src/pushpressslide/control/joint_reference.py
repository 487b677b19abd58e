"""Reference joint positions of a joint path: by time on the approach, by arc length
along the contact's path.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.plan import JointPath

Array = NDArray[np.float64]


def approach_reference(path: JointPath, elapsed: float) -> tuple[Array, Array]:
    """Joint positions (n,) [rad] and velocities (n,) [rad/s] of the approach.

    ``elapsed`` [s] is the time since its start. After its end the joints are at rest.
    """
    times = path.approach_time
    q = path.approach
    i, share = _interval(times, elapsed)
    velocity = np.zeros(q.shape[1])
    if elapsed < times[-1]:
        velocity = (q[i + 1] - q[i]) / (times[i + 1] - times[i])
    return q[i] + share * (q[i + 1] - q[i]), velocity


def path_reference(path: JointPath, progress: float) -> Array:
    """Joint positions (n,) [rad] at arc length ``progress`` [m] of the contact's path.

    A negative ``progress`` places the tip at that distance before the contact; a
    ``progress`` beyond the end places it at that distance of its retreat. If these
    joint positions are not known, those at the nearer end of the path are returned.
    """
    touch = path.touch
    if progress < 0.0 and touch is not None and len(touch) > 1:
        return _between(np.linspace(-path.gap, 0.0, len(touch)), touch, progress)
    beyond = progress - float(path.arc_length[-1])
    back = path.back
    if beyond > 0.0 and back is not None and len(back) > 1:
        return _between(np.linspace(0.0, path.max_retreat, len(back)), back, beyond)
    if path.arc_length[-1] <= 0.0:  # the goal is the start
        start: Array = path.move[0]
        return start
    return _between(path.arc_length, path.move, progress)


def _between(grid: Array, rows: Array, value: float) -> Array:
    """Rows (n,) interpolated at ``value`` from ``rows`` (k, n) at a rising ``grid``
    (k,).
    """
    i, share = _interval(grid, value)
    out: Array = rows[i] + share * (rows[i + 1] - rows[i])
    return out


def _interval(grid: Array, value: float) -> tuple[int, float]:
    """Index of the interval of a rising ``grid`` that contains ``value``, and the
    fraction of the interval up to ``value``.
    """
    i = min(max(int(grid.searchsorted(value)) - 1, 0), len(grid) - 2)
    before = float(grid[i])
    share = (value - before) / (float(grid[i + 1]) - before)
    return i, min(max(share, 0.0), 1.0)
