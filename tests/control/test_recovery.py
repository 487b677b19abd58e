"""Plans made anew: what is tried, and in which order."""

from __future__ import annotations

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control import recovery as module
from pushpressslide.core.bodies import start_state
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.task import Restart

TASK = pps.load_task("press-slide")
BEGIN = Restart(start_state(TASK), 0, TASK.object.center_of_mass, 1.2, None)


def test_a_friction_that_leads_nowhere_is_given_up_for_the_believed_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Restart] = []

    def planned(plan: Plan, begin: Restart, preparation: object) -> Plan:
        asked.append(begin)
        if begin.support_friction > 1.0:
            raise InfeasibleTaskError("no press drags it")
        return plan

    monkeypatch.setattr(module, "_planned", planned)
    module.planned_anew(Plan(TASK), BEGIN, lambda: None)  # type: ignore[arg-type,return-value]
    believed = TASK.scene.support.friction
    assert [one.support_friction for one in asked] == [1.2, 1.2, believed]
    assert [one.free for one in asked] == [False, True, True]


def test_the_first_refusal_is_the_one_that_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    reasons = iter(["first", "second", "third"])

    def refused(plan: Plan, begin: Restart, preparation: object) -> Plan:
        raise InfeasibleTaskError(next(reasons))

    monkeypatch.setattr(module, "_planned", refused)
    with pytest.raises(InfeasibleTaskError, match="first"):
        module.planned_anew(Plan(TASK), BEGIN, lambda: None)  # type: ignore[arg-type,return-value]


def test_the_same_task_is_not_tried_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    free = replace(TASK, motion=TASK.motion.freed)
    begin = replace(BEGIN, support_friction=free.scene.support.friction)
    asked = []

    def refused(plan: Plan, begin: Restart, preparation: object) -> Plan:
        asked.append(begin)
        raise InfeasibleTaskError("no")

    monkeypatch.setattr(module, "_planned", refused)
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(free), begin, lambda: None)  # type: ignore[arg-type,return-value]
    assert len(asked) == 1
