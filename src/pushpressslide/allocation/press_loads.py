"""Normal loads of two top contacts (docs/mechanics.md, section 7): in a given ratio,
for a given centre of pressure, with the smallest sum, and on a wall.

The wrench that slides the object grows with the load, and the centre of pressure moves
with the ratio. The loads for one twist are therefore found by iteration, which takes
0.1 ms to a few milliseconds and is meant for planning. The loads for a given centre of
pressure are exact (``cop_load``), and those for all twists follow from one formula. The
height of the contacts, which shifts the centre of pressure along the force, is
neglected.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.cop_load import cop_friction, largest_enough
from pushpressslide.allocation.presses import least_press, two_press_allocator
from pushpressslide.core import margins
from pushpressslide.core.allocation import AllocationStatus
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.checks import (
    check_force,
    check_friction,
    check_rho,
)
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

Side = Literal["balanced", "left", "right"]
# share of the load on the lighter contact beyond the minimum for a turn on the spot
EXACT = 1e-9  # accuracy of the smallest load, as a share of the largest
TOPS = (1.0, 0.7, 0.5, 0.35, 0.25)  # shares of the largest load that are tried first
RATIOS = 16
SECTIONS = 10  # looked at, then between them, for the ratio that needs least press
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class PressLoads(NamedTuple):
    """Normal loads for a twist, with contact forces, centre of pressure, margin and
    status.
    """

    # [N] tangential, of the left and right contact ON the object, in B
    forces: tuple[Point, Point]
    normals: Point  # [N] of the left and right contact
    cop: Point  # [m] centre of pressure, in B
    margin: float  # [N] smallest distance of a force from the edge of its friction disc
    # [N] smallest sum of normals in this ratio for the wrench at this load; decides
    needed: float
    # "projected": feasible, but not in the requested ratio
    status: AllocationStatus


@dataclass(frozen=True, slots=True)
class TwoPresses:
    """Two top contacts on an object whose CoM is the origin of B.

    Raises InputError for friction or a weight < 0, rho or cap <= 0, and contacts that
    coincide. ``gravity`` in the methods is the weight [N] in the plane of the support,
    in B. It acts on a wall, where ``weight`` is 0.
    """

    left: Point  # [m] in B
    right: Point  # [m] in B
    weight: float  # [N] >= 0, presses the object at its CoM
    support_friction: float  # of the pair object/support
    contact_friction: float  # of the pair tip/object
    rho: float  # [m] of the ellipsoid about the centre of pressure
    cap: float  # [N] largest load of one contact

    def __post_init__(self) -> None:
        check_friction(self.support_friction, "support_friction")
        check_friction(self.contact_friction, "contact_friction")
        check_rho(self.rho)
        check_force(self.cap, "cap")
        if not (self.weight >= 0.0 and math.isfinite(self.weight)):
            raise InputError(f"weight {self.weight} N; must be finite and >= 0")
        ContactLine(self.left, self.right)

    @property
    def least_fraction(self) -> float:
        """Smallest share N_i / N of the load on each contact for a turn about the
        centre of pressure: (mu_s / mu_a) rho / l. Infinite if the contacts have no
        friction.
        """
        if self.contact_friction == 0.0:
            return math.inf
        return (
            self.support_friction
            / self.contact_friction
            * self.rho
            / math.dist(self.left, self.right)
        )

    def press_for_every_twist(self) -> float:
        """Smallest sum [N] of two equal normals that drives every twist. Infinite if
        none does.

        The contacts are opposite each other about the CoM. A finite sum requires mu_a >
        mu_s sqrt(1 + 4 rho^2 / l^2).
        """
        asked = self.support_friction * math.hypot(
            1.0, 2.0 * self.rho / math.dist(self.left, self.right)
        )
        spare = self.contact_friction - asked
        if spare <= 0.0:
            return math.inf
        return asked * self.weight / spare

    def loads_for(
        self, normals: Point, twist: Twist, gravity: Point = (0.0, 0.0)
    ) -> PressLoads:
        """Contact forces, centre of pressure, margin and status under ``normals`` [N].

        ``twist`` is that of any body point, in B.
        """
        cop, wrench = self._wrench(normals, twist, gravity)
        total = normals[0] + normals[1]
        share = normals[1] / total if total > 0.0 else 0.5
        points = (self.left, self.right)
        mu = self.contact_friction
        needed = least_press(ContactLine(*points).components(*wrench, cop), mu, share)
        allocation = two_press_allocator(points, mu)(*wrench, normals, cop)
        forces = (allocation.forces[0], allocation.forces[1])
        status: AllocationStatus = "ok" if allocation.status == "ok" else "infeasible"
        return PressLoads(forces, normals, cop, allocation.margin, needed, status)

    def in_ratio(
        self, share: float | Side, twist: Twist, gravity: Point = (0.0, 0.0)
    ) -> PressLoads:
        """Smallest loads with the fraction ``share`` on the right contact. If no loads
        within the cap suffice, these are the loads at the cap, with status
        "infeasible".
        """
        total = min(self._least_total(share, twist, gravity), self._max_total(share))
        return self.loads_for(self._shared(share, total), twist, gravity)

    def for_share(
        self, share: float | Side, twist: Twist, gravity: Point = (0.0, 0.0)
    ) -> PressLoads:
        """Smallest loads for ``twist`` with the fraction ``share`` of the total load on
        the right contact.

        "balanced" is one half. "left" and "right" put the centre of pressure as near to
        that contact as a turn on the spot allows. If the loads in this ratio exceed the
        cap, those of ``for_least_press`` are taken instead, with status "projected". If
        even these exceed the cap, their ratio is kept with the loads at the cap, and
        the status is "infeasible".
        """
        found = self.in_ratio(share, twist, gravity)
        if found.status != "ok":
            return self._instead(twist, gravity)
        return found

    def for_cop(
        self, fraction: float, twist: Twist, gravity: Point = (0.0, 0.0)
    ) -> PressLoads:
        """Smallest loads for ``twist`` with the centre of pressure at ``fraction`` in
        (0, 1) from the left to the right contact, along their line.

        They are exact: no smaller loads within the cap suffice. If they exceed the cap,
        or no loads suffice, the result is as in ``for_share``. If no weight presses the
        object on the support, the two methods are equivalent.
        """
        if self.weight == 0.0:
            return self.for_share(fraction, twist, gravity)
        normals = self._normals_for_cop(fraction, twist)
        if normals is None:
            return self._instead(twist, gravity)
        return self.loads_for(normals, twist)

    def _normals_for_cop(self, fraction: float, twist: Twist) -> Point | None:
        """Smallest normals [N] with the centre of pressure at ``fraction``.

        None if no loads within the cap drive ``twist``.
        """
        if not all(map(math.isfinite, twist[:3])):
            return None
        line = ContactLine(self.left, self.right)
        com = line.in_axes((-self.left[0], -self.left[1]))[0] / line.length
        # each contact's part of the load, and of the weight
        parts = ((1.0 - fraction, 1.0 - com), (fraction, com))
        lower = 0.0
        upper = 1.0
        for of_load, of_weight in parts:
            largest = self.cap + of_weight * self.weight
            if not largest > 0.0:
                return None
            lower = max(lower, of_load * self.weight / largest)
            if of_weight > 0.0:
                upper = min(upper, of_load / of_weight)
        frictions = (self.support_friction, self.contact_friction)
        friction = cop_friction(line, self.left, fraction, twist, self.rho, frictions)
        share = largest_enough(friction, lower, upper)
        if share is None:
            return None
        load = self.weight / share
        left, right = (
            of_load * load - of_weight * self.weight for of_load, of_weight in parts
        )
        return (max(left, 0.0), max(right, 0.0))

    def for_least_press(self, twist: Twist, gravity: Point = (0.0, 0.0)) -> PressLoads:
        """Loads for ``twist`` in the ratio with the smallest total.

        The status is "infeasible" if no loads within the cap suffice. The ratio is the
        best of a grid, refined by golden section.
        """

        def press(share: float) -> float:
            """Smallest total press [N] with a given ratio of the loads."""
            return self._least_total(share, twist, gravity)

        step = 1.0 / RATIOS
        middle = min([step * i for i in range(1, RATIOS)], key=press)
        if press(middle) == math.inf:
            return self.in_ratio(0.5, twist, gravity)
        low = middle - step
        high = middle + step
        for _ in range(SECTIONS):
            a = high - GOLDEN * (high - low)
            b = low + GOLDEN * (high - low)
            if press(a) <= press(b):
                high = b
            else:
                low = a
        best = min(middle, 0.5 * (low + high), key=press)
        return self.in_ratio(best, twist, gravity)

    def _instead(self, twist: Twist, gravity: Point) -> PressLoads:
        other = self.for_least_press(twist, gravity)
        if other.status != "ok":
            return other
        return other._replace(status="projected")

    def _wrench(
        self, normals: Point, twist: Twist, gravity: Point
    ) -> tuple[Point, tuple[float, float, float]]:
        """Centre of pressure, and the wrench about it required of the contacts."""
        left, right = normals
        load = self.weight + left + right
        cop = (
            (left * self.left[0] + right * self.right[0]) / load,
            (left * self.left[1] + right * self.right[1]) / load,
        )
        slide = EllipsoidLimitSurface(
            self.support_friction * load, self.rho, cop
        ).wrench(twist)
        held = Wrench(*gravity, 0.0).moved_to(cop)
        return cop, (slide.fx - held.fx, slide.fy - held.fy, slide.tau - held.tau)

    def _least_total(self, share: float | Side, twist: Twist, gravity: Point) -> float:
        """Smallest sum [N] of two normals with a given ratio. Infinite if it exceeds
        the cap.
        """
        line = ContactLine(self.left, self.right)
        mu = self.contact_friction

        def surplus(total: float) -> float:
            """Excess of a sum [N] of normals over the required press. The requirement
            depends on the sum through the drag.
            """
            normals = self._shared(share, total)
            cop, wrench = self._wrench(normals, twist, gravity)
            return total - least_press(
                line.components(*wrench, cop), mu, normals[1] / total
            )

        return _first_enough(surplus, self._max_total(share))

    def _max_total(self, share: float | Side) -> float:
        """Largest sum [N] of two normals in a given ratio within the cap."""
        if isinstance(share, str):
            lower = self._least_of_side(share)
            return min(2.0 * self.cap, (self.cap + lower * self.weight) / (1.0 - lower))
        return self.cap / max(share, 1.0 - share)

    def _shared(self, share: float | Side, total: float) -> Point:
        """Normals [N] of both contacts, from their sum and ratio."""
        if isinstance(share, str):
            lighter = min(
                self._least_of_side(share) * (self.weight + total), 0.5 * total
            )
            if share == "right":
                return (lighter, total - lighter)
            return (total - lighter, lighter)
        return (1.0 - share) * total, share * total

    def _least_of_side(self, side: Side) -> float:
        """Fraction of the load on the lighter contact."""
        if side == "balanced":
            return 0.5
        return min(self.least_fraction + margins.SPARE_LOAD, 0.5)


def _first_enough(surplus: Callable[[float], float], upper: float) -> float:
    """Smallest total with surplus(total) >= 0, to within ``EXACT`` times ``upper``.

    Infinite if no total suffices. ``surplus`` is nearly linear and is solved by false
    position (Illinois), always within a bracket. It may decrease again when a larger
    press moves the centre of pressure away from the turning centre, and ``TOPS`` allows
    for this.
    """
    width = EXACT * upper
    low = width
    high = next((part * upper for part in TOPS if surplus(part * upper) >= 0.0), 0.0)
    if high == 0.0:
        return math.inf
    at_low = surplus(low)
    at_high = surplus(high)
    kept = 0  # bracket end kept by the last step
    while at_low < 0.0 and high - low > width:
        middle = 0.5 * (low + high)
        total = middle
        if at_low > -math.inf:
            total = (low * at_high - high * at_low) / (at_high - at_low)
        total = min(max(total, low + 0.5 * width), high - 0.5 * width)
        value = surplus(total)
        if value >= 0.0:
            high = total
            at_high = value
            if kept < 0:
                at_low *= 0.5
            kept = -1
        else:
            low = total
            at_low = value
            if kept > 0:
                at_high *= 0.5
            kept = 1
    return high if at_low < 0.0 else low


def wall_press(
    weight: float, contact_friction: float, wall_friction: float, up: float
) -> float:
    """Smallest sum [N] of two equal normals that slides an object along a wall.

    Infinite if none does. ``weight`` [N] acts in the plane of the wall. ``up`` is the
    upward component of the direction of sliding: 1 up, 0 sideways, -1 down. The object
    does not turn, and the contacts are level with the CoM, one on either side. The
    press is mg / (sqrt(mu_w^2 up^2 + mu_a^2 - mu_w^2) - mu_w up).
    """
    b = wall_friction * up
    square = b * b + contact_friction**2 - wall_friction**2
    spare = math.sqrt(square) - b if square >= 0.0 else 0.0
    return weight / spare if spare > 0.0 else math.inf


def wall_hold(weight: float, contact_friction: float, wall_friction: float) -> float:
    """Smallest sum [N] of two equal normals that holds an object at rest on a wall.

    The friction at the tips and at the wall together carry the ``weight`` [N]: mg /
    (mu_a + mu_w). Infinite without any friction.
    """
    friction = contact_friction + wall_friction
    return weight / friction if friction > 0.0 else math.inf
