"""Replans during the motion are free of obstacles and stay in the workspace."""

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.correction import (
    Replan,
    Replanner,
    led_in,
    press_creep,
    rest_of,
    side_slide,
    sides_of,
    slide,
    touched_point,
)
from pushpressslide.control.pressed_body import PressedBody
from pushpressslide.core import margins
from pushpressslide.core.control import TipState
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Belief, Box, Obstacle, Robot, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.online import AxleEstimate
from pushpressslide.identification.parameter_estimates import (
    NOTHING,
    ParameterEstimates,
)
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
    (retried,) = Replanner(task.queries()).retry(
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
        Replanner(blocked.queries()).retry(
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
        replanner.improve(PLAN.segments, OFF, TOUCHED, guidance(0.0, 0.0), 9.0) is None
    )
    assert replanner.improve(PLAN.segments, OFF, TOUCHED, off, 0.1) is None
    near = guidance(LENGTH - 0.01, 0.004)
    assert replanner.improve(PLAN.segments, OFF, TOUCHED, near, 9.0) is None


def test_a_replan_on_the_way_begins_at_speed() -> None:
    made = Replanner(TASK.queries()).improve(
        PLAN.segments, OFF, TOUCHED, guidance(0.0, 0.004), 9.0
    )
    assert made is not None
    (segment,) = made.segments
    profile = segment.profile
    assert profile.state_at(made.clock) == pytest.approx((made.progress, profile.speed))
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


def improve(
    aside: float = 0.0,
    turned: float = 0.0,
    progress: float = 0.0,
    since: float = 9.0,
    touched: tuple[Point, ...] = TOUCHED,
    estimates: ParameterEstimates = NOTHING,
) -> Replan | None:
    """Replan for an object ``aside`` [m] and ``turned`` [rad] from its path, or None."""
    off = guidance(progress, 0.0)._replace(error=(9.0, aside, turned))
    there = SEGMENT.body_pose(progress).compose(Pose2(0.0, 0.002, 0.0))
    return Replanner(TASK.queries()).improve(
        PLAN.segments, there, touched, off, since, estimates
    )


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_each_error_above_its_own_bound_is_replanned(side: float) -> None:
    arm = margins.ARM
    for share, made in ((1.0, False), (1.01, True)):
        assert (improve(aside=side * share * arm.off_path) is not None) == made
        assert (improve(turned=side * share * arm.off_heading) is not None) == made
    ((x, y),) = TOUCHED
    for share, made in ((0.99, False), (1.01, True)):
        slid = ((x, y + side * share * arm.slid),)
        assert (improve(touched=slid) is not None) == made


def test_an_axle_or_a_centre_that_is_found_elsewhere_is_replanned() -> None:
    planned, _ = Pose2(0.0, 0.0, SEGMENT.X_BV.yaw).unrotate(SEGMENT.X_BV.position)
    most = margins.ARM.off_axle
    for off, made in ((0.99, False), (1.01, True), (-1.01, True)):
        axle = AxleEstimate(planned + off * most, 0.1, 0.1)
        assert (improve(estimates=ParameterEstimates(axle=axle)) is not None) == made
    assert improve(estimates=ParameterEstimates(elsewhere=True)) is not None


def test_nothing_is_replanned_shortly_before_the_end_or_after_a_replan() -> None:
    arm = margins.ARM
    off = 2.0 * arm.off_path
    for share, made in ((0.99, False), (1.01, True)):
        assert (improve(off, since=share * arm.replan_pause) is not None) == made
        ends = LENGTH - share * arm.least_left
        assert improve(off, progress=ends) is None or made
    assert improve(off, since=arm.replan_pause) is not None
    half = improve(off, progress=0.5 * LENGTH)
    assert half is not None
    rest = half.segments[0].path.length - half.progress
    assert rest == pytest.approx(0.5 * LENGTH, rel=0.1)


def test_a_side_slides_and_a_press_does_not_count() -> None:
    push = Contact(0, "side", (0.0, 0.0), (1.0, 0.0), 0.1)
    press = Contact(1, "top", (0.0, 0.0), (0.0, 0.0), 0.1, 20.0)
    far = [(0.03, 0.04), (0.3, 0.4)]
    assert side_slide([push, push], far) == pytest.approx(0.5)
    assert side_slide([push, press], far) == pytest.approx(0.05)
    assert side_slide([press, press], far) == 0.0
    assert slide([push, press], far) == pytest.approx(0.5)


def test_a_tip_touches_a_face_at_its_foot() -> None:
    X_WB = Pose2(0.5, 0.1, 0.7)
    zero = (0.0, 0.0, 0.0)
    body = TASK.object
    (contact,) = PLAN.contacts
    (side,) = sides_of(body, [contact])
    nx, ny = contact.normal
    place = (
        contact.point[0] - 0.05 * nx - 0.01 * ny,
        contact.point[1] - 0.05 * ny + 0.01 * nx,
    )
    tip = TipState((*X_WB.apply(place), 0.03), zero, zero)
    assert side is not None
    assert touched_point(side, X_WB, tip) == pytest.approx(
        (contact.point[0] - 0.01 * ny, contact.point[1] + 0.01 * nx)
    )
    assert touched_point(None, X_WB, tip) == pytest.approx(place)
    top = Contact(0, "top", (0.0, 0.0), (0.0, 0.0), 0.1, 20.0)
    assert sides_of(body, [top, contact])[0] is None


def test_a_path_is_led_in_along_its_first_direction() -> None:
    """Along arcs by a straight piece, along twists by more of the first one."""
    path = led_in(SEGMENT.path, 0.03)
    assert path.length == pytest.approx(LENGTH + 0.03)
    assert path.pose(0.03).position == pytest.approx(SEGMENT.path.start.position)
    assert path.end.position == pytest.approx(SEGMENT.path.end.position)
    back = SEGMENT.path.start.unapply(path.start.position)
    assert back == pytest.approx((-0.03, 0.0))
    twists = TwistPath.between((Pose2(), Pose2(0.2, 0.1, 0.5)), 0.1)
    longer = led_in(twists, 0.03)
    assert longer.pose(0.03).position == pytest.approx((0.0, 0.0))
    assert longer.end.position == pytest.approx(twists.end.position)


def test_the_rest_of_a_way_not_begun_is_all_of_it() -> None:
    assert rest_of(SEGMENT, -0.1).path.length == pytest.approx(LENGTH)
    (turn,) = pps.plan(pps.load_task("press-slide-pivot")).segments
    assert rest_of(turn, 0.1) is turn


@pytest.mark.parametrize("name", ["rear-push-left", "tee"])
def test_an_axle_is_compared_along_the_heading_of_its_vehicle(name: str) -> None:
    """Wherever the vehicle heads on the object."""
    task = pps.load_task(name, ["obstacles=[]", "limits.workspace=null"])
    plan = pps.plan(task)
    segment = plan.segments[0]
    X_BV = segment.X_BV
    planned, _ = Pose2(0.0, 0.0, X_BV.yaw).unrotate(X_BV.position)
    touched = tuple(contact.point for contact in segment.contacts)
    calm = guidance(0.0, 0.0)
    here = segment.body_pose(0.0)
    most = margins.ARM.off_axle
    for off in (-0.9, 0.9):
        found = ParameterEstimates(axle=AxleEstimate(planned + off * most, 0.1, 0.1))
        replan = Replanner(task.queries()).improve(
            plan.segments, here, touched, calm, 9.0, found
        )
        assert replan is None


def test_a_motion_begun_anew_has_the_run_up_of_its_speed() -> None:
    """Of a constant acceleration from rest."""
    made = improve(aside=0.004)
    assert made is not None
    profile = SEGMENT.profile
    speed = profile.speed
    assert made.progress == pytest.approx(speed * made.clock / 2.0)
    assert made.clock == pytest.approx(speed / profile.acceleration)


def test_a_replanner_believes_what_presses_have_told() -> None:
    """Mass and friction. The centre of mass, from which B is placed, stays."""
    replanner = Replanner(pps.load_task("press-slide").queries())
    scene = replanner.queries[0].scene
    assert replanner.believing(None) is replanner
    told = PressedBody(0.7, 0.1, CenterBelief(0.01, 0.02, 1e-6), 0.44)
    (query,) = replanner.believing(None, told).queries
    assert query.scene.body == replace(scene.body, mass=0.7)
    assert query.scene.support == replace(scene.support, friction=0.44)
