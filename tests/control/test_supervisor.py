"""The policy of the motion: the table, and each of its rows on a scripted measurement."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.state import (
    ControllerState,
    Instant,
    Losses,
    Still,
    begin,
    tip_position,
)
from pushpressslide.control.supervisor import (
    LOSSES,
    RETOUCHES,
    RETRIES,
    TRANSITIONS,
    Moment,
    Supervisor,
)
from pushpressslide.core import margins
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2

PAGE = Path(__file__).parents[2] / "docs" / "architecture.md"
TIME = 100.0  # [s] of the run, at the moment that is looked at
BEGAN = 20.0  # [s] of its phase
ZERO = (0.0, 0.0, 0.0)
PUSH = "rear-push-rear"
PRESS = "press-slide"
TWO = "press-slide-car"  # of two segments


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
    (contact,) = made.segments[0].contacts
    tip = TipState(tip_position(contact, X_WB, radius), ZERO, ZERO)
    state = made.init(Measurement(BEGAN, pose, (tip,)))
    instant = Instant(TIME, 0.004, pose, X_WB, (tip,))
    state = begin(state, "move", instant._replace(time=BEGAN))
    following = state.following.begun(BEGAN)._replace(clock_start=BEGAN)
    segment = following.segment
    watches = state.watches._replace(still=Still(X_WB, TIME), replanned=TIME)
    state = state._replace(following=following, watches=watches)
    guidance = following.binding.tracker.step(segment.path, X_WB, 0.0, 0.05, 1.0)
    touched = following.binding.touched(X_WB, instant.tips)
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
    ((x, y),) = of.touched
    contact = of.state.following.segment.contacts[0]
    nx, ny = contact.normal
    if contact.kind == "top":
        nx, ny = 1.0, 0.0
    return of._replace(touched=((x - way * ny, y + way * nx),))


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
    stalled = watching(well, still=Still(well.instant.X_WB, since))
    event, state = after(PUSH, stalled)
    assert event == "stalled"
    assert state.phase.failure is not None
    assert "stood still" in state.phase.failure[1]
    # it does not count from before this phase, nor if it has moved
    before = watching(well, still=Still(well.instant.X_WB, BEGAN - 1.0))
    assert controller(PUSH).supervisor.step(before).phase.failure is None
    moved = Still(Pose2(0.0, 0.0, 0.0), since)
    state = controller(PUSH).supervisor.step(watching(well, still=moved))
    assert state.phase.failure is None
    assert state.watches.still == Still(well.instant.X_WB, TIME)


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
    assert state.watches.losses == Losses(well.instant.X_WB, 1)


def test_a_contact_that_is_lost_a_seventh_time_in_a_place_ends_the_attempt() -> None:
    patience = controller(PRESS).supervisor.patience
    well = moment(PRESS)
    lost = watching(well, lost=TIME - patience - 1e-3)
    losses = Losses(well.instant.X_WB, LOSSES)
    event, state = after(PRESS, watching(lost, losses=losses))
    assert event == "lost for good"
    assert state.phase.failure is not None
    assert state.phase.failure[0] == "contact_lost"
    elsewhere = Losses(Pose2(0.0, 0.0, 0.0), LOSSES)
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
