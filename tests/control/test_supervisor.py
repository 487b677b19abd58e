"""The policy of the motion: the table, and each of its rows on a scripted measurement."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import pushpressslide as pps
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.controller import Controller
from pushpressslide.control.insertion import HOLD_TIME, SEAT_TIME, Insertion
from pushpressslide.control.placement import Placement
from pushpressslide.control.pressed_body import PressedBody
from pushpressslide.control.state import (
    ContactLosses,
    ControllerState,
    Instant,
    StallWatch,
    Touched,
    Watches,
    enter_phase,
    ramp_time,
    tip_position,
)
from pushpressslide.control.supervisor import (
    LOSSES,
    RETOUCHES,
    RETRIES,
    SLOWED,
    TRANSITIONS,
    Moment,
    Settled,
    Supervisor,
)
from pushpressslide.core import margins
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2
from pushpressslide.core.sensing import Sensing
from pushpressslide.modes import MODES

PAGE = Path(__file__).parents[2] / "docs" / "architecture.md"
TIME = 100.0  # [s] of the run, at the moment that is looked at
BEGAN = 20.0  # [s] of its phase
ZERO = (0.0, 0.0, 0.0)
PUSH = "rear-push-rear"
PRESS = "press-slide"
TWO = "press-slide-car"  # of two segments
BOTH = "parallel-push"  # by two arms


@cache
def controller(name: str) -> Controller:
    # time for a retry is left
    return Controller(pps.plan(pps.load_task(name, ["limits.time=600"])))


def moment(name: str, X_WG: Pose2 | None = None) -> Moment:
    """Return a tick of a motion in which all is well, with the object at ``X_WG``, by
    default where the plan begins.
    """
    made = controller(name)
    query = made.placement.query
    pose = X_WG or query.start
    X_WB = pose.compose(query.X_GB)
    radius = query.scene.robots[0].tip_radius
    contacts = sorted(made.segments[0].contacts, key=lambda contact: contact.arm)
    places = [tip_position(contact, X_WB, radius) for contact in contacts]
    tips = tuple(TipState(place, ZERO, ZERO) for place in places)
    state = made.init(Measurement(BEGAN, pose, tips))
    instant = Instant(TIME, 0.004, pose, X_WB, tips)
    state = enter_phase(state, "move", instant._replace(time=BEGAN))
    following = state.following.begun(BEGAN)._replace(clock_start=BEGAN)
    segment = following.segment
    watches = state.watches._replace(still=StallWatch(X_WB, TIME), replanned=TIME)
    state = state._replace(following=following, watches=watches)
    guidance = following.binding.tracker.step(segment.path, X_WB, 0.0, 0.05, 1.0)
    touched = following.binding.contact_points(X_WB, instant.tips)
    return Moment(state, instant, touched, guidance)


def watching(of: Moment, **watches: object) -> Moment:
    state = of.state._replace(watches=of.state.watches._replace(**watches))
    return of._replace(state=state)


def at_the_end(of: Moment, last: bool) -> Moment:
    """Return a tick at the end of the segment that is followed, with or without another
    one ahead.
    """
    following = of.state.following
    if last:
        following = following._replace(ahead=())
    length = following.binding.segment.path.length
    following = following._replace(progress=length)
    return of._replace(state=of.state._replace(following=following))


def slipped(of: Moment, way: float) -> Moment:
    """Return a tick at which the tip touches ``way`` [m] beside its place."""
    ((x, y),) = of.contact_points
    contact = of.state.following.segment.contacts[0]
    nx, ny = contact.normal
    if contact.kind == "top":
        nx, ny = 1.0, 0.0
    return of._replace(contact_points=((x - way * ny, y + way * nx),))


def behind(of: Moment, way: float) -> Moment:
    """Return a tick at which all tips have fallen ``way`` [m] behind their sides."""
    contacts = of.state.following.segment.contacts
    tips = list(of.instant.tips)
    for contact in contacts:
        nx, ny = of.instant.X_WB.rotate(contact.normal)
        x, y, z = tips[contact.arm].position
        place = (x - way * nx, y - way * ny, z)
        tips[contact.arm] = replace(tips[contact.arm], position=place)
    return of._replace(instant=of.instant._replace(tips=tuple(tips)))


def pushing(of: Moment, share: float) -> Moment:
    """Return a tick at which the tips push ahead with a ``share`` of the object's
    friction.
    """
    segment = of.state.following.segment
    force = share * segment.drive.max_friction / len(of.instant.tips)
    x, y, _ = segment.contacts[0].direction(of.instant.X_WB)
    tips = tuple(
        replace(tip, force=(force * x, force * y, 0.0)) for tip in of.instant.tips
    )
    return of._replace(instant=of.instant._replace(tips=tips))


def after(name: str, of: Moment) -> tuple[str, ControllerState]:
    """Return the event that holds first, and the state that it leads to."""
    supervisor = controller(name).supervisor
    event = next(row.event for row in TRANSITIONS if row.holds(supervisor, of))
    return event, supervisor.step(of)


def test_the_page_has_the_table_in_its_order() -> None:
    rows = []
    for number, row in enumerate(TRANSITIONS, start=1):
        when, then = row.words
        rows.append(f"| {number} | {row.event} | {when[:-1]} | {then[:-1]} |")
    print("\n".join(rows))  # noqa: T201 with pytest -s, the table
    assert "\n".join(rows) in PAGE.read_text("utf-8")


def test_two_pushes_that_another_body_pushes_back_hold_until_it_is_gone() -> None:
    supervisor = controller(BOTH).supervisor
    long_since = TIME - margins.ARM.settle_time - 0.01
    resisted = watching(pushing(moment(BOTH), 3.0), resisted=long_since)
    event, held = after(BOTH, resisted)
    assert event == "resisted"
    assert held.phase.name == "touch"
    places = [memory.held_command.position for memory in held.phase.tips]
    assert places == [tip.position for tip in resisted.instant.tips]
    assert (held.watches.resistances, held.watches.retouches) == (1, 0)
    still_there = Settled(held, resisted.instant)
    assert supervisor.step(still_there) is held
    assert not supervisor.plans(still_there)
    gone = Settled(held, pushing(resisted, 1.0).instant)
    assert supervisor.step(gone).phase.name == "move"
    later = resisted.instant._replace(time=TIME + margins.ARM.stall_time)
    assert supervisor.step(Settled(held, later)).phase.name == "move"


def test_the_friction_of_the_object_is_no_other_body() -> None:
    long_since = TIME - margins.ARM.settle_time - 0.01
    usual = watching(pushing(moment(BOTH), 1.5), resisted=long_since)
    state = controller(BOTH).supervisor.step(usual)
    assert state.phase.name == "move"
    assert state.watches.resisted is None
    # nor is that of one with more friction and mass than believed
    heavy = watching(pushing(moment(BOTH), 3.0), resisted=long_since)
    assert after(BOTH, heavy)[0] == "resisted"
    unsure = replace(
        controller(BOTH).placement.scene, friction_error=0.3, mass_error=0.3
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(controller(BOTH).placement, "scene", unsure)
        watching_anew = Supervisor(controller(BOTH).placement, True, 0.1)
        assert watching_anew.step(heavy).watches.resisted is None
    # a short one is none either
    short = watching(pushing(moment(BOTH), 3.0), resisted=TIME - 0.1)
    assert after(BOTH, short)[0] == "otherwise"


def test_no_row_is_there_twice() -> None:
    assert len({row.holds for row in TRANSITIONS}) == len(TRANSITIONS)


def test_an_object_far_off_its_path_ends_the_attempt() -> None:
    well = moment(PUSH)
    off = margins.ARM.astray + 1e-3
    astray = well._replace(guidance=well.guidance._replace(error=(0.0, -off, 0.0)))
    event, state = after(PUSH, astray)
    assert event == "astray"
    assert state.phase.name == "release"
    assert state.phase.failure is not None
    assert state.phase.failure[0] == "goal_missed"
    assert "off its path" in state.phase.failure[1]


def test_an_object_that_stands_still_ends_the_attempt() -> None:
    well = moment(PUSH)
    since = TIME - margins.ARM.stall_time - 0.1
    stalled = watching(well, still=StallWatch(well.instant.X_WB, since))
    event, state = after(PUSH, stalled)
    assert event == "stalled"
    assert state.phase.failure is not None
    assert "stood still" in state.phase.failure[1]
    # it does not count from before this phase, nor if it has moved
    before = watching(well, still=StallWatch(well.instant.X_WB, BEGAN - 1.0))
    assert controller(PUSH).supervisor.step(before).phase.failure is None
    moved = StallWatch(Pose2(0.0, 0.0, 0.0), since)
    state = controller(PUSH).supervisor.step(watching(well, still=moved))
    assert state.phase.failure is None
    assert state.watches.still == StallWatch(well.instant.X_WB, TIME)


def test_an_object_that_stands_still_at_its_goal_is_let_go() -> None:
    goal = controller(PUSH).placement.last.goal
    well = moment(PUSH, goal)
    since = TIME - margins.ARM.stall_time - 0.1
    stalled = watching(well, still=StallWatch(well.instant.X_WB, since))
    event, state = after(PUSH, stalled)
    assert event == "stalled"
    assert state.phase.name == "release"
    assert state.phase.failure is None


def test_a_segment_that_is_over_gives_way_to_the_next() -> None:
    well = moment(TWO)
    event, state = after(TWO, at_the_end(well, last=False))
    assert event == "arrived midway"
    assert state.phase.name == "move"
    assert state.following.segment == well.state.following.ahead[0]
    assert state.following.clock_start == TIME


def test_at_the_goal_the_tips_let_go() -> None:
    goal = controller(PRESS).placement.last.goal
    event, state = after(PRESS, at_the_end(moment(PRESS, goal), last=True))
    assert event == "arrived"
    assert state.phase.name == "release"
    assert state.phase.failure is None


def test_beside_the_goal_a_press_tries_again_four_times() -> None:
    goal = controller(PRESS).placement.last.goal
    off = 1.5 * controller(PRESS).placement.last.tolerance.position
    beside = at_the_end(moment(PRESS, Pose2(goal.x, goal.y + off, goal.yaw)), last=True)
    event, state = after(PRESS, beside)
    assert event == "arrived"
    assert state.phase.name == "move"
    assert state.watches.retries == 1
    event, state = after(PRESS, watching(beside, retries=RETRIES))
    assert state.phase.name == "release"


def test_what_nothing_else_carries_is_held() -> None:
    well = moment(PUSH)
    made = controller(PUSH)
    placement = made.placement
    supervisor = Supervisor(placement, True, 1.0)
    end = at_the_end(moment(PUSH, placement.last.goal), last=True)
    assert supervisor.step(end).phase.name == "release"
    holds = placement.holds
    placement.holds = True
    try:
        assert supervisor.step(end).phase.name == "done"
    finally:
        placement.holds = holds
    assert well.state.phase.name == "move"


def test_a_contact_that_is_lost_is_touched_where_the_tips_are() -> None:
    patience = controller(PRESS).supervisor.patience
    well = moment(PRESS)
    lost = watching(well, lost=TIME - patience - 1e-3)
    event, state = after(PRESS, lost)
    assert event == "lost"
    assert state.phase.name == "touch"
    assert not state.phase.align
    assert state.watches.losses == ContactLosses(well.instant.X_WB, 1)


def test_a_contact_that_is_lost_a_seventh_time_in_a_place_ends_the_attempt() -> None:
    patience = controller(PRESS).supervisor.patience
    well = moment(PRESS)
    lost = watching(well, lost=TIME - patience - 1e-3)
    losses = ContactLosses(well.instant.X_WB, LOSSES)
    event, state = after(PRESS, watching(lost, losses=losses))
    assert event == "lost for good"
    assert state.phase.failure is not None
    assert state.phase.failure[0] == "contact_lost"
    elsewhere = ContactLosses(Pose2(0.0, 0.0, 0.0), LOSSES)
    event, _ = after(PRESS, watching(lost, losses=elsewhere))
    assert event == "lost"


def test_a_press_that_crept_touches_its_place_again_and_harder() -> None:
    well = moment(PRESS)
    (contact,) = well.state.following.segment.contacts
    event, state = after(PRESS, slipped(well, 0.08))
    assert event == "crept"
    assert state.phase.name == "touch"
    assert state.phase.align
    assert state.watches.retouches == 1
    (again,) = state.following.binding.segment.contacts
    assert again.load > contact.load
    assert again.point == contact.point


def test_a_press_that_slides_however_often_it_touches_ends_the_attempt() -> None:
    """Only a tip that may have less friction than believed slides that far."""
    slid = watching(slipped(moment(PRESS), 0.08), retouches=RETOUCHES)
    assert after(PRESS, slid)[0] == "otherwise"
    task = pps.load_task(PRESS, ["belief.friction_error=0.3"])
    unsure = Controller(pps.plan(task)).supervisor
    row = next(row for row in TRANSITIONS if row.holds(unsure, slid))
    assert row.event == "slid off"
    failure = row.act(unsure, slid).phase.failure
    assert failure is not None
    code, text = failure
    assert code == "contact_lost"
    assert text.endswith(f"mm, although touched {RETOUCHES} times again")


def test_a_push_that_slid_touches_its_place_again() -> None:
    well = moment(PUSH)
    slid = slipped(well, margins.ARM.retouch + 1e-3)
    event, state = after(PUSH, slid)
    assert event == "slid"
    assert state.phase.name == "touch"
    (again,) = state.following.binding.segment.contacts
    (contact,) = well.state.following.segment.contacts
    assert again.point == contact.point
    assert again.load == contact.load
    # but not for ever, and not shortly before its end
    event, _ = after(PUSH, watching(slid, retouches=RETOUCHES))
    assert event == "otherwise"
    event, _ = after(PUSH, at_the_end(slid, last=True))
    assert event == "arrived"


@pytest.mark.parametrize("name", [PUSH, BOTH])
def test_a_tip_away_from_its_side_touches_again_and_lets_go_at_last(name: str) -> None:
    """Its force does not tell: light objects are not felt."""
    well = moment(name)
    allowed = (
        controller(name).placement.scene.robots[0].tip_radius + margins.ARM.retouch
    )
    assert after(name, behind(well, allowed - 1e-3))[0] == "otherwise"
    off = behind(well, allowed + 1e-3)
    assert after(name, off)[0] == "slid"
    event, state = after(name, watching(off, retouches=RETOUCHES))
    assert event == "slid off"
    assert state.phase.failure == (
        "contact_lost",
        f"a tip is {1e3 * allowed + 1.0:.0f} mm off the side that it pushed",
    )
    # a force that is missing tells more
    assert after(name, watching(off, retouches=RETOUCHES, lost=TIME))[0] == "missing"
    # a tip is where it is seen
    x, y = (
        a.position[i] - b.position[i]
        for a, b, i in zip(
            2 * well.instant.tips[:1], 2 * off.instant.tips[:1], (0, 1), strict=True
        )
    )
    seen = off.state.estimate._replace(tip_error=(x, y))
    state = off.state._replace(estimate=seen)
    assert after(name, off._replace(state=state))[0] == "otherwise"


def test_a_press_beside_a_push_that_slid_is_pressed_no_harder() -> None:
    well = moment(PRESS)
    (contact,) = well.state.following.segment.contacts
    state = controller(PRESS).supervisor.touch_planned(well)
    (touched,) = state.following.binding.segment.contacts
    assert contact.load > 0.0
    assert touched.load == contact.load


def test_only_events_that_plan_let_the_tips_hold_meanwhile() -> None:
    push = moment(PUSH)
    goal = controller(PUSH).placement.last.goal
    error = (0.0, 1.0, 0.0)
    astray = push._replace(guidance=push.guidance._replace(error=error))
    events = {
        "arrived midway": (TWO, at_the_end(moment(TWO), last=False), True),
        "arrived": (PUSH, at_the_end(moment(PUSH, goal), last=True), True),
        "otherwise": (PUSH, push, False),
        "missing": (PUSH, watching(push, lost=TIME), False),
        "lost": (PUSH, watching(push, lost=BEGAN), False),
        "slid": (PUSH, slipped(push, 0.08), False),
        "astray": (PUSH, astray, False),
        "mistaken": (PRESS, watching(moment(PRESS), mistaken=BEGAN), True),
    }
    for event, (name, of, plans) in events.items():
        assert after(name, of)[0] == event
        assert controller(name).supervisor.plans(of) == plans


def test_a_contact_that_is_missing_for_a_moment_changes_nothing() -> None:
    missing = watching(moment(PUSH), lost=TIME)
    event, state = after(PUSH, missing)
    assert event == "missing"
    assert state == missing.state


def test_where_all_is_well_the_motion_goes_on() -> None:
    well = moment(PUSH)
    event, state = after(PUSH, well)
    assert event == "otherwise"
    assert state == well.state


def test_a_better_plan_is_followed() -> None:
    """The object is beside its path, and nobody has looked for a while."""
    start = controller(PUSH).placement.query.start
    beside = moment(PUSH, Pose2(start.x, start.y + 0.01, start.yaw))
    event, state = after(PUSH, watching(beside, replanned=0.0))
    assert event == "otherwise"
    assert state.watches.replanned == TIME
    before = beside.state.following.binding.segment.path
    after_it = state.following.binding.segment.path
    X_WB = beside.instant.X_WB
    ways = [
        math.dist(path.pose(0.0).position, X_WB.position) for path in (before, after_it)
    ]
    assert ways[1] < ways[0] + 1e-9


@pytest.mark.parametrize("number", range(len(TRANSITIONS)))
def test_each_row_says_when_it_holds_and_what_is_done(number: int) -> None:
    when, then = TRANSITIONS[number].words
    assert when.endswith(".")
    assert then.endswith(".")


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_object_may_be_off_its_path_by_what_is_allowed(side: float) -> None:
    well = moment(PUSH)
    off = side * margins.ARM.astray
    edge = well._replace(guidance=well.guidance._replace(error=(0.0, off, 0.0)))
    supervisor = controller(PUSH).supervisor
    assert not supervisor.astray(edge)
    beyond = well._replace(
        guidance=well.guidance._replace(error=(9.0, 1.01 * off, 9.0))
    )
    assert supervisor.astray(beyond)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_pushed_object_may_be_turned_from_its_path_by_what_is_allowed(
    side: float,
) -> None:
    """A pressed one trails its tip, and comes round by itself."""
    allowed = side * margins.ARM.turned_away
    for turned, ends in ((0.99 * allowed, False), (1.01 * allowed, True)):
        for name, pushed in ((PUSH, True), (BOTH, True), (PRESS, False)):
            well = moment(name)
            error = (0.0, 0.0, turned)
            turning = well._replace(guidance=well.guidance._replace(error=error))
            supervisor = controller(name).supervisor
            assert supervisor.turned_away(turning) == (ends and pushed)
    well = moment(PUSH)
    error = (0.0, 0.0, 1.01 * allowed)
    turning = well._replace(guidance=well.guidance._replace(error=error))
    event, state = after(PUSH, turning)
    assert event == "turned away"
    assert state.phase.failure == (
        "goal_missed",
        "turned 61 deg from its path, allowed 60 deg",
    )


def test_an_object_may_stand_still_for_what_is_allowed() -> None:
    supervisor = controller(PUSH).supervisor
    well = moment(PUSH)
    X_WB = well.instant.X_WB
    for rests, stalled in ((margins.ARM.stall_time, False), (5.01, True)):
        still = watching(well, still=StallWatch(X_WB, TIME - rests))
        assert supervisor.stalled(still) == stalled
    assert not supervisor.stalled(watching(well, still=None))


def test_an_object_stands_still_below_a_share_of_its_speed() -> None:
    """Turns count by what they move its edge by."""
    made = controller(PUSH)
    well = moment(PUSH)
    speed = well.state.following.binding.segment.profile.speed
    way = margins.STALL * speed * margins.ARM.stall_time
    radius = made.placement.object.radius
    X_WB = well.instant.X_WB
    since = TIME - 1.0
    for share, still in ((0.99, True), (1.01, False)):
        part = 0.5 * share * way
        for moved, turned in ((2.0 * part, 0.0), (part, part), (0.0, -2.0 * part)):
            before = Pose2(X_WB.x - moved, X_WB.y, X_WB.yaw + turned / radius)
            rested = watching(well, still=StallWatch(before, since))
            watches = made.supervisor.step(rested).watches
            assert watches.still is not None
            assert (watches.still.since == since) == still
            assert watches.still.pose == (before if still else X_WB)


def test_an_object_may_rest_since_its_phase_began() -> None:
    well = moment(PUSH)
    X_WB = well.instant.X_WB
    kept = controller(PUSH).supervisor.step(
        watching(well, still=StallWatch(X_WB, BEGAN))
    )
    assert kept.phase.failure is not None  # for 80 s
    anew = controller(PUSH).supervisor.step(watching(well, still=None))
    assert anew.watches.still == StallWatch(X_WB, TIME)


@pytest.mark.parametrize("waits", [False, True])
def test_only_an_object_that_is_led_and_not_waited_for_can_stall(waits: bool) -> None:
    placement = controller(PUSH).placement
    well = moment(PUSH)
    stalled = watching(well, still=StallWatch(well.instant.X_WB, TIME - 60.0))
    before = placement.waits
    placement.waits = waits
    try:
        forced = Supervisor(placement, False, 1.0).step(stalled)
        led = Supervisor(placement, True, 1.0).step(stalled)
    finally:
        placement.waits = before
    assert forced.phase.failure is None
    assert forced.watches.still is None
    assert (led.phase.failure is None) == waits


def left(of: Moment, way: float) -> Moment:
    """Return a tick with ``way`` [m] of the path left."""
    length = of.state.following.binding.segment.path.length
    following = of.state.following._replace(progress=length - way)
    return of._replace(state=of.state._replace(following=following))


@pytest.mark.parametrize(("share", "over"), [(0.9, True), (1.1, False)])
def test_a_segment_is_over_a_little_before_its_end(share: float, over: bool) -> None:
    way = share * margins.ARM.stop
    event, _ = after(PUSH, left(moment(PUSH), way))
    assert (event == "arrived") == over
    event, _ = after(TWO, left(moment(TWO), way))
    assert (event == "arrived midway") == over


@pytest.mark.parametrize(
    ("beside", "turned", "again"),
    [(0.0, 0.0, False), (0.96, 0.0, False), (1.0, 0.0, True), (0.0, 1.0, True)],
)
def test_a_goal_is_tried_again_that_is_missed_by_nearly_the_tolerance(
    beside: float, turned: float, again: bool
) -> None:
    task = controller(PRESS).placement.last
    goal = task.goal
    off = Pose2(
        goal.x,
        goal.y + beside * task.tolerance.position,
        goal.yaw - turned * task.tolerance.yaw,
    )
    state = controller(PRESS).supervisor.step(at_the_end(moment(PRESS, off), last=True))
    assert (state.watches.retries == 1) == again
    assert (state.phase.name == "move") == again


def test_a_contact_may_be_missing_for_the_patience() -> None:
    supervisor = Supervisor(controller(PRESS).placement, True, 0.5)
    well = moment(PRESS)
    assert not supervisor.lost(watching(well, lost=None))
    assert not supervisor.lost(watching(well, lost=TIME - 0.5))
    assert supervisor.lost(watching(well, lost=TIME - 0.5001))
    assert not supervisor.missing(watching(well, lost=None))
    assert supervisor.missing(watching(well, lost=TIME))


def test_losses_are_counted_within_a_way_that_includes_turns() -> None:
    supervisor = controller(PRESS).supervisor
    radius = supervisor.placement.object.radius
    within = margins.ARM.retouch
    well = moment(PRESS)
    X_WB = well.instant.X_WB
    lost = watching(well, lost=0.0)
    for way, same in ((0.99 * within, True), (1.01 * within, False)):
        for moved, turned in ((way, 0.0), (0.0, way), (0.5 * way, -0.5 * way)):
            there = Pose2(X_WB.x, X_WB.y - moved, X_WB.yaw + turned / radius)
            state = supervisor.step(watching(lost, losses=ContactLosses(there, 2)))
            counted = ContactLosses(there, 3) if same else ContactLosses(X_WB, 1)
            assert state.watches.losses == counted


@pytest.mark.parametrize(("count", "ends"), [(LOSSES - 1, False), (LOSSES, True)])
def test_the_attempt_ends_at_the_loss_after_the_sixth(count: int, ends: bool) -> None:
    well = moment(PRESS)
    lost = watching(well, lost=0.0, losses=ContactLosses(well.instant.X_WB, count))
    event, state = after(PRESS, lost)
    assert event == ("lost for good" if ends else "lost")
    assert state.watches.losses == ContactLosses(well.instant.X_WB, count + 1)
    assert 3 <= LOSSES <= 10


@pytest.mark.parametrize(
    ("name", "event", "way"),
    [(PUSH, "slid", margins.ARM.retouch), (PRESS, "crept", None)],
)
def test_a_contact_is_touched_anew_above_what_it_may_slide(
    name: str, event: str, way: float | None
) -> None:
    well = moment(name)
    (contact,) = well.state.following.segment.contacts
    if way is None:
        way = margins.CREPT * math.hypot(*contact.point)
    for side in (-1.0, 1.0):
        assert after(name, slipped(well, side * 1.01 * way))[0] == event
        assert after(name, slipped(well, side * 0.99 * way))[0] == "otherwise"


@pytest.mark.parametrize(("name", "event"), [(PUSH, "slid"), (PRESS, "crept")])
def test_a_contact_is_touched_anew_while_way_and_touches_are_left(
    name: str, event: str
) -> None:
    far = slipped(moment(name), 0.08)
    enough = margins.ARM.retouch
    assert after(name, left(far, 1.01 * enough))[0] == event
    assert after(name, left(far, 0.99 * enough))[0] == "otherwise"
    assert after(name, watching(far, retouches=RETOUCHES - 1))[0] == event
    assert after(name, watching(far, retouches=RETOUCHES))[0] == "otherwise"
    state = after(name, watching(far, retouches=1))[1]
    assert state.watches.retouches == 2
    assert state.watches.lost == TIME
    assert state.following.binding.segment.drive == far.state.following.segment.drive
    assert 1 <= RETOUCHES <= 10


def test_a_press_of_unsure_friction_slides_from_where_it_was_seen_to_touch() -> None:
    """A tip that is seen beside its planned place from the beginning has not slid."""
    task = pps.load_task(PRESS, ["belief.friction_error=0.3"])
    unsure = Controller(pps.plan(task)).supervisor
    well = moment(PRESS)
    (tip,) = well.instant.tips
    (x, y, z), far = tip.position, 0.08
    dx, dy = well.instant.X_WB.rotate((0.0, far))
    tips = (replace(tip, position=(x + dx, y + dy, z)),)
    beside = slipped(well, far)._replace(instant=well.instant._replace(tips=tips))
    X_WB = well.instant.X_WB
    at_plan = Touched(X_WB, well.instant.tips, 0.0)
    assert unsure.crept(watching(beside, touched=at_plan))
    assert not unsure.crept(watching(beside, touched=Touched(X_WB, tips, 0.0)))
    # what the pose was known to, then and now, is no slide
    doubtful = at_plan._replace(place=far)
    assert not unsure.crept(watching(beside, touched=doubtful))
    # as a touch at the planned place forgets
    again = unsure.touch_harder(watching(beside, touched=at_plan))
    assert again.watches.touched is None
    state = well.state._replace(phase=well.state.phase._replace(name="touch"))
    begun = unsure.step(Settled(state, beside.instant))
    assert begun.watches.touched == Touched(X_WB, tips, 0.0)
    sure = controller(PRESS).supervisor.step(Settled(state, beside.instant))
    assert sure.watches.touched is None


def test_a_tip_that_is_seen_elsewhere_later_has_not_slid() -> None:
    """What is learnt of where the tip is, is true of its touch as well."""
    task = pps.load_task(PRESS, ["belief.friction_error=0.3"])
    unsure = Controller(pps.plan(task)).supervisor
    well = moment(PRESS)
    touched = Touched(well.instant.X_WB, well.instant.tips, 0.0)
    estimate = well.state.estimate._replace(tip_error=(0.05, 0.06))
    learnt = slipped(well, 0.08)._replace(state=well.state._replace(estimate=estimate))
    assert not unsure.crept(watching(learnt, touched=touched))


def test_an_object_that_turns_otherwise_is_led_to_its_goal_by_the_same_contacts() -> (
    None
):
    """As if it had arrived beside its goal. Without a retry the attempt ends."""
    since = TIME - 2.0 * margins.ARM.mistaken_time
    goal = controller(PRESS).placement.last.goal
    off = 1.5 * controller(PRESS).placement.last.tolerance.position
    beside = moment(PRESS, Pose2(goal.x, goal.y + off, goal.yaw))
    event, state = after(PRESS, watching(beside, mistaken=since))
    assert event == "mistaken"
    assert state.phase.name == "move"
    assert state.watches.retries == 1
    assert state.watches.mistaken is None
    # one with turns ahead counts as well: it does not begin for ever
    following = beside.state.following
    turning = following._replace(ahead=(following.binding.segment,))
    again = watching(beside, mistaken=since, retries=1)
    again = again._replace(state=again.state._replace(following=turning))
    assert controller(PRESS).supervisor.lead_again(again).watches.retries == 2
    tried = watching(beside, mistaken=since, retries=RETRIES)
    _, state = after(PRESS, tried)
    assert state.phase.name == "release"
    assert state.phase.failure is not None
    assert state.phase.failure[0] == "goal_missed"


def test_the_next_segment_is_planned_with_what_presses_have_told() -> None:
    """Of mass, friction and centre, from then on."""
    made = Controller(pps.plan(pps.load_task(TWO, ["limits.time=600"])))
    scene = made.placement.scene
    x, y = scene.body.center_of_mass
    center = CenterBelief(x + 0.004, y - 0.003, 1e-6, 0.0, 1e-6)
    told = PressedBody(1.3 * scene.body.mass, 0.1, center, 1.2 * scene.support.friction)
    made.supervisor.pressed_body = lambda: told
    begun = at_the_end(moment(TWO), last=False)
    state = made.supervisor.go_on(begun)
    assert state.following.body == told
    assert state.following.prediction.followed_center == pytest.approx((0.004, -0.003))
    (query, *_) = made.supervisor._replanner(state.following).queries
    assert query.scene.body.mass == told.mass
    assert query.scene.support.friction == told.friction
    assert query.X_GB == made.placement.query.X_GB
    # nothing told, nothing changed
    assert after(TWO, begun)[1].following.body is None


def test_a_press_that_crept_is_pressed_harder_up_to_what_is_planned() -> None:
    made = controller(PRESS)
    far = slipped(moment(PRESS), 0.08)
    binding = far.state.following.binding
    (contact,) = binding.segment.contacts
    most = made.placement.queries[0].limits.planned_force
    cases = ((0.5 * most, 0.5 * most * margins.HARDER), (0.99 * most, most))
    for load, wanted in (*cases, (1.2 * most, 1.2 * most)):
        heavy = replace(contact, load=load)
        segment = replace(binding.segment, contacts=(heavy,))
        following = far.state.following._replace(
            binding=replace(binding, segment=segment)
        )
        of = far._replace(state=far.state._replace(following=following))
        (again,) = made.supervisor.step(of).following.binding.segment.contacts
        assert again.load == pytest.approx(wanted)


@pytest.mark.parametrize("name", [PUSH, PRESS])
def test_a_segment_that_slid_is_touched_at_the_planned_place(name: str) -> None:
    """Though it was planned anew meanwhile, with its contact elsewhere."""
    far = slipped(moment(name), 0.08)
    following = far.state.following
    (contact,) = following.segment.contacts
    moved = replace(contact, point=(contact.point[0], contact.point[1] + 0.01))
    segment = replace(following.binding.segment, contacts=(moved,))
    binding = replace(following.binding, segment=segment)
    state = far.state._replace(following=following._replace(binding=binding))
    after_it = controller(name).supervisor.step(far._replace(state=state))
    (again,) = after_it.following.binding.segment.contacts
    assert again.point == contact.point
    assert after_it.phase.name == "touch"


def test_the_next_segment_begins_now_and_keeps_what_the_placement_knows() -> None:
    well = moment(TWO)
    end = at_the_end(well, last=False)
    end = end._replace(
        state=end.state._replace(following=end.state.following._replace(rho=0.07))
    )
    before = end.state.following
    state = controller(TWO).supervisor.step(watching(end, retries=2))
    following = state.following
    assert following.reference_start == following.clock_start == TIME
    assert following.reference is following.binding.segment
    assert following.began == before.began == BEGAN
    assert following.progress == 0.0
    assert following.ahead == ()
    assert following.rho == 0.07
    # the joints have done the first segment's way
    assert following.joint_start == pytest.approx(before.segment.path.length)
    assert state.watches.replanned == TIME
    assert state.watches.retries == 2


def test_the_next_segment_begins_where_the_object_is() -> None:
    made = controller(TWO)
    end = made.segments[0].goal
    X_GB = made.X_GB
    beside = Pose2(end.x + 0.002, end.y - 0.001, end.yaw + 0.01)
    there = moment(TWO, beside.compose(X_GB).compose(X_GB.inverse()))
    state = made.supervisor.step(at_the_end(there, last=False))
    X_WB = there.instant.X_WB
    body = state.following.binding.segment.body_pose(0.0)
    assert body.position == pytest.approx(X_WB.position, abs=1e-6)


def test_a_retry_ends_in_time_or_is_not_begun() -> None:
    goal = controller(PRESS).placement.last.goal
    off = 1.5 * controller(PRESS).placement.last.tolerance.position
    beside = at_the_end(moment(PRESS, Pose2(goal.x, goal.y + off, goal.yaw)), last=True)
    for time, begun in ((TIME, True), (599.5, False)):
        late = beside._replace(instant=beside.instant._replace(time=time))
        late = watching(late, still=StallWatch(beside.instant.X_WB, time))
        state = controller(PRESS).supervisor.step(late)
        assert (state.phase.name == "move") == begun


def test_a_retry_has_time_to_slow_down_where_the_object_is_looked_at() -> None:
    task = pps.load_task(PRESS, ["limits.time=600"])
    seen = Controller(pps.plan(replace(task, sensing=Sensing(pose_rate=10.0))))
    lasts = math.fsum(segment.profile.duration for segment in seen.segments)
    for made, share in ((controller(PRESS), 1.0), (seen, SLOWED)):
        ready = 600.0 - ramp_time(margins.ARM.retreat)
        for late in (-0.01, 0.01):
            begun = ready - share * lasts + late
            assert made.supervisor._in_time(made.segments, begun) == (late < 0.0)


def test_a_run_that_has_just_begun_looks_for_a_better_plan_after_one_pause() -> None:
    start = controller(PUSH).placement.query.start
    beside = moment(PUSH, Pose2(start.x, start.y + 0.01, start.yaw))
    for share, made in ((0.99, False), (1.01, True)):
        time = share * margins.ARM.replan_pause
        early = beside._replace(
            state=beside.state._replace(watches=Watches()),
            instant=beside.instant._replace(time=time),
        )
        state = controller(PUSH).supervisor.replan(early)
        assert (state.watches.replanned == time) == made


def test_a_plan_is_not_looked_for_while_one_is_new() -> None:
    start = controller(PUSH).placement.query.start
    beside = moment(PUSH, Pose2(start.x, start.y + 0.01, start.yaw))
    pause = margins.ARM.replan_pause
    for since, made in ((0.99 * pause, False), (1.01 * pause, True)):
        state = after(PUSH, watching(beside, replanned=TIME - since))[1]
        assert (state.watches.replanned == TIME) == made
        same = state.following.binding is beside.state.following.binding
        assert same != made


def test_a_better_plan_is_led_on_at_the_speed_there_is() -> None:
    start = controller(PUSH).placement.query.start
    beside = moment(PUSH, Pose2(start.x, start.y + 0.01, start.yaw))
    following = after(PUSH, watching(beside, replanned=0.0))[1].following
    profile = following.binding.segment.profile
    way, speed = profile.state_at(TIME - following.clock_start)
    assert way == pytest.approx(following.progress)
    assert speed == pytest.approx(profile.speed)
    assert following.segment is beside.state.following.segment
    assert following.prediction == beside.state.following.prediction
    assert following.reference is beside.state.following.reference


def test_a_rho_that_is_identified_is_believed_from_then_on() -> None:
    well = moment(PUSH)
    found = well.state.estimate.parameters._replace(rho=0.055)
    state = well.state._replace(estimate=well.state.estimate._replace(parameters=found))
    assert after(PUSH, well._replace(state=state))[1].following.rho == 0.055


def test_the_axle_is_looked_for_anew_about_a_centre_that_is_found() -> None:
    start = controller(PRESS).placement.query.start
    well = moment(PRESS, Pose2(start.x, start.y + 0.01, start.yaw))
    well = watching(well, replanned=0.0)
    before = well.state.following.prediction
    assert before.axle is not None
    estimate = well.state.estimate
    for center in ((0.0, 0.0), (0.0, 0.003)):
        found = estimate.parameters._replace(center=center)
        state = well.state._replace(estimate=estimate._replace(parameters=found))
        state = after(PRESS, well._replace(state=state))[1]
        assert state.watches.replanned == TIME
        prediction = state.following.prediction
        assert prediction.followed_center == center
        assert (prediction.axle is before.axle) == (center == (0.0, 0.0))
        assert prediction.center is before.center


def test_a_plan_follows_its_first_axle_again_if_that_is_not_contradicted() -> None:
    well = watching(moment(PRESS), replanned=0.0)
    first = well.state.following.segment.X_BV
    identifier = well.state.following.prediction.axle
    assert identifier is not None
    planned = identifier.predicted
    assert first.x == pytest.approx(planned.axle)
    estimate = well.state.estimate
    state = well.state
    for axle in (planned._replace(axle=planned.axle - 0.1), None):
        found = estimate.parameters._replace(axle=axle)
        state = state._replace(estimate=estimate._replace(parameters=found))
        watches = state.watches._replace(replanned=0.0)
        state = after(PRESS, well._replace(state=state._replace(watches=watches)))[1]
        followed = state.following.binding.segment.X_BV
        assert followed.x == pytest.approx((axle or planned).axle)


@pytest.mark.parametrize("touch", [Supervisor.touch_again, Supervisor.touch_planned])
def test_what_a_lost_contact_told_of_the_axle_is_forgotten(
    touch: Callable[[Supervisor, Moment], ControllerState],
) -> None:
    """A knock moves the object otherwise than the tip."""
    well = moment(PRESS)
    before = well.state.following.prediction
    again = touch(controller(PRESS).supervisor, well).following.prediction
    assert before.axle is not None
    assert again.axle is not None
    assert again.axle is not before.axle
    assert again.axle.predicted == before.axle.predicted
    assert again.center is before.center


def test_ways_are_beside_the_planned_one_that_come_near_it_everywhere() -> None:
    supervisor = controller(PUSH).supervisor
    (segment,) = supervisor.placement.segments
    assert supervisor._is_near_plan((segment,))
    near = margins.ARM.near_plan
    for offset, beside in (
        (Pose2(0.0, 0.98 * near, 0.0), True),
        (Pose2(0.0, 1.5 * near, 0.0), False),
        (Pose2(0.0, 0.0, 3.0), False),
    ):
        path = segment.path
        aside = segment.follows(replace(path, start=path.start.compose(offset)))
        assert supervisor._is_near_plan((aside,)) == beside
        assert supervisor._is_near_plan((segment, aside)) == beside


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_path_that_is_turned_aside_is_not_near_the_planned_one(
    monkeypatch: pytest.MonkeyPatch, side: float
) -> None:
    supervisor = controller(PUSH).supervisor
    placement = supervisor.placement
    poses = placement.planned_poses
    for share, near in ((0.9, True), (1.1, False)):
        turn = side * share * margins.ARM.turned_beside
        turned = [Pose2(pose.x, pose.y, pose.yaw + turn) for pose in poses]
        monkeypatch.setattr(placement, "planned_poses", turned)
        assert supervisor._is_near_plan(placement.segments) == near


@pytest.fixture
def waiting() -> Iterator[Placement]:
    """The placement of the push, whose object is waited for at its goal."""
    placement = controller(PUSH).placement
    placement.waits = True
    yield placement
    placement.waits = False
    placement.entry = None


def late(of: Moment, by: float) -> Moment:
    """Return a tick ``by`` [s] after the planned end of the segment's motion."""
    following = of.state.following
    duration = following.binding.segment.profile.duration
    following = following._replace(clock_start=BEGAN)
    state = of.state._replace(following=following)
    instant = of.instant._replace(time=BEGAN + (duration + by))
    return of._replace(state=state, instant=instant)


@pytest.mark.parametrize(
    ("way", "by", "over"),
    [
        (0.0, 0.0, False),
        (0.0, HOLD_TIME, False),
        (0.0, 1.01 * HOLD_TIME, True),
        (0.01, 1.01 * HOLD_TIME, False),
        (0.01, 2.99, False),
        (0.01, 3.01, True),
    ],
)
def test_a_held_object_is_waited_for_until_it_rests(
    waiting: Placement, way: float, by: float, over: bool
) -> None:
    """Or for 3 s, wherever it is."""
    supervisor = Supervisor(waiting, True, 1.0)
    assert supervisor.arrived(late(left(moment(PUSH), way), by)) == over
    assert 0.1 < HOLD_TIME < SEAT_TIME < 10.0


@pytest.mark.parametrize(("deep", "over"), [(0.0995, True), (0.09, False)])
def test_an_object_in_an_opening_has_arrived_when_it_is_seated(
    waiting: Placement, deep: float, over: bool
) -> None:
    supervisor = Supervisor(waiting, True, 1.0)
    end = late(left(moment(PUSH), 0.0), 0.1)
    height = end.instant.tips[0].position[2]
    waiting.entry = Insertion(0.1, ((0, height + deep),))
    assert supervisor.arrived(end) == over
    assert supervisor.arrived(late(end, 1.01 * SEAT_TIME))
    assert not supervisor.arrived(late(left(end, 0.01), 0.1))


def test_what_is_ahead_is_gone_on_to_without_a_wait() -> None:
    placement = controller(TWO).placement
    placement.waits = True
    try:
        assert Supervisor(placement, True, 1.0).arrived_midway(
            late(left(moment(TWO), 0.0), -1.0)
        )
    finally:
        placement.waits = False


def test_in_an_opening_a_smaller_miss_is_tried_again(waiting: Placement) -> None:
    task = waiting.last
    supervisor = Supervisor(waiting, True, 1.0)
    for share, again in (
        (0.9 * margins.RETRY_ABOVE_SEATED, False),
        (1.1 * margins.RETRY_ABOVE_SEATED, True),
    ):
        off = Pose2(
            task.goal.x, task.goal.y + share * task.tolerance.position, task.goal.yaw
        )
        end = left(moment(PUSH, off), 0.0)
        waiting.entry = Insertion(0.1, ((0, 9.0),))
        seated = supervisor._retry(end.state, end.instant)
        waiting.entry = None
        assert supervisor._retry(end.state, end.instant) == ()
        assert bool(seated) <= again


def missing_its_goal(monkeypatch: pytest.MonkeyPatch) -> None:
    mode = type(MODES[controller(TWO).segments[0].mode])
    monkeypatch.setattr(mode, "misses", lambda *_: True)


def test_a_motion_that_would_miss_its_goal_is_tried_again_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Unless it has been often enough."""
    end = at_the_end(moment(TWO), last=False)
    supervisor = controller(TWO).supervisor
    goal = supervisor.placement.segments[-1].goal
    assert supervisor.go_on(end).watches.retries == 0
    again = (controller(TWO).segments[-1],)
    replanner = type(supervisor.placement.replanner)
    monkeypatch.setattr(replanner, "retry", lambda *_: again)
    missing_its_goal(monkeypatch)
    for retries, then in ((0, 1), (RETRIES - 1, RETRIES), (RETRIES, RETRIES)):
        state = supervisor.go_on(watching(end, retries=retries))
        assert state.watches.retries == then
        led = state.following.binding.segment
        assert led.goal.position == pytest.approx(goal.position)
    assert 2 <= RETRIES <= 10


def test_a_motion_that_would_miss_goes_on_for_want_of_better(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    end = at_the_end(moment(TWO), last=False)
    supervisor = controller(TWO).supervisor
    replanner = type(supervisor.placement.replanner)
    missing_its_goal(monkeypatch)
    monkeypatch.setattr(replanner, "retry", lambda *_: ())
    assert supervisor.go_on(end).watches.retries == 0
    again = (controller(TWO).segments[-1],)
    monkeypatch.setattr(replanner, "retry", lambda *_: again)
    over = end._replace(instant=end.instant._replace(time=599.9))
    assert supervisor.go_on(over).watches.retries == 0


def test_a_way_that_cannot_be_replanned_is_followed_as_it_was_planned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    end = at_the_end(moment(TWO), last=False)
    supervisor = controller(TWO).supervisor
    replanner = type(supervisor.placement.replanner)
    monkeypatch.setattr(replanner, "replan", lambda *_: ())
    following = supervisor.go_on(end).following
    assert following.binding.segment == end.state.following.ahead[0]
    before = end.state.following.prediction.followed_center
    assert following.prediction.followed_center == before


def test_a_better_plan_that_leads_far_aside_is_left_alone() -> None:
    """Where nobody has looked whether the arms can follow; unless nothing else helps."""
    start = controller(PUSH).placement.query.start
    beside = watching(
        moment(PUSH, Pose2(start.x, start.y + 0.01, start.yaw)), replanned=0.0
    )
    placement = controller(PUSH).placement
    poses = placement.planned_poses
    far = [Pose2(9.0, 9.0, 0.0)]
    for reaches, planned, followed in (
        (False, poses, True),
        (False, far, False),
        (True, far, True),
    ):
        placement.planned_poses = planned
        placement.reaches_far = reaches
        try:
            state = controller(PUSH).supervisor.replan(beside)
        finally:
            placement.planned_poses = poses
            placement.reaches_far = False
        same = state.following.binding is beside.state.following.binding
        assert same != followed
        assert state.watches.replanned == TIME
