"""The rest of a plan, replanned where a placement has told of the centre of mass."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import pushpressslide as pps
from pushpressslide.control import run_loop as module
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.jobs.run import simulate
from pushpressslide.jobs.sampling import random_task
from pushpressslide.planar.physics import PlanarPhysics


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Two pushes of an object whose centre of mass is not sure."""
    base = pps.load_task("press-slide", ["modes=[rear_push]"])
    task = random_task(base, 1, 609, "any")
    belief = replace(task.belief, center_error=0.003)
    plan = pps.plan(replace(task, belief=belief))
    assert len(plan.by_placement) == 2
    return plan


def run(plan: Plan) -> Record:
    _, record, _ = simulate(plan.task, engine="planar")
    return record


@pytest.mark.parametrize("off", [False, True])
def test_the_rest_is_planned_again_beside_the_centre_only(
    plan: Plan, off: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which is no recovery."""
    planned = []
    own = module.planned_anew

    def again(*asked: Any, **options: Any) -> Plan:
        planned.append(asked)
        return own(*asked, **options)

    monkeypatch.setattr(module, "planned_anew", again)
    monkeypatch.setattr(module, "beside_center", lambda *_: off and not planned)
    record = run(plan)
    assert record.reason == "goal_reached"
    assert len(planned) == int(off)
    assert not record.meta["events"]


def test_a_rest_that_cannot_be_replanned_is_followed(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    restored = []

    def refused(*_: object, **__: object) -> Plan:
        raise InfeasibleTaskError("no plan")

    monkeypatch.setattr(module, "planned_anew", refused)
    monkeypatch.setattr(module, "beside_center", lambda *_: True)
    monkeypatch.setattr(PlanarPhysics, "restore", lambda one: restored.append(one))
    record = run(plan)
    assert record.reason == "goal_reached"
    assert len(restored) == 1
