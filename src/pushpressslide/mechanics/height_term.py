"""The ellipsoid under a load that the drag itself shifts: forces at a height above the
support move the centre of pressure by h F / N (docs/mechanics.md, sections 1 and 1.2).

The shift is along the force, so that the moments about the original and the shifted
centre of pressure are equal. For wrenches the surface therefore remains the ellipsoid;
only the twist that belongs to a wrench changes. The conversions in both directions have
closed forms, in plain floats.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.kernels.limit_surface import (
    Ellipsoid,
    dragged_twist,
    dragged_wrench,
)
from pushpressslide.mechanics.checks import check_force, check_rho


@dataclass(frozen=True, slots=True)
class DraggedSurface:
    """Limit surface fx^2 + fy^2 + (tau/rho)^2 = max_force^2 about ``center``. The CoP
    is displaced from ``center`` by lift F / max_force.
    """

    max_force: float  # [N] mu_s N > 0
    rho: float  # [m] > 0
    # [m] h mu_s >= 0, of forces that all act at one height h; a mean where they do not
    lift: float = 0.0
    center: Point = (0.0, 0.0)  # [m] in B: the centre of pressure without drag

    def __post_init__(self) -> None:
        check_force(self.max_force, "max_force")
        check_rho(self.rho)

    def twist_direction(self, wrench: Wrench) -> Twist:
        """Direction of sliding under ``wrench`` scaled to the surface, as a twist of
        ``center``.

        The twist of the displaced centre of pressure is nu ~ (fx, fy, tau/rho^2) with
        |(v, rho w)| = 1 m/s. Zero for a zero wrench.
        """
        fx, fy, tau, _ = wrench.moved_to(self.center)
        return Twist(*dragged_twist(fx, fy, tau, self._figures), self.center)

    def wrenches(self, twists: Array) -> Array:
        """Wrenches (m, 3) about ``center`` that drive twists (m, 3) of ``center``, as
        in ``wrench``.
        """
        figures = self._figures
        rows = [dragged_wrench(vx, vy, w, figures) for vx, vy, w in twists.tolist()]
        return np.array(rows).reshape(-1, 3)

    def wrench(self, twist: Twist) -> Wrench:
        """Wrench on the surface, about ``center``, that drives ``twist``.

        Zero for a zero twist.
        """
        vx, vy, w, _ = twist.moved_to(self.center)
        return Wrench(*dragged_wrench(vx, vy, w, self._figures), self.center)

    @property
    def _figures(self) -> Ellipsoid:
        return self.max_force, self.rho, self.lift
