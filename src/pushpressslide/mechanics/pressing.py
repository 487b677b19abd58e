"""One tip pressed on top of an object: load, centre of pressure, how it moves, and how hard to press.

Source: docs/mechanics.md, sections 1.2, 2 and 4. Forces along the support are given by their angle from the
heading axis, which leads from the centre of pressure (CoP) to the contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.task import ObjectModel
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.limit_surface import exact_level, exact_twist_direction
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.mechanics.rho import rho_straight
from pushpressslide.mechanics.top import room_inside

RESOLUTION = 4  # of the pressure samples: enough for twists within a percent
USES = (0.7, 0.8, 0.9, 0.96)  # shares of the press's friction that a motion may take, the best first
MOST_USE = USES[-1]
LEAST_PRESS = 2.0  # [N] below which contact is not felt for sure
STRAIGHT = 1e-3  # [rad] force angle below which the limit of straight sliding is used


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


def press_loads(
    weight: float, mu_support: float, mu_contact: float, most: float, wanted: float | None = None
) -> tuple[str | None, list[float]]:
    """Return what stands against any press of up to ``most`` [N], and the loads [N] to try, the safest first;
    ``wanted`` [N] is the only one where it is given.
    """
    if wanted is None:
        loads = [max(LEAST_PRESS, least_load(weight, mu_support, mu_contact, use)) for use in USES]
        if loads[-1] <= most:
            return None, sorted({load for load in loads if load <= most}, reverse=True)
        if mu_contact <= mu_support:
            why = f"contact friction {mu_contact:g} must exceed the support's, {mu_support:g}: no press drags"
            return why, []
        return f"needs a press of {loads[-1]:.1f} N, limits.normal_force is {most:g} N", []
    if wanted > most:
        return f"motion.press_force of {wanted:g} N, limits.normal_force is {most:g} N", []
    use = friction_use(wanted, weight, mu_support, mu_contact)
    if use > MOST_USE:
        needed = mu_support * (weight + wanted) / (MOST_USE * wanted)
        return (
            f"pressed with {wanted:g} N the tip slips before the object: straight sliding takes {use:.2f} of "
            f"its friction, allowed {MOST_USE:g}; contact friction {mu_contact:g}, needed {needed:.3f}"
        ), []
    return None, [wanted]


def pressed_cop(contact: Point, load: float, weight: float) -> Point:
    """Return the CoP [m] in B under a press at ``contact``, no force along the support."""
    n = load / (weight + load)
    return (n * contact[0], n * contact[1])


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
    from ``cop`` by h F / N, and the pressure with it; ``pressure_at(p)`` gives the distribution whose CoP is
    p. Raises ValueError where it leaves the base: the object tips.
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


@dataclass(frozen=True, slots=True)
class Press:
    """A press at ``contact`` [m] in B; raises ValueError for one at the CoM, where there is no heading
    axis.
    """

    body: ObjectModel
    contact: Point
    load: float  # [N]
    weight: float  # [N]
    mu: float  # of the pair object/support

    def __post_init__(self) -> None:
        if self.contact == (0.0, 0.0):
            raise ValueError("the contact is at the CoM; the object only translates")

    @property
    def cop(self) -> Point:
        """CoP in B [m], no force along the support."""
        return pressed_cop(self.contact, self.load, self.weight)

    @property
    def axis(self) -> Point:
        """Unit vector of the heading axis in B."""
        d = math.hypot(*self.contact)
        return (self.contact[0] / d, self.contact[1] / d)

    @property
    def lever(self) -> float:
        """Distance d from the CoP to the contact [m]."""
        return math.dist(self.contact, self.cop)

    @property
    def shift(self) -> float:
        """How far straight drag at the contact's height moves the CoP along the force [m]: h mu_s."""
        return self.body.shape.height * self.mu

    def along(self, angle: float) -> Point:
        """Return the unit vector in B at ``angle`` [rad] from the heading axis."""
        (ex, ey), c, s = self.axis, math.cos(angle), math.sin(angle)
        return (c * ex - s * ey, s * ex + c * ey)

    def _pressure(self, cop: Point) -> PressureSamples:
        return support_pressure(self.body.shape, 1.0, self.body.center_of_mass, cop, RESOLUTION)

    def room(self, angle: float) -> float:
        """Return how far the CoP stays inside the base under drag at ``angle`` [rad], in half widths; < 0: it
        tips.
        """
        u = self.along(angle)
        return room_inside(self.body, (self.cop[0] + self.shift * u[0], self.cop[1] + self.shift * u[1]))

    def twist(self, angle: float) -> Twist:
        """Return the twist of B's origin under a force at ``angle`` [rad], on the exact surface; only its
        direction counts. Raises ValueError where the object tips.
        """
        return pressed_twist(
            self._pressure, self.mu, self.cop, self.contact, self.body.shape.height, self.along(angle)
        )

    def axle(self, angle: float, backward: bool) -> tuple[float, float]:
        """Return where the virtual axle is on the heading axis, ahead of the CoP [m], and the tan(force
        angle) per curvature there [m], both of the mean of forces to the left and to the right.

        ``angle`` in [0, pi/2) from the direction of motion: along the axis, or ``backward`` against it. Near
        zero exact to first order: x_cop +- h mu - rho_x^2 / d. Raises ValueError where the object tips.
        """
        sign = -1.0 if backward else 1.0
        if angle < STRAIGHT:
            e, shift = self.axis, sign * self.shift
            at = (self.cop[0] + shift * e[0], self.cop[1] + shift * e[1])
            reach = rho_straight(self._pressure(at), e) ** 2 / self.lever
            return shift - reach, reach
        (ex, ey), ahead, reach = self.axis, 0.0, 0.0
        for side in (angle, -angle):
            twist = self.twist(math.pi - side if backward else side).moved_to(self.cop)
            along, across = twist.vx * ex + twist.vy * ey, ex * twist.vy - ey * twist.vx
            ahead -= 0.5 * across / twist.w
            reach += 0.5 * math.tan(side) * sign * along / twist.w
        return ahead, reach

    def pivot(self, left: bool) -> Point:
        """Return the point of B [m] that stays where it is under a force across the axis, to the left or to
        the right of the contact; the drag's height moves it off the axis. Raises ValueError where it tips.
        """
        twist = self.twist(0.5 * math.pi if left else -0.5 * math.pi)
        return (-twist.vy / twist.w, twist.vx / twist.w)
