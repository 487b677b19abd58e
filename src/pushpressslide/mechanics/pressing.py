"""One tip pressed on top of an object: load, centre of pressure, virtual axle, and how hard to press.

Source: docs/mechanics.md, sections 1.2, 2 and 4. Plain floats, but for the pressure under the object.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pushpressslide.core.pose import Point
from pushpressslide.mechanics.pressure import PressureSamples
from pushpressslide.mechanics.rho import rho_straight


def friction_use(load: float, weight: float, mu_support: float, mu_contact: float) -> float:
    """Return what straight sliding takes of the press's friction: mu_s (N_o + N_a) / (mu_a N_a); below 1 it
    sticks.
    """
    return mu_support * (weight + load) / (mu_contact * load) if load > 0.0 else math.inf


def least_load(weight: float, mu_support: float, mu_contact: float, use: float = 1.0) -> float:
    """Return the least press N_a [N] that drags in every direction with ``use`` of its friction.

    mu_s N_o / (use mu_a - mu_s); infinite where no press is hard enough.
    """
    room = use * mu_contact - mu_support
    return mu_support * weight / room if room > 0.0 else math.inf


@dataclass(frozen=True, slots=True)
class Press:
    """A press at ``contact`` [m] in B with ``load`` [N] on an object of ``weight`` [N]."""

    contact: Point
    load: float
    weight: float

    @property
    def total(self) -> float:
        """Load on the support N [N]."""
        return self.weight + self.load

    @property
    def cop(self) -> Point:
        """Centre of pressure in B [m], no force along the support."""
        n = self.load / self.total
        return (n * self.contact[0], n * self.contact[1])

    @property
    def lever(self) -> float:
        """Distance d from the centre of pressure to the contact [m]."""
        return math.hypot(*self.contact) * self.weight / self.total

    @property
    def axis(self) -> Point:
        """Unit vector e in B from the centre of pressure to the contact.

        Raises ValueError for a contact at the CoM, where the object only translates.
        """
        d = math.hypot(*self.contact)
        if d == 0.0:
            raise ValueError("the contact is at the CoM; the object only translates")
        return (self.contact[0] / d, self.contact[1] / d)


def straight_axle(
    pressure_at: Callable[[Point], PressureSamples], mu: float, press: Press, height: float, backward: bool
) -> tuple[Point, float]:
    """Return the virtual axle of near-straight sliding in B [m] and rho^2/d [m], exact to first order.

    Pulled, the force is along the axis e; ``backward``, against it. At ``height`` [m] the drag mu N shifts
    the CoP, and with it the pressure's variance along e: x_va = (x_cop +- h mu) - rho_x^2(x_cop +- h mu) / d.
    Raises ValueError where the shifted CoP leaves the base: the object tips.
    """
    e, sign = press.axis, -1.0 if backward else 1.0
    shift = sign * height * mu
    at = (press.cop[0] + shift * e[0], press.cop[1] + shift * e[1])
    reach = rho_straight(pressure_at(at), e) ** 2 / press.lever
    return (at[0] - reach * e[0], at[1] - reach * e[1]), reach
