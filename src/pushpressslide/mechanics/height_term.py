"""The ellipsoid under a load that the drag itself shifts: forces at a height above the
support move the centre of pressure by h F / N (docs/mechanics.md, sections 1 and 1.2).

The shift is along the force, so that the moment about the resting centre of pressure is
that about the moved one: in terms of wrenches the surface is the ellipsoid; what
changes is the twist that goes with a wrench. Both ways are closed forms, in plain
floats.
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
    """fx^2 + fy^2 + (tau/rho)^2 = max_force^2 about ``center``, from which the CoP is
    lift F / max_force.
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
        """Return the direction of sliding under ``wrench``, put on the surface, as a
        twist of ``center``.

        Of the moved centre of pressure it is nu ~ (fx, fy, tau/rho^2) with |(v, rho w)|
        = 1 m/s; zero for a zero wrench.
        """
        fx, fy, tau, _ = wrench.moved_to(self.center)
        return Twist(*dragged_twist(fx, fy, tau, self._figures), self.center)

    def wrenches(self, twists: Array) -> Array:
        """Return ``wrench`` (m, 3) about ``center`` of twists (m, 3) of it."""
        figures = self._figures
        rows = [dragged_wrench(vx, vy, w, figures) for vx, vy, w in twists.tolist()]
        return np.array(rows).reshape(-1, 3)

    def wrench(self, twist: Twist) -> Wrench:
        """Return the wrench on the surface, about ``center``, that drives ``twist``.

        Zero for none.
        """
        vx, vy, w, _ = twist.moved_to(self.center)
        return Wrench(*dragged_wrench(vx, vy, w, self._figures), self.center)

    @property
    def _figures(self) -> Ellipsoid:
        return self.max_force, self.rho, self.lift
