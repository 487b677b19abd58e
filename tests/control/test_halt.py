"""Tips that are drawn back and halted during the motion."""

from __future__ import annotations

import math

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.state import tip_position
from pushpressslide.core import margins
from pushpressslide.core.control import Measurement, TipState

TASK = pps.load_task("press-slide")
PLAN = pps.plan(TASK)
DT = 0.004
REST = margins.ARM.rest_time


@pytest.mark.parametrize(
    ("begin", "end", "drawn"),
    [
        (math.inf, math.inf, 1.0),  # never halted
        (0.0, 0.9 * REST, 1.0),  # while the tips still stand at their contacts
        (REST + 0.5, REST + 0.6, None),  # on the way
    ],
)
def test_tips_stay_only_where_they_are_halted_on_their_way_back(
    begin: float, end: float, drawn: float | None
) -> None:
    controller = Controller(PLAN)
    (contact,) = controller.segments[0].contacts
    X_WB = TASK.start.compose(TASK.object.X_GB)
    place = tip_position(contact, X_WB, TASK.robots[0].tip_radius)
    tip = TipState(place, (0.0, 0.0, 0.0), (0.0, 0.0, -contact.load))
    state = controller.init(Measurement(0.0, TASK.start, (tip,)))
    failure = ("joint_limit", "near")
    state = controller.stop(state, Measurement(0.0, TASK.start, (tip,)), failure)
    heights = []
    for i in range(1, 10_000):
        measured = Measurement(i * DT, TASK.start, (tip,))
        if begin <= i * DT <= end:
            state = controller.halted(state, measured)
        (command,), _, state, _ = controller.step(state, measured)
        heights.append(command.position[2])
        if state.phase.name == "done":
            break
    rise = heights[-1] - place[2]
    if drawn is None:
        assert 0.0 < rise < 0.5 * margins.ARM.retreat
    else:
        assert rise == pytest.approx(drawn * margins.ARM.retreat)
