"""The car fitted to a push on one face, and the limit at which it would tip the object."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.core.task import ObjectModel
from pushpressslide.geometry.shapes import Box, Prism
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.rear_car import (
    COMFORT,
    HARDER,
    axle_ends,
    planned_share,
    resume_route,
    route,
)
from pushpressslide.planning.rear_car_fit import (
    ANGLES,
    fitted_car,
    looked_at,
    push_twists,
)
from pushpressslide.planning.run_in import with_run_in
from pushpressslide.planning.side_contacts import contact_height, pushable
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar

# long, narrow and tall: pushed along its length it tips over a side before it tips ahead
TASK = load_task(
    "rear-push-rear", ["object.shape.box=[0.3, 0.06, 0.3]", "support.friction=0.5"]
)
BASE = TASK.scene
NARROW = next(face for face in pushable(BASE, 0.04) if face.normal[0] > 0.9)
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
    angles = looked_at(scene(body), motion, face)
    return float(angles.mean(axis=0)[np.count_nonzero(stands) - 1])


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
    ours = {f.normal: f for f in pushable(scene(body), 0.04)}
    for face in pushable(scene(image), 0.04):
        nx, ny = face.normal
        twin = min(ours, key=lambda n: math.hypot(n[0] + nx, n[1] - ny))
        a = car_angle(image, face, height)
        b = car_angle(body, ours[twin], height)
        assert a == pytest.approx(b, nan_ok=True)


def test_a_car_that_is_not_to_tip_the_object_steers_less() -> None:
    motion = replace(TASK.motion, contact_height=0.05)
    twists = push_twists(BASE, motion, [NARROW])[0]
    free, _ = fitted_car(BASE, motion, NARROW, twists, 0.5)
    twists[:, ANGLES[0] :] = math.nan
    tipping, _ = fitted_car(BASE, motion, NARROW, twists, 0.5)
    assert max(tipping.curvature_limits) < 0.8 * max(free.curvature_limits)


def test_a_push_that_tips_where_the_path_turns_is_refused() -> None:
    motion = replace(TASK.motion, contact_height=0.05)
    twists = push_twists(BASE, motion, [NARROW])[0]
    tipping = np.full_like(twists, math.nan)
    with pytest.raises(RefusedError, match="tips the object where it turns"):
        fitted_car(BASE, motion, NARROW, tipping, 0.5)


def exact_turn(pushed: Scene, face: Face, angle: float) -> tuple[float, float]:
    """Return the curvature [1/m] of a push at a force ``angle`` [rad], and how far ahead
    of the CoM the axle is [m], on the exact limit surface.
    """
    lift = contact_height(pushed, TASK.motion) * pushed.support.friction
    heading = math.atan2(-face.foot[1], -face.foot[0])
    push = np.array([[math.cos(heading + angle), math.sin(heading + angle)]])
    slid = DraggedBase(pushed.body, lift, 16).slide(
        np.zeros((1, 2)), np.array([face.foot]), push
    )
    vx, vy, w = slid.twists[0]
    ahead = vx * math.cos(heading) + vy * math.sin(heading)
    across = vy * math.cos(heading) - vx * math.sin(heading)
    return w / ahead, -across / w


def fitted_to(
    pushed: Scene, face: Face, harder: float = 1.0
) -> tuple[RearSteerCar, float]:
    """Return the car of a path that is ``harder`` than planned, and its CoP's place."""
    twists = push_twists(pushed, TASK.motion, [face])[0]
    share = planned_share(TASK.motion, harder)
    return fitted_car(pushed, TASK.motion, face, twists, share)


@pytest.mark.parametrize(
    "size", [(0.12, 0.12, 0.08), (0.1, 0.3, 0.08), (0.05, 0.4, 0.03)]
)
@pytest.mark.parametrize("harder", HARDER)
def test_the_planned_turn_of_a_car_is_the_objects(
    size: tuple[float, float, float], harder: float
) -> None:
    """On the exact limit surface, also of a thin bar pushed across its length."""
    pushed = scene(replace(BASE.body, shape=Box(size)))
    face = next(face for face in pushable(pushed, 0.04) if face.normal[0] > 0.9)
    car, shift = fitted_to(pushed, face, harder)
    assert car.bounds is not None
    turn = planned_share(TASK.motion, harder) * car.bounds[1]
    curvature, axle = exact_turn(pushed, face, car.steering(turn))
    assert curvature == pytest.approx(turn, rel=0.06)
    assert abs(axle - shift - car.effective_wheelbase) < 0.02 * size[1]


def test_a_long_bar_pushed_at_its_end_turns_more_than_its_car_never_less() -> None:
    """Its axle is farther ahead than its curvature says: the longer of both is stable."""
    pushed = scene(replace(BASE.body, shape=Box((0.3, 0.06, 0.06))))
    face = next(face for face in pushable(pushed, 0.04) if face.normal[0] > 0.9)
    car, shift = fitted_to(pushed, face)
    assert car.bounds is not None
    turn = planned_share(TASK.motion, 1.0) * car.bounds[1]
    curvature, axle = exact_turn(pushed, face, car.steering(turn))
    assert curvature > 1.1 * turn
    assert abs(axle - shift - car.effective_wheelbase) < 0.003


def test_a_contact_beside_the_centre_of_mass_turns_farther_to_one_side() -> None:
    """Each side is looked at up to its own edge of the cone."""
    body = replace(BASE.body, shape=Box((0.12, 0.2, 0.08)), center_of_mass=(0.0, 0.02))
    pushed = scene(body)
    face = next(face for face in pushable(pushed, 0.04) if face.normal[0] > 0.9)
    face = replace(face, foot=(face.foot[0], -0.02), offset=-0.02)
    car, _ = fitted_to(pushed, face)
    right, left = car.bounds or (0.0, 0.0)
    half = math.atan(pushed.contact_friction)
    eta = math.atan2(0.02, face.depth)
    assert car.eta == pytest.approx(eta)
    assert car.steering_limits[0] < -half
    assert left > -1.5 * right
    exact = [exact_turn(pushed, face, angle)[0] for angle in (half - eta, -half - eta)]
    assert left - right == pytest.approx(exact[1] - exact[0], rel=0.15)


def drives_of(pushed: Scene, index: int) -> dict[float, RearSteerDrive]:
    """Drives of the cars that push a face, by how much harder than planned they turn."""
    face = next(face for face in pushable(pushed, 0.04) if face.index == index)
    drives = {}
    for harder in HARDER:
        car, shift = fitted_to(pushed, face, harder)
        drives[harder] = RearSteerDrive(car, 3.0, shift)
    return drives


def test_a_way_with_a_loop_ends_on_the_longest_run_in_that_is_no_great_detour() -> None:
    """To a goal beside and behind the object every way has a loop."""
    sets = ["goal={x: 0.3, y: -0.1, yaw_deg: 0}", "motion.face=3", "limits.legs=1"]
    task = load_task("rear-push-rear", sets)
    drives = drives_of(task.scene, 3)
    best, looped = route(task.query, drives)
    assert looped
    assert best.path.sections[-1] == (0.0, best.run_in)
    _, high = best.drive.car.curvature_limits
    turn = best.curvature_share * high
    ends = axle_ends(task.query.body_ends, best.drive)
    most = margins.LOOP_FOR_RUN_IN * with_run_in(ends, turn, turn, 0.0).length
    longer = [c.run_in for c in COMFORT if c.run_in * task.motion.run_in > best.run_in]
    assert best.path.length <= most
    assert longer
    for share in longer:
        other = with_run_in(ends, turn, turn, share * task.motion.run_in)
        assert other.length > most


def test_the_quickest_of_ways_with_a_loop_is_taken() -> None:
    """The tightest turns make the shortest way, and the slowest."""
    sets = ["goal={x: 0.45, y: -0.1, yaw_deg: 0}", "motion.face=3", "limits.legs=1"]
    task = load_task(
        "rear-push-rear",
        [*sets, "contact.friction=0.9", "belief.center_error=0.002"],
    )
    drives = drives_of(task.scene, 3)
    best, looped = route(task.query, drives)
    assert looped
    ends = axle_ends(task.query.body_ends, best.drive)
    _, high = best.drive.car.curvature_limits
    shortest = with_run_in(ends, high, high, best.run_in)
    tightest = max(abs(bend) for bend, _ in shortest.sections)
    assert best.path.length > shortest.length
    assert best.time < shortest.length * tightest / margins.ARM.turn_rate


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
    path = resume_route((start, goal), drive, 1.15 * ahead, 0.0)
    assert path is not None
    end = path.pose(path.length)
    assert (end.x, end.y, end.yaw) == pytest.approx((goal.x, goal.y, goal.yaw))
    assert path.sections[-1][0] == 0.0
