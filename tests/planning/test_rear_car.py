"""The car fitted to a push on one face, and where it would tip the object."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide import load_task
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.core.shapes import Prism
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.rear_car import (
    ANGLES,
    fitted_car,
    looked_at,
    push_twists,
    route_onward,
)
from pushpressslide.planning.side_contacts import pushable
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar

# long, narrow and tall: pushed along its length it tips over a side before it tips ahead
TASK = load_task(
    "rear-push-rear", ["object.shape.box=[0.3, 0.06, 0.3]", "support.friction=0.5"]
)
BASE = TASK.scene
NARROW = next(face for face in pushable(BASE) if face.normal[0] > 0.9)
# of a triangle that points to -y, with its centre of mass to the left of the middle
TRIANGLE = ((0.1, 0.05), (-0.1, 0.05), (0.0, -0.12))


def scene(body: ObjectModel) -> Scene:
    return replace(BASE, body=body)


def car_angle(body: ObjectModel, face: Face, height: float) -> float:
    """Return the largest force angle [rad] of the car that pushes ``face`` at
    ``height`` [m]; NaN where the object tips.
    """
    motion = replace(TASK.motion, contact_height=height)
    twists = push_twists(scene(body), motion, [face])[0]
    stands = ~np.isnan(twists[0, :, 0])
    if not stands[: ANGLES[0]].all():
        return math.nan
    return float(looked_at(scene(body), motion)[np.count_nonzero(stands) - 1])


def test_the_higher_a_push_the_less_it_may_steer_and_then_it_tips() -> None:
    edge = math.atan(BASE.contact_friction)
    heights = np.linspace(0.02, 0.29, 28)
    angles = [car_angle(BASE.body, NARROW, float(height)) for height in heights]
    assert angles[0] == pytest.approx(edge)
    stood = [angle for angle in angles if not math.isnan(angle)]
    assert angles[: len(stood)] == stood  # and nowhere above the first height that tips
    assert stood == sorted(stood, reverse=True)
    assert len(set(stood)) > 2
    assert len(stood) < len(angles)


def mirrored(body: ObjectModel) -> ObjectModel:
    shape = body.shape
    assert isinstance(shape, Prism)
    turned = tuple((-x, y) for x, y in reversed(shape.polygon))
    x, y = body.center_of_mass
    return replace(body, shape=replace(shape, polygon=turned), center_of_mass=(-x, y))


@pytest.mark.parametrize("height", [0.05, 0.1, 0.12, 0.14, 0.16])
def test_an_object_and_its_mirror_image_tip_alike(height: float) -> None:
    body = replace(
        BASE.body, shape=Prism(TRIANGLE, 0.25), center_of_mass=(-0.004, 0.003)
    )
    image = mirrored(body)
    ours = {f.normal: f for f in pushable(scene(body))}
    for face in pushable(scene(image)):
        nx, ny = face.normal
        twin = min(ours, key=lambda n: math.hypot(n[0] + nx, n[1] - ny))
        a = car_angle(image, face, height)
        b = car_angle(body, ours[twin], height)
        assert a == pytest.approx(b, nan_ok=True)


def test_a_car_that_is_not_to_tip_the_object_steers_less() -> None:
    motion = replace(TASK.motion, contact_height=0.05)
    twists = push_twists(BASE, motion, [NARROW])[0]
    free, _ = fitted_car(BASE, motion, NARROW, twists)
    twists[:, ANGLES[0] :] = math.nan
    tipping, _ = fitted_car(BASE, motion, NARROW, twists)
    assert max(tipping.curvature_limits) < 0.8 * max(free.curvature_limits)


def test_a_push_that_tips_where_the_path_turns_is_refused() -> None:
    motion = replace(TASK.motion, contact_height=0.05)
    twists = push_twists(BASE, motion, [NARROW])[0]
    tipping = np.full_like(twists, math.nan)
    with pytest.raises(RefusedError, match="tips the object where it turns"):
        fitted_car(BASE, motion, NARROW, tipping)


@pytest.mark.parametrize("ahead", [0.06, 0.1, 0.2])
@pytest.mark.parametrize("left", [-0.003, 0.003])
def test_a_push_that_is_a_little_off_has_a_way_on_to_its_goal(
    ahead: float, left: float
) -> None:
    """Also where less is left than the planned run-in: the turns need room."""
    car = RearSteerCar((-0.06, 0.0), (1.0, 0.0), ORIGIN, 0.045, 0.4)
    drive = RearSteerDrive(car, 3.0, 0.0, curvature_share=0.55, run_in=0.16)
    start = Pose2(0.0, 0.0, 0.0)
    goal = Pose2(ahead, left, math.copysign(math.radians(1.0), left))
    path = route_onward((start, goal), drive, 1.15 * ahead, 0.0)
    assert path is not None
    end = path.pose(path.length)
    assert (end.x, end.y, end.yaw) == pytest.approx((goal.x, goal.y, goal.yaw))
    assert path.pieces[-1][0] == 0.0
