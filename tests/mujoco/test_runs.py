"""Shipped tasks in MuJoCo, with the plans and the laws of the other engines."""

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.core.knock import Ball, Knock
from pushpressslide.core.record import Record
from pushpressslide.jobs.engines import ENGINES, ArmOptions
from pushpressslide.jobs.run import run as run_plan
from pushpressslide.jobs.run import run_task, simulate


def reached(task: str, engine: str = "mujoco", **changes: object) -> Record:
    record = run_plan(task, engine=engine, overrides=changes)
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 3e-3
    assert abs(record.figures["final_yaw_error"]) < np.radians(1.0)
    return record


@pytest.mark.parametrize(
    "name",
    [
        "rear-push-rear",
        "press-slide",
        pytest.param("bimanual-slide", marks=pytest.mark.long),
        pytest.param("incline-slide", marks=pytest.mark.long),
        pytest.param("book", marks=pytest.mark.long),
    ],
)
def test_a_shipped_task_reaches_its_goal(name: str) -> None:
    record = reached(name)
    assert record.engine == "mujoco"
    assert record.meta["clearance_driven"] > 0.0
    # nothing sinks, jumps or lifts off: the centre of the body stays at its height
    normal = np.array(record.plan.task.support.frame.normal)
    heights = record.arrays["object_pose_3d"][:, 4:] @ normal
    assert np.ptp(heights) < 1e-3


def test_the_same_seed_gives_the_same_record() -> None:
    plan = pps.plan("rear-push-rear")
    one, other = (run_plan(plan, engine="mujoco") for _ in range(2))
    for name in one.arrays:
        if name.startswith("tick_"):  # wall times
            continue
        values = one.arrays[name]
        np.testing.assert_array_equal(values, other.arrays[name], err_msg=name)


def test_a_run_agrees_with_drake() -> None:
    plan = pps.plan("push-t")
    ours, theirs = (run_plan(plan, engine=name) for name in ("mujoco", "drake"))
    ends = [record.arrays["object_pose"][-1] for record in (ours, theirs)]
    assert np.hypot(*(ends[0] - ends[1])[:2]) < 2e-3
    assert ours.arrays["time"][-1] == pytest.approx(theirs.arrays["time"][-1], rel=0.1)


@pytest.mark.long
def test_another_body_is_pushed_along() -> None:
    task = pps.load_task("tool-use")
    result = run_task(task, engine="mujoco")
    assert result["success"], result["reason"]


def test_a_knocked_object_is_brought_to_its_goal() -> None:
    knocks = (Knock(share=0.5, ball=Ball("left")),)
    task = replace(pps.load_task("press-slide"), disturbances=knocks)
    _, record, _ = simulate(task, engine="mujoco")
    assert pps.result(record)["success"], record.reason_text
    assert 0.01 < record.meta["knocked"]["moved"] < 0.05


def test_an_object_pushed_over_the_edge_falls() -> None:
    task = pps.load_task("rear-push-rear")
    edge = 0.5 * (task.start.x + task.goal.x)
    plan = pps.plan(task)
    short = ((-1.0, -1.0), (edge, -1.0), (edge, 1.0), (-1.0, 1.0))
    table = replace(task.support, region=short)
    onto = replace(plan, task=replace(task, support=table))
    record = ENGINES["mujoco"].run(onto, pps.RunOptions(), ArmOptions())
    assert record.reason == "diverged"
    assert "fallen" in record.reason_text


def test_models_of_drake_are_refused() -> None:
    plan = pps.plan("rear-push-rear")
    options = ArmOptions(models="drake_models")
    with pytest.raises(TaskError, match="generated"):
        ENGINES["mujoco"].run(plan, pps.RunOptions(), options)
