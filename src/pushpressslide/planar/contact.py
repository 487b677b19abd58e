"""Contacts of massless, compliant tips with an object, and their response to its twist.

Numbers are plain floats, in frame B, with positions relative to the centre of pressure.
The laws are those of ``kernels.compliant_tip``.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from pushpressslide.core.pose import Point
from pushpressslide.kernels import compliant_tip
from pushpressslide.kernels.compliant_tip import (
    PULL,
    Touch,
    press_touch,
    side_touch,
    tip_velocity,
    wedged_touch,
)

ContactStatus = Literal["free", "stick", "slip", "slip_left", "slip_right", "pull"]
STATUSES: tuple[ContactStatus, ...] = (
    "stick",
    "slip_left",
    "slip_right",
    "free",
    "slip",
    "pull",
)
"""Names of the statuses, in the order of their numbers in ``kernels.compliant_tip``."""


class Response(NamedTuple):
    """A contact's force [N] on the object, and the decrease [N s/m] of its components
    per velocity of the tip's centre.
    """

    force: Point
    slope: tuple[float, float, float, float]  # xx, xy, yx, yy
    status: ContactStatus


FREE = Response((0.0, 0.0), (0.0, 0.0, 0.0, 0.0), "free")


class TipLaw(NamedTuple):
    """Law f = f_0 - B v of a tip in the plane."""

    axis: Point  # unit; the other axis is to its left
    force: Point  # [N] f_0 along the two axes
    damping: Point  # [N s/m] B along them, > 0

    def velocity(self, force: Point) -> Point:
        """Velocity [m/s] of a tip that exerts ``force`` [N], both in B."""
        return tip_velocity(force, self)


class SideContact(NamedTuple):
    """A tip at a side face. The axis of its law is the inward normal."""

    point: Point  # [m] of the face
    # [m] of the tip; it turns with the object, so that it does not roll along the face
    center: Point
    law: TipLaw
    friction: float  # of the pair tip/object
    # [m/s] largest speed of the tip towards the face: its gap over the tick
    approach: float = 0.0

    def touch(self, vx: float, vy: float, w: float) -> Touch:
        """Force, slope and status of the contact under an object's twist at the CoP."""
        return side_touch(vx, vy, w, self)

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Force under an object's ``twist`` at the CoP."""
        return _named(self.touch(*twist))


def side_contact(
    tip: Point,
    tip_radius: float,
    gap: float,
    law: TipLaw,
    friction: float,
    dt: float,
) -> SideContact:
    """Contact of a tip with its centre at ``tip`` [m], a distance ``gap`` [m] before a
    side, in a tick of ``dt`` [s].

    The axis of the law is the side's inward normal.
    """
    point, center, _, _, approach = compliant_tip.side_contact(
        tip, tip_radius, gap, law, friction, dt
    )
    return SideContact(point, center, law, friction, approach)


class WedgedContact(NamedTuple):
    """A tip in a notch, between its own side and another wall.

    The tip touches only one of the two if this contact also keeps it out of the other.
    Otherwise it sticks between them.
    """

    own: SideContact
    wall: SideContact

    @property
    def point(self) -> Point:
        """Point [m] of action of the forces: the tip's centre."""
        return self.own.center

    @property
    def center(self) -> Point:
        """Position of the tip's centre in the plane [m]."""
        return self.own.center

    def touch(self, vx: float, vy: float, w: float) -> Touch:
        """Force, slope and status of the contact under an object's twist at the CoP."""
        return wedged_touch(vx, vy, w, self.own, self.wall)

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Force under an object's ``twist`` at the CoP."""
        return _named(self.touch(*twist))


class TopContact(NamedTuple):
    """A tip pressed on the top face."""

    point: Point  # [m] of the contact, below the tip's centre
    law: TipLaw
    limit: float  # [N] friction of the pair tip/object times the press, > 0

    @property
    def center(self) -> Point:
        """Position of the tip's centre in the plane [m]."""
        return self.point

    def touch(self, vx: float, vy: float, w: float) -> Touch:
        """Force, slope and status of the contact under an object's twist at the CoP."""
        return press_touch(vx, vy, w, *self)

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Force under an object's ``twist`` at the CoP: the force that holds the tip,
        or the limiting friction if the tip slips.
        """
        return _named(self.touch(*twist))


class Pull(NamedTuple):
    """A constant force: a weight in the plane."""

    point: Point  # [m] where it acts
    force: Point  # [N]

    @property
    def center(self) -> Point:
        """Point [m] at which the force acts."""
        return self.point

    def touch(self, vx: float, vy: float, w: float) -> Touch:
        """Force, slope and status, the same for every twist."""
        return self.force, (0.0, 0.0, 0.0, 0.0), PULL, self.point, self.point

    def response(self, twist: tuple[float, float, float]) -> Response:
        """The force, the same for every twist."""
        return _named(self.touch(*twist))


Contact = SideContact | WedgedContact | TopContact | Pull


def touched(vx: float, vy: float, w: float, contact: Contact) -> Touch:
    """Force, slope and status of a contact under an object's twist at the CoP."""
    return contact.touch(vx, vy, w)


def _named(touch: Touch) -> Response:
    """Response of a contact, with its status by name."""
    force, slope, status, _, _ = touch
    return Response(force, slope, STATUSES[status])
