"""Object on its support and falling into an opening, from a record made by hand."""

import numpy as np
import pytest

from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.report.support import support_figures
from pushpressslide.taskfile.load import load_task

HOLD = 50
FALL = 25
REST = 25  # ticks
DT = 0.004
ACCELERATION = 2.0  # [s], [m/s^2] of a fall that friction brakes


def fall() -> tuple[np.ndarray, np.ndarray]:
    """Heights in the plane and depths [m]: held, falling and going in, at rest on the
    sill and the back.
    """
    t = DT * np.arange(FALL)
    y = np.concatenate([np.full(HOLD, 0.003), 0.003 - 0.5 * ACCELERATION * t**2])
    depth = np.concatenate([np.zeros(HOLD), np.linspace(0.004, 0.15, FALL)])
    return np.append(y, np.full(REST, y[-1])), np.append(depth, np.full(REST, 0.15))


@pytest.mark.parametrize(
    "goal", [[], ["goal.x=0.7", "goal.y=0", "goal.yaw_deg=0"]], ids=["into", "beside"]
)
def test_the_fall_into_the_opening_is_measured_from_where_it_begins(goal):
    task = load_task("press-fit", goal)
    y, depth = fall()
    frame = task.support.frame
    half = 0.5 * task.object.shape.height
    places = np.array(
        [frame.point((0.0, v, half - d)) for v, d in zip(y, depth, strict=True)]
    )
    turned = np.tile([1.0, 0.0, 0.0, 0.0], (len(y), 1))
    arrays = {
        "time": DT * np.arange(len(y)),
        "phase": np.full(len(y), PHASES.index("move")),
        "placement": np.zeros(len(y)),
        "object_pose_3d": np.hstack([turned, places]),
    }
    found = support_figures(
        task,
        Record(arrays, "goal_reached", "", "drake", 0, 1.0, (), Plan(task, ())),
    )
    if goal:
        assert found["fall_height"] is None
        assert found["fall_speed"] is None
        return
    time = DT * (FALL - 1)
    assert found["fall_height"] == pytest.approx(0.5 * ACCELERATION * time**2)
    assert found["fall_speed"] == pytest.approx(ACCELERATION * (time - 0.5 * DT))
    assert found["support_gap_max"] == pytest.approx(0.0, abs=1e-12)
    assert found["seated_depth"] == pytest.approx(0.15)
