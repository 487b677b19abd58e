"""What a massless, compliant tip does at a contact: its force on the object as a
function of the object's twist.

The tip's own law is f = f_0 - B v, B > 0 along two axes of the plane: a force, a
spring, taken at the end of the tick, and a damper. With it each contact's force is an
explicit function of the velocity that the object carries the tip's centre with: there
is nothing to iterate between stick, slip and separation (docs/mechanics.md, section 3).
Plain floats; frame B, places relative to the centre of pressure.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from pushpressslide.core.pose import Point

ContactStatus = Literal["free", "stick", "slip", "slip_left", "slip_right", "pull"]

ENTERING = 1e-9  # [m/s] into a wall, that is rounding
PARALLEL = 1e-3  # sine of the angle between two walls below which they are parallel
ON_RIM = 1e-12  # of the limit: force beyond it at which a slip is found
SLIP_STEPS = 30  # one for equal dampings


class Response(NamedTuple):
    """A contact's force on the object [N], and what its components lose per velocity of
    the tip's centre [N s/m].
    """

    force: Point
    slope: tuple[float, float, float, float]  # xx, xy, yx, yy
    status: ContactStatus


FREE = Response((0.0, 0.0), (0.0, 0.0, 0.0, 0.0), "free")


class TipLaw(NamedTuple):
    """f = f_0 - B v of one tip in the plane."""

    axis: Point  # unit; the other axis is to its left
    force: Point  # [N] f_0 along the two axes
    damping: Point  # [N s/m] B along them, > 0

    def velocity(self, force: Point) -> Point:
        """Return the velocity [m/s] of a tip that exerts ``force`` [N], both in B."""
        (ax, ay), (f1, f2), (d1, d2) = self
        v1 = (f1 - (ax * force[0] + ay * force[1])) / d1
        v2 = (f2 - (ax * force[1] - ay * force[0])) / d2
        return (ax * v1 - ay * v2, ay * v1 + ax * v2)


class SideContact(NamedTuple):
    """A tip at a side face; its law's axis is the inward normal."""

    point: Point  # [m] of the face
    # [m] of the tip; it turns with the object, so that it does not roll along the face
    center: Point
    law: TipLaw
    friction: float  # of the pair tip/object
    # [m/s] at which the tip may come nearer to the face: its gap over the tick
    approach: float = 0.0

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Return the force under an object's ``twist`` at the CoP.

        The normal force is what keeps the tip out of the face, or none; it is free of
        the friction, which is what holds the tip on the face, up to the cone's edge.
        """
        _, (x, y), law, friction, approach = self
        axis, (fn, ft), (bn, bt) = law
        nx, ny = axis
        vx, vy, w = twist
        vx = vx - w * y
        vy = vy + w * x
        fn = fn - bn * (nx * vx + ny * vy + approach)
        if fn <= 0.0:
            return FREE
        ft = ft - bt * (nx * vy - ny * vx)
        edge = friction * fn
        if -edge <= ft <= edge:
            return Response(
                (nx * fn - ny * ft, ny * fn + nx * ft),
                _turned(axis, bn, 0.0, bt),
                "stick",
            )
        mu = math.copysign(friction, ft)
        ex = nx - mu * ny
        ey = ny + mu * nx
        status: ContactStatus = "slip_left" if ft > 0.0 else "slip_right"
        return Response(
            (fn * ex, fn * ey),
            (bn * ex * nx, bn * ex * ny, bn * ey * nx, bn * ey * ny),
            status,
        )


def side_contact(
    tip: Point,
    tip_radius: float,
    gap: float,
    law: TipLaw,
    friction: float,
    dt: float,
) -> SideContact:
    """Return the contact of a tip whose centre is at ``tip`` [m], ``gap`` [m] before
    the side whose inward normal is the law's axis, in a tick of ``dt`` [s].
    """
    nx, ny = law.axis
    out = gap + tip_radius
    point = (tip[0] + out * nx, tip[1] + out * ny)
    center = (tip[0] + gap * nx, tip[1] + gap * ny)
    return SideContact(point, center, law, friction, gap / dt)


class WedgedContact(NamedTuple):
    """A tip between its own side and another wall of a notch.

    It touches the one that alone keeps it out of both; where neither does, it sticks
    between them.
    """

    own: SideContact
    wall: SideContact

    @property
    def point(self) -> Point:
        """Where the forces are taken to act: at the tip's centre [m]."""
        return self.own.center

    @property
    def center(self) -> Point:
        """Place of the tip's centre in the plane [m]."""
        return self.own.center

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Return the force under an object's ``twist`` at the CoP."""
        for one, other in ((self.own, self.wall), (self.wall, self.own)):
            response = one.response(twist)
            if not _enters(one, other, response, twist):
                return response
        return self._stuck(twist)

    def _stuck(self, twist: tuple[float, float, float]) -> Response:
        """Return the force of a tip that closes both gaps and moves with the object."""
        ax, ay = self.own.law.axis
        bx, by = self.wall.law.axis
        a = self.own.approach
        b = self.wall.approach
        size = ax * by - ay * bx
        if abs(size) < PARALLEL:
            return self.own.response(twist)
        closing = ((a * by - b * ay) / size, (b * ax - a * bx) / size)
        vx = twist[0] - twist[2] * self.own.center[1] + closing[0]
        vy = twist[1] + twist[2] * self.own.center[0] + closing[1]
        law = self.own.law
        bn, bt = law.damping
        fn = law.force[0] - bn * (ax * vx + ay * vy)
        ft = law.force[1] - bt * (ax * vy - ay * vx)
        force = (ax * fn - ay * ft, ay * fn + ax * ft)
        return Response(force, _turned(law.axis, bn, 0.0, bt), "stick")


def _enters(
    touched: SideContact,
    other: SideContact,
    response: Response,
    twist: tuple[float, float, float],
) -> bool:
    """Return whether a tip that touches one side would go into another one."""
    ux, uy = touched.law.velocity(response.force)
    cx, cy = touched.center
    nx, ny = other.law.axis
    into = nx * (ux - twist[0] + twist[2] * cy) + ny * (uy - twist[1] - twist[2] * cx)
    return into > other.approach + ENTERING


class TopContact(NamedTuple):
    """A tip pressed on the top face."""

    point: Point  # [m] of the contact, below the tip's centre
    law: TipLaw
    limit: float  # [N] friction of the pair tip/object times the press, > 0

    @property
    def center(self) -> Point:
        """Place of the tip's centre in the plane [m]."""
        return self.point

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Return the force under an object's ``twist`` at the CoP: what holds the tip,
        or the limit against its slip.
        """
        (x, y), law, limit = self
        axis, (f1, f2), (d1, d2) = law
        ax, ay = axis
        vx, vy, w = twist
        vx = vx - w * y
        vy = vy + w * x
        f1 = f1 - d1 * (ax * vx + ay * vy)
        f2 = f2 - d2 * (ax * vy - ay * vx)
        if math.hypot(f1, f2) <= limit:
            s11 = d1
            s12 = 0.0
            s22 = d2
            status: ContactStatus = "stick"
        else:
            f1, f2, per_force = _sliding_force((f1, f2), (d1, d2), limit)
            t1 = -f2 / limit
            t2 = f1 / limit  # the force can only turn
            k = 1.0 / (per_force + t1 * t1 / d1 + t2 * t2 / d2)
            s11 = k * t1 * t1
            s12 = k * t1 * t2
            s22 = k * t2 * t2
            status = "slip"
        return Response(
            (ax * f1 - ay * f2, ay * f1 + ax * f2),
            _turned(axis, s11, s12, s22),
            status,
        )


class Pull(NamedTuple):
    """A force that is always there: a weight in the plane."""

    point: Point  # [m] where it acts
    force: Point  # [N]

    @property
    def center(self) -> Point:
        """Place where it acts [m]."""
        return self.point

    def response(self, twist: tuple[float, float, float]) -> Response:
        """Return the force, whatever the twist."""
        return Response(self.force, (0.0, 0.0, 0.0, 0.0), "pull")


Contact = SideContact | WedgedContact | TopContact | Pull


def _turned(
    axis: Point, s11: float, s12: float, s22: float
) -> tuple[float, float, float, float]:
    """Return a symmetric matrix, given along ``axis`` and to its left, in B: xx, xy,
    yx, yy.
    """
    if s11 == s22 and s12 == 0.0:
        return (s11, 0.0, 0.0, s11)
    x, y = axis
    xy = x * y * (s11 - s22) + (x * x - y * y) * s12
    return (
        x * x * s11 - 2.0 * x * y * s12 + y * y * s22,
        xy,
        xy,
        y * y * s11 + 2.0 * x * y * s12 + x * x * s22,
    )


def _sliding_force(
    holding: Point, damping: Point, limit: float
) -> tuple[float, float, float]:
    """Return the force of size ``limit`` along the slip that it leaves, and slip per
    force [m/(N s)].

    ``holding`` is the force that would prevent the slip s; D s = holding - f and s = m
    f, so that f_i = holding_i / (1 + d_i m): 1/|f| is concave in m, and Newton's steps
    from m = 0 do not overshoot.
    """
    m = 0.0
    for _ in range(SLIP_STEPS):
        f1 = holding[0] / (1.0 + damping[0] * m)
        f2 = holding[1] / (1.0 + damping[1] * m)
        size = math.hypot(f1, f2)
        if size <= limit * (1.0 + ON_RIM):
            break
        fall = f1 * f1 * damping[0] / (1.0 + damping[0] * m) + f2 * f2 * damping[1] / (
            1.0 + damping[1] * m
        )
        m += (size / limit - 1.0) * size * size / fall
    return f1, f2, m
