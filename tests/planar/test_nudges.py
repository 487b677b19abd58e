"""Small errors at the goal, corrected by pushing a little further."""

from __future__ import annotations

import math

import pytest

import pushpressslide as pps
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result


@pytest.mark.parametrize("center", [[0.01, 0.01], [0.0, 0.015], [0.02, -0.01]])
def test_a_push_that_ends_turned_goes_on_without_letting_go(
    center: list[float],
) -> None:
    """A wrong centre of mass turns the object by one or two degrees."""
    task = pps.load_task(
        "rear-push-rear",
        [
            f"belief.center_of_mass={center}",
            "tolerance.position=0.01",
            "tolerance.yaw_deg=0.5",
        ],
    )
    plan, record, _ = simulate(task, engine="planar")
    found = result(task, plan, record)
    assert found["success"], found["reason"]
    assert found["events"] == []
    assert found["final_yaw_error"] < math.radians(0.5)
    assert len(record.plan.placements) == 1
