"""Friction at one contact: its cone, its motion cone, and its response to a velocity.

Source: docs/mechanics.md, section 3. The left tangent t = J n is the inward normal n
turned by +90 degrees; mu is the friction of the pair end effector/object.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Twist
from pushpressslide.kernels import pushing
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

PushKind = Literal["stick", "slip_left", "slip_right", "separate"]
KINDS: tuple[PushKind, ...] = ("stick", "slip_left", "slip_right", "separate")
"""Names of the statuses, in the order of their numbers in ``kernels.pushing``."""


def cone_edges(normal: Point, mu: float) -> tuple[Point, Point]:
    """Right and left edge (f_-, f_+) = n -+ mu t of a side contact's friction cone."""
    return pushing.cone_edges(normal, mu)


def cone_margin(force: Point, normal: Point, mu: float) -> float:
    """Margin mu f_n - |f_t| [N] of a side contact: >= 0 inside the cone, negative
    outside.
    """
    return pushing.cone_margin(force, normal, mu)


def press_margin(force: Point, normal_force: float, mu: float) -> float:
    """Margin mu N_i - |f| [N] of a top contact pressed with ``normal_force`` [N]. Not
    negative if the contact sticks.
    """
    return mu * normal_force - math.hypot(force[0], force[1])


def utilisation_margin(mu: float, utilisation: float) -> float:
    """Angle [rad] between a force with friction ``utilisation`` and the edge of the
    cone of ``mu``. Negative outside.
    """
    return math.atan(mu) - math.atan(utilisation * mu)


def force_angle(force: Point, axis: Point) -> float:
    """Angle [rad] of ``force`` from ``axis``, positive to the left, in (-pi, pi]."""
    return math.atan2(cross(axis, force), axis[0] * force[0] + axis[1] * force[1])


def motion_cone(
    lever: Point, rho: float, normal: Point, mu: float
) -> tuple[Point, Point]:
    """Right and left edge (G f_-, G f_+) of the velocities at which the contact sticks.

    ``lever`` [m] is the contact relative to the CoP. If the contact's normal points at
    the CoP, the half angle psi of the cone has tan(psi) = (1 + d^2/rho^2) mu.
    """
    return pushing.motion_cone((lever, normal, mu, rho))


@dataclass(frozen=True, slots=True)
class PushOutcome:
    """Motion of a quasi-static object under a pusher with a prescribed velocity."""

    # slip_left: the pusher slides to the left (+t) along the object's face
    kind: PushKind
    force: Point  # [N] on the object, on the limit surface; zero when separated
    twist: Twist  # of the centre of pressure
    slip_velocity: float  # [m/s] of the pusher relative to the object, along t


def push_outcome(
    surface: EllipsoidLimitSurface,
    contact: Point,
    normal: Point,
    mu: float,
    velocity: Point,
) -> PushOutcome:
    """Motion of the object under a pusher that moves at ``velocity`` [m/s], in contact
    at ``contact`` [m].

    Inside the motion cone the contact sticks. Outside, the force stays on the edge of
    the friction cone and the normal velocity is kept. The pusher separates from the
    object if its velocity is not into the object. ``normal`` is the unit inward normal.
    """
    cop = surface.center
    rho = surface.rho
    lever = (contact[0] - cop[0], contact[1] - cop[1])
    kind, moving, slip = pushing.pushed(velocity, (lever, normal, mu, rho))
    twist = Twist(*moving, cop)
    wrench = surface.wrench(twist)
    return PushOutcome(KINDS[kind], (wrench.fx, wrench.fy), twist, slip)
