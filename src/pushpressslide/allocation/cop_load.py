"""The smallest load of two presses that drives a twist with the centre of pressure at a
given point of the line between them (docs/mechanics.md, section 7).

Let u be the weight over the load. The centre of pressure is a polynomial in u, and so
is the wrench that slides the object, up to a factor. The loads at which a contact
reaches the edge of its friction disc are therefore roots of polynomials. Between two
neighbouring roots either every load suffices or none does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist

NOTHING = 1e-15  # share of the largest coefficient below which a leading one is dropped
HALVINGS = 60  # halvings of the interval around the smallest load


@dataclass(frozen=True, slots=True)
class CopFriction:
    """Available and required forces of two contacts for a twist, as functions of the
    load.

    They are polynomials in u, the weight over the load, with the lowest power first.
    Forces are multiplied by the speed |(v, rho w)| of the centre of pressure, squared
    forces by its square.
    """

    left: Array  # force that the left contact can give
    right: Array
    across_left: Array  # force across the line that it must give
    across_right: Array
    along: Array  # force along the line that both must give
    speed_squared: Array

    def surplus(self, u: float) -> float:
        """Available force of both contacts along the line, minus the required force.

        -inf if a contact cannot provide its force across the line.
        """
        speed_squared = _polynomial_value(self.speed_squared, u)
        room_left = _squared(self.left, u) * speed_squared
        room_left -= _squared(self.across_left, u)
        room_right = _squared(self.right, u) * speed_squared
        room_right -= _squared(self.across_right, u)
        if not (room_left >= 0.0 and room_right >= 0.0):
            return -math.inf
        return (
            math.sqrt(room_left)
            + math.sqrt(room_right)
            - abs(_polynomial_value(self.along, u))
        )

    def edges(self) -> Array:
        """Every u at which the surplus can change sign."""
        room_left = _product(_product(self.left, self.left), self.speed_squared)
        room_left = _sum(room_left, -_product(self.across_left, self.across_left))
        room_right = _product(_product(self.right, self.right), self.speed_squared)
        room_right = _sum(room_right, -_product(self.across_right, self.across_right))
        rest = _sum(_product(self.along, self.along), -_sum(room_left, room_right))
        balance = _sum(_product(rest, rest), -4.0 * _product(room_left, room_right))
        return np.concatenate([_roots(p) for p in (room_left, room_right, balance)])


def cop_friction(
    line: ContactLine,
    left: Point,
    fraction: float,
    twist: Twist,
    rho: float,
    frictions: tuple[float, float],
) -> CopFriction:
    """Polynomials for a centre of pressure at ``fraction`` of the length of ``line``.

    The line leads from ``left`` [m] to the right contact, in B, whose origin is the
    CoM; ``rho`` is in [m]. ``frictions`` are those of the pairs object/support and
    tip/object.
    """
    mu_s, mu_a = frictions
    com, offset = line.in_axes((-left[0], -left[1]))
    foot = line.in_body((fraction * line.length, 0.0))
    at_foot = twist.moved_to((left[0] + foot[0], left[1] + foot[1]))
    v_e, v_m = line.in_axes((at_foot.vx, at_foot.vy))
    # the centre of pressure is offset u beside the line
    along = np.array([v_e, -twist.w * offset])
    moment = _sum(np.array([rho * rho * twist.w]), -offset * np.append(0.0, along))
    across_right = _sum(np.array([fraction * v_m]), moment / line.length)
    across_left = _sum(np.array([v_m]), -across_right)
    speed_squared = _sum(
        _product(along, along), np.array([v_m**2 + (rho * twist.w) ** 2])
    )
    com_fraction = com / line.length
    return CopFriction(
        left=mu_a * np.array([1.0 - fraction, com_fraction - 1.0]),
        right=mu_a * np.array([fraction, -com_fraction]),
        across_left=mu_s * across_left,
        across_right=mu_s * across_right,
        along=mu_s * along,
        speed_squared=speed_squared,
    )


def largest_enough(friction: CopFriction, lower: float, upper: float) -> float | None:
    """Largest u in [``lower``, ``upper``] with a surplus >= 0, or None."""
    if not lower <= upper:
        return None
    if friction.surplus(upper) >= 0.0:
        return upper
    edges = friction.edges()
    inside = edges[(edges > lower) & (edges < upper)]
    bounds = np.unique(np.concatenate([[lower], inside, [upper]]))
    high = upper
    for middle in (0.5 * (bounds[1:] + bounds[:-1]))[::-1].tolist():
        if friction.surplus(middle) >= 0.0:
            return _last_enough(friction, middle, high)
        high = middle
    return lower if friction.surplus(lower) >= 0.0 else None


def _last_enough(friction: CopFriction, low: float, high: float) -> float:
    """Largest u up to ``high`` with a surplus >= 0. The surplus is >= 0 at ``low``."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if friction.surplus(middle) >= 0.0:
            low = middle
        else:
            high = middle
    return low


def _polynomial_value(polynomial: Array, u: float) -> float:
    value = 0.0
    for coefficient in polynomial[::-1].tolist():
        value = value * u + coefficient
    return value


def _squared(polynomial: Array, u: float) -> float:
    value = _polynomial_value(polynomial, u)
    return value * value


def _product(a: Array, b: Array) -> Array:
    out: Array = np.convolve(a, b)
    return out


def _sum(a: Array, b: Array) -> Array:
    out = np.zeros(max(len(a), len(b)))
    out[: len(a)] += a
    out[: len(b)] += b
    return out


def _roots(polynomial: Array) -> Array:
    """Real parts of all roots.

    The real part of a complex root only makes the partition into intervals finer than
    needed.
    """
    size = np.abs(polynomial)
    counts = np.flatnonzero(size > NOTHING * size.max())
    if not len(counts):
        return np.zeros(0)
    roots = np.roots(polynomial[counts[-1] :: -1])
    return np.array(roots.real, dtype=np.float64)
