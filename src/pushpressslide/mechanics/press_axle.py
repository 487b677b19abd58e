"""The virtual axle of an object pressed on top at one place: exact, without the contact's height, and as the
paper has it.

Source: docs/mechanics.md, sections 2, 4 and 4.1. Axles are coordinates on the line from the CoM to the
contact: 0 at the CoM, positive towards the contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Point
from pushpressslide.core.task import Cylinder, ObjectModel
from pushpressslide.mechanics.pressure import PressureSamples, center_of_pressure, support_pressure
from pushpressslide.mechanics.virtual_axle import axle_with_height

GRAVITY = 9.81  # [m/s^2]
PAPER_C = 0.6  # c of a uniform contact, as the paper takes it


@dataclass(frozen=True, slots=True)
class PressedObject:
    """An object on a table, one tip pressed on top of it and dragged along. Raises ValueError for no load, or
    a contact at the CoM, where the object only translates.
    """

    body: ObjectModel
    friction: float  # of the pair object/support
    contact: Point  # [m] in B
    load: float  # [N] > 0

    def __post_init__(self) -> None:
        if not self.load > 0.0:
            raise ValueError(f"load {self.load} N; must be > 0")
        if self.contact == (0.0, 0.0):
            raise ValueError("the contact is at the CoM; the object only translates")

    @property
    def weight(self) -> float:
        """N_o [N]."""
        return self.body.mass * GRAVITY

    @property
    def total(self) -> float:
        """N [N]: weight and load."""
        return self.weight + self.load

    @property
    def cop(self) -> Point:
        """Centre of pressure in B [m], no force along the support."""
        return center_of_pressure(self.weight, (0.0, 0.0), (self.load,), (self.contact,))

    @property
    def lever(self) -> float:
        """Distance d from the centre of pressure to the contact [m]."""
        return math.dist(self.cop, self.contact)

    @property
    def half_diagonal(self) -> float:
        """r0 [m]: half the diagonal of a rectangle, the radius of a cylinder; the paper's length."""
        shape = self.body.shape
        if isinstance(shape, Cylinder):
            return shape.radius
        x, y = zip(*shape.footprint, strict=True)
        center = (sum(x) / len(x), sum(y) / len(y))
        return max(math.dist(center, corner) for corner in shape.footprint)

    def pressure(self, cop: Point, resolution: int = 8) -> PressureSamples:
        """Return the pressure under the object, unit load, whose centre is ``cop`` [m] in B."""
        return support_pressure(self.body.shape, 1.0, self.body.center_of_mass, cop, resolution)

    def axle(self, force_angle: float, height: float | None = None) -> float:
        """Return the virtual axle [m] under a force at ``force_angle`` [rad] from the line CoM to contact.

        On the exact surface, the contact at ``height`` [m] above the support; None: on top of the object, 0:
        as if the force acted in the support's plane. Raises ValueError where the object tips.
        """
        height = self.body.shape.height if height is None else height
        at = axle_with_height(self.pressure, self.friction, self.cop, self.contact, height, force_angle)
        return (at[0] * self.contact[0] + at[1] * self.contact[1]) / math.hypot(*self.contact)

    def paper_distance(self, c: float = PAPER_C) -> float:
        """Return (c r0)^2 / d [m], the paper's distance from the centre of pressure to the axle."""
        return (c * self.half_diagonal) ** 2 / self.lever

    def paper_axle(self, c: float = PAPER_C) -> float:
        """Return the virtual axle [m] by the paper's formula: the same for every force and height."""
        return math.hypot(*self.cop) - self.paper_distance(c)

    def paper_printed(self, c: float = PAPER_C) -> float:
        """Return the distance from the CoM [m] as the paper adds it up: as if the axle, the centre of
        pressure and the CoM came in this order.
        """
        return math.hypot(*self.cop) + self.paper_distance(c)
