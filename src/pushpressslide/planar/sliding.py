"""Motion of an object on its support under compliant tips: the twist at which all
forces balance.

``kernels.sliding`` computes a quasi-static tick (docs/mechanics.md, sections 1 to 3) on
the exact limit surface. Everything is in frame B, about the centre of pressure.
"""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.kernels import sliding
from pushpressslide.kernels.sliding import REST as REST
from pushpressslide.kernels.support_friction import Friction as Taken
from pushpressslide.planar.contact import Contact, touched
from pushpressslide.planar.support import Friction
from pushpressslide.planar.support_friction import Vector
from pushpressslide.planar.uneven_friction import UnevenFriction

AnyFriction = Friction | UnevenFriction


def slide(
    friction: AnyFriction, limit: float, contacts: Sequence[Contact], guess: Vector
) -> Vector:
    """Twist [m/s, rad/s] of the CoP at which the forces of the support and of
    ``contacts`` balance, to 1e-9 of mu_s N.

    ``limit`` [N] is mu_s N, ``guess`` the twist of the previous tick. At rest the
    object creeps, by less than a few times ``CREEP``.
    """
    support = (friction, limit, friction.rho)
    return sliding.slide(guess, contacts, support, (_resistance, touched))


def _resistance(
    vx: float, vy: float, w: float, friction: AnyFriction, limit: float, sloped: bool
) -> Taken:
    """Wrench that slides the object, and its slope. The slope is 0 if it is not
    requested.
    """
    if not sloped:
        wrench = friction.wrench((vx, vy, w), limit)
        return (*wrench, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    wrench, slope = friction.wrench_and_slope((vx, vy, w), limit)
    (xx, xy, xw), (_, yy, yw), (_, _, ww) = slope
    return (*wrench, xx, xy, xw, yy, yw, ww)
