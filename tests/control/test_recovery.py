"""Replanning after a loss: the options tried, and their order."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control import recovery as module
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.core import margins
from pushpressslide.core.bodies import start_state
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Restart, Task
from pushpressslide.identification.parameter_estimates import NOTHING
from pushpressslide.identification.tip_friction import TipFriction
from pushpressslide.selection.placement_planner import (
    FailedPlacement,
    PlacementPlanner,
    PlansAlone,
)

TASK = pps.load_task("press-slide")
BEGIN = Restart(start_state(TASK), 0, TASK.object.center_of_mass, 1.2, None)


def refused_from(friction: float, monkeypatch: pytest.MonkeyPatch) -> list[Restart]:
    """Restarts that are planned from. Those with this support ``friction`` or more are
    refused.
    """
    asked: list[Restart] = []

    def planned(
        plan: Plan, begin: Restart, preparation: object, sequences: bool
    ) -> Plan:
        asked.append(begin)
        if plan.task.resumed(begin).scene.support.friction >= friction:
            raise InfeasibleTaskError("no press drags it")
        return plan

    monkeypatch.setattr(module, "_planned", planned)
    return asked


def test_a_friction_that_leads_nowhere_is_given_up_for_the_believed_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = refused_from(1.0, monkeypatch)
    module.planned_anew(Plan(TASK), BEGIN, lambda: None)  # type: ignore[arg-type,return-value]
    believed = TASK.scene.support.friction
    assert [one.support_friction for one in asked] == [1.2, 1.2, believed]
    assert [one.free for one in asked] == [False, True, True]


def test_no_belief_has_less_friction_than_the_support_has_shown(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = refused_from(0.5, monkeypatch)
    unsure = replace(TASK, belief=replace(TASK.belief, friction_error=0.5))
    begin = replace(BEGIN, least_friction=0.5)
    module.planned_anew(Plan(unsure), begin, lambda: None)  # type: ignore[arg-type,return-value]
    *bounded, last = asked
    frictions = [TASK.resumed(one).scene.support.friction for one in bounded]
    assert min(frictions) == 0.5
    assert {one.least_friction for one in bounded} == {0.5}
    # what held the object may have been something else
    assert last.least_friction == 0.0


def test_the_first_refusal_is_the_one_that_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    reasons = iter(["first", "second", "third", "fourth"])

    def refused(*_: object) -> Plan:
        raise InfeasibleTaskError(next(reasons))

    monkeypatch.setattr(module, "_planned", refused)
    with pytest.raises(InfeasibleTaskError, match="first"):
        module.planned_anew(Plan(TASK), BEGIN, lambda: None)  # type: ignore[arg-type,return-value]


def test_the_same_task_is_not_tried_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    free = replace(TASK, motion=TASK.motion.freed)
    begin = replace(BEGIN, support_friction=free.scene.support.friction)
    asked = all_refused(monkeypatch)
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(free), begin, lambda: None)  # type: ignore[arg-type,return-value]
    assert len(asked) == 1


def test_a_restart_begins_where_the_object_is_with_what_was_identified() -> None:
    task = pps.load_task("press-slide", ["belief.rho=0.05"])
    (segment,) = pps.plan(task).segments
    load = sum(contact.load for contact in segment.contacts)
    drag = 1.2 * task.scene.max_friction(load)
    pose = Pose2(0.4, 0.1, 0.2)
    found = NOTHING._replace(rho=0.06, drag=drag, center=(0.01, -0.02))
    begun = module.restart(task.scene, segment, pose, found)
    x, y = task.object.center_of_mass
    assert begun.leg == segment.leg
    assert begun.state.object == pose
    assert begun.center_of_mass == pytest.approx((x + 0.01, y - 0.02))
    assert begun.support_friction == pytest.approx(1.2 * task.support.friction)
    assert not begun.free
    assert begun.legs is None


@pytest.mark.parametrize(
    ("told", "found", "believed"),
    [(0.05, 0.06, 0.06), (0.05, None, 0.05), (None, 0.06, None), (None, None, None)],
)
def test_a_rho_that_was_told_gives_way_to_one_that_is_found(
    told: float | None, found: float | None, believed: float | None
) -> None:
    overrides = [] if told is None else [f"belief.rho={told}"]
    task = pps.load_task("press-slide", overrides)
    (segment,) = pps.plan(task).segments
    begun = module.restart(task.scene, segment, task.start, NOTHING._replace(rho=found))
    assert begun.rho == believed


def test_the_plan_that_is_made_anew_begins_where_the_restart_says() -> None:
    pose = Pose2(0.5, -0.2, 1.7)
    state = WorldState({OBJECT: pose})
    friction = TASK.scene.support.friction
    begun = replace(BEGIN, state=state, support_friction=friction)
    plan = module.planned_anew(Plan(TASK), begun, PlansAlone)
    body = plan.segments[0].body_pose(0.0)
    assert body.position == pytest.approx(pose.compose(TASK.object.X_GB).position)
    assert plan.task.goal == TASK.goal


def all_refused(
    monkeypatch: pytest.MonkeyPatch, searched: list[Restart] | None = None
) -> list[Restart]:
    """Refuse every restart. Returns the list of those for which one motion will be asked
    for; ``searched`` is filled with those for which sequences are searched as well.
    """
    asked: list[Restart] = []

    def refused(
        plan: Plan, begin: Restart, preparation: object, sequences: bool
    ) -> Plan:
        if sequences and searched is not None:
            searched.append(begin)
        if begin not in asked:
            asked.append(begin)
        raise InfeasibleTaskError("no")

    monkeypatch.setattr(module, "_planned", refused)
    return asked


def test_the_last_hope_ignores_the_errors_and_has_the_least_friction(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = all_refused(monkeypatch)
    unsure = replace(TASK, belief=replace(TASK.belief, friction_error=0.2))
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(unsure), BEGIN, lambda: None)  # type: ignore[arg-type,return-value]
    believed = unsure.scene.support.friction
    assert [one.dares for one in asked] == [False, False, False, True, True]
    assert asked[3].support_friction == believed
    assert asked[4].support_friction == pytest.approx(0.8 * believed)
    assert unsure.resumed(asked[4]).scene.planned_friction_error == 0.0


def test_a_press_that_slid_shares_the_error_between_both_frictions() -> None:
    """A load that slides although it should stick drags with as much as it weighs."""
    scene = TASK.scene
    (segment,) = pps.plan(TASK).segments
    begun = module.after_slides(BEGIN, scene, segment)
    load = segment.contacts[0].load
    drag = scene.support.friction * (scene.body.mass * GRAVITY + load)
    ratio = drag / load / scene.contact_friction
    share = min(math.sqrt(ratio), margins.SLID_SHARE)
    assert begun.contact_friction == pytest.approx(share * scene.contact_friction)
    assert begun.support_friction == pytest.approx(BEGIN.support_friction / share)
    assert TASK.resumed(begun).scene.contact_friction == begun.contact_friction


@pytest.mark.parametrize("share", [0.8, 1.1, 3.0])
def test_after_a_slide_the_measured_friction_of_the_tips_is_known(share: float) -> None:
    """Tips that dragged with more than the support should resist tell of the support."""
    scene = TASK.scene
    (segment,) = pps.plan(TASK).segments
    resisted = scene.support.friction * (scene.body.mass * GRAVITY + 10.0)
    drag = share * resisted
    measured = TipFriction(drag / 10.0, 0.02 * drag / 10.0, 10.0, drag)
    begun = module.after_slides(BEGIN, scene, segment, measured)
    assert begun.contact_friction == measured.value
    support = BEGIN.support_friction
    if share > 1.0:
        least = share * scene.support.friction / margins.SLID_SHARE
        support = max(support, least)
    assert begun.support_friction == pytest.approx(support)


def test_a_push_that_slid_has_a_smoother_tip() -> None:
    push = pps.load_task("rear-push-rear")
    (segment,) = pps.plan(push).segments
    begun = module.after_slides(BEGIN, push.scene, segment)
    expected = margins.SLID_SHARE * push.scene.contact_friction
    assert begun == replace(BEGIN, contact_friction=expected)


def test_after_a_slide_the_support_alone_may_be_to_blame_or_the_slide_is_ignored(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = all_refused(monkeypatch)
    unsure = replace(TASK, belief=replace(TASK.belief, friction_error=0.2))
    slid = 0.5 * unsure.scene.contact_friction
    begin = replace(BEGIN, contact_friction=slid)
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(unsure), begin, lambda: None)  # type: ignore[arg-type,return-value]
    assert [one.dares for one in asked] == [False] * 2 + [True] * 3 + [
        False,
        True,
        True,
    ]
    assert [one.contact_friction for one in asked] == [slid] * 3 + [None] * 5
    friction = BEGIN.support_friction
    believed = unsure.scene.support.friction
    assert [one.support_friction for one in asked[2:]] == pytest.approx(
        [friction, 2.0 * friction, friction, believed, believed, 0.8 * believed]
    )


def test_after_a_slide_pushes_are_planned_for_the_likeliest_centre(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A centre that is wrong rules out pushes, and presses have just slid."""
    asked = all_refused(monkeypatch)
    believed = (0.03, 0.0)
    belief = replace(TASK.belief, center_of_mass=believed, center_error=0.02)
    unsure = replace(TASK, belief=belief)
    begin = replace(BEGIN, center_of_mass=believed, contact_friction=0.2)
    for known, expected in ((None, 0.01), (0.005, 0.025)):
        asked.clear()
        start = replace(begin, center_error=known)
        with pytest.raises(InfeasibleTaskError):
            module.planned_anew(Plan(unsure), start, lambda: None)  # type: ignore[arg-type,return-value]
        assert asked[2].center_of_mass == pytest.approx((expected, 0.0))
        assert {one.center_of_mass for one in asked[3:-1]} == {believed}


def test_sequences_are_searched_for_few_beliefs_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The arms wait meanwhile."""
    searched: list[Restart] = []
    asked = all_refused(monkeypatch, searched)
    unsure = replace(TASK, belief=replace(TASK.belief, friction_error=0.2))
    slid = 0.5 * unsure.scene.contact_friction
    begin = replace(BEGIN, contact_friction=slid)
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(unsure), begin, lambda: None)  # type: ignore[arg-type,return-value]
    first, second, last = searched
    assert (first, second) == (begin, replace(begin, free=True))
    assert last == asked[-2]
    assert (last.dares, last.contact_friction) == (True, None)
    assert last.support_friction == unsure.scene.support.friction


def test_after_presses_slid_anything_else_is_planned_before_another_press(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A harder press is not to be had, and a top is as smooth elsewhere."""
    planned = pps.plan(TASK)
    (pressed,) = planned.segments
    (contact,) = pressed.contacts
    (pushed,) = pps.plan(pps.load_task("rear-push-rear")).segments
    x, y = contact.point
    elsewhere = replace(contact, point=(x + 0.03, y))
    another = replace(planned, segments=(replace(pressed, contacts=(elsewhere,)),))
    push = replace(planned, segments=(pushed,))
    here = FailedPlacement(pressed, planned.query.X_GB)
    refused = []
    for failed in (here, here.anywhere):
        made: list[PlacementPlanner] = []

        def plans(
            plan: Plan,
            _: Restart,
            prepare: Callable[[], PlacementPlanner],
            made: list[PlacementPlanner] = made,
            *,
            bounded: bool,
            before: Task | None,
        ) -> Plan:
            assert bounded
            assert before is None
            made.append(prepare())
            return plan

        monkeypatch.setattr(module, "planned_anew", plans)
        module.planned_otherwise(Plan(TASK), BEGIN, PlansAlone, (failed,))
        (planner,) = made
        planner.add(push)
        for placement in (planned, another):
            try:
                planner.add(placement)
            except InfeasibleTaskError:
                refused.append((failed, placement))
    anywhere = here.anywhere
    assert refused == [(here, planned), (anywhere, planned), (anywhere, another)]


def test_after_a_force_limit_plans_have_less_force_where_they_lead_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begin = module.after_force_limit(BEGIN, TASK.limits)
    less = TASK.resumed(begin)
    share = margins.LIMITED_SHARE
    assert less.limits.planned_force == pytest.approx(share * TASK.limits.planned_force)
    assert less.limits.normal_force == TASK.limits.normal_force
    again = module.after_force_limit(BEGIN, less.limits)
    expected = share * share * TASK.limits.planned_share
    assert again.planned_share == pytest.approx(expected)
    searched: list[Restart] = []
    asked = all_refused(monkeypatch, searched)
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(TASK), begin, lambda: None)  # type: ignore[arg-type,return-value]
    assert {one.planned_share for one in searched} == {begin.planned_share}
    shares = [one.planned_share for one in asked]
    assert shares[0] == begin.planned_share
    full = [one for one in asked if one.planned_share is None]
    assert full[0] == replace(begin, free=True, planned_share=None)
    assert all(one.dares for one in full[1:])


def test_an_object_close_to_its_goal_is_nudged() -> None:
    task = pps.load_task("rear-push-rear", ["tolerance.yaw_deg=2"])
    goal = task.goal
    close = Pose2(goal.x, goal.y, goal.yaw + math.radians(3.0))
    begun = replace(BEGIN, state=WorldState({OBJECT: close}))
    center = task.scene.body.center_of_mass
    begun = replace(begun, center_of_mass=center, support_friction=0.35)
    plan = module.planned_anew(Plan(task), begun, PlansAlone)
    assert sum(segment.path.length for segment in plan.segments) < task.object.radius
    assert plan.task.goal == goal


def test_a_restart_knows_the_centre_and_its_error() -> None:
    task = pps.load_task("rear-push-rear", ["belief.center_error=0.02"])
    (segment,) = pps.plan(task).segments
    center = CenterBelief(0.01, 0.02, 1e-6, 0.0, 4e-6)
    begun = module.restart(task.scene, segment, task.start, NOTHING, center)
    belief = task.resumed(begun).belief
    assert belief.center_of_mass == (0.01, 0.02)
    assert belief.center_error == pytest.approx(center.error)
    assert center.error == pytest.approx(math.sqrt(8e-6))


def test_the_belief_before_the_run_is_that_of_the_first_plan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Not that of the last recovery, which may have been wrong as well."""
    scene = TASK.scene
    tip = 0.7 * scene.contact_friction
    support = 1.4 * scene.support.friction
    lowered = replace(
        TASK,
        belief=replace(TASK.belief, contact_friction=tip, support_friction=support),
        limits=replace(TASK.limits, planned_share=0.5),
    )
    begin = replace(BEGIN, contact_friction=0.7 * tip, planned_share=0.4)
    asked = all_refused(monkeypatch)
    with pytest.raises(InfeasibleTaskError):
        module.planned_anew(Plan(lowered), begin, lambda: None, before=TASK)  # type: ignore[arg-type,return-value]
    tried = {
        (one.contact_friction, one.support_friction, one.planned_share) for one in asked
    }
    whole = TASK.limits.planned_share
    assert (scene.contact_friction, scene.support.friction, 0.4) in tried
    assert (0.7 * tip, BEGIN.support_friction, whole) in tried
    assert tip not in {one.contact_friction for one in asked}
    # or the support alone is to blame for what has slid
    told = BEGIN.support_friction / (0.7 * tip)
    alone = told * scene.contact_friction
    assert any(one.support_friction == pytest.approx(alone) for one in asked)


def test_a_plan_that_dares_is_no_reason_for_the_next_one_to_dare() -> None:
    unsure = replace(TASK, belief=replace(TASK.belief, friction_error=0.3), dares=True)
    assert not unsure.resumed(BEGIN).dares
    assert unsure.resumed(replace(BEGIN, dares=True)).dares


def test_failed_contacts_are_compared_on_the_object() -> None:
    """The origin of B is where the centre of mass is believed, which changes."""
    planned = pps.plan(TASK)
    (pressed,) = planned.segments
    (contact,) = pressed.contacts
    failed = FailedPlacement(pressed, Pose2())
    x, y = contact.point
    same = replace(pressed, contacts=(replace(contact, point=(x, y - 0.025)),))
    assert failed.repeated_by(same, Pose2(0.0, 0.025))
    assert not failed.repeated_by(same, Pose2())
    assert not failed.repeated_by(pressed, Pose2(0.0, 0.025))
