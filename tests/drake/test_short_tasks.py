"""Short Drake versions of the long tests: the modes of two arms, a wrong belief, noise
with delay over a new contact, a wall, a bar as a tool.

One arm that pushes or presses, two that press, and limits have short tests of their
own.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.control import PHASES
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import (
    Belief,
    Box,
    Motion,
    ObjectModel,
    Robot,
    Task,
    Tolerance,
)
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import load_task, task_from_data

HANDS = ["robots.0.model=hand", "robots.1.model=hand"]
NOISE = {
    "position_noise": 5e-4,
    "yaw_noise_deg": 0.2,
    "force_noise": 0.2,
    "delay": 0.02,
}


def pushed_box(**more: Any) -> Task:
    """Return a push of a 12 cm box by a free hand."""
    data: dict[str, Any] = {
        "name": "pushed-box",
        "object": {"shape": {"box": [0.12, 0.12, 0.12]}, "mass": 1.0},
        "start": {"x": 0.45, "y": 0.0, "yaw_deg": 0},
        "robots": [{"model": "hand", "base": {"z": 0.5}}],
        "tolerance": {"position": 0.005, "yaw_deg": 2},
        "modes": ["rear_push"],
    }
    if "legs" in more:
        del data["modes"]
    return task_from_data(data | more, "pushed-box")


def done(task: Task) -> tuple[dict[str, Any], Record]:
    """Run a task and check that it succeeds within its limits."""
    plan, record, _ = simulate(task, seed=11)
    measured = result(task, plan, record, {})
    assert measured["success"], measured["reason"]
    assert measured["torque_limit_violation_fraction"] == 0.0
    assert measured["max_mean_normal_force"] < task.limits.normal_force
    assert set(measured["planning_time"]) == {"selection", "joint_paths"}
    return measured, record


def largest_lag(record: Record) -> float:
    """Largest lag [rad] of a joint behind its plan while the tips are drawn back, minus
    its lag at the start.
    """
    released = record.arrays["phase"] == PHASES.index("release")
    lags = []
    for arm in range(len(record.plan.task.robots)):
        q, wanted = (
            record.arrays[f"joint_{name}_{arm}"][released]
            for name in ("position", "reference")
        )
        lag = np.abs(wanted - q)
        lags.append(float((lag - lag[0]).max()))
    return max(lags)


def test_two_arms_push_side_by_side() -> None:
    task = load_task("parallel-push", ["goal={x: 0.56, y: 0.04, yaw_deg: 0}"])
    measured, record = done(task)
    assert measured["modes"] == ["parallel_push"]
    assert measured["bodies"]["object"]["displacement"] > 0.05
    assert largest_lag(record) < 0.03


def test_two_tips_push_at_a_right_angle() -> None:
    task = load_task("orthogonal-push", ["goal={x: 0.43, y: 0.17, yaw_deg: 3}", *HANDS])
    measured, _ = done(task)
    assert measured["modes"] == ["orthogonal_push"]
    assert measured["bodies"]["object"]["displacement"] > 0.04


def test_one_arm_holds_a_point_and_the_other_turns_the_object_about_it() -> None:
    start = Pose2(0.5, 0.0, 0.0)
    held = (-0.08, 0.10)
    yaw = math.radians(12.0)
    x, y = Pose2(0.0, 0.0, yaw).rotate(held)
    goal = Pose2(start.x + held[0] - x, start.y + held[1] - y, yaw)
    task = Task(
        "pivot",
        ObjectModel(Box((0.4, 0.3, 0.1)), 2.0, (0.0, 0.0)),
        start,
        goal,
        tuple(Robot("iiwa7", (0.0, side, 0.2)) for side in (0.4, -0.4)),
        contact_friction=0.8,
        tolerance=Tolerance(0.005, math.radians(1.0)),
        modes=("press_and_push",),
        motion=Motion(contacts=(held,)),
    )
    _, record = done(task)
    places = [Pose2(*pose).apply(held) for pose in record.arrays["object_pose"][::20]]
    assert max(math.dist(place, places[0]) for place in places) < 2e-3


def test_a_friction_believed_two_fifths_too_low_is_made_up_for() -> None:
    told = pushed_box(goal={"x": 0.51, "y": 0.005, "yaw_deg": 5})
    task = replace(told, belief=Belief(0.18, told.contact_friction, told.object.mass))
    assert task.support.friction == 0.3
    first = pps.plan(task).segments[0].drive
    assert first.max_friction < 0.7 * pps.plan(told).segments[0].drive.max_friction
    done(task)


@pytest.mark.long
def test_with_noise_and_delay_a_box_is_let_go_and_taken_at_another_face() -> None:
    task = pushed_box(
        goal={"x": 0.48, "y": 0.03, "yaw_deg": 0},
        sensing=NOISE,
        legs=[
            {"mode": "rear_push", "pose": {"x": 0.48, "y": 0.0, "yaw_deg": 0}},
            {"mode": "rear_push"},
        ],
    )
    _, record = done(task)
    legs = record.arrays["leg"]
    assert set(legs) == {0.0, 1.0}
    forces = [
        record.arrays["measured_force"][legs == leg, 0, :2].sum(axis=0)
        for leg in (0.0, 1.0)
    ]
    along, aside = (int(np.argmax(np.abs(force))) for force in forces)
    assert (along, aside) == (0, 1)


def test_two_arms_slide_a_box_up_a_wall() -> None:
    wall = "{kind: wall, friction: 0.2, pose: {x: 0.86, y: 0, z: 0.81, yaw_deg: 180}}"
    task = load_task(
        "press-fit",
        [
            f"support={wall}",
            "legs=null",
            "modes=[bimanual_press_slide]",
            "goal={x: 0.20, y: 0.0, yaw_deg: 0}",
        ],
    )
    measured, record = done(task)
    assert measured["support_gap_max"] < 0.002  # never leaves the wall
    heights = record.arrays["object_pose"][:, 1]
    assert heights[-1] - heights[0] == pytest.approx(0.03, abs=0.005)


@pytest.mark.long
def test_a_bar_pushes_a_cube() -> None:
    task = load_task(
        "tool-use",
        [
            "start={x: 0.45, y: 0.01, yaw_deg: 90}",
            "goal={x: 0.45, y: 0.41, yaw_deg: 0, body: cube}",
        ],
    )
    measured, _ = done(task)
    assert measured["bodies"]["cube"]["displacement"] == pytest.approx(0.03, abs=0.01)
