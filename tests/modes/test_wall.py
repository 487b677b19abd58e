"""Two arms press an object on a wall: choices, refusals, and the whole press-fit on the
planar engine.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.control import PHASES
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Obstacle, Task
from pushpressslide.mechanics.pressure import center_of_pressure
from pushpressslide.modes import MODES
from pushpressslide.modes.bimanual_press_slide import MODE
from pushpressslide.planar.engine import run as run_planar
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import HeldDrive
from pushpressslide.selection.select import select
from pushpressslide.selection.solve import plan


def turn(*overrides: str, contacts=None) -> Task:
    """One motion of the shipped task, the turn above the opening."""
    task = pps.load_task("press-fit", list(overrides))
    query = task.queries()[2]
    motion = replace(query.motion, contacts=contacts)
    alone = replace(task, legs=(), modes=query.modes, motion=motion)
    return replace(alone, start=query.start, goal=query.goal)


def test_contacts_are_moved_to_the_side_that_is_down_in_the_end_and_pressed_alike() -> (
    None
):
    task = turn()
    choice = next(c for c in MODE.choices(task.query) if c.feasible)
    first, second = choice.contacts
    assert first.load == second.load == pytest.approx(65.4, abs=0.1)
    middle = [0.5 * (a + b) for a, b in zip(first.point, second.point, strict=True)]
    assert task.goal.rotate((middle[0], middle[1])) == pytest.approx(
        (0.0, -0.15 * 0.125)
    )


def test_at_the_goal_the_load_is_in_the_middle_while_the_arms_carry_the_weight() -> (
    None
):
    task = turn()
    choice = next(c for c in MODE.choices(task.query) if c.feasible)
    (segment,) = plan(task, choice).segments
    tracker = MODE.tracker(task.query, segment)
    allocate = MODE.allocator(choice.contacts, 0.8, None, segment.drive.center)
    path = segment.path
    wrench = tracker.step(path, task.goal, path.length, 1e-9, 1.0).wrench
    forces = allocate(wrench.fx, wrench.fy, wrench.tau).forces
    loads = [c.load for c in choice.contacts]
    points = [c.point for c in choice.contacts]
    weight = task.goal.unrotate(task.scene.weight_along)
    # what the wall's friction takes, and where it puts the load
    sliding = np.sum(forces, axis=0) + weight
    cop = np.array(
        center_of_pressure(
            0.0, (0.0, 0.0), loads, points, [*forces, weight], [0.25, 0.25, 0.125]
        )
    )
    assert cop - 0.25 * sliding / sum(loads) == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (
            ["contact.friction=0.205", "support.friction=0.2"],
            "must exceed the wall's, 0.20",
        ),
        (["limits.normal_force=5"], "to hold 19.6 N on the wall"),
        (
            ["limits.normal_force=40"],
            "65.4 N of each arm; allowed 36 N by limits.normal_force",
        ),
        (["support.friction=0.7", "contact.friction=1.5"], "tip"),
    ],
)
def test_what_would_fall_or_tip_is_refused_before_anything_moves(
    overrides, says
) -> None:
    with pytest.raises(InfeasibleTaskError, match=says):
        pps.plan(pps.load_task("press-fit", overrides))


def test_other_modes_say_that_they_cannot_hold_it() -> None:
    task = replace(
        turn(), modes=tuple(name for name, mode in MODES.items() if mode.arms == 2)
    )
    refused = {c.mode: c for c in select(task) if not MODES[c.mode].carries_weight}
    assert set(refused) == {"parallel_push", "orthogonal_push", "press_and_push"}
    for choice in refused.values():
        assert choice.refusal is not None
        assert choice.refusal.code == "support"
        assert choice.reason.startswith("cannot hold an object on a wall")


@pytest.mark.parametrize(
    "overrides", [[], ["support.opening.size=[0.82, 0.27]", "goal.y=-0.01"]]
)
def test_the_press_fit_is_lifted_slid_and_turned_on_the_planar_engine(
    overrides,
) -> None:
    task = pps.load_task("press-fit", overrides)
    plan = pps.plan(task)
    record = run_planar(plan)
    found = result(task, plan, record, {})
    assert found["success"], found["reason"]
    assert found["path_max_error"] < 0.003
    assert found["slip_distance"] < 0.002
    use = [contact["mean_friction_use"] for contact in found["contacts"]]
    assert max(use) < 0.6
    # the ledge carries it until then
    standing = record.arrays["object_pose"][record.arrays["phase"] < 2]
    assert standing == pytest.approx(
        np.tile(standing[0], (len(standing), 1)), abs=1e-12
    )


def test_an_object_that_nothing_presses_or_carries_falls() -> None:
    hanging = replace(pps.load_task("press-fit"), obstacles=())
    assert (record := run_planar(plan(hanging))).reason == "diverged"
    assert "falls" in record.reason_text


def test_where_nothing_else_carries_it_the_arms_hold_it_to_the_end() -> None:
    task = turn()
    ledge = Obstacle("ledge", Box((0.2, 0.04, 0.2)), Pose2(0.0, -0.417))
    task = replace(
        task,
        support=replace(task.support, opening=None),
        obstacles=(ledge,),
        goal=Pose2(0.05, 0.1),
    )
    plan = pps.plan(task)
    record = run_planar(plan)
    assert result(task, plan, record, {})["success"]
    assert PHASES[int(record.arrays["phase"][-1])] == "move"
    held = record.arrays["time"] > record.arrays["time"][-1] - 0.3
    assert max(np.ptp(record.arrays["object_pose"][held], axis=0)) < 1e-4


def test_the_same_motion_in_a_mirror_needs_the_same_press() -> None:
    task = turn()
    mirrored = replace(
        task,
        start=Pose2(-task.start.x, task.start.y, -task.start.yaw),
        goal=Pose2(-task.goal.x, task.goal.y, -task.goal.yaw),
        robots=task.robots[::-1],
    )
    here, there = (
        next(c for c in MODE.choices(t.query) if c.feasible) for t in (task, mirrored)
    )
    assert here.contacts[0].load == pytest.approx(there.contacts[0].load)
    used = []
    for choice in (here, there):
        drive = choice.segments[0].drive
        assert isinstance(drive, HeldDrive)
        used.append(drive.friction_utilisation)
    assert used[0] == pytest.approx(used[1], rel=1e-6)
    assert math.isclose(here.path_length, there.path_length)
