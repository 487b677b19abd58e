"""One tip pressed on top of an object: load, centre of pressure, virtual axle, and how hard to press.

Source: docs/mechanics.md, sections 1.2, 2 and 4. Plain floats, but for the pressure under the object.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.limit_surface import exact_level, exact_twist_direction
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


def pressed_cop(contact: Point, load: float, weight: float) -> Point:
    """Return the centre of pressure [m] in B under a press at ``contact``, no force along the support."""
    n = load / (weight + load)
    return (n * contact[0], n * contact[1])


def straight_rho(
    pressure_at: Callable[[Point], PressureSamples], cop: Point, contact: Point, shift: float
) -> float:
    """Return rho [m] of near-straight sliding along the line of CoP and contact, exact to first order.

    The pressure's deviation along that line, under the load whose CoP the drag has moved by ``shift`` [m]
    towards the contact. ``pressure_at(p)`` gives the distribution whose CoP is p. Raises ValueError where that
    is outside the base: the object tips.
    """
    d = math.dist(cop, contact)
    e = ((contact[0] - cop[0]) / d, (contact[1] - cop[1]) / d)
    return rho_straight(pressure_at((cop[0] + shift * e[0], cop[1] + shift * e[1])), e)


def pressed_twist(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    direction: Point,
) -> Twist:
    """Return the twist of B's origin under a force along the unit vector ``direction`` at ``height`` [m], on
    the exact surface; only its direction counts.

    The force, of the size that slides (``mu`` of the pair object/support; found by iteration), moves the CoP
    from ``cop`` by h F / N. Raises ValueError when it leaves the base: the object tips.
    """
    ratio = mu  # |F| / N
    for _ in range(6):
        moved = (cop[0] + height * ratio * direction[0], cop[1] + height * ratio * direction[1])
        samples = pressure_at(moved)
        arm = (contact[0] - moved[0], contact[1] - moved[1])
        wrench = Wrench(*direction, cross(arm, direction), moved)
        last, ratio = ratio, 1.0 / (exact_level(samples, mu, wrench) * samples.total_load)
        if abs(ratio - last) < 1e-4:
            break
    return exact_twist_direction(samples, wrench).moved_to((0.0, 0.0))
