"""Everything that a run writes is read back unchanged."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pushpressslide as pps
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Leg, Motion, Restart, Task
from pushpressslide.report.json_text import to_json
from pushpressslide.report.plan_files import plan_from_dict, plan_to_dict
from pushpressslide.taskfile.load import dump_task, load_task, load_written_task

MODES = ("press_slide", "rear_push")
metres = st.floats(-1e3, 1e3)
anywhere = st.builds(Pose2, metres, metres, st.floats(-1e3, 1e3))
points = st.tuples(metres, metres)
some_points = st.none() | st.lists(points, min_size=1, max_size=2).map(tuple)
motions = st.builds(
    Motion,
    speed=st.floats(1e-3, 0.2),
    contacts=some_points,
    cop=st.none() | st.floats(0.0, 1.0) | st.sampled_from(["balanced", "left"]),
    arm=st.none() | st.sampled_from(["left", "right"]),
    vehicle=st.none() | st.sampled_from(["car", "pivot"]),
    face=st.none() | st.integers(0, 3),
)
legs = st.lists(
    st.builds(Leg, st.sampled_from(MODES), anywhere, motions), min_size=1, max_size=4
).map(tuple)
restarts = st.builds(
    Restart,
    state=anywhere.map(lambda X: WorldState({OBJECT: X})),
    leg=st.just(0),
    center_of_mass=points,
    support_friction=st.floats(1e-3, 5.0),
    rho=st.none() | st.floats(1e-3, 20.0),
    free=st.booleans(),
    legs=st.none() | legs | st.just(()),
)


@cache
def simple_plan() -> Plan:
    return pps.plan(pps.load_task("rear-push-rear"))


def resumed(plan: Plan, begun: list[Restart]) -> Plan:
    """Return a plan that was left and gone on with, once for each restart."""
    task = plan.task
    for restart in begun:
        task = task.resumed(restart)
        later = Plan(task, plan.segments, restart, plan.from_search, plan.may_push)
        plan = plan.followed(later)
    return plan


def assert_same(plan: Plan, other: Plan) -> None:
    """What was asked for counts, too."""
    assert plan == other
    assert plan.by_placement == other.by_placement
    for one, read in zip(chain(plan), chain(other), strict=True):
        assert one.queries == read.queries


def chain(plan: Plan) -> list[Plan]:
    """Return a plan and all that went on from it."""
    return [plan, *plan.later]


@settings(deadline=None, max_examples=60)
@given(st.lists(restarts, max_size=4), st.booleans(), st.booleans())
def test_a_plan_with_recoveries_is_read_as_written(
    begun: list[Restart], searched: bool, pushes: bool
) -> None:
    plan = simple_plan()
    plan = resumed(replace(plan, from_search=searched, may_push=pushes), begun)
    data = json.loads(to_json(plan_to_dict(plan)))
    assert_same(plan_from_dict(data, plan.task), plan)


@settings(
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(anywhere, anywhere, anywhere, legs)
def test_a_task_is_read_as_written_wherever_its_bodies_lie(
    tmp_path: Path, start: Pose2, goal: Pose2, error: Pose2, found: tuple[Leg, ...]
) -> None:
    task = replace(load_task("post"), start=start, goal=goal, start_error=error)
    post = replace(task.obstacles[0], pose=start)
    task = replace(task, obstacles=(post,), legs=ending_at(goal, found))
    path = tmp_path / "task.yaml"
    path.write_text(dump_task(task), encoding="utf-8")
    assert_close(load_written_task(path), task)


def ending_at(goal: Pose2, found: tuple[Leg, ...]) -> tuple[Leg, ...]:
    return (*found[:-1], replace(found[-1], goal=goal))


def assert_close(read: Task, task: Task) -> None:
    """Angles are in degrees in the file, which may cost their last bit."""
    for name in ("start", "goal", "start_error"):
        assert_same_pose(getattr(read, name), getattr(task, name))
    for one, other in zip(read.legs, task.legs, strict=True):
        assert_same_pose(one.goal, other.goal)
        assert (one.mode, one.motion) == (other.mode, other.motion)
    rest = {"start": task.start, "goal": task.goal, "start_error": task.start_error}
    obstacles = task.obstacles
    assert_same_pose(read.obstacles[0].pose, obstacles[0].pose)
    assert replace(read, **rest, legs=task.legs, obstacles=obstacles) == task


def assert_same_pose(read: Pose2, pose: Pose2) -> None:
    assert read.position == pose.position
    assert math.isclose(read.yaw, pose.yaw, rel_tol=1e-15, abs_tol=1e-300)


@pytest.mark.parametrize("yaw", [90.0, 300.0, -300.0])
def test_a_task_with_found_legs_can_be_run_from_its_own_file(
    tmp_path: Path, yaw: float
) -> None:
    sets = ["modes=[rear_push]", f"goal.yaw_deg={yaw:g}"]
    plan = pps.plan(load_task("post", sets))
    *begun, last = plan.task.legs
    assert begun
    assert all(abs(leg.goal.yaw) <= math.pi for leg in begun)
    assert last.goal == plan.task.goal
    path = tmp_path / "task.yaml"
    path.write_text(dump_task(plan.task), encoding="utf-8")
    for read in (load_written_task(path), load_task(path)):
        assert [leg.goal.position for leg in read.legs] == [
            leg.goal.position for leg in plan.task.legs
        ]
        for leg, other in zip(read.legs, plan.task.legs, strict=True):
            assert_same_pose(leg.goal, other.goal)
