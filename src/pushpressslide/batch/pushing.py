"""One contact on the ellipsoid, on arrays: motion cones, virtual axles, and how a pusher
with a given velocity moves an object.

Source: docs/mechanics.md, sections 2 to 4; ``mechanics.friction`` and
``mechanics.virtual_axle`` for one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import (
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.elementwise import (
    columns_of,
    figures,
    leading_shape,
    table,
    values,
)
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, where

# how a pusher moves an object: the kinds of ``mechanics.friction.PushKind``, as numbers
STICK = 0
SLIP_LEFT = 1
SLIP_RIGHT = 2
SEPARATE = 3


class Vector(NamedTuple):
    """A vector in B."""

    x: Column
    y: Column


class Contact(NamedTuple):
    """One side contact on an ellipsoid, as columns; in B."""

    rx: Column  # [m] from the centre of pressure to the contact
    ry: Column
    nx: Column  # unit inward normal
    ny: Column
    friction: Column
    rho: Column  # [m]
    max_force: Column  # [N] mu_s N


class PushOutcomes(NamedTuple):
    """What pushers do to an object; as ``mechanics.friction.PushOutcome``."""

    kind: NDArray[np.int8]  # (...) STICK, SLIP_LEFT, SLIP_RIGHT or SEPARATE
    force: Array  # (..., 2) [N] on the object; zero when separated
    twist: Array  # (..., 3) of the centre of pressure, [m/s] and [rad/s]
    slip: Array  # (...) [m/s] of the pusher along the object's face, to the left


class SideContact:
    """One side contact on an ellipsoid; figures of any leading shape."""

    def __init__(
        self,
        lever: ArrayLike,
        normal: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        max_force: ArrayLike = 1.0,
    ) -> None:
        """Prepare the contact.

        ``lever`` (..., 2) [m] from the centre of pressure to the contact and unit
        inward ``normal`` (..., 2) in B, ``friction`` (...), ``rho`` (...) [m],
        ``max_force`` (...) [N] mu_s N. Raises ValueError for other shapes, friction < 0
        and rho or max_force <= 0.
        """
        r, n, mu, length, force = figures(lever, normal, friction, rho, max_force)
        check_last(r, (2,), "lever")
        check_last(n, (2,), "normal")
        check_units(n)
        check_frictions(mu)
        check_positive(length, "rho", "m")
        check_positive(force, "max_force", "N")
        self._contact = Contact(
            r[..., 0], r[..., 1], n[..., 0], n[..., 1], mu, length, force
        )
        self.shape = leading_shape(self._contact)
        """The leading shape of the contact."""

    def motion_cones(self) -> tuple[Array, Array]:
        """Return the right and left edges (..., 2) of the velocities at which the
        contact sticks, as ``mechanics.friction.motion_cone``.
        """
        contact = columns_of(self._contact, self.shape)
        right, left = values(motion_cone, (contact,), self.shape, (2, 2))
        return right, left

    def push(self, velocities: ArrayLike) -> PushOutcomes:
        """Return what pushers with ``velocities`` (..., 2) [m/s] do, as
        ``mechanics.friction.push_outcome``; a velocity that is not finite separates.
        """
        (rows,) = figures(velocities)
        check_last(rows, (2,), "velocities")
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        arguments = (table(Vector, rows, shape), columns_of(self._contact, shape))
        kind, force, twist, slip = values(pushed, arguments, shape, (0, 2, 3, 0))
        return PushOutcomes(kind.astype(np.int8), force, twist, slip)


def velocity_of_force(c: Contact, fx: Column, fy: Column) -> Vector:
    """Return G f: the contact's velocity per unit of the CoP's velocity per force."""
    k = (c.rx * fy - c.ry * fx) * (1.0 / (c.rho * c.rho))
    return Vector(fx - k * c.ry, fy + k * c.rx)


def motion_cone(c: Contact) -> Columns:
    """Return the right and the left edge G f_-, G f_+ of the motion cone."""
    right = velocity_of_force(c, c.nx + c.friction * c.ny, c.ny - c.friction * c.nx)
    left = velocity_of_force(c, c.nx - c.friction * c.ny, c.ny + c.friction * c.nx)
    return right.x, right.y, left.x, left.y


def pushed(v: Vector, c: Contact) -> Columns:
    """Return kind, force, twist and slip of a pusher with velocity ``v``."""
    approach = v.x * c.nx + v.y * c.ny
    across = c.nx * v.y - c.ny * v.x
    meets = (approach > 0.0) & np.isfinite(v.x) & np.isfinite(v.y)
    square = c.rho * c.rho + c.rx * c.rx + c.ry * c.ry
    k = (c.rx * v.y - c.ry * v.x) / square
    fx = v.x + k * c.ry
    fy = v.y - k * c.rx
    slips = c.friction * (fx * c.nx + fy * c.ny) < np.abs(c.nx * fy - c.ny * fx)
    right_x, right_y, left_x, left_y = motion_cone(c)
    # an edge that leads away from the pusher cannot be passed by a velocity towards
    # the object
    leads_in = left_x * c.nx + left_y * c.ny > 0.0
    to_left = leads_in & (left_x * v.y - left_y * v.x > 0.0)
    edge_x = where(to_left, left_x, right_x)
    edge_y = where(to_left, left_y, right_y)
    side = where(to_left, c.friction, -c.friction)
    m = approach / (edge_x * c.nx + edge_y * c.ny)
    fx = where(slips, m * (c.nx - side * c.ny), fx)
    fy = where(slips, m * (c.ny + side * c.nx), fy)
    edge_across = c.nx * edge_y - c.ny * edge_x
    slip = where(slips, across - m * edge_across, 0.0)
    slip = where(meets, slip, across)
    vx = where(meets, fx, 0.0)
    vy = where(meets, fy, 0.0)
    w = (c.rx * vy - c.ry * vx) * (1.0 / (c.rho * c.rho))
    norm = np.sqrt(vx * vx + vy * vy + (c.rho * w) * (c.rho * w))
    scale = where(norm > 0.0, c.max_force / norm, 0.0)
    moved = where(slips, where(to_left, SLIP_LEFT, SLIP_RIGHT), STICK)
    kind = where(meets, moved, SEPARATE)
    return kind, scale * vx, scale * vy, vx, vy, w, slip


def virtual_axles(
    contacts: ArrayLike,
    cops: ArrayLike,
    rho: ArrayLike,
    shift: ArrayLike = 0.0,
) -> Array:
    """Return the virtual axles (..., 2) [m] in B of contacts on the ellipsoid, the same
    for every force: rho^2/d beyond the centre of pressure, ``shift`` [m] towards the
    contact.

    ``contacts`` and ``cops`` (..., 2) [m] in B, ``rho`` (...) [m]; ``shift`` (...) is
    how far the drag of a press at a height moves the centre of pressure, 0 for a push
    (``mechanics.virtual_axle.axle_distance``, ``rom.unicycle.Unicycle``). Raises
    ValueError for a contact at its centre of pressure.
    """
    points, centers, length, ahead = figures(contacts, cops, rho, shift)
    check_last(points, (2,), "contacts")
    check_last(centers, (2,), "cops")
    check_positive(length, "rho", "m")
    lever = points - centers
    d = np.hypot(lever[..., 0], lever[..., 1])
    check_positive(d, "lever", "m")
    axis = lever / d[..., None]
    out: Array = centers + (ahead - length * length / d)[..., None] * axis
    return out
