"""Tasks in several legs, on the planar engine: arms that let go, hold on, or keep their
contacts.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import arms_kept
from pushpressslide.core.task import Task
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.report.plan_files import plan_from_dict, plan_to_dict
from pushpressslide.report.series import by_placement
from pushpressslide.selection.select import select
from pushpressslide.selection.solve import plan
from pushpressslide.taskfile.load import task_from_data

PIN = (0.42, 0.15)  # [m] in the world, pressed


def turned(degrees: float) -> dict[str, float]:
    """Pose of a box whose point (0, 0.15) is at PIN."""
    yaw = math.radians(degrees)
    return {
        "x": PIN[0] + 0.15 * math.sin(yaw),
        "y": PIN[1] - 0.15 * math.cos(yaw),
        "yaw_deg": degrees,
    }


BAR: dict[str, Any] = {
    "name": "bar",
    "object": {"shape": {"box": [0.3, 0.2, 0.1]}, "mass": 0.5},
    "contact": {"friction": 0.9},
    "start": {"x": 0.50, "y": 0.20},
    "goal": {"x": 0.70, "y": -0.10, "yaw_deg": -30},
    "tolerance": {"position": 0.005, "yaw_deg": 1},
    "limits": {"normal_force": 80},
    "robots": [{"model": "panda"}],
}
HALFWAY = {"x": 0.45, "y": 0.10, "yaw_deg": -20}
LET_GO = {
    **BAR,
    "legs": [{"mode": "press_slide", "pose": HALFWAY}, {"mode": "rear_push"}],
}
KEPT = {
    "name": "two-presses",
    "object": {"shape": {"box": [0.4, 0.4, 0.2]}, "mass": 2.0},
    "contact": {"friction": 0.8},
    "start": {"x": 0.55, "y": 0.05},
    "goal": {"x": 0.62, "y": -0.05, "yaw_deg": 30},
    "tolerance": {"position": 0.005, "yaw_deg": 1},
    "limits": {"normal_force": 80},
    "robots": [
        {"model": "iiwa7", "base": {"y": 0.5, "z": 0.2}},
        {"model": "iiwa7", "base": {"y": -0.5, "z": 0.2}},
    ],
    "legs": [
        {"mode": "bimanual_press_slide", "pose": {"x": 0.62, "y": -0.05}},
        {"mode": "bimanual_press_slide"},
    ],
}
HELD = {
    "name": "pivot-in-two",
    "object": {"shape": {"box": [0.3, 0.4, 0.2]}, "mass": 2.0},
    "contact": {"friction": 0.7},
    "start": turned(0.0),
    "goal": turned(45.0),
    "tolerance": {"position": 0.005, "yaw_deg": 1},
    "limits": {"normal_force": 80},
    "robots": [
        {
            "model": "iiwa7",
            "base": {"y": 0.45, "z": 0.1},
            "tip_radius": 0.03,
            "tip_length": 0.12,
        },
        {
            "model": "iiwa7",
            "base": {"y": -0.35, "z": 0.1},
            "tip_radius": 0.03,
            "tip_length": 0.12,
        },
    ],
    "motion": {"contacts": [[0.0, 0.15]]},
    "legs": [
        {"mode": "press_and_push", "pose": turned(20.0), "motion": {"face": 3}},
        {"mode": "press_and_push", "motion": {"face": 0}},
    ],
}


# the left arm keeps its press when the right one has done its part
GOES_ON = {
    "name": "hold-and-slide",
    "object": {"shape": {"box": [0.4, 0.3, 0.1]}, "mass": 2.0},
    "contact": {"friction": 0.8},
    "start": {"x": 0.50, "y": 0.0},
    "goal": {"x": 0.459, "y": 0.069, "yaw_deg": 12},
    "limits": {"normal_force": 60},
    "robots": [
        {"model": "iiwa7", "base": {"y": 0.4, "z": 0.2}},
        {"model": "iiwa7", "base": {"y": -0.4, "z": 0.2}},
    ],
    "motion": {"contacts": [[-0.08, 0.10]]},
    "legs": [
        {
            "mode": "press_and_push",
            "pose": {"x": 0.51904, "y": 0.01882, "yaw_deg": 12},
        },
        {"mode": "press_slide"},
    ],
}


def task(data: dict[str, Any]) -> Task:
    return task_from_data(data, "by-hand")


@pytest.mark.parametrize(("data", "placements"), [(LET_GO, 2), (KEPT, 1), (HELD, 2)])
def test_the_legs_take_the_object_to_its_goal(
    data: dict[str, Any], placements: int
) -> None:
    made, record, _ = simulate(task(data), engine="planar")
    found = result(task(data), made, record, {})
    assert found["success"], found["reason"]
    assert len(made.placements) == placements
    assert np.array_equal(np.unique(record.arrays["leg"]), [0.0, 1.0])
    assert np.all(np.diff(record.arrays["leg"]) >= 0.0)
    assert record.modes == tuple(dict.fromkeys(leg["mode"] for leg in data["legs"]))


def test_every_placement_has_its_own_figures() -> None:
    made, record, _ = simulate(task(LET_GO), engine="planar")
    found = result(task(LET_GO), made, record, {})
    assert [(c["leg"], c["kind"]) for c in found["contacts"]] == [
        (0, "top"),
        (1, "side"),
    ]
    parts = by_placement(made, record)
    assert sum(len(part.arrays["time"]) for _, part in parts) == len(
        record.arrays["time"]
    )
    lost = sum(c["contact_loss_time"] for c in found["contacts"])
    assert found["contact_loss_time"] == pytest.approx(lost)
    assert lost < 0.1  # of the way from one contact to the other nothing is counted


def test_an_arm_whose_contact_stays_holds_it_while_the_other_takes_its_own_anew() -> (
    None
):
    made, record, _ = simulate(task(HELD), engine="planar")
    assert arms_kept(*made.placements) == {0}
    began = int(np.argmax(record.arrays["leg"] == 1.0))
    moved = began + int(np.argmax(record.arrays["phase"][began:] == 2.0))
    press = -record.arrays["measured_force"][began + 1 : moved, 0, 2]
    assert press.min() > 0.9 * made.contacts[0].load
    assert np.ptp(record.arrays["object_pose"][began:moved, :2], axis=0).max() < 3e-3


def test_an_arm_goes_on_with_its_press_alone_while_the_other_waits() -> None:
    made, record, _ = simulate(task(GOES_ON), engine="planar")
    assert result(task(GOES_ON), made, record, {})["success"]
    assert arms_kept(*made.placements) == {0}
    alone = record.arrays["placement"] == 1
    moving = alone & (record.arrays["phase"] == 2)
    press = -record.arrays["measured_force"][alone, 0, 2]
    assert press[: len(press) // 2].min() > 0.9 * made.contacts[0].load
    waits = record.arrays["tip_position"][moving, 1]
    assert np.ptp(waits, axis=0).max() == 0.0
    assert math.dist(waits[0], (0.0, -0.4, 0.2)) < 0.01


def test_where_it_turned_is_told_beside_what_was_predicted() -> None:
    made, record, _ = simulate(task(HELD), engine="planar")
    pivots = result(task(HELD), made, record, {})["pivots"]
    assert pivots
    for pivot in pivots:
        assert pivot["distance"]["pressed"] < 5e-3
        assert (
            min(
                pivot["distance"][name]
                for name in ("center_of_pressure", "virtual_axle")
            )
            > 0.02
        )


@pytest.mark.parametrize("data", [LET_GO, KEPT, HELD])
def test_a_plan_of_legs_survives_its_file(data: dict[str, Any]) -> None:
    made = plan(task(data))
    assert plan_from_dict(plan_to_dict(made, select(task(data))), task(data)) == made


def test_the_leg_that_cannot_be_done_is_named() -> None:
    data = {
        **LET_GO,
        "legs": [
            {"mode": "press_slide", "pose": {"x": 0.72, "y": -0.05}},
            {"mode": "rear_push"},
        ],
    }
    with pytest.raises(
        InfeasibleTaskError,
        match=r"by-hand: legs\[1\]: no mode can do this task: rear_push",
    ):
        plan(task(data))
