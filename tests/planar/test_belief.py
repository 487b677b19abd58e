"""The planar engine with a centre of mass that is not where it is believed to be."""

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Belief, Robot, Task
from pushpressslide.planar.plant import PlanarPlant
from pushpressslide.report.metrics import result

OFF = 0.01  # [m]
ERRORS = [(OFF, 0.0), (0.0, OFF), (0.0, -OFF)]


def mistaken(task: Task, error: tuple[float, float]) -> Task:
    """Return ``task`` with its true centre of mass ``error`` [m] from the believed one."""
    x, y = task.object.center_of_mass
    there = (x + error[0], y + error[1])
    return replace(
        task,
        object=replace(task.object, center_of_mass=there),
        belief=Belief(center_of_mass=(x, y)),
    )


def handled(name: str) -> Task:
    task = pps.load_task(name)
    hands = tuple(Robot("hand", robot.base) for robot in task.robots)
    return replace(task, robots=hands)


@pytest.mark.parametrize("error", ERRORS)
def test_the_plan_knows_nothing_of_the_error(error: tuple[float, float]) -> None:
    task = handled("rear-push-rear")
    assert pps.plan(mistaken(task, error)).segments == pps.plan(task).segments


@pytest.mark.parametrize("error", ERRORS)
def test_tips_touch_the_object_where_they_are_planned_to(
    error: tuple[float, float],
) -> None:
    task = handled("rear-push-rear")
    tips = [
        PlanarPlant(pps.plan(each)).measure().tips[0].position
        for each in (task, mistaken(task, error))
    ]
    assert tips[0] == pytest.approx(tips[1])


def test_a_push_through_the_believed_centre_turns_the_object_about_the_true_one() -> (
    None
):
    task = handled("rear-push-rear")
    ahead = task.start.compose(Pose2(0.15, 0.0, 0.0))
    task = replace(task, goal=ahead)
    turns = []
    for error in ((0.0, OFF), (0.0, -OFF)):
        record = pps.run(pps.plan(mistaken(task, error)), engine="planar")
        yaw = record.arrays["object_pose"][:, 2]
        move = record.arrays["phase"] == 2
        turns.append(yaw[move][60] - yaw[move][0])
    # a centre to the left is turned to the left: the push passes on its right
    assert turns[0] > math.radians(0.05)
    assert turns[1] < -math.radians(0.05)


@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide", "parallel-push"])
@pytest.mark.parametrize("error", ERRORS)
def test_the_goal_is_reached_all_the_same(
    name: str, error: tuple[float, float]
) -> None:
    task = mistaken(handled(name), error)
    plan = pps.plan(task)
    found = result(task, plan, pps.run(plan, engine="planar"), {})
    assert found["final_position_error"] < 0.01
    assert found["final_yaw_error"] < math.radians(2.0)
