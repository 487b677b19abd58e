"""Drag and centre of friction of an object that several tips move, by what they feel.

While an object slides, its support resists by as much however hard the tips are
commanded to push. The tips' own motion tells whether it slides, and how it turns while
they stick. On the ellipsoid with the radius rho, a force F with the moment m about the
centre of pressure slides an object whose straight drag is sqrt(F^2 + (m / rho)^2). The
twist tells this moment, and with it how far from a believed centre the force passes
(docs/mechanics.md, section 1).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.online import LEAST_SPEED, MEMORY
from pushpressslide.mechanics.height_term import DraggedSurface

ENOUGH = 0.3
"""[s] of sliding that tell the drag."""
LEAST_FORCE = 3.0
"""Force, in standard deviations of a measured one, below which its line tells nothing."""
MODEL = 0.7
"""Standard deviation of the moment that a turn takes, as a share of it: it goes with the
square of rho, which feet or a bowed base change.
"""
PLACED = 4e-3  # [m] the same of the line of a force, between tips that are known


class Line(NamedTuple):
    """How far the line of a force passes beside a centre of friction."""

    value: float  # [m] of the centre, from B's origin
    deviation: float  # [m] standard deviation
    across: Point  # direction in B


class FeltDrag(NamedTuple):
    """Wrench on a sliding object and its twist, summed over time with forgetting. Both
    are about B's origin, in B.
    """

    fx: float = 0.0  # [N s]
    fy: float = 0.0
    tau: float = 0.0  # [N m s]
    x: float = 0.0  # [m]
    y: float = 0.0
    yaw: float = 0.0  # [rad]
    time: float = 0.0  # [s] that the sums have

    def step(self, wrench: Wrench, twist: Twist, dt: float) -> FeltDrag:
        """The sums after a tick of ``dt`` [s] with a ``wrench`` on an object that tips
        move with a ``twist``, both about B's origin.

        An object that they do not move tells nothing: its support may hold it with less
        than it can.
        """
        fx, fy, tau, _ = wrench
        vx, vy, w, _ = twist
        if fx * vx + fy * vy + tau * w < LEAST_SPEED * math.hypot(fx, fy):
            return self
        keep = math.exp(-dt / MEMORY)
        return FeltDrag(
            keep * self.fx + dt * fx,
            keep * self.fy + dt * fy,
            keep * self.tau + dt * tau,
            keep * self.x + dt * vx,
            keep * self.y + dt * vy,
            keep * self.yaw + dt * w,
            keep * self.time + dt,
        )

    def drag(self, center: Point, rho: float) -> float | None:
        """Drag [N] on an ellipsoid of radius ``rho`` [m] about a ``center`` [m] in B.
        None before it is known.
        """
        if self.time < ENOUGH:
            return None
        moment = Wrench(self.fx, self.fy, self.tau).moved_to(center).tau
        return math.hypot(self.fx, self.fy, moment / rho) / self.time

    def line(
        self, surface: DraggedSurface, noise: float, apart: float, aside: float
    ) -> Line | None:
        """Where the centre of the ``surface`` is across the felt force. None before it
        is known.

        ``noise`` [N] is the standard deviation of the mean force of a tip, ``apart`` [m]
        the distance of the tips, and ``aside`` [m] the standard deviation of where they
        touch the object.
        """
        force = math.hypot(self.fx, self.fy)
        if self.time < ENOUGH or force < LEAST_FORCE * noise * self.time:
            return None
        turned = surface.wrench(Twist(self.x, self.y, self.yaw))
        straight = math.hypot(turned.fx, turned.fy)
        if straight == 0.0:
            return None
        beside = turned.tau / straight
        ex, ey = self.fx / force, self.fy / force
        unsure = noise * self.time / force * apart
        deviation = math.hypot(PLACED, aside, MODEL * beside, unsure)
        return Line(self.tau / force - beside, deviation, (ey, -ex))
