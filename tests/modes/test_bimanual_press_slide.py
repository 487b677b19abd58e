"""Two arms press on top and slide the object in any direction: loads, centre of
pressure, runs on both engines.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.core import margins
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, ObjectModel, Task
from pushpressslide.core.wrench import Twist
from pushpressslide.jobs.sampling import random_task, varied_task
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.pressure import center_of_pressure
from pushpressslide.modes.base import Measured
from pushpressslide.modes.bimanual_press_slide import MODE
from pushpressslide.planar.engine import run as run_planar
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import HeldDrive

GRAVITY = 9.81
SIDES = ((0.0, 0.12), (0.0, -0.12))


def slide(
    goal: Pose2 | None = None, contacts=None, cap: float = 60.0, **motion
) -> Task:
    """The shipped task from a start in the middle, to another goal."""
    task = pps.load_task("bimanual-slide")
    start = Pose2(0.55, 0.0, 0.0)
    goal = goal or Pose2(0.60, 0.1, 0.5)
    motion = replace(task.motion, contacts=contacts, **motion)
    return replace(
        task,
        start=start,
        goal=goal,
        motion=motion,
        limits=replace(task.limits, normal_force=cap),
    )


def turned(point: tuple[float, float], degrees: float) -> Pose2:
    """The goal of ``slide`` that is turned about a point of B."""
    start = Pose2(0.55, 0.0, 0.0)
    yaw = math.radians(degrees)
    cx, cy = start.apply(point)
    x, y = Pose2(0.0, 0.0, yaw).rotate(point)
    return Pose2(cx - x, cy - y, yaw)


def with_cop(task: Task, cop) -> Task:
    return replace(task, motion=replace(task.motion, cop=cop))


def best(task: Task, cop=None) -> Choice:
    choice = MODE.choices(with_cop(task, cop).query)[0]
    assert choice.feasible, choice.reason
    return choice


def driven(choice: Choice) -> HeldDrive:
    drive = choice.segments[0].drive
    assert isinstance(drive, HeldDrive)
    return drive


def cop_fraction(task: Task, choice: Choice) -> float:
    """The centre of pressure without drag, as part of the way from left to right."""
    loads = [contact.load for contact in choice.contacts]
    left, right = (contact.point for contact in choice.contacts)
    weight = task.object.mass * GRAVITY
    cop = center_of_pressure(weight, (0.0, 0.0), loads, (left, right))
    line = ContactLine(left, right)
    fraction = line.in_axes((cop[0] - left[0], cop[1] - left[1]))[0] / line.length
    assert f"centre of pressure {fraction:.2f} of the way" in choice.reason
    return fraction


def run(made: Plan) -> dict:
    return result(made.task, made, run_planar(made), {})


GOALS = {
    "sideways": Pose2(0.55, 0.2, 0.0),
    "back": Pose2(0.42, 0.02, -0.3),
    "turn on the spot": turned((0.0, 0.0), 60.0),
    "pivot about a contact": turned((0.0, 0.12), 45.0),
    "pivot about a point beside the object": turned((0.1, -0.3), -30.0),
    "anywhere": Pose2(0.65, -0.1, -0.7),
}


@pytest.mark.parametrize("goal", GOALS.values(), ids=list(GOALS))
def test_any_goal_is_reached_along_the_planned_path(goal: Pose2) -> None:
    task = slide(goal, SIDES)
    measured = run(pps.plan(task, best(task)))
    assert measured["success"], measured["reason"]
    assert measured["final_position_error"] < 5e-4
    assert measured["final_yaw_error"] < math.radians(0.2)
    assert measured["path_max_error"] < 1e-4
    assert measured["slip_distance"] < 1e-4


@pytest.mark.parametrize("cop", ["left", "right", 0.42, 0.6])
def test_the_centre_of_pressure_goes_where_the_strategy_wants_it_and_the_goal_is_reached(
    cop,
) -> None:
    task = slide(turned((0.0, 0.05), 40.0), SIDES)
    choice = best(task, cop)
    fraction = cop_fraction(task, choice)
    if isinstance(cop, float):
        assert fraction == pytest.approx(cop)
    else:
        assert fraction < 0.4 if cop == "left" else fraction > 0.52
    left, right = (contact.load for contact in choice.contacts)
    weight = task.object.mass * GRAVITY
    cop_y = 0.12 * (left - right) / (weight + left + right)
    assert 0.12 - 0.24 * fraction == pytest.approx(cop_y)
    measured = run(pps.plan(task, choice))
    assert measured["success"], measured["reason"]
    assert measured["path_max_error"] < 1e-4


def test_a_pivot_is_tracked_at_the_centre_of_pressure_and_any_other_motion_at_the_com() -> (
    None
):
    task = slide(turned((0.0, 0.05), 40.0), SIDES)
    pivot = best(task, "left")
    _, y = driven(pivot).point
    assert 0.02 < y < 0.12
    assert 0.12 - 0.24 * cop_fraction(task, pivot) == pytest.approx(y)
    for goal in (Pose2(0.55, 0.2, 0.0), Pose2(0.65, -0.1, -0.3)):
        (segment,) = best(slide(goal, SIDES), 0.4).segments
        assert Pose2() == segment.X_BV


def test_balanced_loads_hold_the_object_in_every_twist() -> None:
    task = slide()
    choice = best(task)
    rng = np.random.default_rng(0)
    allocate = MODE.allocator(choice.contacts, task.contact_friction)
    weight = task.object.mass * GRAVITY
    level = task.support.friction * (weight + sum(c.load for c in choice.contacts))
    surface = EllipsoidLimitSurface(level, driven(choice).rho)
    held = task.contact_friction * choice.contacts[0].load
    least = (1.0 - margins.FRICTION_USES[-1]) * held
    for _ in range(500):
        wrench = surface.wrench(Twist(*rng.normal(size=2), rng.normal() / 0.1))
        allocation = allocate(wrench.fx, wrench.fy, wrench.tau)
        assert allocation.status == "ok"
        assert allocation.margin > least


def test_the_two_forces_do_not_work_against_each_other() -> None:
    choice = best(slide(contacts=SIDES))
    allocate = MODE.allocator(choice.contacts, 0.8)
    rng = np.random.default_rng(1)
    for _ in range(200):
        first, second = allocate(*rng.normal(size=2), 0.1 * rng.normal()).forces
        assert first[1] * second[1] >= -1e-12


def test_a_tall_object_is_led_as_well_since_the_drag_at_its_top_is_reckoned_with() -> (
    None
):
    """Two presses 0.3 m above the table move the centre of pressure by 0.09 m."""
    task = replace(
        slide(turned((0.0, 0.1), 35.0)),
        object=ObjectModel(Box((0.4, 0.4, 0.3)), 2.0, (0.0, 0.0)),
    )
    measured = run(pps.plan(task, best(task)))
    assert measured["success"]
    assert measured["path_max_error"] < 2e-4


def test_the_arms_do_not_cross() -> None:
    for name in ("sideways", "turn on the spot", "anywhere"):
        task = slide(GOALS[name])
        for choice in MODE.choices(task.query):
            if choice.feasible:
                ends = [X.compose(task.object.X_GB) for X in (task.start, task.goal)]
                left, right = (
                    [X.apply(c.point)[1] for X in ends] for c in choice.contacts
                )
                assert max(left) > min(right)
                assert [c.arm for c in choice.contacts] == [0, 1]


def refusal(task: Task, cop=None) -> str:
    choices = MODE.choices(with_cop(task, cop).query)
    assert not any(choice.feasible for choice in choices)
    return choices[0].reason


def test_a_pivot_on_a_contact_that_would_not_press_is_refused_with_the_span_that_is_possible() -> (
    None
):
    task = slide(turned((0.0, 0.12), 40.0), SIDES)
    for cop in (0.0, 0.05, 0.95, 1.0):
        why = refusal(task, cop)
        span = why.rsplit("allowed from ", 1)[1]
        low, high = (float(word) for word in span.split(" to "))
        assert 0.0 < low < 0.5 < high < 1.0
        assert not low <= cop <= high
    assert best(task, round(low + 0.02, 2)).feasible
    assert "allowed from 3 N" in refusal(replace_press(task, 54.0), 0.02)


def test_the_strategy_of_the_task_file_is_the_one_that_is_planned() -> None:
    fractions = {}
    for cop in ("balanced", "left", "right", "0.55", "null"):
        task = pps.load_task("bimanual-slide", [f"motion.cop={cop}"])
        fractions[cop] = cop_fraction(task, best(task, task.motion.cop))
    assert fractions["left"] < 0.45 < 0.5 < fractions["right"]
    assert fractions["balanced"] == fractions["null"] == pytest.approx(0.5)
    assert fractions["0.55"] == pytest.approx(0.55)


def replace_press(task: Task, force: float) -> Task:
    return replace(task, motion=replace(task.motion, press_force=force))


def test_too_little_friction_or_force_is_refused_with_the_number_that_decides() -> None:
    task = slide(contacts=SIDES)
    smooth = replace(task, belief=replace(task.full_belief, contact_friction=0.25))
    assert "contact friction 0.25 must exceed the support's, 0.3" in refusal(smooth)
    weak = slide(contacts=SIDES, cap=6.0)
    assert "allowed 5.4 N by limits.normal_force" in refusal(weak)
    why = refusal(replace_press(task, 70.0))
    allowed = "allowed 54 N by limits.normal_force"
    assert f"motion.press_force of 70 N, {allowed}" in why
    why = refusal(replace_press(task, 5.0))
    assert "pressed with 5.0 and 5.0 N the tips slip" in why


def test_the_press_at_which_a_motion_is_refused_is_the_one_at_which_the_tips_slip() -> (
    None
):
    task = slide(Pose2(0.55, 0.2, 0.0), SIDES)
    held = replace_press(task, 7.5)
    why = refusal(replace_press(task, 6.2))
    use = float(why.split("takes ")[1].split()[0])
    assert margins.FRICTION_USES[-1] < use < 1.0
    assert run(pps.plan(held, best(held)))["slip_distance"] < 1e-4
    lost = replace_press(task, 5.0)
    choice = MODE.choices(lost.query)[0]
    assert driven(choice).friction_utilisation > 1.0
    measured = run(pps.plan(lost, choice, force=True))
    assert measured["slip_distance"] > 0.01


def test_wrong_contacts_are_refused_with_the_distance() -> None:
    near = slide(contacts=((0.0, 0.04), (0.0, -0.04)))
    least = f"{margins.ARM.hand_room * 1e3:.0f} mm"
    assert f"80 mm apart, allowed from {least}" in refusal(near)
    assert "12 mm inside" in refusal(slide(contacts=((0.0, 0.145), (0.0, -0.1))))
    body = ObjectModel(Box((0.08, 0.08, 0.1)), 1.0, (0.0, 0.0))
    small = replace(slide(), object=body)
    assert "no two places 100 mm apart" in refusal(small)


def test_presses_are_harder_where_the_drags_lever_takes_more_of_their_friction() -> (
    None
):
    task = random_task(pps.load_task("bimanual-slide"), 14, 2)
    choice = MODE.choices(task.query, 1)[0]
    assert choice.feasible
    assert driven(choice).friction_utilisation <= margins.FRICTION_USES[-1]
    level = 24.8  # [N] which would do without a lever
    assert "the tips slip before the object" in refusal(replace_press(task, level))
    harder = margins.HARDER * level
    assert harder < task.limits.planned_force
    loads = [contact.load for contact in choice.contacts]
    assert loads == pytest.approx([harder] * 2, rel=1e-3)


def test_an_object_that_would_tip_is_refused() -> None:
    tall = replace(slide(), object=ObjectModel(Box((0.4, 0.2, 0.5)), 2.0, (0.0, 0.0)))
    rough = replace(tall.full_belief, support_friction=0.4)
    task = replace(tall, goal=Pose2(0.55, 0.2, 0.0), belief=rough)
    assert "it would tip" in refusal(task)


def test_a_plan_made_anew_leads_from_the_true_pose_and_contacts_to_the_goal() -> None:
    task = slide(contacts=SIDES)
    made = pps.plan(task, best(task))
    contacts = made.segments[0].contacts
    X_WB = Pose2(0.56, 0.01, 0.05)
    touched = ((0.003, 0.118), (-0.002, -0.123))
    off = Measured.touching(X_WB, contacts, touched, 1.0)
    (fresh,) = MODE.replan(task.query, made.segments, off)
    assert tuple(c.point for c in fresh.contacts) == touched
    assert made.object_pose(fresh, 0.0) == X_WB
    length = fresh.path.length
    goal = made.object_pose(fresh, length)
    assert math.dist(goal.position, task.goal.position) < 1e-9
    scant = Measured.touching(X_WB, contacts, touched, 0.5 * length)
    assert MODE.replan(task.query, made.segments, scant) == ()
    at_goal = Measured.touching(task.goal, contacts, touched, 1.0)
    assert MODE.replan(task.query, made.segments, at_goal) == ()
    X_WB = task.goal.compose(Pose2(0.004, 0.0, 0.0))
    beyond = Measured.touching(X_WB, contacts, touched)
    assert len(MODE.retry(task.query, made.segments[0], beyond)) == 1


@cache
def shipped_run() -> dict:
    from pushpressslide.sim.engine import run as run_drake

    made = pps.plan(pps.load_task("bimanual-slide"))
    return result(made.task, made, run_drake(made), {})


@pytest.mark.long
def test_the_shipped_task_reaches_its_goal_on_drake_with_two_arms() -> None:
    measured = shipped_run()
    assert measured["success"], measured["reason"]
    assert measured["final_position_error"] < 2e-3
    assert measured["final_yaw_error"] < math.radians(0.5)
    assert measured["path_max_error"] < 2e-3
    assert measured["slip_distance"] < 5e-3
    assert measured["cone_violation_fraction"] == 0.0
    assert measured["contact_loss_time"] == 0.0
    assert measured["torque_limit_violation_fraction"] == 0.0


@pytest.mark.long
@pytest.mark.parametrize("index", [0, 3])
def test_a_wrong_start_friction_and_mass_are_made_up_for_on_drake(index: int) -> None:
    from pushpressslide.sim.engine import run as run_drake

    task = varied_task(pps.load_task("bimanual-slide"), index, seed=3)
    made = pps.plan(task)
    measured = result(task, made, run_drake(made), {})
    assert measured["success"], measured["reason"]
