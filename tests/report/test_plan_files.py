"""A written plan is read back unchanged."""

import json
from dataclasses import replace
from functools import cache

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.refusal import Refusal
from pushpressslide.jobs.sampling import random_task
from pushpressslide.modes import MODES
from pushpressslide.report.plan_files import (
    choices_from_dict,
    drive_to_dict,
    plan_from_dict,
    plan_to_dict,
)

# between them they have every mode and every drive
CASES = (
    ("rear-push-rear", None),
    ("press-slide", None),
    ("press-slide", "manoeuvre"),
    ("press-slide-car", "car"),
    ("press-slide-pivot", "pivot"),
    ("parallel-push", "mixed"),
    ("parallel-push", "differential"),
    ("orthogonal-push", None),
    ("bimanual-slide", None),
    ("pivot-and-move", None),
    ("press-fit", None),
)


@cache
def planned(name: str, vehicle: str | None) -> Plan:
    task = pps.load_task(name)
    if vehicle == "manoeuvre":
        task = random_task(task, 10, seed=7)
    elif vehicle is not None:
        task = replace(task, motion=replace(task.motion, vehicle=vehicle))
    return pps.plan(task)


def through_json(data):
    return json.loads(json.dumps(data))


@pytest.mark.parametrize(("name", "vehicle"), CASES)
def test_a_plan_is_read_as_it_was_written(name: str, vehicle: str | None) -> None:
    plan = planned(name, vehicle)
    data = through_json(plan_to_dict(plan))
    assert plan_from_dict(data, plan.task) == plan
    for segment, entry in zip(plan.segments, data["segments"], strict=True):
        assert entry["drive"] == through_json(drive_to_dict(segment.drive))
        assert entry["drive"]["drive"] == type(segment.drive).__name__


def test_these_are_plans_of_every_mode_with_every_drive() -> None:
    driven = {
        (segment.mode, type(segment.drive))
        for case in CASES
        for segment in planned(*case).segments
    }
    assert driven == {
        (name, kind) for name, mode in MODES.items() for kind in mode.drives
    }


def test_the_choices_beside_a_plan_are_read_as_they_were_written() -> None:
    plan = planned("rear-push-rear", None)
    refusal = Refusal("tipping", "tips at {figure:mm.0f}", 0.2, 0.1, "m")
    choices = (
        Choice(
            "rear_push", "face 1", plan.contacts, plan.segments, 4.0, "path 1 m", leg=0
        ),
        Choice("rear_push", "face 2", plan.contacts, refusal=refusal, leg=2),
        *pps.select(plan.task),
    )
    data = through_json(plan_to_dict(plan, choices))
    assert choices_from_dict(data) == choices
    assert data["choices"][1]["reason"] == "face 2: tips at 200 mm"
    assert choices_from_dict(through_json(plan_to_dict(plan))) == ()


def test_what_is_no_plan_is_refused() -> None:
    plan = planned("rear-push-rear", None)
    data = through_json(plan_to_dict(plan))
    with pytest.raises(ValueError, match="without segments"):
        plan_from_dict({**data, "segments": []}, plan.task)
    segment = dict(data["segments"][0], drive={"drive": "NoSuchDrive"})
    with pytest.raises(KeyError):
        plan_from_dict({**data, "segments": [segment]}, plan.task)
