"""The motion of an object on its support under compliant tips: the twist at which all
forces balance.

One tick of quasi-statics (docs/mechanics.md, sections 1 to 3): friction on the exact
limit surface, contacts that stick, slip or let go, no inertia. Frame B, about the
centre of pressure.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pushpressslide.mechanics.balance import (
    BALANCE,
    CLOSE,
    CREEP,
    DRAG_SPEED,
    HALVINGS,
    SOFTENING,
    STEPS,
    SURE,
    TRIALS,
)
from pushpressslide.planar.contact import Contact, Response
from pushpressslide.planar.support import Friction
from pushpressslide.planar.support_friction import Matrix, Vector

REST: Vector = (0.0, 0.0, 0.0)


def slide(
    friction: Friction, limit: float, contacts: Sequence[Contact], guess: Vector
) -> Vector:
    """Return the twist (m/s, rad/s) of the CoP at which support and ``contacts``
    balance, to 1e-9 of mu N.

    ``limit`` [N] is mu N, ``guess`` the twist of the tick before; at rest the object
    creeps, by less than ``CREEP`` times a few. Newton's method from the guess, two
    steps long while no contact changes, with one slope. Where it fails the object is let go from
    rest, held back by drag, until it moves in balance: so that the motion is found that
    the object would take up. Always ends, after ``TRIALS`` without balance.
    """
    for contact in contacts:
        if contact.response(REST).status != "free":
            break
    else:
        return REST
    balance = _Balance(friction, limit, contacts)
    found = balance.solved(guess)
    twist = REST
    drag = limit / DRAG_SPEED
    for _ in range(TRIALS):
        if found is not None:
            return found
        moved = replace(balance, drag=drag, origin=twist).solved(twist)
        if moved is None:
            drag *= 4.0
            continue
        twist = moved
        drag = 0.5 * drag
        found = balance.solved(twist)
    return twist


@dataclass(frozen=True, slots=True)
class _Balance:
    """What support friction and drag take, less what the contacts give, as a function
    of the twist.
    """

    friction: Friction
    limit: float  # [N]
    contacts: Sequence[Contact]
    drag: float = 0.0  # [N s/m] that holds the object back to its twist at the origin
    origin: Vector = REST

    def left_over(self, twist: Vector) -> Vector:
        """Return the force [N] and moment [N m] that nothing balances."""
        return self._less(twist, self._responses(twist))

    def left_over_and_slope(self, twist: Vector) -> tuple[Vector, Matrix]:
        """Return the same and its derivative by the twist."""
        wrench, slope = self.friction.wrench_and_slope(twist, self.limit)
        fx, fy, tau = self._dragged(wrench, twist)
        by_fx, by_fy, by_tau = slope
        for contact in self.contacts:
            (gx, gy), (xx, xy, yx, yy), status = contact.response(twist)
            if status == "free":
                continue
            px, py = contact.point
            qx, qy = contact.center
            fx = fx - gx
            fy = fy - gy
            tau = tau - px * gy + py * gx
            xw = xy * qx - xx * qy
            yw = yy * qx - yx * qy
            by_fx[0] += xx
            by_fx[1] += xy
            by_fx[2] += xw
            by_fy[0] += yx
            by_fy[1] += yy
            by_fy[2] += yw
            by_tau[0] += px * yx - py * xx
            by_tau[1] += px * yy - py * xy
            by_tau[2] += px * yw - py * xw
        vx, vy, w = twist
        turn = self.friction.rho * self.friction.rho
        soft = self.drag + SOFTENING * self.limit / (
            math.sqrt(vx * vx + vy * vy + turn * w * w) + CREEP
        )
        by_fx[0] += soft
        by_fy[1] += soft
        by_tau[2] += soft * turn
        return (fx, fy, tau), slope

    def _responses(self, twist: Vector) -> list[Response]:
        return [contact.response(twist) for contact in self.contacts]

    def _less(self, twist: Vector, responses: Sequence[Response]) -> Vector:
        """Return what the friction takes, less what the contacts give."""
        wrench = self.friction.wrench(twist, self.limit)
        fx, fy, tau = self._dragged(wrench, twist)
        for contact, response in zip(self.contacts, responses, strict=True):
            gx, gy = response.force
            px, py = contact.point
            fx = fx - gx
            fy = fy - gy
            tau = tau - px * gy + py * gx
        return fx, fy, tau

    def size(self, force: Vector) -> float:
        """Return the size [N] of a force and moment."""
        return math.hypot(force[0], force[1], force[2] / self.friction.rho)

    def solved(self, twist: Vector) -> Vector | None:
        """Return the balanced twist that Newton's method reaches from ``twist``, None
        if it does not.
        """
        force, slope = self.left_over_and_slope(twist)
        for _ in range(STEPS):
            size = self.size(force)
            if size < BALANCE * self.limit:
                return twist
            step = _newton_step(slope, force)
            if step is None:
                return None
            end = _moved(twist, step, 1.0)
            if size < CLOSE * self.limit:
                last = self._ended(end, size, slope)
                if last is not None:
                    return last
            twist = end
            ahead, slope = self.left_over_and_slope(twist)
            if self._too_far(ahead, force, step):
                twist = self._shortened(twist, force, step)
                ahead, slope = self.left_over_and_slope(twist)
            force = ahead
        return None

    def _ended(self, twist: Vector, before: float, slope: Matrix) -> Vector | None:
        """Return the balanced twist near ``twist``, to which one step of Newton's
        method led from a force of size ``before`` [N]; None if one more with the same
        slope may not do.

        What it leaves over falls by twice what the first step left over of the force,
        while the contacts go on as they are.
        """
        responses = self._responses(twist)
        ahead = self._less(twist, responses)
        size = self.size(ahead)
        allowed = BALANCE * self.limit
        if size < allowed:
            return twist
        if 2.0 * size * size > SURE * allowed * before:
            return None
        step = _newton_step(slope, ahead)
        if step is None:
            return None
        end = _moved(twist, step, 1.0)
        for contact, response in zip(self.contacts, responses, strict=True):
            if contact.response(end).status != response.status:
                return None
        return end

    def _dragged(self, wrench: Vector, twist: Vector) -> Vector:
        if self.drag == 0.0:
            return wrench
        vx, vy, w = (
            self.drag * (a - b) for a, b in zip(twist, self.origin, strict=True)
        )
        return (
            wrench[0] + vx,
            wrench[1] + vy,
            wrench[2] + self.friction.rho * self.friction.rho * w,
        )

    def _too_far(self, ahead: Vector, force: Vector, step: Vector) -> bool:
        """Whether a step leads beyond balance: the force ahead points back, by more
        than half of what pointed on.
        """
        on = -_dot(force, step)
        return (
            on > 0.0
            and 2.0 * _dot(ahead, step) > on
            and 2.0 * self.size(ahead) > self.size(force)
        )

    def _shortened(self, end: Vector, force: Vector, step: Vector) -> Vector:
        """Return the twist on the way to ``end``, by bisection, where little force is
        left over along ``step``.
        """
        low = -1.0
        high = 0.0
        twist = end
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            twist = _moved(end, step, share)
            ahead = self.left_over(twist)
            if self._too_far(ahead, force, step):
                high = share
            elif 2.0 * _dot(ahead, step) < _dot(force, step) and 2.0 * self.size(
                ahead
            ) > self.size(force):
                low = share
            else:
                break
        return twist


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _moved(twist: Vector, step: Vector, share: float) -> Vector:
    return (
        twist[0] + share * step[0],
        twist[1] + share * step[1],
        twist[2] + share * step[2],
    )


def _newton_step(slope: Matrix, force: Vector) -> Vector | None:
    """Return the step x with slope x = -force, by Cramer's rule.

    None where the slope is singular.
    """
    (a, b, c), (d, e, f), (g, h, i) = slope
    A = e * i - f * h
    B = f * g - d * i
    C = d * h - e * g
    determinant = a * A + b * B + c * C
    if determinant == 0.0:
        return None
    x = -force[0] / determinant
    y = -force[1] / determinant
    z = -force[2] / determinant
    return (
        A * x + (c * h - b * i) * y + (b * f - c * e) * z,
        B * x + (a * i - c * g) * y + (c * d - a * f) * z,
        C * x + (b * g - a * h) * y + (a * e - b * d) * z,
    )
