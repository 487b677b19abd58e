"""One tip pressed on top of an object and dragged along: the object's motion and its
virtual axle.

The axle is computed exactly, without the height of the contact, and by the paper's
formula. Source: docs/mechanics.md, sections 1.2, 2, 4 and 4.1. Force angles are from
the heading axis, which leads from the CoM through the centre of pressure (CoP) to the
contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.pose import Point
from pushpressslide.core.task import ObjectModel
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.checks import check_point, check_press
from pushpressslide.mechanics.dragging import DraggedEllipsoid
from pushpressslide.mechanics.face_pressure import FacePressure, face_pressure
from pushpressslide.mechanics.pressing import pressed_cop
from pushpressslide.mechanics.top import room_inside
from pushpressslide.mechanics.virtual_axle import (
    STRAIGHT_FACE,
    axle_with_height,
    dragged_twist,
    turned,
)

PAPER_C = 0.6  # c of a uniform contact, as the paper takes it


@dataclass(frozen=True, slots=True)
class Press:
    """A press on an object on a table.

    Raises ValueError for no load, friction < 0, or a contact at the CoM, where the
    object only translates.
    """

    body: ObjectModel
    friction: float  # of the pair object/support
    contact: Point  # [m] in B
    load: float  # [N] > 0
    # [m] of the ellipsoid that stands for the exact surface; None: the exact one
    rho: float | None = None

    def __post_init__(self) -> None:
        check_press(self.load, self.friction)
        check_point(self.contact, "contact")
        if self.contact == (0.0, 0.0):
            raise ValueError("the contact is at the CoM; the object only translates")

    @property
    def weight(self) -> float:
        """Weight N_o [N] of the object."""
        return self.body.mass * GRAVITY

    @property
    def cop(self) -> Point:
        """Centre of pressure in B [m] without a force along the support."""
        return pressed_cop(self.contact, self.load, self.weight)

    @property
    def axis(self) -> Point:
        """Unit vector of the heading axis, in B."""
        d = math.hypot(*self.contact)
        return (self.contact[0] / d, self.contact[1] / d)

    @property
    def lever(self) -> float:
        """Distance d from the CoP to the contact [m]."""
        return math.dist(self.contact, self.cop)

    @property
    def shift(self) -> float:
        """Displacement h mu_s [m] of the CoP along the force, if a force at the top
        drags the object straight.
        """
        return self.body.shape.top_height * self.friction

    @property
    def half_diagonal(self) -> float:
        """The paper's length r0 [m]: half the diagonal of a rectangle, or the radius of
        a disc.
        """
        return self.body.shape.circumradius

    def along(self, angle: float) -> Point:
        """Unit vector in B at ``angle`` [rad] from the heading axis."""
        return turned(self.axis, angle)

    def pressure(self, cop: Point) -> FacePressure:
        """Pressure under the object with its centre at ``cop`` [m] in B."""
        return face_pressure(self.body.shape, self.body.center_of_mass, cop)

    def tipping_margin(self, angle: float) -> float:
        """Tipping margin [half widths] under drag at ``angle`` [rad]. Negative if the
        object tips.
        """
        u = self.along(angle)
        return room_inside(
            self.body,
            (self.cop[0] + self.shift * u[0], self.cop[1] + self.shift * u[1]),
        )

    def twist(self, angle: float) -> Twist:
        """Twist of B's origin under a force at ``angle`` [rad], on the exact surface,
        or on the ellipsoid if ``rho`` is given.

        The twist has an arbitrary magnitude. Raises ValueError if the object tips.
        """
        if self.rho is not None:
            return self._ellipsoid_twist(self.rho, angle)
        height = self.body.shape.top_height
        return dragged_twist(
            self.pressure,
            self.friction,
            self.cop,
            self.contact,
            height,
            self.along(angle),
        )

    def _ellipsoid_twist(self, rho: float, angle: float) -> Twist:
        if self.tipping_margin(angle) < 0.0:
            raise ValueError("the centre of pressure leaves the base: the object tips")
        one = (np.array([p]) for p in (self.cop, self.contact, self.along(angle)))
        vx, vy, w = DraggedEllipsoid(rho, self.shift).slide(*one).twists[0]
        return Twist(float(vx), float(vy), float(w))

    def axle(self, angle: float, height: float | None = None) -> float:
        """Coordinate [m] of the virtual axle on the heading axis, from the CoM, under a
        force at ``angle`` [rad].

        It is found on the exact surface. ``height`` [m] is the height of the contact
        above the support: None stands for the top of the object, and 0 for a force in
        the support's plane. Raises ValueError if the object tips.
        """
        if height is None:
            height = self.body.shape.top_height
        at = axle_with_height(
            self.pressure, self.friction, self.cop, self.contact, height, angle
        )
        return at[0] * self.axis[0] + at[1] * self.axis[1]

    def steered(self, angle: float, backward: bool) -> tuple[float, float]:
        """Position of the virtual axle on the heading axis, and effective wheelbase
        [m].

        The axle is ahead of the CoM. Both values are means over a force to the left and
        one to the right. ``angle`` in [0, pi/2) is measured from the direction of
        motion, which is along the axis, or against it if ``backward``. Near zero the
        position is x_cop +- h mu - rho_x^2 / d, exact to first order. Raises ValueError
        if the object tips.
        """
        sign = -1.0 if backward else 1.0
        if angle < STRAIGHT_FACE:
            e = self.axis
            shift = sign * self.shift
            at = (self.cop[0] + shift * e[0], self.cop[1] + shift * e[1])
            if self.rho is None:
                variance = self.pressure(at).variance(e)
            else:
                variance = self.rho**2
            effective_wheelbase = variance / self.lever
            return shift - effective_wheelbase, effective_wheelbase
        ex, ey = self.axis
        ahead = 0.0
        effective_wheelbase = 0.0
        for side in (angle, -angle):
            twist = self.twist(math.pi - side if backward else side).moved_to(self.cop)
            along = twist.vx * ex + twist.vy * ey
            across = ex * twist.vy - ey * twist.vx
            ahead -= 0.5 * across / twist.w
            effective_wheelbase += 0.5 * math.tan(side) * sign * along / twist.w
        return ahead, effective_wheelbase

    def pivot(self, left: bool) -> Point:
        """Point [m] in B that stands still while a force across the heading axis turns
        the object.

        With ``left`` the force points to the left of the axis, otherwise to the right.
        The point is off the axis, since the drag acts at a height. Raises ValueError if
        the object tips.
        """
        twist = self.twist(0.5 * math.pi if left else -0.5 * math.pi)
        return (-twist.vy / twist.w, twist.vx / twist.w)

    def paper_distance(self, c: float = PAPER_C) -> float:
        """The paper's distance (c r0)^2 / d [m] from the centre of pressure to the
        axle.
        """
        return (c * self.half_diagonal) ** 2 / self.lever

    def paper_axle(self, c: float = PAPER_C) -> float:
        """Virtual axle [m] by the paper's formula: the same for every force and height."""
        return math.hypot(*self.cop) - self.paper_distance(c)

    def paper_printed(self, c: float = PAPER_C) -> float:
        """The paper's distance [m] of the axle from the CoM.

        It is a sum, which assumes that the centre of pressure lies between the axle and
        the CoM.
        """
        return math.hypot(*self.cop) + self.paper_distance(c)
