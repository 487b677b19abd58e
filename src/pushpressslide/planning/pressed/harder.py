"""A harder press in place of one that has slid over the top."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pushpressslide.core import margins
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.plan import Contact
from pushpressslide.core.scene import Scene
from pushpressslide.planning.pressed.vehicle import press_of

STEPS = 4  # loads that are tried between the present one and the harder one
DRAGGED = tuple(0.5 * math.pi * i for i in range(4))
"""Directions [rad] of the drag in which a pressed object must not tip."""


def harder(scene: Scene) -> float:
    """Factor on the load of presses that have slid: it meets half of the friction that
    errors of the belief allow.
    """
    return max(margins.HARDER, 1.0 / math.sqrt(scene.surest_drag))


def harder_presses(
    scene: Scene, contacts: Sequence[Contact], limit: float
) -> tuple[Contact, ...]:
    """The ``contacts`` with ``harder`` loads up to ``limit`` [N]. A single press does not
    tip the object.
    """
    loads = [
        max(contact.load, min(harder(scene) * contact.load, limit))
        for contact in contacts
    ]
    pairs = zip(contacts, loads, strict=True)
    pressed = tuple(replace(contact, load=load) for contact, load in pairs)
    if len(contacts) > 1 or contacts[0].point == (0.0, 0.0):
        return pressed
    (contact,) = contacts
    for step in range(STEPS):
        load = loads[0] + (contact.load - loads[0]) * step / STEPS
        one = replace(contact, load=load)
        if _stands(scene, one):
            return (one,)
    return (contact,)


def _stands(scene: Scene, contact: Contact) -> bool:
    """Whether an object that a ``contact`` drags in any direction does not tip, however
    light.
    """
    press = press_of(scene, contact)
    lightest = (1.0 - scene.mass_error) * scene.body.mass
    press = replace(press, body=replace(scene.body, mass=lightest))
    lower = min(press.tipping_margin(angle) for angle in DRAGGED)
    return lower >= margins.TIPPING_MARGIN


def slid_friction(scene: Scene, load: float) -> float:
    """Largest friction of a tip whose press of ``load`` [N] slid over an object that
    stood still: less than the drag took.
    """
    weight = scene.body.mass * GRAVITY
    return scene.support.friction * (weight + load) / load
