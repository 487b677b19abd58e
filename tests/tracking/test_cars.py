"""Laws of the trackers that follow arcs: each on its own reduced model."""

import math
from dataclasses import dataclass

import pytest

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import integrate
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.rom.drives import TurnDrive, UnicycleDrive
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.axle import AxleTracker
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.rear_car import EASING, RearPushTracker
from pushpressslide.tracking.rear_stanley import rear_stanley
from pushpressslide.tracking.unicycle import UnicycleTracker

MU_N = 5.0  # [N]
SPEED = 0.05  # [m/s]
LAW = LookAheadAlignment(0.06, 6.0)
PATH = ArcPath(Pose2(0.3, -0.2, 0.7), ((2.0, 0.3), (0.0, 0.2), (-3.0, 0.3)))
OFF = [
    Pose2(),
    Pose2(0.0, 0.004, 0.0),
    Pose2(0.0, -0.003, 0.05),
    Pose2(0.0, 0.002, -0.04),
]


@dataclass(frozen=True)
class Follower:
    """A tracker, and what is known of its object."""

    tracker: object
    X_BV: Pose2
    rho: float
    center: tuple[float, float]


def rear_push(contact: tuple[float, float]) -> Follower:
    car = RearSteerCar(contact, (1.0, 0.0), (0.0, 0.0), 0.06, 0.5)
    steer = rear_stanley(car.effective_wheelbase, car.steering_limits)
    tracker = RearPushTracker(steer, car, car.X_BV, MU_N)
    return Follower(tracker, car.X_BV, car.rho, car.cop)


def pressed(backward: bool) -> Follower:
    car = Unicycle((0.08, 0.03), (0.03, 0.01), 0.07, backward)
    drive = UnicycleDrive(car, MU_N, 0.3, 0.06, 3.0, 0.05)
    return Follower(UnicycleTracker(LAW, drive), car.X_BV, car.rho, car.cop)


def pushed(axle: float) -> Follower:
    """Two pushes: with equal forces, or (axle 0) by normal forces alone."""
    car = PushedCar(0.4, axle, axle, 0.08, 6.0, 6.0)
    return Follower(AxleTracker(LAW, car, MU_N), car.X_BV, car.rho, (0.0, 0.0))


FOLLOWERS = {
    "rear push": rear_push((-0.1, 0.0)),
    "rear push beside the middle": rear_push((-0.1, 0.02)),
    "pulled": pressed(backward=False),
    "pushed from above": pressed(backward=True),
    "synchronised": pushed(0.05),
    "differential": pushed(0.0),
}
every_follower = pytest.mark.parametrize("name", FOLLOWERS)


def guidance_at(follower: Follower, s: float, off: Pose2, steering_scale: float = 1.0):
    X_WB = PATH.pose(s).compose(off).compose(follower.X_BV.inverse())
    return follower.tracker.step(PATH, X_WB, s, SPEED, steering_scale)


@every_follower
def test_the_wrench_is_on_the_ellipsoid_and_drives_the_twist(name: str) -> None:
    follower = FOLLOWERS[name]
    surface = EllipsoidLimitSurface(MU_N, follower.rho, follower.center)
    for s in (0.1, 0.4, 0.6):
        for off in OFF:
            guidance = guidance_at(follower, s, off)
            assert guidance.wrench.about == follower.center
            assert surface.level(guidance.wrench) == pytest.approx(1.0)
            driven = surface.twist_direction(guidance.wrench)
            twist = guidance.twist.moved_to(follower.center)
            size = math.hypot(twist.vx, twist.vy, follower.rho * twist.w)
            assert twist[:3] == pytest.approx([size * part for part in driven[:3]])


@every_follower
def test_the_tracked_point_moves_ahead_at_the_speed(name: str) -> None:
    follower = FOLLOWERS[name]
    for s in (0.1, 0.4, 0.6):
        for off in OFF:
            at_V = guidance_at(follower, s, off).twist.moved_to(follower.X_BV.position)
            ahead, aside = follower.X_BV.unrotate((at_V.vx, at_V.vy))
            assert ahead == pytest.approx(SPEED)
            assert aside == pytest.approx(0.0, abs=1e-12)


@every_follower
def test_on_the_path_it_turns_as_the_path_does(name: str) -> None:
    for s in (0.1, 0.4, 0.6):
        guidance = guidance_at(FOLLOWERS[name], s, Pose2())
        assert guidance.twist.w == pytest.approx(SPEED * PATH.curvature(s), abs=1e-9)
        assert guidance.progress == pytest.approx(s)
        assert not guidance.saturated


@every_follower
def test_errors_are_reference_minus_actual(name: str) -> None:
    guidance = guidance_at(FOLLOWERS[name], 0.4, Pose2(0.0, 0.004, 0.03))
    assert guidance.error == pytest.approx((0.0, -0.004, -0.03))


@every_follower
def test_the_steering_is_the_angle_of_the_force_from_the_heading(name: str) -> None:
    follower = FOLLOWERS[name]
    for s in (0.1, 0.6):
        for off in OFF:
            guidance = guidance_at(follower, s, off)
            fx, fy = follower.X_BV.unrotate(guidance.wrench[:2])
            assert guidance.steering == pytest.approx(math.atan2(fy, fx))


@every_follower
def test_whatever_the_error_at_the_start_it_ends_on_the_path(name: str) -> None:
    follower = FOLLOWERS[name]
    dt = 0.02
    for off in OFF:
        X_WB = PATH.pose(0.0).compose(off).compose(follower.X_BV.inverse())
        guidance = follower.tracker.step(PATH, X_WB, 0.0, SPEED, 1.0)
        while guidance.progress < PATH.length - 1e-3:
            twist = guidance.twist.moved_to((0.0, 0.0))
            X_WB = integrate(X_WB, twist[:3], dt)
            guidance = follower.tracker.step(PATH, X_WB, guidance.progress, SPEED, 1.0)
        _, left, turned = guidance.error
        assert abs(left) < 1e-4
        assert abs(turned) < 5e-3


@every_follower
def test_far_off_it_turns_back_as_tightly_as_it_may_and_says_so(name: str) -> None:
    follower = FOLLOWERS[name]
    for side in (1.0, -1.0):
        guidance = guidance_at(follower, 0.4, Pose2(0.0, side * 0.1, side * 0.7))
        farther = guidance_at(follower, 0.4, Pose2(0.0, side * 0.15, side * 0.9))
        assert guidance.saturated
        assert guidance.twist.w * side < 0.0
        assert guidance.twist.w == pytest.approx(farther.twist.w)


@pytest.mark.parametrize("name", ["rear push", "synchronised"])
def test_less_grip_means_less_steering_of_a_car_that_steers_by_friction(
    name: str,
) -> None:
    off = Pose2(0.0, 0.1, 0.7)
    full, half = (
        abs(guidance_at(FOLLOWERS[name], 0.4, off, g).steering) for g in (1.0, 0.5)
    )
    assert half < 0.6 * full


def test_a_car_that_is_turned_without_friction_needs_no_grip() -> None:
    off = Pose2(0.0, 0.1, 0.7)
    follower = FOLLOWERS["differential"]
    full, half = (
        guidance_at(follower, 0.4, off, steering_scale) for steering_scale in (1.0, 0.5)
    )
    assert full == half


def test_a_turn_is_steered_about_the_force_and_the_curvature_that_were_planned() -> (
    None
):
    """tan(force angle - planned angle) = effective wheelbase (curvature - turn)."""
    car = Unicycle((0.08, 0.03), (0.03, 0.01), 0.07)
    planned, turn, wheelbase = 0.7, 2.0, 0.1
    X_BV = Pose2(-0.04, 0.05, 0.9)
    stiffness = 1.5
    drive = TurnDrive(
        car, MU_N, X_BV, 0.06, 0.3, planned, turn, wheelbase, -0.2, 0.15, stiffness
    )
    follower = Follower(UnicycleTracker(LAW, drive), X_BV, car.rho, car.cop)
    ahead = (car.contact[0] - car.cop[0], car.contact[1] - car.cop[1])
    axis = math.atan2(ahead[1], ahead[0])
    for off in OFF:
        guidance = guidance_at(follower, 0.1, off)
        fx, fy = guidance.wrench[:2]
        steered = math.atan2(fy, fx) - planned
        assert steered == pytest.approx(guidance.steering)
        curvature = guidance.twist.w / SPEED
        assert math.tan(steered) == pytest.approx(
            wheelbase * (curvature - turn), abs=1e-12
        )
        assert -0.2 - 1e-12 <= steered <= 0.15 + 1e-12
        size = MU_N / math.sqrt(
            1.0 + stiffness * math.sin(planned + steered - axis) ** 2
        )
        assert math.hypot(fx, fy) == pytest.approx(size)
        assert guidance.wrench.tau == pytest.approx(ahead[0] * fy - ahead[1] * fx)
    far = [guidance_at(follower, 0.1, Pose2(0.0, y, 0.0)).steering for y in (0.1, -0.1)]
    assert far == pytest.approx([-0.2, 0.15])


def test_a_rear_push_heads_into_a_bend_before_it_is_there() -> None:
    follower = rear_push((-0.1, 0.0))
    bend = PATH.sections[0][1]
    ahead, _ = PATH.eased(bend, EASING * SPEED)
    assert ahead < -0.004  # to the right, from a curve to the left
    X_WB = PATH.pose(bend).compose(follower.X_BV.inverse())
    guidance = follower.tracker.step(PATH, X_WB, bend, SPEED, 1.0)
    assert guidance.error[2] == pytest.approx(ahead, rel=1e-6)
