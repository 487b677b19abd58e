"""What is said where no mode can do a task."""

from dataclasses import replace

import pushpressslide as pps
from pushpressslide.core.plan import Choice
from pushpressslide.selection.planner import gathered, refusal


def test_reasons_that_differ_in_their_numbers_are_said_once_and_counted() -> None:
    far = [
        Choice("rear_push", False, f"face {i}: needs about {60.5 + i} s")
        for i in range(4)
    ]
    other = Choice("rear_push", False, "face 4: it tips")
    good = Choice("rear_push", True, "face 5: path 1 m")
    found = gathered([good, replace(good, reason="face 6: path 2 m"), *far, other])
    assert [c.reason for c in found] == [
        "face 5: path 1 m",
        "face 6: path 2 m",
        "face 0: needs about 60.5 s (3 more like this)",
        "face 4: it tips",
    ]


def test_modes_for_another_number_of_arms_are_not_spoken_of() -> None:
    task = pps.load_task("rear-push-rear", ["modes=null", "limits.normal_force=2"])
    line = refusal(task, pps.select(task))
    assert "rear_push: face 3: needs 2.9 N, limits.normal_force is 2 N" in line
    assert "press_slide" in line
    assert "parallel_push" not in line
