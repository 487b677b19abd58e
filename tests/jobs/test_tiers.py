"""Worlds of the tiers, and what is tried where the stated belief refuses."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import InfeasibleTaskError, TaskError
from pushpressslide.core.sensing import Sensing
from pushpressslide.core.task import Task
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.jobs.hopes import hopeful_runner, hopes
from pushpressslide.jobs.run import simulate
from pushpressslide.jobs.sampling import random_task
from pushpressslide.jobs.stages import StageOptions, StageRunner
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.jobs.tiers import TIERS, drawn_world
from pushpressslide.selection.stages import plan_stages
from pushpressslide.taskfile.load import dump_task, load_task, task_from_data
from pushpressslide.taskfile.yaml_text import parse_yaml

PUSH = "rear-push-rear"
TOLERANCE = ("tolerance.position=0.01", "tolerance.yaw_deg=2")
SEED = 620


def at_tier(name: str, task: str = PUSH) -> Task:
    return load_task(task, [f"truth={name}"])


def test_a_task_without_a_tier_stays_as_it_is() -> None:
    task = load_task(PUSH)
    assert drawn_world(task, 3, "drake") is task


@pytest.mark.parametrize("name", list(TIERS))
def test_the_truth_of_the_object_stays_and_beliefs_are_within_the_tier(
    name: str,
) -> None:
    task = at_tier(name)
    tier = TIERS[name]
    ratios = []
    for seed in range(60):
        drawn = drawn_world(task, seed, "drake")
        assert (drawn.object, drawn.support) == (task.object, task.support)
        belief = drawn.belief
        assert belief.mass is not None
        assert belief.support_friction is not None
        ratios.append(task.object.mass / belief.mass)
        low, high = tier.support
        share = task.support.friction / belief.support_friction
        assert low - 1e-9 <= share <= high + 1e-9
        assert math.hypot(*drawn.center_error) <= belief.center_error + 1e-12
        bias = math.hypot(*drawn.sensing.position_bias)
        assert bias == pytest.approx(tier.position_bias)
    low, high = tier.mass
    assert low <= min(ratios) < 1.0 - 0.5 * (1.0 - low)
    assert 1.0 + 0.5 * (high - 1.0) < max(ratios) <= high


def test_the_same_seed_draws_the_same_world() -> None:
    task = at_tier("tier3")
    assert drawn_world(task, 4, "drake") == drawn_world(task, 4, "drake")
    assert drawn_world(task, 4, "drake") != drawn_world(task, 5, "drake")


def test_what_an_engine_or_an_arm_does_not_have_is_left_out() -> None:
    task = at_tier("tier2")
    assert drawn_world(task, 0, "drake").truth.link_mass != 1.0
    planar = drawn_world(task, 0, "planar").truth
    assert planar == planar.for_tips()
    assert planar != EXACT
    robots = tuple(replace(one, interface="velocity") for one in task.robots)
    servo = drawn_world(replace(task, robots=robots), 0, "drake").truth
    assert servo == servo.for_servos()


def test_other_errors_of_the_truth_stay() -> None:
    own = ("truth={tier: tier2, ridge: 0.001, backlash_deg: 0.1, link_mass: 1.5}",)
    drawn = drawn_world(load_task(PUSH, own), 0, "drake").truth
    assert (drawn.ridge, drawn.tier) == (0.001, None)
    assert drawn.backlash == pytest.approx(math.radians(0.1))
    assert abs(drawn.link_mass - 1.0) == pytest.approx(0.1)  # the tier's
    assert replace(drawn, ridge=0.0, backlash=0.0) == (
        drawn_world(at_tier("tier2"), 0, "drake").truth
    )


def test_a_plan_hopes_as_a_run_does() -> None:
    task = at_tier("tier3", "press-slide")
    world = drawn_world(task)
    with pytest.raises(InfeasibleTaskError):
        plan_stages(world)
    plan = pps.plan(task)
    assert plan.task.dares
    assert plan.task.belief.center_error == world.belief.center_error


def test_a_plan_is_that_of_the_world_of_seed_0() -> None:
    task = at_tier("tier3")
    world = drawn_world(task, 0, "drake")
    plan = pps.plan(task)
    assert plan.task == world
    assert pps.select(task) == pps.select(world)
    assert pps.select(task) != pps.select(load_task(PUSH))


def test_a_file_names_a_tier_in_one_word() -> None:
    task = at_tier("tier2")
    assert task.truth == Truth(tier="tier2")
    assert (
        task_from_data(parse_yaml(dump_task(task), "again"), "again").truth
        == task.truth
    )
    with pytest.raises(TaskError, match=r"truth\.tier"):
        at_tier("tier4")


def test_a_refusal_within_the_errors_of_the_belief_is_tried() -> None:
    """A press needs a grip that the belief denies and its error allows."""
    task = load_task("press-slide", ["belief.contact_friction=0.16"])
    with pytest.raises(InfeasibleTaskError) as refused:
        StageRunner(task, StageOptions("planar"))
    hopeful = replace(task, belief=replace(task.belief, friction_error=0.5))
    assert len(list(hopes(task))) == 1
    assert len(list(hopes(hopeful))) == 4
    hopeful_runner(hopeful, StageOptions("planar"))
    with pytest.raises(InfeasibleTaskError) as again:
        hopeful_runner(task, StageOptions("planar"))
    assert str(again.value) == str(refused.value)


def test_a_refusal_because_of_the_centre_of_mass_is_tried_with_the_likeliest() -> None:
    believed = (0.03, -0.04)
    task = load_task(PUSH)
    belief = replace(task.belief, center_of_mass=believed, center_error=0.02)
    unsure = replace(task, belief=belief)
    centers = [one.belief.center_of_mass for one in hopes(unsure)]
    assert centers[:2] == [believed, believed]
    assert centers[2] == pytest.approx((0.018, -0.024))
    surer = replace(unsure, belief=replace(belief, center_error=0.1))
    (_, _, likeliest) = hopes(surer)
    assert likeliest.belief.center_of_mass == pytest.approx((0.0, 0.0))
    assert likeliest.dares


def test_hopes_are_within_the_error_of_the_mass_and_differ() -> None:
    task = load_task(PUSH)
    believed = task.full_belief.mass
    assert believed is not None
    sure = replace(task, belief=replace(task.belief, friction_error=0.2))
    heavy = replace(sure, belief=replace(sure.belief, mass_error=0.4))
    assert {one.belief.mass for one in list(hopes(sure))[2:]} == {believed}
    masses = [one.belief.mass for one in list(hopes(heavy))[2:]]
    assert masses == pytest.approx([0.6 * believed, believed, 1.4 * believed])
    for one in (sure, heavy):
        beliefs = [(hope.belief, hope.dares) for hope in hopes(one)]
        assert len(set(beliefs)) == len(beliefs)
    only = replace(task, belief=replace(task.belief, mass_error=0.4))
    masses = [one.belief.mass for one in hopes(only)][1:]
    assert masses == pytest.approx([0.6 * believed, 1.4 * believed])


def test_an_object_that_might_slide_before_it_is_felt_is_tried() -> None:
    """With the least drag it would, and with the believed one it is not felt either."""
    task = random_task(load_task("press-slide", ["modes=null"]), 26, 612, "any")
    options = StageOptions("planar", 612026)
    drawn = drawn_world(replace(task, truth=Truth(tier="tier3")), 612026, "planar")
    with pytest.raises(InfeasibleTaskError, match="before the contacts are felt"):
        StageRunner(drawn, options)
    assert hopeful_runner(drawn, options).task.dares


@pytest.mark.parametrize("name", list(TIERS))
def test_a_tier_states_the_error_of_its_masses(name: str) -> None:
    drawn = drawn_world(at_tier(name), 2, "planar")
    most = TIERS[name].mass[1] - 1.0
    assert drawn.belief.mass_error == pytest.approx(min(0.5, most))


def test_a_push_arrives_in_the_second_tier() -> None:
    plan, record, _ = simulate(at_tier("tier2"), engine="planar", seed=1)
    assert plan.task.sensing != Sensing()
    assert record.reason == "goal_reached"
    x, y, yaw = record.arrays["object_pose"][-1].tolist()
    bias_x, bias_y = plan.task.sensing.position_bias
    goal = plan.task.goal
    assert math.hypot(x + bias_x - goal.x, y + bias_y - goal.y) < 0.01
    assert abs(math.remainder(yaw - goal.yaw, math.tau)) < math.radians(2.0)


LADDER = {"tier2": (5, 4), "tier3": (5, 1)}
"""Tasks of a tier, and how many of them have to arrive at least: five tell no rate, but
a filter or a recovery that does not work.
"""


@pytest.mark.long
@pytest.mark.parametrize("name", list(LADDER))
def test_random_tasks_arrive_in_the_worlds_of_a_tier(name: str, tmp_path: Path) -> None:
    """One arm, no mode given, on the planar engine."""
    task = load_task(PUSH, ["modes=null", *TOLERANCE])
    tasks, least = LADDER[name]
    options = SweepOptions(
        attempts=tasks,
        vary="tasks",
        draw="any",
        world=name,  # type: ignore[arg-type]
        seed=SEED,
        engine="planar",
    )
    assert sweep(task, options, tmp_path)["reached"] >= least


def test_a_body_whose_centre_is_outside_of_it_has_a_world() -> None:
    """A slim L: its centroid is between its legs."""
    legs = "[[0, 0], [0.2, 0], [0.2, 0.04], [0.04, 0.04], [0.04, 0.2], [0, 0.2]]"
    task = load_task(
        PUSH, [f"object.shape={{prism: {{polygon: {legs}, height: 0.1}}}}"]
    )
    shape = task.object.shape
    assert shape.depth(task.object.center_of_mass) < 0.0
    for seed in range(9):
        drawn = drawn_world(replace(task, truth=Truth(tier="tier2")), seed)
        assert drawn.belief.center_of_mass is not None
        assert shape.hull.depth(drawn.belief.center_of_mass) > 0.0
