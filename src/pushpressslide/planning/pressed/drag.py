"""Friction utilisation and tipping margin of an object that two contacts drag."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import hypot, inf

from pushpressslide.core import margins
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.osculating import dragged_ellipsoid, pressures
from pushpressslide.mechanics.pressing import resting_cop
from pushpressslide.mechanics.top import room_inside
from pushpressslide.mechanics.wall import lever, weights

AllocatorAbout = Callable[[Point], Callable[[float, float, float], Allocation]]
"""Function that returns an allocator of wrenches about a point [m] in B."""


@dataclass(frozen=True, slots=True)
class HeldDrag:
    """Two presses that drag the object with one twist."""

    surface: DraggedSurface  # the limit surface near that twist
    friction_utilisation: float
    tipping_margin: float  # half widths


@dataclass(frozen=True, slots=True)
class PinnedDrag(HeldDrag):
    """A press and a push that drag the object with one twist."""

    forces: Allocation
    cop: Point  # [m] in B, centre of pressure


def held_drag(
    scene: Scene,
    contacts: Sequence[Contact],
    path: TwistPath,
    point: Point,
    allocator: AllocatorAbout,
) -> HeldDrag:
    """Drag of an object that two presses move along a path of its ``point`` [m] in B.

    Raises ValueError if the object tips.
    """
    height = scene.body.shape.top_height
    twist = path.initial_twist(point)
    load = scene.weight_on + sum(contact.load for contact in contacts)
    surface, cop = dragged_ellipsoid(
        pressures(scene),
        scene.support.friction,
        load,
        resting_cop(scene, contacts),
        twist,
        lambda wrench: (height * wrench.fx / load, height * wrench.fy / load),
    )
    mu = scene.contact_friction
    raised = lever(scene, load)
    x, y = surface.center
    upper = 0.0
    margin = inf
    allocate = allocator(surface.center)
    for wx, wy in weights(scene, path):
        lifted = replace(surface, center=(x - raised * wx, y - raised * wy))
        fx, fy, tau, _ = lifted.wrench(twist).moved_to((x, y))
        held = Wrench(wx, wy, 0.0).moved_to((x, y))
        allocation = allocate(fx - wx, fy - wy, tau - held.tau)
        upper = max(upper, _utilisation(contacts, mu, allocation, surface))
        moved = (cop[0] - raised * wx, cop[1] - raised * wy)
        margin = min(margin, room_inside(scene.body, moved))
    return HeldDrag(surface, upper, margin)


def pinned_drag(
    scene: Scene,
    contacts: Sequence[Contact],
    twist: Twist,
    allocator: AllocatorAbout,
) -> PinnedDrag:
    """Drag of an object that a press and a push move with ``twist``. Raises ValueError
    if the object tips.
    """
    press, push = contacts
    load = scene.weight_on + press.load

    def forces(wrench: Wrench) -> Allocation:
        """Contact forces [N] for a wrench."""
        return allocator(wrench.about)(wrench.fx, wrench.fy, wrench.tau)

    def shift(wrench: Wrench) -> Point:
        """Shift [m] of the centre of pressure by the contact forces."""
        (ax, ay), (bx, by) = forces(wrench).forces
        h1 = press.height / load
        h2 = push.height / load
        return (h1 * ax + h2 * bx, h1 * ay + h2 * by)

    resting = resting_cop(scene, [press])
    surface, cop = dragged_ellipsoid(
        pressures(scene), scene.support.friction, load, resting, twist, shift
    )
    allocation = forces(surface.wrench(twist))
    utilisation = _utilisation([press], scene.contact_friction, allocation, surface)
    margin = room_inside(scene.body, cop)
    return PinnedDrag(surface, utilisation, margin, allocation, cop)


def _utilisation(
    presses: Sequence[Contact],
    mu: float,
    allocation: Allocation,
    surface: DraggedSurface,
) -> float:
    """Largest friction utilisation of the presses, which are the first contacts of an
    allocation.

    It is scaled up according to the share of the wanted wrench that the allocation
    could not realise.
    """
    upper = max(
        hypot(*force) / (mu * press.load)
        for press, force in zip(presses, allocation.forces, strict=False)
    )
    fx, fy, tau = allocation.residual
    lost = hypot(fx, fy, tau / surface.rho) / surface.max_force
    return upper / max(1.0 - lost, margins.GIVEN)
