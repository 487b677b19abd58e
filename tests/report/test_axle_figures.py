"""The virtual axle over the time of a run, from a record whose axle is known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core.plan import Contact
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.report.axle_figures import axle_over_time
from pushpressslide.report.axle_series import axle_series

AXLE = -0.05
ANGLE = 0.6
LOAD = 8.0
SPEED = 0.02
TURN = 0.1


@pytest.fixture(params=[(0.0, 0.0), (0.03, -0.02)], ids=["centred", "off-centre"])
def pressed_run(run, request):
    """A bar that turns about a known axle under a press of known load and drag."""
    com = request.param
    body = ObjectModel(Box((0.6, 0.2, 0.1)), 0.3, com)
    task = replace(run.task, object=body)
    contact = Contact(0, "top", (0.12, 0.05), (0.0, 0.0), 0.1, LOAD)
    plan = replace(run.with_contacts(contact).plan, task=task)
    time = run.record.arrays["time"]
    yaw = TURN * time
    ex = 12.0 / 13.0
    ey = 5.0 / 13.0
    # the axle's velocity is along e; that of G's origin follows
    rx = -AXLE * ex - com[0]
    ry = -AXLE * ey - com[1]
    vx = SPEED * ex - TURN * ry
    vy = SPEED * ey + TURN * rx
    c = np.cos(yaw)
    s = np.sin(yaw)
    twist = np.stack(
        [c * vx - s * vy, s * vx + c * vy, np.full(len(time), TURN)], axis=1
    )
    bearing = yaw + math.atan2(ey, ex) + ANGLE
    force = np.stack(
        [3.0 * np.cos(bearing), 3.0 * np.sin(bearing), np.full(len(time), -LOAD)],
        axis=1,
    )
    made = replace(run, task=task, plan=plan)
    pose = np.stack([np.zeros_like(yaw), np.zeros_like(yaw), yaw], axis=1)
    return made.with_arrays(
        object_pose=pose, object_twist=twist, measured_force=force[:, None, :]
    )


def test_the_axle_is_read_off_the_twist_and_predicted_for_the_measured_force(
    pressed_run,
) -> None:
    axles = axle_series(pressed_run.plan, pressed_run.record)
    assert np.isnan(axles.measured[~pressed_run.move]).all()
    np.testing.assert_allclose(axles.measured[pressed_run.move], AXLE, atol=1e-6)
    thing = Press(pressed_run.task.object, 0.3, (0.12, 0.05), LOAD)
    for key, value in (
        ("predicted", thing.axle(ANGLE)),
        ("without_height", thing.axle(ANGLE, 0.0)),
        ("paper", thing.paper_axle()),
    ):
        assert len(getattr(axles, key)) == len(axles.time) >= 50
        np.testing.assert_allclose(getattr(axles, key), value, atol=1e-5)


def test_where_the_object_hardly_turns_nothing_is_measured(pressed_run) -> None:
    slow = pressed_run.record.arrays["object_twist"] * [1.0, 1.0, 0.1]
    made = pressed_run.with_arrays(object_twist=slow)
    assert np.isnan(axle_series(made.plan, made.record).measured).all()


def test_nothing_is_measured_while_a_turn_begins(pressed_run) -> None:
    time = pressed_run.record.arrays["time"]
    ramp = np.clip(time - 2.0, 0.0, 1.0)
    made = pressed_run.with_arrays(
        object_twist=pressed_run.record.arrays["object_twist"] * ramp[:, None]
    )
    measured = axle_series(made.plan, made.record).measured
    assert np.isnan(measured[time < 2.9]).all()
    np.testing.assert_allclose(measured[made.move & (time > 3.4)], AXLE, atol=1e-6)


def test_the_figure_has_four_panels_and_is_for_one_top_press_only(
    pressed_run, run
) -> None:
    figure = axle_over_time(pressed_run.plan, pressed_run.record)
    assert figure is not None
    assert len(figure.axes) == 4
    assert axle_over_time(run.plan, run.record) is None


def test_a_run_that_never_moved_has_no_axle(pressed_run) -> None:
    phase = np.zeros_like(pressed_run.record.arrays["phase"])
    made = pressed_run.with_arrays(phase=phase)
    assert axle_over_time(made.plan, made.record) is None
