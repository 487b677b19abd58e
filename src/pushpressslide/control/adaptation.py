"""Adaptation of the controller: less steering while contacts are near slipping, more
force while servoed tips stand still.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.control import Vector3
from pushpressslide.core.motion import Limits
from pushpressslide.core.plan import Segment
from pushpressslide.core.scene import Scene
from pushpressslide.kernels.leading import eased_steering_scale

# scale of the steering: utilisation above which it falls, rates of fall and rise [1/s],
# and smallest value
STEERING_SCALE = (margins.CONE_USE, 4.0, 0.5, 0.3)
SLOW_SHARE = 0.5  # share of the commanded tip speed below which the tips push harder
FORCE_SCALE_RISE = 1.0  # [1/s] rate of the factor on their forces for tips at rest
MOST_FORCE_SCALE = 1.6
LED = 1e-4  # [m/s] below which tips count as not commanded to move


TipSpeed = tuple[Vector3, Vector3]
"""Commanded and measured velocity [m/s] of a tip."""


class Adaptation(NamedTuple):
    """Factors on steering and forces, from friction utilisation and the object's
    resistance.
    """

    steering_scale: float = 1.0  # share of the steering that may be used
    force_scale: float = 1.0  # on the contact forces
    drag: float | None = None  # [N] that slides the object; None: as planned

    def step(
        self,
        utilisation: float,
        speeds: Sequence[TipSpeed],
        drag: float | None,
        dt: float,
        max_scale: float = MOST_FORCE_SCALE,
    ) -> Adaptation:
        """Adaptation after a tick of ``dt`` [s].

        ``utilisation`` is the largest friction utilisation of all contacts, ``speeds``
        are those of the tips led by a servo, ``drag`` [N] is the identified drag, and
        ``max_scale`` the largest factor on the forces.
        """
        steering_scale = eased_steering_scale(
            self.steering_scale, utilisation, dt, STEERING_SCALE
        )
        return Adaptation(
            steering_scale, self._force_scale(speeds, dt, max_scale), drag
        )

    def force_gain(self, gain: float, planned: float) -> float:
        """Factor on the contact forces, including the contacts' own ``gain``.

        ``planned`` is the support friction [N] of the plan. The factor compensates for
        errors of friction or mass, and for a load that the object pushes.
        """
        ratio = 1.0
        if self.drag is not None:
            ratio = margins.drag_ratio(self.drag, planned)
        return gain * ratio * self.force_scale

    def _force_scale(
        self, speeds: Sequence[TipSpeed], dt: float, max_scale: float
    ) -> float:
        """Factor on the contact forces after a tick.

        A velocity servo alone cannot move an object whose resistance exceeds the
        servo's force.
        """
        led = 0.0
        moved = 0.0
        for (vx, vy, _), (x, y, _) in speeds:
            led += vx * vx + vy * vy
            moved += vx * x + vy * y
        if led < LED * LED:
            return self.force_scale
        slow = SLOW_SHARE - moved / led
        rise = FORCE_SCALE_RISE * max_scale / MOST_FORCE_SCALE
        return min(max_scale, max(1.0, self.force_scale + rise * slow * dt))


def most_force_scale(scene: Scene, limits: Limits, segment: Segment) -> float:
    """Largest factor on the forces of a ``segment``: more in a ``scene`` whose friction
    or mass may be larger than believed, within ``limits`` and the friction of presses.
    """
    smallest = scene.surest_drag
    if smallest == 1.0:
        return MOST_FORCE_SCALE
    allowed = limits.planned_force
    if any(contact.kind == "top" for contact in segment.contacts):
        press = sum(contact.load for contact in segment.contacts)
        allowed = scene.contact_friction * press
    allowed /= segment.drive.max_friction
    return max(MOST_FORCE_SCALE, min(MOST_FORCE_SCALE / smallest, allowed))
