"""Drag and centre of friction of an object that two tips move, by what they feel.

While an object slides, its support resists with the same force, however hard the tips are
commanded to push. Their own motion tells whether it slides, and how it turns while they
stick. On the ellipsoid with the radius rho, the power of the wrench is the drag times the
speed |(v, rho w)| of the centre. The twist tells the moment about this centre, and with
it how far from there the force passes (docs/mechanics.md, section 4.4).
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
PLACED = 4e-3
"""Standard deviation [m] of the line of a force if the tips' places are known."""


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
    time: float = 0.0  # [s] that these sums have
    work: float = 0.0  # [J]
    travel: float = 0.0  # [m] of the centre, with turns times rho
    slid: float = 0.0  # [s] that work and travel have

    def step(
        self, wrench: Wrench, twist: Twist, center: Point, rho: float, dt: float
    ) -> FeltDrag:
        """The sums after a tick of ``dt`` [s] with a ``wrench`` on an object that tips
        move with a ``twist``, both about B's origin.

        The object slides on an ellipsoid of radius ``rho`` [m] about a ``center`` [m] in
        B. One that the tips do not move tells nothing: its support may hold it with less
        than it can.
        """
        fx, fy, tau, _ = wrench
        vx, vy, w, _ = twist
        there = twist.moved_to(center)
        speed = math.hypot(there.vx, there.vy, rho * w)
        power = fx * vx + fy * vy + tau * w
        if speed < LEAST_SPEED or power <= 0.0:
            return self
        keep = math.exp(-dt / MEMORY)
        # a force that has turned about has another line
        kept = keep if vx * self.x + vy * self.y >= 0.0 else 0.0
        return FeltDrag(
            kept * self.fx + dt * fx,
            kept * self.fy + dt * fy,
            kept * self.tau + dt * tau,
            kept * self.x + dt * vx,
            kept * self.y + dt * vy,
            kept * self.yaw + dt * w,
            kept * self.time + dt,
            keep * self.work + dt * power,
            keep * self.travel + dt * speed,
            keep * self.slid + dt,
        )

    @property
    def drag(self) -> float | None:
        """The drag [N]. None before it is known."""
        return self.work / self.travel if self.slid >= ENOUGH else None

    def line(
        self, surface: DraggedSurface, noise: float, distance: float, aside: float
    ) -> Line | None:
        """Where the centre of the ``surface`` is across the felt force. None before it
        is known.

        ``noise`` [N] is the standard deviation of the mean force of a tip, ``distance`` [m]
        the distance of the tips, and ``aside`` [m] the standard deviation of the line
        from where they touch the object.
        """
        force = math.hypot(self.fx, self.fy)
        if self.time < ENOUGH or force <= LEAST_FORCE * noise * self.time:
            return None
        turned = surface.wrench(Twist(self.x, self.y, self.yaw))
        straight = math.hypot(turned.fx, turned.fy)
        if straight == 0.0:
            return None
        beside = turned.tau / straight
        ex, ey = self.fx / force, self.fy / force
        unsure = noise * self.time / force * distance
        deviation = math.hypot(PLACED, aside, MODEL * beside, unsure)
        return Line(self.tau / force - beside, deviation, (ey, -ex))
