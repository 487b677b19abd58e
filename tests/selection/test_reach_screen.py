"""Arms that reach the object at both ends of a motion, and the point of hand-over."""

from collections.abc import Callable

import pytest
import yaml

import pushpressslide as pps
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.selection.reach_screen import ReachScreen, touching
from pushpressslide.selection.waypoints import free_space, waypoints
from pushpressslide.taskfile.load import dump_task, task_from_data

SMALL = {"shape": {"box": [0.1, 0.1, 0.08]}, "mass": 0.5}


def cell(start: dict[str, float], goal: dict[str, float]) -> Task:
    """Return a task for two arms that stand 1.5 m apart."""
    data = {
        "name": "cell",
        "support": {"friction": 0.3},
        "object": SMALL,
        "contact": {"friction": 0.8},
        "start": start,
        "goal": goal,
        "robots": [
            {"model": "iiwa7", "base": {"x": 0.0, "y": 0.75}},
            {"model": "iiwa7", "base": {"x": 0.0, "y": -0.75}},
        ],
    }
    return task_from_data(data, "cell.yaml")


@pytest.fixture(scope="module")
def across() -> Task:
    return cell({"x": 0.5, "y": -0.6}, {"x": 0.5, "y": 0.6})


def test_no_arm_leads_an_object_from_one_side_to_the_other(across: Task) -> None:
    asked = ReachScreen(across.query)
    poses = [across.start, across.goal, Pose2(0.45, -0.4), Pose2(0.45, 0.4)]
    for mode in ("rear_push", "press_slide"):
        assert not asked.can_reach(mode, poses, 0, 1)
        assert asked.can_reach(mode, poses, 0, 2)
        assert asked.can_reach(mode, poses, 3, 1)
        assert not asked.can_reach(mode, poses, 2, 3)
    assert not asked.can_reach("bimanual_press_slide", poses, 0, 2)


def test_what_can_be_chosen_is_known_to_be_reached() -> None:
    for name in ("rear-push-rear", "press-slide"):
        task = pps.load_task(name)
        (best,) = [choice for choice in pps.select(task) if choice.feasible][:1]
        assert ReachScreen(task.query).can_reach(
            best.mode, [task.start, task.goal], 0, 1
        )


def test_what_was_found_is_written_and_read_again(
    shipped_plan: Callable[[str], Plan],
) -> None:
    """Poses of a grid are plain numbers."""
    plan = shipped_plan("hand-over")
    assert {c.arm for piece in plan.segments for c in piece.contacts} == {0, 1}
    again = yaml.safe_load(dump_task(plan.task))
    assert len(again["legs"]) == len(plan.task.legs) >= 2


def test_an_object_is_handed_over_where_both_arms_press_it(across: Task) -> None:
    ways = free_space(across.query).paths_to(across.goal)
    reached = touching(across.query, "press_slide", waypoints(across.query, ways)).any(
        axis=2
    )
    assert reached.all(axis=1).sum() >= 2
    modes = pps.plan(across).segments
    arms = [contact.arm for segment in modes for contact in segment.contacts]
    assert arms[0] == 1
    assert arms[-1] == 0


def test_one_arm_that_reaches_both_ends_hands_nothing_over() -> None:
    task = cell({"x": 0.45, "y": -0.6}, {"x": 0.55, "y": -0.8})
    assert {c.arm for s in pps.plan(task).segments for c in s.contacts} == {1}
