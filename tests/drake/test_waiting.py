"""Waiting positions of an arm without a contact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.paths.all_arms import joint_paths
from pushpressslide.arms.paths.approach import Approach
from pushpressslide.arms.paths.arm_problem import ArmProblem
from pushpressslide.arms.paths.clearance import CLEARANCE, Gap
from pushpressslide.arms.paths.joint_path import search
from pushpressslide.core import margins
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath
from pushpressslide.core.task import Task
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.taskfile.load import load_task, task_from_data

RIGHT = 1


def cell(end: float) -> Task:
    """Return a push by the left arm of two to y = ``end`` [m]; the tip of the other, at
    its home posture, is at (0.51, -0.3, 0.11).
    """
    data: dict[str, Any] = {
        "name": "cell",
        "object": {"shape": {"box": [0.16, 0.16, 0.16]}, "mass": 1.0},
        "support": {"friction": 0.25},
        "contact": {"friction": 0.7},
        "start": {"x": 0.5, "y": 0.05},
        "goal": {"x": 0.5, "y": end},
        "modes": ["rear_push"],
        "motion": {"arm": "left"},
        "robots": [
            {"model": "iiwa7", "base": {"y": 0.3}},
            {"model": "iiwa7", "base": {"y": -0.3}},
        ],
    }
    return task_from_data(data, "cell")


def waiting(end: float) -> ArmProblem:
    return ArmProblem(DRAKE, pps.plan(cell(end)), RIGHT)


def way(problem: ArmProblem) -> JointPath:
    return next(search(problem)).best(problem).path


def test_it_stays_where_it_is_if_that_is_out_of_the_way() -> None:
    problem = waiting(-0.05)
    path = way(problem)
    home = problem.kin.facts.home
    assert np.array_equal(path.approach, np.stack([home, home]))
    assert path.clearance >= margins.ARM.waiting


def test_it_is_parked_with_room_about_it_if_it_is_in_the_way() -> None:
    problem = waiting(-0.25)
    path = way(problem)
    home = problem.kin.facts.home
    assert problem.waiting_clearance(home).distance < 0.0
    assert np.array_equal(path.approach[0], home)
    assert np.array_equal(path.approach[-1], path.move[0])
    assert np.ptp(path.move, axis=0).max() == 0.0
    assert problem.waiting_clearance(path.move[0]).distance >= margins.ARM.waiting
    assert path.clearance >= CLEARANCE


def test_it_is_led_around_what_is_in_the_direct_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Approach, "_direct", lambda *_: iter(()))
    problem = waiting(-0.25)
    path = way(problem)
    assert problem.waiting_clearance(path.move[0]).distance >= CLEARANCE
    for q in path.approach:
        assert problem.free(problem.clearance, q)


def test_where_it_can_wait_nowhere_the_arm_and_the_nearest_miss_are_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        ArmProblem, "waiting_clearance", lambda *_: Gap(0.001, "link_7 and object")
    )
    said = (
        "robots: the iiwa7 has no place to wait: waiting, link_7 and object come as near "
        "as 1.0 mm, allowed from 5 mm"
    )
    with pytest.raises(InfeasibleTaskError, match=said):
        joint_paths(DRAKE, pps.plan(cell(-0.05)))


def test_it_keeps_clear_of_what_the_object_pushes() -> None:
    left = "{model: panda, base: {y: 0.1}, tip_length: 0.10}"
    right = "{model: iiwa7, base: {y: 0.55}}"
    task = load_task("tool-use", [f"robots=[{left}, {right}]", "motion.arm=left"])
    problem = ArmProblem(DRAKE, pps.plan(task), RIGHT)
    home = problem.kin.facts.home
    stands = problem.clearance.min_distance(
        home[None], problem.object_path.shapes[:1], touching=False
    )
    pushed = problem.waiting_clearance(home)
    assert "cube" in pushed.pair
    assert pushed.distance < stands.distance - 0.01
    again = problem.clearance.min_distance(
        home[None], problem.object_path.shapes[:1], touching=False
    )
    assert again == stands
