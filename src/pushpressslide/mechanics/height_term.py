"""The ellipsoid under a load that the drag itself shifts: forces at a height above the
support move the centre of pressure by h F / N (docs/mechanics.md, sections 1 and 1.2).

The shift is along the force, so that the moment about the resting centre of pressure is
that about the moved one: in terms of wrenches the surface is the ellipsoid; what
changes is the twist that goes with a wrench. Both ways are closed forms, in plain
floats.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
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
        spin = tau / self.rho
        norm = sqrt(fx * fx + fy * fy + spin * spin)
        if norm == 0.0:
            return Twist(0.0, 0.0, 0.0, self.center)
        vx = fx / norm
        vy = fy / norm
        w = spin / (self.rho * norm)
        k = self.lift * w
        return Twist(vx + k * vy, vy - k * vx, w, self.center)

    def wrenches(self, twists: Array) -> Array:
        """Return ``wrench`` (m, 3) about ``center`` of twists (m, 3) of it."""
        vx, vy, w = twists.T
        turn = (self.rho * w) ** 2
        shift = (self.lift * w) ** 2
        square = vx * vx + vy * vy
        half = 0.5 * (square - turn - shift)
        norm = np.sqrt(
            np.maximum(half + np.sqrt(half * half + square * turn), 0.0) + turn
        )
        norm = np.maximum(norm, 1e-300)
        k = self.lift * w / norm
        scale = self.max_force / (norm * (1.0 + k * k))
        tau = self.max_force * self.rho**2 * w / norm
        return np.stack([scale * (vx - k * vy), scale * (vy + k * vx), tau], axis=-1)

    def wrench(self, twist: Twist) -> Wrench:
        """Return the wrench on the surface, about ``center``, that drives ``twist``.

        Zero for none.
        """
        vx, vy, w, _ = twist.moved_to(self.center)
        turn = (self.rho * w) ** 2
        shift = (self.lift * w) ** 2
        # |v_center|^2 = v^2 (1 + shift / (v^2 + turn)) for the speed v of the moved
        # centre of pressure
        square = vx * vx + vy * vy
        half = 0.5 * (square - turn - shift)
        v_squared = max(0.0, half + sqrt(half * half + square * turn))
        norm = sqrt(v_squared + turn)
        if norm == 0.0:
            return Wrench(0.0, 0.0, 0.0, self.center)
        # v_center = F - k J F, F the velocity of the moved centre of pressure
        k = self.lift * w / norm
        scale = self.max_force / (norm * (1.0 + k * k))
        return Wrench(
            scale * (vx - k * vy),
            scale * (vy + k * vx),
            self.max_force * self.rho**2 * w / norm,
            self.center,
        )
