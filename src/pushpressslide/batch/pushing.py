"""One contact on the ellipsoid, on arrays: motion cones, virtual axles, and the motion
of an object under a pusher with a given velocity.

Source: docs/mechanics.md, sections 2 to 4; ``mechanics.friction`` and
``mechanics.virtual_axle`` do the same for one object.
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
from pushpressslide.batch.rows import (
    NO_FIGURES,
    Figures,
    answers,
    figures,
    figures_of,
    grouped,
    halves,
)
from pushpressslide.core.arrays import Array
from pushpressslide.kernels import compliant_tip
from pushpressslide.kernels.pushing import motion_cone, pushed_with_force

# how a pusher moves an object: the kinds of ``mechanics.friction.PushKind``, as numbers
STICK = compliant_tip.STICK
SLIP_LEFT = compliant_tip.SLIP_LEFT
SLIP_RIGHT = compliant_tip.SLIP_RIGHT
SEPARATE = compliant_tip.FREE


class PushOutcomes(NamedTuple):
    """Results of pushes, as ``mechanics.friction.PushOutcome``."""

    kind: NDArray[np.int8]  # (...) STICK, SLIP_LEFT, SLIP_RIGHT or SEPARATE
    force: Array  # (..., 2) [N] on the object; zero when separated
    twist: Array  # (..., 3) of the centre of pressure, [m/s] and [rad/s]
    slip: Array  # (...) [m/s] of the pusher along the object's face, to the left


class SideContact:
    """One side contact on an ellipsoid. Point, normal and friction may have any leading
    shape.
    """

    def __init__(
        self,
        lever: ArrayLike,
        normal: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        max_force: ArrayLike = 1.0,
    ) -> None:
        """Prepare the contact.

        ``lever`` (..., 2) [m], from the centre of pressure to the contact, and
        ``normal`` (..., 2), the unit inward normal, are in B. ``friction`` (...) is
        that of the contact, ``rho`` (...) [m] that of the ellipsoid, and ``max_force``
        (...) [N] is mu_s N. Raises ValueError for other shapes, friction < 0 and rho or
        max_force <= 0.
        """
        r, n, mu, length, force = figures(lever, normal, friction, rho, max_force)
        check_last(r, (2,), "lever")
        check_last(n, (2,), "normal")
        check_units(n)
        check_frictions(mu)
        check_positive(length, "rho", "m")
        check_positive(force, "max_force", "N")
        self._contact = figures_of((halves(r), halves(n), mu, length), force)
        self.shape = self._contact.shape
        """The leading shape of the contact."""

    def motion_cones(self) -> tuple[Array, Array]:
        """Right and left edges (..., 2) of the cone of velocities at which the contact
        sticks, as in ``mechanics.friction.motion_cone``.
        """
        table, like = self._contact
        contact = Figures(table[..., :-1], like[:1])
        out = answers(motion_cone, NO_FIGURES, contact, columns=4)
        return out[..., :2], out[..., 2:]

    def push(self, velocities: ArrayLike) -> PushOutcomes:
        """Results of pushers with ``velocities`` (..., 2) [m/s], as
        ``mechanics.friction.push_outcome``. A velocity that is not finite separates.
        """
        (rows,) = figures(velocities)
        check_last(rows, (2,), "velocities")
        out = answers(pushed_with_force, grouped(rows), self._contact, columns=7)
        kind = out[..., 0].astype(np.int8)
        return PushOutcomes(kind, out[..., 1:3], out[..., 3:6], out[..., 6])


def virtual_axles(
    contacts: ArrayLike,
    cops: ArrayLike,
    rho: ArrayLike,
    shift: ArrayLike = 0.0,
) -> Array:
    """Virtual axles (..., 2) [m] in B of contacts on the ellipsoid, the same for every
    force.

    An axle lies at rho^2/d - ``shift`` [m] from the centre of pressure, away from the
    contact. ``contacts`` and ``cops`` (..., 2) [m] are in B, ``rho`` (...) is in [m].
    ``shift`` (...) [m] is the displacement of the centre of pressure by the drag, which
    acts at the height of the press; it is 0 for a push
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
