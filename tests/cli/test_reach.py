"""Goals out of reach, by the arms' own kinematics, are refused when the task is loaded;
others never are.
"""

from collections.abc import Callable
from pathlib import Path

import pytest

import pushpressslide as pps
from pushpressslide.robots.facts import load_facts
from pushpressslide.robots.urdf import urdf_text

Refusal = Callable[..., str]
FAR = ["--set", "goal={x: 1.4, y: 0.1}"]


@pytest.mark.parametrize("model", ["panda", "iiwa7"])
@pytest.mark.parametrize("command", ["run", "select", "plan"])
def test_a_goal_out_of_reach_is_refused_with_the_shortfall(
    model: str, command: str, refusal: Refusal
) -> None:
    line = refusal(command, "rear-push-rear", "--set", f"robots.0.model={model}", *FAR)
    assert ": goal: object's centre at x 1.4, y 0.1" in line
    assert f"the tip of the {model} stays 0." in line


def test_reach_is_of_the_arm_where_it_stands(refusal: Refusal) -> None:
    moved = ["--set", "robots.0.base={x: 0.8, y: 0.5, yaw_deg: -90}"]
    pps.load_task("rear-push-rear", [*FAR[1:], moved[1]])
    assert ": start: " in refusal(
        "run", "rear-push-rear", "--set", "robots.0.base={x: 1.6}"
    )


def test_a_free_tip_reaches_what_no_arm_does() -> None:
    far = pps.load_task(
        "rear-push-rear", ["robots.0.model=hand", "goal={x: 2.4, y: 0.1}"]
    )
    assert far.goal.x == 2.4


def test_nothing_is_refused_that_selection_could_do() -> None:
    """On a grid of goals around the edge of what can be reached: feasible means loaded."""
    task = pps.load_task("rear-push-rear")
    from dataclasses import replace

    from pushpressslide.core.errors import TaskError
    from pushpressslide.core.pose import Pose2
    from pushpressslide.selection.select import select
    from pushpressslide.taskfile.checks import check_reach

    loaded = 0
    for x in (0.60, 0.68, 0.76, 0.84, 0.92, 1.0, 1.2):
        moved = replace(task, start=Pose2(x - 0.2, 0.05, 0.0), goal=Pose2(x, 0.05, 0.0))
        try:
            check_reach(moved.query, moved.object)
            loaded += 1
        except TaskError:
            assert not select(moved)[0].feasible, x
    assert 1 < loaded < 7


def test_a_wrong_tip_frame_is_refused_by_its_field(
    tmp_path: Path, refusal: Refusal
) -> None:
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(urdf_text(load_facts("panda")))
    robot = f"robots=[{{model: {urdf}, tip_frame: nowhere}}]"
    line = refusal("run", "rear-push-rear", "--set", robot)
    assert (
        "robots[0].tip_frame: 'nowhere' is not allowed; it has no frame 'nowhere'"
        in line
    )
    assert "panda_link8" in line


def test_a_physics_step_longer_than_the_control_period_is_refused(
    refusal: Refusal,
) -> None:
    line = refusal("run", "rear-push-rear", "--set", "motion.time_step=0.008")
    assert (
        "motion.time_step: 0.008 is not allowed; allowed: at most "
        "motion.control_period, 0.004 s" in line
    )
