"""Online identification of the force that slides a pushed object straight, mu_s N.

On the ellipsoid with the radius rho, a force F with the moment m about the centre of
pressure slides an object whose straight drag is sqrt(F^2 + (m / rho)^2). The mean over
time windows, in which the object slides, has a standard error from their scatter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.twist_path import screw
from pushpressslide.identification.online import LEAST_SPEED, WINDOW

LEAST_WINDOWS = 5
"""Smallest number of windows whose scatter gives an interval."""
MOMENT = 0.5
"""Standard deviation of the part of a level that comes from the moment, as a share of
that part: the true surface is no ellipsoid.
"""
MOST_ALIKE = 0.9
"""Largest correlation of a level with the next one that counts."""


class DragState(NamedTuple):
    """Levels of completed windows, and the window being filled."""

    levels: tuple[float, ...] = ()  # [N]
    turned: float = 0.0  # sum of the shares of the levels that come from moments
    slides: bool = False  # whether the object slid in the window before
    pose: Pose2 | None = None  # X_WB at the window's start
    time: float = 0.0  # [s] of its start
    force: Point = (0.0, 0.0)  # [N] summed over its ticks, in B
    ticks: int = 0


class Drag(NamedTuple):
    """Identified drag."""

    mean: float  # [N]
    deviation: float  # [N] standard deviation

    @classmethod
    def of_windows(cls, state: DragState, lever: float, force: float) -> Drag | None:
        """Mean of the levels of ``state``. None for fewer than ``LEAST_WINDOWS``.

        ``lever`` is the standard deviation of the force's lever, as a share of rho, and
        ``force`` [N] that of a constant error of the force.
        """
        count = len(state.levels)
        if count < LEAST_WINDOWS:
            return None
        mean = math.fsum(state.levels) / count
        turned = state.turned / count
        straight = 1.0 - turned
        moment = math.sqrt(1.0 - straight * straight)  # over rho, per level
        errors = (
            _scatter(state.levels, mean),
            MOMENT * mean * turned,
            lever * mean * moment * straight,
            force,
        )
        return cls(mean, math.hypot(*errors))


def _scatter(levels: tuple[float, ...], mean: float) -> float:
    """Standard deviation [N] of the ``mean`` of levels, each like the one before."""
    off = [level - mean for level in levels]
    square = math.fsum(each * each for each in off)
    if square == 0.0:
        return 0.0
    product = math.fsum(one * other for one, other in pairwise(off))
    alike = min(max(product / square, 0.0), MOST_ALIKE)
    apart = len(levels) * (1.0 - alike) / (1.0 + alike)
    return math.sqrt(square / (len(levels) - 1) / apart)


class DragIdentifier:
    """Mean of the drag over windows. The caller keeps its state."""

    def __init__(self, rho: float, window: float = WINDOW) -> None:
        """Bind to an ellipsoid of radius ``rho`` [m]. A window lasts ``window`` [s]."""
        self.rho = rho
        self._window = window

    @staticmethod
    def paused(state: DragState) -> DragState:
        """State while the object is not driven."""
        if state.pose is None:
            return state
        return DragState(state.levels, state.turned)

    def step(
        self,
        state: DragState,
        time: float,
        X_WB: Pose2,
        force: Point,
        lever: Callable[[], Point],
    ) -> DragState:
        """Next state after a tick.

        ``force`` [N] is that of the tip on the object, along the support, and ``lever``
        gives the contact [m] from the centre of mass at the end of a window, both in B.
        """
        if state.pose is None:
            return state._replace(pose=X_WB, time=time, force=(0.0, 0.0), ticks=0)
        fx = state.force[0] + force[0]
        fy = state.force[1] + force[1]
        ticks = state.ticks + 1
        span = time - state.time
        if span < self._window:
            begun = state.pose, state.time
            return DragState(
                state.levels, state.turned, state.slides, *begun, (fx, fy), ticks
            )
        vx, vy, w = (value / span for value in screw(state.pose, X_WB))
        x, y = lever()
        size = math.hypot(fx, fy)
        power = ((vx - w * y) * fx + (vy + w * x) * fy) / max(size, 1e-9)
        slides = power > LEAST_SPEED
        fresh = DragState(state.levels, state.turned, slides, X_WB, time)
        if not (slides and state.slides):
            return fresh
        level = math.hypot(size, (x * fy - y * fx) / self.rho) / ticks
        turned = state.turned + 1.0 - size / ticks / level
        return fresh._replace(levels=(*state.levels, level), turned=turned)
