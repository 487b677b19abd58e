"""An inclined plane as a support: two arms slide a box across and up it, on both
engines.
"""

import math

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.jobs.run import simulate
from pushpressslide.modes import MODES
from pushpressslide.report.metrics import result

NAME = "incline-slide"
ANGLE = math.radians(12.0)


@pytest.mark.parametrize("engine", ["planar", "drake"])
def test_a_box_is_slid_up_an_inclined_plane_to_its_goal(engine: str) -> None:
    task = pps.load_task(NAME)
    plan, record, _ = simulate(task, engine=engine)
    found = result(task, plan, record, {})
    assert found["success"], found["reason"]
    assert found["final_position_error"] < 2e-3
    assert found["final_yaw_error"] < math.radians(0.5)
    assert found["max_normal_force"] < task.limits.normal_force


def test_the_weight_is_shared_between_slope_and_support() -> None:
    scene = pps.load_task(NAME).scene
    weight = 9.81 * scene.body.mass
    x, y = scene.weight_along
    assert x == pytest.approx(-weight * math.sin(ANGLE))
    assert y == 0.0
    assert scene.weight_on == pytest.approx(weight * math.cos(ANGLE))


@pytest.mark.parametrize(("friction", "rests"), [(0.22, True), (0.20, False)])
def test_an_object_rests_where_friction_exceeds_the_slope(
    friction: float, rests: bool
) -> None:
    assert (math.tan(ANGLE) <= friction) == rests
    overrides = [f"support.friction={friction}"]
    if rests:
        assert pps.load_task(NAME, overrides).scene.rests
    else:
        with pytest.raises(TaskError, match="it would fall before the arms press it"):
            pps.load_task(NAME, overrides)


def test_the_frame_of_an_incline_is_right_handed_and_rises_along_x() -> None:
    frame = SupportFrame.of_incline(ANGLE)
    assert frame.handedness == 1.0
    assert frame.direction((1.0, 0.0, 0.0))[2] == pytest.approx(math.sin(ANGLE))
    assert frame.normal == pytest.approx((-math.sin(ANGLE), 0.0, math.cos(ANGLE)))


def test_modes_that_carry_no_weight_are_refused_on_an_incline() -> None:
    task = pps.load_task(NAME, ["modes=null"])
    without = [
        choice
        for choice in pps.select(task)
        if MODES[choice.mode].arms == 2 and not MODES[choice.mode].carries_weight
    ]
    assert {choice.mode for choice in without} >= {"parallel_push", "orthogonal_push"}
    for choice in without:
        assert choice.refusal is not None
        assert choice.refusal.code == "support"
        assert "on an incline" in choice.reason


def test_an_incline_needs_its_angle_and_a_table_has_none() -> None:
    with pytest.raises(TaskError, match=r"support\.angle_deg.*missing"):
        pps.load_task(NAME, ["support={kind: incline, friction: 0.3}"])
    with pytest.raises(TaskError, match="only an incline has one"):
        pps.load_task("bimanual-slide", ["support.angle_deg=5"])
