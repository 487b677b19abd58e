"""A tip without a contact, on the planar engine: it waits at its robot's base."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.control import Commands, TipCommand
from pushpressslide.jobs.run import Output, run_task, simulate
from pushpressslide.planar.engine import run
from pushpressslide.report.files import load_run
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import task_from_data

CELL: dict[str, Any] = {
    "name": "cell",
    "object": {"shape": {"box": [0.2, 0.2, 0.12]}, "mass": 1.0},
    "support": {"friction": 0.25},
    "contact": {"friction": 0.7},
    "start": {"x": 0.45, "y": 0.05},
    "goal": {"x": 0.52, "y": 0.07, "yaw_deg": 5},
    "robots": [
        {"model": "panda", "base": {"y": 0.35}},
        {"model": "panda", "base": {"y": -0.35}},
    ],
}
LEGS: list[dict[str, Any]] = [
    {"mode": "rear_push", "pose": {"x": 0.50, "y": 0.05}, "motion": {"arm": "left"}},
    {"mode": "rear_push", "pose": {"x": 0.50, "y": 0.10}, "motion": {"arm": "right"}},
    {"mode": "bimanual_press_slide"},
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What is written of a run of one arm, then the other, then both."""
    task = task_from_data(CELL | {"legs": LEGS}, "cell")
    out = tmp_path_factory.mktemp("cell")
    found = run_task(task, engine="planar", out=Output(out))
    assert found["contacts"] == load_run(out).result["contacts"]
    return out


def test_one_arm_then_the_other_then_both_take_the_object_to_its_goal(
    folder: Path,
) -> None:
    ran = load_run(folder)
    task = ran.plan.task
    record = ran.record
    found = ran.result
    assert found["success"], found["reason"]
    assert [c["arm"] for c in found["contacts"]] == [0, 1, 0, 1]
    arrays = record.arrays
    moving = arrays["phase"] == 2
    for leg, arm in ((0, 1), (1, 0)):
        ticks = moving & (arrays["leg"] == leg)
        places = arrays["tip_position"][ticks, arm]
        assert np.ptp(places, axis=0).max() == 0.0
        assert math.dist(places[0], task.scene.bases[arm]) < 0.01
        assert not arrays["measured_force"][ticks, arm].any()
        assert np.isnan(arrays["tip_reference"][ticks, arm]).all()


def test_its_files_tell_which_arm_did_what(folder: Path) -> None:
    run = load_run(folder)
    assert [s.contacts[0].arm for s in run.plan.segments] == [0, 1, 0]
    assert [c["arm"] for c in run.result["contacts"]] == [0, 1, 0, 1]
    page = (folder / "report.html").read_text("utf-8")
    assert "right arm, face 0" in page
    for name in ("Placement 1, left arm: panda", "Placement 2, right arm: panda"):
        assert name in page
    assert (folder / "replay.html").is_file()


def test_an_object_that_only_the_right_arm_reaches_is_pushed_by_the_right_arm() -> None:
    task = task_from_data(
        CELL
        | {
            "start": {"x": 0.45, "y": -0.75},
            "goal": {"x": 0.52, "y": -0.75},
            "modes": ["rear_push"],
        },
        "cell",
    )
    plan, record, _ = simulate(task, engine="planar")
    found = result(task, plan, record, {})
    assert found["success"], found["reason"]
    assert [c["arm"] for c in found["contacts"]] == [1]
    assert found["contacts"][0]["max_normal_force"] > 1.0


def test_what_one_arm_has_to_leave_may_be_done_by_the_other() -> None:
    across = {
        "modes": ["rear_push"],
        "start": {"x": 0.5, "y": 0.25},
        "goal": {"x": 0.5, "y": -0.20},
    }
    task = task_from_data(CELL | across, "cell")

    def stopped(time: float, commands: Commands) -> Commands:
        return tuple(map(raised, commands)) if 9.0 <= time < 9.004 else commands

    record = run(pps.plan(task), RunOptions(disturb=stopped))
    found = result(task, record.plan, record, {})
    assert found["events"][0]["code"] == "reference_jump"
    assert found["success"], found["reason"]
    assert [c["arm"] for c in found["contacts"]] == [0, 1]


def raised(command: Any) -> Any:
    """Return a tip's command with its reference 5 cm up; any other as it is."""
    if not isinstance(command, TipCommand):
        return command
    x, y, z = command.position
    return replace(command, position=(x, y, z + 0.05))
