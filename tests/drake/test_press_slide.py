"""One arm on top, in Drake: goals reached, presses lost and found again, wrong beliefs,
tool use.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.control import PHASES
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import load_task

BACK = [
    "start.x=0.40",
    "start.y=0.33",
    "start.yaw_deg=100",
    "goal.x=0.47",
    "goal.y=-0.25",
    "goal.yaw_deg=90",
]


Run = Callable[[str], tuple[Plan, Record]]


def measured(task):
    """Return the result of a run, the yaw error in degrees and the position error in
    millimetres.
    """
    plan, record, _ = simulate(task)
    return figures(plan, record)


def figures(plan: Plan, record: Record):
    found = result(plan.task, plan, record, {})
    return (
        found,
        1e3 * found["final_position_error"],
        math.degrees(found["final_yaw_error"]),
    )


def test_press_slide_reaches_its_goal_without_slipping(shipped_run: Run) -> None:
    found, off, turned = figures(*shipped_run("press-slide"))
    assert found["success"]
    assert off < 1.5
    assert turned < 0.5
    assert found["torque_limit_violation_fraction"] == 0.0
    assert found["slip_distance"] < 0.003


@pytest.mark.long
@pytest.mark.parametrize(
    "overrides",
    [
        ["start.x=0.40", "start.yaw_deg=75"],
        ["start.x=0.6", "start.y=-0.3", "start.yaw_deg=125"],
    ],
)
def test_press_slide_reaches_its_goal_from_other_starts(overrides: list[str]) -> None:
    _, off, turned = measured(load_task("press-slide", overrides))
    assert off < 1.5
    assert turned < 0.5


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "overrides", "most"),
    [
        ("press-slide", BACK, 3.0),
        # press-slide-car is run with noise, in test_noise.py
        ("press-slide-forklift", [], 3.0),
        ("press-slide-pivot", [], 5.0),
    ],
)
def test_other_vehicles_reach_their_goals(
    shipped_run: Run, name: str, overrides: list[str], most: float
) -> None:
    if overrides:
        _, off, turned = measured(load_task(name, overrides))
    else:
        _, off, turned = figures(*shipped_run(name))
    assert off < most
    assert turned < 1.0


def test_a_tip_too_smooth_to_drag_is_refused_before_it_moves() -> None:
    with pytest.raises(InfeasibleTaskError, match="the tip slips before the object"):
        # 1.3 times the support's
        simulate(load_task("press-slide", ["contact.friction=0.39"]))


@pytest.mark.long
def test_a_tip_just_rough_enough_drags() -> None:
    # 1.5 times
    _, off, turned = measured(load_task("press-slide", ["contact.friction=0.45"]))
    assert off < 5.0
    assert turned < 1.0


@pytest.mark.long
@pytest.mark.parametrize(
    "belief",
    ["rho=0.0545", "support_friction=0.18", "support_friction=0.42"],
)
def test_a_wrong_belief_is_found_out_on_the_way(belief: str) -> None:
    task = load_task("press-slide", [f"belief.{belief}"])
    # the first plan has it wrong
    assert pps.plan(task).segments != pps.plan(load_task("press-slide")).segments
    _, off, turned = measured(task)
    assert off < 5.0
    assert turned < 1.0


@pytest.mark.long
def test_a_lost_press_is_noticed_and_taken_again() -> None:
    from pushpressslide.sim.engine import run

    task = load_task("press-slide")
    plan = pps.plan(task)
    begin = 9.0
    end = 9.2

    def cut(time, commands):
        if not begin <= time < end:
            return commands
        return tuple(c and replace(c, force=(*c.force[:2], 0.0)) for c in commands)

    record = run(plan, RunOptions(disturb=cut))
    time = record.arrays["time"]
    phase = record.arrays["phase"]
    touching = phase == PHASES.index("touch")
    noticed = time[touching & (time > begin)]
    assert len(noticed)
    assert noticed[0] - begin < 0.05
    moving = phase == PHASES.index("move")
    assert time[moving & (time > end)][0] - end < 1.0
    found = result(task, plan, record, {})
    assert found["success"]


@pytest.mark.long
@pytest.mark.parametrize(
    "overrides", [[], ["obstacles.0.mass=1.0"], ["obstacles.0.pose.x=0.46"]]
)
def test_a_bar_pushes_a_cube_to_its_place(overrides: list[str]) -> None:
    found, off, turned = measured(load_task("tool-use", overrides))
    assert found["success"]
    assert off < 10.0
    assert turned < 3.0


@pytest.mark.parametrize(
    "name",
    ["press-slide", pytest.param("press-slide-forklift", marks=pytest.mark.long)],
)
def test_the_planar_engine_takes_the_same_way(shipped_run: Run, name: str) -> None:
    _, drake = shipped_run(name)
    _, planar, _ = simulate(load_task(name), engine="planar")
    paths = []
    for record in (drake, planar):
        moving = record.arrays["phase"] == PHASES.index("move")
        paths.append(record.arrays["object_pose"][moving][:, :2])
    far = [np.min(np.hypot(*(paths[1] - p).T)) for p in paths[0][::20]]
    assert max(far) < 0.01
