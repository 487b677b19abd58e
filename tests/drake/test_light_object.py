"""A light object: what the arm does beside its push must not use up the friction."""

from __future__ import annotations

import numpy as np
import pytest

from pushpressslide.jobs.run import simulate
from pushpressslide.taskfile.load import load_task

PUSHED = (
    "object.mass=0.12",
    "start.x=0.45",
    "start.y=0.1",
    "goal.x=0.6",
    "goal.y=-0.02",
    "goal.yaw_deg=-50",
    "limits.legs=1",
)


@pytest.mark.long
def test_a_tip_does_not_lean_on_the_face_of_a_light_object() -> None:
    """A push of 0.35 N along a bend, while the tool turns by 50 degrees: the force
    along the height is a small share of it.
    """
    _, record, _ = simulate(load_task("rear-push-rear", PUSHED))
    assert record.reason == "goal_reached"
    moving = record.arrays["phase"] == 2
    force = record.arrays["measured_force"][moving][:, 0]
    along = np.hypot(force[:, 0], force[:, 1])
    assert 0.2 < np.median(along) < 0.5
    upright = np.abs(force[:, 2])
    assert np.median(upright) < 0.05
    assert np.percentile(upright, 75.0) < 0.08
