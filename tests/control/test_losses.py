"""A contact that is lost repeatedly."""

from __future__ import annotations

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.state import ControllerState, tip_position
from pushpressslide.control.supervisor import LOSSES
from pushpressslide.core import margins
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2

TASK = pps.load_task("press-slide")
PLAN = pps.plan(TASK)
DT = 0.004


def touched_and_lost(way: float) -> tuple[ControllerState, int]:
    """Final state, and number of touches, if the contact is felt in every touch and
    lost in every move.

    The object advances by ``way`` [m] each time.
    """
    controller = Controller(PLAN)
    (contact,) = controller.segments[0].contacts
    radius = TASK.robots[0].tip_radius
    pressing = (0.0, 0.0, -contact.load)
    pose = TASK.start
    touches = 1
    X_WB = pose.compose(TASK.object.X_GB)
    place = tip_position(contact, X_WB, radius)
    tip = TipState(place, (0.0, 0.0, 0.0), pressing)
    state = controller.init(Measurement(0.0, pose, (tip,)))
    for i in range(1, 20000):
        before = state.phase.name
        force = pressing if before == "touch" else (0.0, 0.0, 0.0)
        place = tip_position(contact, pose.compose(TASK.object.X_GB), radius)
        tip = TipState(place, (0.0, 0.0, 0.0), force)
        step = controller.step(state, Measurement(i * DT, pose, (tip,)))
        state = step.state
        if step.event is not None:
            state = controller.supervisor.step(step.event)
        if state.phase.name == "touch" and before == "move":
            touches += 1
            pose = Pose2(pose.x + way, pose.y, pose.yaw)
        if state.phase.failure is not None or touches > 2 * LOSSES:
            break
    return state, touches


def test_a_contact_that_is_lost_in_one_place_ends_the_attempt() -> None:
    state, touches = touched_and_lost(0.0)
    assert state.phase.failure is not None
    code, text = state.phase.failure
    assert code == "contact_lost"
    assert f"{LOSSES + 1} times within 12 mm" in text
    assert touches == LOSSES + 1


def test_losses_on_the_way_are_borne() -> None:
    state, touches = touched_and_lost(1.5 * margins.ARM.retouch)
    assert touches > 2 * LOSSES
    assert state.phase.failure is None
