"""Position of an arm on its planned joint path if the object leaves its plan."""

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.execution import USUAL
from pushpressslide.control.following import bind_laws
from pushpressslide.control.run_loop import RunLoop
from pushpressslide.core.path import ArcPath
from pushpressslide.core.task import Robot
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planning.pressed.manoeuvre import pressed_manoeuvres


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8, 1.0])
def test_a_turn_on_the_spot_that_goes_on_as_arcs_keeps_its_place_by_the_yaw(
    share: float,
) -> None:
    task = pps.load_task("press-slide-pivot")
    task = replace(task, robots=(Robot("hand", task.robots[0].base),))
    plan = pps.plan(task)
    (planned,) = plan.segments
    controller = Controller(plan)
    measurement, _ = RunLoop(planar_cell(plan), plan).measure()
    state = controller.init(measurement)
    here = planned.path.pose(share * planned.path.length)
    X_WB = here.compose(planned.X_BV.inverse())
    arcs = pressed_manoeuvres(task.query, task.query.body_ends[0], planned.contacts)
    turn = arcs[0].choice(task, "press_slide").segments[0]
    assert isinstance(turn.path, ArcPath)
    # its lengths are those of another point
    assert not math.isclose(turn.path.length, planned.path.length, rel_tol=0.1)
    binding = bind_laws(task.scene, turn, USUAL.tracker(task.query, turn))
    led = state.following._replace(binding=binding)
    assert led.joint_progress(X_WB) == pytest.approx(
        share * planned.path.length, abs=1e-6 * planned.path.length
    )
