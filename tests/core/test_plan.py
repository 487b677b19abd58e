"""Segments, placements, choices and plans."""

import math
from dataclasses import dataclass, replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import (
    Choice,
    Contact,
    Plan,
    Segment,
    arms_kept,
    same_places,
)
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Restart

TASK = load_task("press-fit")  # four legs
LEFT = Contact(0, "top", (0.0, 0.1), (0.0, 0.0), 0.1, load=5.0)
RIGHT = Contact(1, "top", (0.0, -0.1), (0.0, 0.0), 0.1, load=5.0)
MOVED = replace(RIGHT, point=(0.05, -0.1))
HARDER = (replace(LEFT, load=9.0), replace(RIGHT, load=7.0))


@dataclass(frozen=True)
class Driven:
    """A drive of these tests."""

    X_BV: Pose2
    max_friction: float = 5.0
    rho: float | None = None
    center: Point = (0.0, 0.0)


def made(*contacts: Contact, mode: str = "held", leg: int = 0, length=0.2) -> Segment:
    path = ArcPath(Pose2(0.1 * leg, 0.0, 0.2), ((1.0, length),))
    profile = SpeedProfile(length, 0.05, 0.5)
    return Segment(
        mode, contacts, Driven(Pose2(0.02, 0.01, 0.3)), path, profile, Pose2(), leg=leg
    )


PLAN = Plan(
    TASK,
    (
        made(LEFT, RIGHT),
        made(*HARDER, leg=1),
        made(LEFT, MOVED, leg=2),
        made(LEFT, MOVED, mode="other", leg=2),
        made(LEFT, RIGHT, leg=3),
    ),
)
RESTART = Restart(
    WorldState({OBJECT: Pose2(0.3, 0.2, 0.1)}), 2, (0.01, 0.0), 0.25, None
)


def test_contacts_are_the_same_places_whatever_their_loads() -> None:
    assert same_places((LEFT, RIGHT), HARDER)
    assert not same_places((LEFT, RIGHT), (RIGHT, LEFT))
    assert not same_places((LEFT, RIGHT), (LEFT, MOVED))
    assert not same_places((LEFT, RIGHT), (LEFT,))


def test_neighbours_with_the_same_contacts_are_one_placement_however_they_press() -> (
    None
):
    sizes = [len(group) for group in PLAN.placements]
    assert sizes == [2, 1, 1, 1]
    # the first contacts again, but not without letting go in between
    assert PLAN.placements[0][0].same_placement(PLAN.placements[-1][0])


def test_the_plans_of_the_placements_have_all_segments_in_order() -> None:
    parts = PLAN.by_placement
    assert sum((part.segments for part in parts), ()) == PLAN.segments
    for part, group in zip(parts, PLAN.placements, strict=True):
        assert part.placements == (group,)
        assert part.query == TASK.queries()[group[0].leg]
        assert part.duration == sum(s.profile.duration for s in group)
    assert PLAN.duration == pytest.approx(sum(part.duration for part in parts))


def test_each_placement_has_its_own_contacts() -> None:
    assert PLAN.contacts == (LEFT, RIGHT)
    assert [plan.contacts for plan in PLAN.by_placement] == [
        (LEFT, RIGHT),
        (LEFT, MOVED),
        (LEFT, MOVED),
        (LEFT, RIGHT),
    ]


def test_what_is_planned_anew_takes_the_place_of_the_rest() -> None:
    rest = Plan(PLAN.task, PLAN.segments[3:], RESTART)
    run = PLAN.begun(2, rest)
    first, second, *_ = PLAN.by_placement
    assert run.segments == PLAN.segments[:3]
    assert run.by_placement == (first, second, *rest.by_placement)
    assert run.later == (rest,)


def test_what_is_planned_anew_again_and_again_stands_in_one_row() -> None:
    rests = [Plan(PLAN.task, PLAN.segments[i:], RESTART) for i in (3, 4)]
    inner = rests[0].begun(1, rests[1])
    run = PLAN.begun(1, inner)
    assert run.later == (replace(inner, later=()), rests[1])
    assert run.by_placement[1:] == inner.by_placement


def test_a_task_goes_on_from_where_it_was_left() -> None:
    rest = PLAN.task.resumed(RESTART)
    query = rest.queries()[RESTART.leg]
    assert query.start == RESTART.state.object
    assert rest.goal == PLAN.task.goal
    assert query.goal == PLAN.queries[RESTART.leg].goal


def test_an_arm_lasts_where_it_goes_on_with_its_contact() -> None:
    first, second, third, last = PLAN.placements
    assert arms_kept(first, second) == {0}
    assert arms_kept(second, third) == {0, 1}
    assert arms_kept(third, last) == {0}
    pushed = made(replace(LEFT, arm=1), RIGHT)
    assert arms_kept((pushed,), first) == {1}
    assert arms_kept(first, (made(MOVED),)) == frozenset()


def test_a_segment_of_another_path_is_driven_at_the_same_speed() -> None:
    (segment, *_) = PLAN.segments
    path = ArcPath(Pose2(0.3, 0.1, 0.0), ((0.0, 0.7),))
    led = segment.follows(path)
    assert led.path is path
    assert led.profile == SpeedProfile(0.7, 0.05, 0.5)
    assert replace(led, path=segment.path, profile=segment.profile) == segment


def test_the_poses_of_body_and_object_are_those_of_the_path() -> None:
    (segment, *_) = PLAN.segments
    X_GB = TASK.object.X_GB
    for s in (0.0, 0.07, 0.2):
        X_WV = PLAN.object_pose(segment, s).compose(X_GB).compose(segment.X_BV)
        wanted = segment.path.pose(s)
        assert math.dist(X_WV.position, wanted.position) < 1e-12
        assert X_WV.yaw == pytest.approx(wanted.yaw)
    assert segment.X_BV == segment.drive.X_BV


def test_the_choices_that_a_plan_consists_of_are_found_again() -> None:
    legs = [Choice("held", segments=(segment,)) for segment in PLAN.segments]
    others = [Choice("held"), Choice("held", segments=(made(LEFT, length=0.3),))]
    assert PLAN.chosen([others[0], *legs, others[1]]) == legs


def test_a_choice_says_what_was_decided_of_it_and_why() -> None:
    good = Choice("held", "face 1", summary="path 1 m")
    assert (good.feasible, good.evaluated) == (True, True)
    assert (good.verdict, good.reason) == ("possible", "face 1: path 1 m")
    bad = good.refused(Refusal("tipping", "tips at {figure:mm.0f}", 0.2))
    assert (bad.feasible, bad.evaluated) == (False, True)
    assert (bad.verdict, bad.reason) == ("refused", "face 1: tips at 200 mm")
    skipped = good.refused(Refusal(SKIPPED, "there is a quicker one"))
    assert (skipped.feasible, skipped.evaluated) == (False, False)
    assert skipped.verdict == "skipped"
    assert skipped.reason == "face 1: there is a quicker one"
    assert bad.refused(None) == good


def test_a_reason_has_no_stray_colon() -> None:
    assert Choice("held", "face 1").reason == "face 1"
    assert Choice("held", summary="path 1 m").reason == "path 1 m"
    assert Choice("held").reason == ""


def test_a_choice_is_as_long_as_its_segments() -> None:
    assert Choice("held").path_length is None
    assert Choice("held").friction_margin is None
    first = replace(made(LEFT, length=0.2), cone_margin=0.1)
    choice = Choice("held", segments=(first, made(LEFT, length=0.3)))
    assert choice.path_length == pytest.approx(0.5)
    assert choice.friction_margin == 0.1


def test_the_choices_of_a_plan_are_those_whose_segments_are_all_in_it() -> None:
    first, second, third, *_ = PLAN.segments
    choices = {
        "whole": Choice("held", segments=(first, second)),
        "alone": Choice("held", segments=(third,)),
        "other end": Choice("held", segments=(first, replace(second, leg=3))),
        "apart": Choice("held", segments=(first, third)),
        "too long": Choice("held", segments=(*PLAN.segments, first)),
        "none": Choice("held"),
    }
    chosen = PLAN.chosen(list(choices.values()))
    assert chosen == [choices["whole"], choices["alone"]]
