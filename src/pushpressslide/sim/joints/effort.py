"""The joint torques that an arm needs to hold its contact."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.arm_model import ArmModel

Array = NDArray[np.float64]

LOOKED_AT = 24  # postures of a path


def largest_share(
    plan: Plan,
    contact: Contact,
    model: ArmModel,
    postures: Array,
    bodies: Sequence[Pose2],
) -> float:
    """Return the largest share of its effort limit that any joint needs along
    ``postures`` (k, n).

    At rest, gravity included, with the contact's planned force: of a press the load,
    and the drag in whatever direction along the support is worst; of a push its part of
    the drag. ``bodies`` are X_WB, k.
    """
    frame = plan.task.support.frame
    effort = model.instance.facts.effort_limit
    along = np.array(
        [frame.direction((1.0, 0.0, 0.0)), frame.direction((0.0, 1.0, 0.0))]
    )
    normal, shear = _forces(plan, contact)
    share = 0.0
    for i in np.unique(
        np.linspace(0, len(postures) - 1, LOOKED_AT).round().astype(int)
    ):
        state = model.state(postures[i], np.zeros(model.size))
        J = state.J[3:]
        pressed = (
            state.bias
            + normal * np.array(frame.direction(contact.direction(bodies[i]))) @ J
        )
        needed = np.abs(pressed) + shear * np.linalg.norm(along @ J, axis=0)
        share = max(share, float(np.max(needed / effort)))
    return share


def _forces(plan: Plan, contact: Contact) -> tuple[float, float]:
    """The normal force of a contact and the force along the support that comes with it
    [N], at most.
    """
    contacts = plan.contacts
    drag = 0.0
    for stretch in plan.segments:
        drag = max(drag, stretch.drive.max_friction)
    if contact.kind == "side":
        return drag / sum(c.kind == "side" for c in contacts), 0.0
    index = contacts.index(contact)
    load = max(stretch.contacts[index].load for stretch in plan.segments)
    presses = math.fsum(c.load for c in contacts)
    return load, min(
        plan.task.believed.contact_friction * load, drag * contact.load / presses
    )
