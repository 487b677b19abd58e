"""Plans made on the way are free of obstacles and stay in the workspace."""

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.correction import Replanner, press_creep, rest_of
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Belief, Box, Obstacle, Robot, Task
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured

HANDS = (Robot("hand", (0.0, 0.0, 0.0)),)
TASK = replace(pps.load_task("rear-push-rear"), robots=HANDS, obstacles=())
PLAN = pps.plan(TASK)
(SEGMENT,) = PLAN.segments
LENGTH = SEGMENT.path.length
TOUCHED = tuple(contact.point for contact in PLAN.contacts)
OFF = SEGMENT.body_pose(0.0).compose(Pose2(0.002, 0.003, 0.02))


def replanned(task: Task, plan: Plan = PLAN):
    longest = 1.3 * plan.segments[0].path.length
    return Replanner(task.queries()).replan(
        plan.segments,
        Measured.touching(OFF, plan.segments[0].contacts, TOUCHED, longest),
    )


def test_a_free_path_is_replanned_from_where_the_object_is() -> None:
    (fresh,) = replanned(TASK)
    body = fresh.body_pose(0.0)
    assert body.position == pytest.approx(OFF.position)
    assert fresh.goal == SEGMENT.goal
    assert fresh.profile.speed == SEGMENT.profile.speed


def test_a_replan_through_an_obstacle_is_refused() -> None:
    middle = PLAN.object_pose(SEGMENT, 0.5 * LENGTH)
    beside = PLAN.object_pose(SEGMENT, 0.5 * LENGTH).compose(Pose2(0.0, 1.0, 0.0))
    for pose, free in ((middle, False), (beside, True)):
        post = Obstacle("post", Box((0.03, 0.03, 0.1)), pose)
        assert bool(replanned(replace(TASK, obstacles=(post,)))) == free


def test_a_replan_that_leaves_the_workspace_is_refused() -> None:
    xs = [PLAN.object_pose(SEGMENT, LENGTH * i / 50).x for i in range(51)]
    ys = [PLAN.object_pose(SEGMENT, LENGTH * i / 50).y for i in range(51)]
    wide = (min(xs) - 0.1, max(xs) + 0.1, min(ys) - 0.1, max(ys) + 0.1)
    tight = (*wide[:1], max(xs) - 0.05, *wide[2:])
    for workspace, free in ((wide, True), (tight, False)):
        limits = replace(TASK.limits, workspace=workspace)
        assert bool(replanned(replace(TASK, limits=limits))) == free


def test_a_longer_path_than_allowed_is_refused() -> None:
    assert (
        Replanner(TASK.queries()).replan(
            PLAN.segments,
            Measured.touching(OFF, PLAN.segments[0].contacts, TOUCHED, 0.5 * LENGTH),
        )
        == ()
    )


def test_another_attempt_is_free_too_and_keeps_its_leg() -> None:
    task = pps.load_task("bimanual-slide", ["obstacles=[]"])
    made = pps.plan(task)
    segment = replace(made.segments[0], leg=0)
    touched = tuple(contact.point for contact in segment.contacts)
    X_WB = segment.body_pose(0.0)
    (retried,) = Replanner(task.queries()).again(
        segment, Measured.touching(X_WB, segment.contacts, touched)
    )
    assert retried.leg == segment.leg
    length = retried.path.length
    assert made.object_pose(retried, length).position == pytest.approx(
        task.goal.position
    )
    post = Obstacle(
        "post", Box((0.03, 0.03, 0.1)), made.object_pose(retried, 0.5 * length)
    )
    blocked = replace(task, obstacles=(post,))
    assert (
        Replanner(blocked.queries()).again(
            segment, Measured.touching(X_WB, segment.contacts, touched)
        )
        == ()
    )


def guidance(progress: float, across: float) -> Guidance:
    return Guidance(
        progress,
        *Wrench(1.0, 0.0, 0.0),
        *Twist(0.1, 0.0, 0.0),
        0.0,
        (0.0, across, 0.0),
        False,
    )


def test_on_the_way_only_an_error_is_replanned_and_not_too_often() -> None:
    replanner = Replanner(TASK.queries())
    off = guidance(0.0, 0.004)
    assert (
        replanner.onward(PLAN.segments, OFF, TOUCHED, guidance(0.0, 0.0), 9.0) is None
    )
    assert replanner.onward(PLAN.segments, OFF, TOUCHED, off, 0.1) is None
    near = guidance(LENGTH - 0.01, 0.004)
    assert replanner.onward(PLAN.segments, OFF, TOUCHED, near, 9.0) is None


def test_a_replan_on_the_way_begins_at_speed() -> None:
    made = Replanner(TASK.queries()).onward(
        PLAN.segments, OFF, TOUCHED, guidance(0.0, 0.004), 9.0
    )
    assert made is not None
    (segment,) = made.segments
    profile = segment.profile
    assert profile.at(made.clock) == pytest.approx((made.progress, profile.speed))
    here = segment.body_pose(made.progress)
    assert here.position == pytest.approx(OFF.position)
    assert here.yaw == pytest.approx(OFF.yaw)


def test_the_rest_of_a_segment_ends_where_the_segment_does() -> None:
    rest = rest_of(SEGMENT, 0.4 * LENGTH)
    assert isinstance(rest.path, ArcPath)
    assert rest.path.length == pytest.approx(0.6 * LENGTH)
    assert rest.path.end.position == pytest.approx(SEGMENT.path.end.position)
    assert rest_of(SEGMENT, 2.0 * LENGTH).path.length == pytest.approx(0.0)


def test_a_replan_that_would_tip_into_an_opening_is_refused() -> None:
    task = pps.load_task("press-fit")
    made = pps.plan(task)
    to_opening = made.segments[1:]
    X_WB = to_opening[0].body_pose(0.0)
    touched = tuple(contact.point for contact in to_opening[0].contacts)
    assert task.support.opening is not None
    below = replace(task.support.opening, size=(0.3, 0.7), center=(-0.02, 0.25))
    for opening, free in ((task.support.opening, True), (below, False)):
        support = replace(task.support, opening=opening)
        replanner = Replanner(replace(task, support=support).queries())
        fresh = replanner.replan(
            to_opening, Measured.touching(X_WB, to_opening[0].contacts, touched, 1.0)
        )
        assert bool(fresh) == free


@pytest.mark.parametrize(
    ("aside", "begun", "free"),
    [(0.0, 0.0, True), (0.005, 0.0, False), (0.0, 0.95, True), (0.005, 0.95, True)],
)
def test_a_replan_keeps_a_tool_straight_that_is_not_askew_already(
    aside: float, begun: float, free: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = pps.load_task("tool-use", ["limits.workspace=null"])
    made = pps.plan(task)
    segment = made.segments[-1]
    rest = rest_of(segment, begun * segment.path.length)
    goal = task.goal
    shift = Pose2(goal.x, goal.y, goal.yaw).compose(Pose2(0.0, aside, 0.0))
    moved = shift.compose(goal.inverse()).compose(rest.path.start)
    fresh = rest.follows(replace(rest.path, start=moved))
    monkeypatch.setattr(MODES[segment.mode], "replan", lambda *_: (fresh,))
    replanned = Replanner(task.queries()).replan(
        (rest,), Measured(Pose2(), rest.contacts, 1.0)
    )
    assert bool(replanned) == free


def test_the_creep_of_one_press_is_measured_by_its_distance_from_the_centre() -> None:
    press = Contact(0, "top", (0.03, 0.04), (0.0, 0.0), 0.1, 20.0)
    push = Contact(0, "side", (0.03, 0.04), (-1.0, 0.0), 0.1)
    crept = [(0.03, 0.03)]
    assert press_creep([press], [press.point]) == 0.0
    assert press_creep([press], crept) == pytest.approx(0.2)
    assert press_creep([push], crept) == 0.0
    assert press_creep([press, press], crept * 2) == 0.0
    assert press_creep([replace(press, point=(0.0, 0.0))], crept) == 0.0


def test_an_identified_rho_takes_the_place_of_a_believed_one_only() -> None:
    told = replace(TASK, belief=Belief(rho=0.1))
    for task, found, rho in ((told, 0.2, 0.2), (TASK, 0.2, None), (told, None, 0.1)):
        (query,) = Replanner(task.queries()).believing(found).queries
        assert query.scene.rho == rho
