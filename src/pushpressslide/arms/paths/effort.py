"""Joint torques that hold a contact."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pushpressslide.arms.model import ArmModel, at_rest
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.mechanics.pressing import resting_cop

SAMPLES = 24  # postures of a path that are checked
STILL = 1e-9  # [m] between two samples, of a point that stays


def largest_share(
    plan: Plan,
    contact: Contact,
    model: ArmModel,
    postures: Array,
    bodies: Sequence[Pose2],
) -> float:
    """Largest joint torque along ``postures`` (k, n), as a fraction of the effort
    limit.

    The arm is at rest under gravity and the contact's planned force. A press applies
    its load and the drag. If it is alone on the object, the drag is along the motion of
    the centre of pressure, otherwise in any direction along the support. A push applies
    its part of the drag. ``bodies`` are the poses X_WB (k).
    """
    frame = plan.task.support.frame
    effort = model.facts.effort_limit
    plane = np.array(
        [frame.direction((1.0, 0.0, 0.0)), frame.direction((0.0, 1.0, 0.0))]
    )
    normal, shear = _forces(plan, contact)
    ahead = _drag_directions(plan, bodies)
    alone = len(plan.contacts) == 1
    share = 0.0
    samples = np.linspace(0, len(postures) - 1, SAMPLES).round().astype(int)
    for i in np.unique(samples):
        state = model.state_at(at_rest(postures[i]))
        J = state.J[3:]
        push = np.array(frame.direction(contact.direction(bodies[i])))
        pressed = state.bias + normal * push @ J
        if alone:  # the way there, and the way from there
            along = [
                frame.direction((x, y, 0.0)) for x, y in ahead[max(i - 1, 0) : i + 1]
            ]
            needed = np.abs(pressed + shear * np.array(along) @ J).max(axis=0)
        else:
            needed = np.abs(pressed) + shear * np.linalg.norm(plane @ J, axis=0)
        share = max(share, float(np.max(needed / effort)))
    return share


def _drag_directions(plan: Plan, bodies: Sequence[Pose2]) -> Array:
    """Unit vectors (k - 1, 2) of the motion of the object's centre of pressure between
    poses X_WB (k). Zero if it stays, as in a spin.
    """
    presses = [contact for contact in plan.contacts if contact.kind == "top"]
    cop = resting_cop(plan.task.scene, presses)
    steps = np.diff([X.apply(cop) for X in bodies], axis=0)
    lengths = np.linalg.norm(steps, axis=1, keepdims=True)
    return np.asarray(steps / np.maximum(lengths, STILL))


def _forces(plan: Plan, contact: Contact) -> tuple[float, float]:
    """Largest normal force of a contact, and its largest force along the support [N]."""
    contacts = plan.contacts
    drag = 0.0
    for segment in plan.segments:
        drag = max(drag, segment.drive.max_friction)
    if contact.kind == "side":
        return drag / sum(c.kind == "side" for c in contacts), 0.0
    index = contacts.index(contact)
    load = max(segment.contacts[index].load for segment in plan.segments)
    presses = math.fsum(c.load for c in contacts)
    steering_scale = plan.task.scene.contact_friction * load
    return load, min(steering_scale, drag * contact.load / presses)
