"""Messages if no mode can do a task."""

from dataclasses import replace

import pushpressslide as pps
from pushpressslide.core.plan import Choice
from pushpressslide.core.refusal import Refusal, enough_feasible
from pushpressslide.modes.base import BLOCKED
from pushpressslide.selection.planner import gathered, refusal


def test_reasons_that_differ_in_their_numbers_are_said_once_and_counted() -> None:
    slow = Refusal("time_limit", "needs about {figure:s.1f}", 60.5, 60.0, "s")
    far = [
        Choice("rear_push", f"face {i}", refusal=replace(slow, figure=60.5 + i))
        for i in range(4)
    ]
    other = Choice("rear_push", "face 4", refusal=Refusal("tipping", "it tips"))
    good = Choice("rear_push", "face 5", summary="path 1 m")
    good_too = Choice("rear_push", "face 6", summary="path 2 m")
    assert gathered([good, good_too, *far, other]) == [
        (good, "face 5: path 1 m"),
        (good_too, "face 6: path 2 m"),
        (far[0], "face 0: needs about 60.5 s (3 more like this)"),
        (other, "face 4: it tips"),
    ]


def test_choices_that_are_skipped_for_two_reasons_are_counted_apart() -> None:
    enough = Choice("press_slide", "a", refusal=enough_feasible(8))
    blocked = Choice("press_slide", "b", refusal=BLOCKED)
    assert gathered([enough, enough, blocked, blocked, blocked]) == [
        (enough, f"{enough.reason} (1 more like this)"),
        (blocked, f"{blocked.reason} (2 more like this)"),
    ]


def test_what_two_modes_are_refused_for_is_said_of_each() -> None:
    same = Refusal("tipping", "it tips")
    choices = [Choice(mode, refusal=same) for mode in ("rear_push", "press_slide")]
    assert gathered(choices) == [(choice, "it tips") for choice in choices]


def test_modes_for_another_number_of_arms_are_not_spoken_of() -> None:
    task = pps.load_task("rear-push-rear", ["modes=null", "limits.normal_force=2"])
    line = refusal(task.queries(), pps.select(task))
    assert (
        "rear_push: face 3: needs 2.9 N, allowed 1.8 N by limits.normal_force" in line
    )
    assert "press_slide" in line
    assert "parallel_push" not in line
