"""Base, side and top of bodies that are no upright prisms, for the tips of a task."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, ObjectModel, Robot, Shape, Task
from pushpressslide.geometry.border import Arc
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.quadrature import moments
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.modes.rear_push import RearPush
from pushpressslide.planning.object_sheet import ObjectSheet, object_sheet

RADIUS = 0.0125
Bodies = Callable[[str], MeshBody]


def task_of(shape: Shape, friction: float = 0.5) -> Task:
    """Task of a body that one tip may push or press."""
    return Task(
        name="body",
        object=ObjectModel(shape, 0.5),
        start=Pose2(0.42, 0.15, 0.0),
        goal=Pose2(0.52, -0.12, -0.4),
        robots=(Robot("panda", tip_radius=RADIUS),),
        contact_friction=friction,
    )


def sheet_of(shape: Shape, friction: float = 0.5) -> ObjectSheet:
    task = task_of(shape, friction)
    return object_sheet(task.scene, task.motion)


def test_a_chamfered_box_stands_on_less_than_its_outline(standing: Bodies) -> None:
    body = standing("chamfered")
    sheet = sheet_of(body)
    assert sheet.base_size == pytest.approx((0.112, 0.072), abs=1e-6)
    assert sheet.press_height == pytest.approx(0.05)
    assert body.holds((0.05, 0.0), 0.005, (0.0, 0.0))
    assert not body.holds((0.055, 0.0), 0.005, (0.0, 0.0))
    x_min, x_max, _, _ = body.section(sheet.push_height).bounds(Pose2())
    assert x_max - x_min == pytest.approx(0.12, abs=1e-6)
    assert sheet.touched_share == pytest.approx(1.0)


def test_the_pressure_of_a_ring_is_that_of_an_annulus(standing: Bodies) -> None:
    body = standing("ring")
    inner, outer = 0.04, 0.06
    assert body.base_area == pytest.approx(math.pi * (outer**2 - inner**2), rel=5e-3)
    samples = support_pressure(body)
    arm = np.hypot(*samples.points.T) @ samples.loads / samples.loads.sum()
    exact = 2.0 / 3.0 * (outer**3 - inner**3) / (outer**2 - inner**2)
    assert arm == pytest.approx(exact, rel=3e-3)


def test_feet_carry_all_of_the_load(standing: Bodies) -> None:
    """A load off centre is shared by the lever rule, in each foot and over all."""
    body = standing("stool")
    cop = (0.02, 0.01)
    samples = support_pressure(body, load=1.0, cop=cop)
    x, y = samples.points.T
    assert (np.abs(np.abs(x) - 0.07) <= 0.01).all()
    assert (np.abs(np.abs(y) - 0.04) <= 0.01).all()
    assert samples.loads @ samples.points == pytest.approx(np.array(cop), abs=1e-9)
    area, first, _ = moments(np.array(body.base_corners))
    assert area == pytest.approx(4 * 0.02**2, rel=1e-4)
    assert first == pytest.approx(np.zeros(2), abs=1e-9)


def test_a_tip_pushes_a_plate_on_feet_at_the_plate(standing: Bodies) -> None:
    body = standing("stool")
    assert not body.section(0.02, 0.2).touchable(RADIUS)
    assert 0.03 < sheet_of(body).push_height < 0.07


def test_a_leaning_side_is_pushed_as_far_as_friction_holds(standing: Bodies) -> None:
    body = standing("cup")
    exact = math.atan2(0.01, 0.1)
    rough = sheet_of(body, 0.5)
    assert rough.lean == pytest.approx(exact, abs=math.radians(0.5))
    assert rough.no_push is None
    assert rough.touched_share == pytest.approx(1.0)
    smooth = sheet_of(body, 0.2)
    assert smooth.no_push is not None
    assert smooth.no_push.code == "leaning"
    assert smooth.no_push.figure == pytest.approx(rough.lean)
    assert "lean by 6 deg" in str(smooth.no_push)


def test_a_bowl_is_not_pushed_but_pressed_inside(standing: Bodies) -> None:
    body = standing("bowl")
    sheet = sheet_of(body)
    assert sheet.no_push is not None
    assert sheet.no_push.code == "leaning"
    assert body.pressed_inside
    assert body.top_height == pytest.approx(0.01, abs=1e-6)


def test_a_handle_is_in_the_way_of_a_tip_beside_it(standing: Bodies) -> None:
    body = standing("mug")
    section = body.section(0.045, 0.2)
    (wall,) = section.border.sides
    assert isinstance(wall, Arc)
    assert wall.radius == pytest.approx(0.04, rel=2e-3)
    covered = sum(part.side.sweep for part in section.touchable(RADIUS))
    beside = min(
        angle for angle in np.linspace(0.0, 0.5, 501) if _clear_of_handle(angle)
    )
    assert covered == pytest.approx(2.0 * (math.pi - beside), abs=0.05)


def _clear_of_handle(angle: float) -> bool:
    """Whether a tip on the wall is clear of the handle's outer part, seen from above."""
    x = (0.04 + RADIUS) * math.cos(angle)
    y = (0.04 + RADIUS) * math.sin(angle)
    return math.hypot(max(0.06 - x, 0.0), max(y - 0.006, 0.0)) > 0.95 * RADIUS


def test_a_lying_bottle_is_pushed_along_itself_alone(standing: Bodies) -> None:
    """It rolls where it is pushed across, or turned."""
    straight = replace(
        task_of(standing("lying")),
        start=Pose2(0.45, 0.12, 0.0),
        goal=Pose2(0.45, -0.08, 0.0),
    )
    candidates = RearPush().candidates(straight.query)
    choices = [one for candidate in candidates for one in candidate.make(True)]
    across = [c for c in choices if abs(c.contacts[0].normal[0]) > 0.9]
    assert [c.refusal.code for c in across] == ["tipping", "tipping"]


def test_a_ball_rolls(standing: Bodies) -> None:
    sheet = sheet_of(standing("ball"))
    assert sheet.no_push is not None
    assert sheet.no_push.code == "tipping"
    assert sheet.press_height is None


@pytest.mark.parametrize("shape", [Box((0.12, 0.08, 0.05)), Cylinder(0.04, 0.06)])
def test_an_upright_body_is_its_footprint_everywhere(shape: Shape) -> None:
    sheet = sheet_of(shape)
    assert sheet.base_area == pytest.approx(shape.placed(Pose2()).area)
    assert sheet.touched_share == pytest.approx(1.0)
    assert sheet.lean == 0.0
    assert sheet.press_height == shape.height
    assert shape.section(0.01) is shape


def test_a_body_read_twice_is_equal_and_another_is_not(standing: Bodies) -> None:
    one = standing("cup")
    assert one == replace(one)
    assert hash(one) == hash(replace(one))
    assert one != standing("mug")
