"""Laws of the holonomic tracker, on its demanded motion (docs/mechanics.md, section 9)."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath, integrate
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.tracking.holonomic import HolonomicTracker

SURFACE = DraggedSurface(6.0, 0.12, 0.03, (0.01, -0.02))
X_BV = Pose2(0.03, 0.02, 0.4)
DECAY = 0.04  # [m]
PATH = TwistPath.between((Pose2(), Pose2(0.3, -0.1, 0.5), Pose2(0.5, -0.1, 0.2)), 0.15)
small = st.floats(-0.01, 0.01)


def drive(tracker, path, X_WV, speed=0.05, dt=0.004, steering_scale=1.0):
    """Move as the tracker asks for; return way and distance from the path, in its
    metric, per tick.
    """
    X_WB = X_WV.compose(X_BV.inverse())
    s = 0.0
    off = []
    while s < path.length:
        guidance = tracker.step(path, X_WB, s, speed, steering_scale)
        s = guidance.progress
        along, left, turned = guidance.error
        off.append((s, math.sqrt(along**2 + left**2 + (path.radius * turned) ** 2)))
        X_WB = integrate(X_WB, guidance.twist[:3], dt)
    return off


def test_on_the_path_it_asks_for_the_twist_of_the_path() -> None:
    tracker = HolonomicTracker(X_BV, SURFACE, DECAY)
    s = 0.1
    guidance = tracker.step(PATH, PATH.pose(s).compose(X_BV.inverse()), s, 0.05, 1.0)
    at_V = guidance.twist.moved_to(X_BV.position)
    wanted = PATH.rate(s)
    assert X_BV.unrotate((at_V.vx, at_V.vy)) == pytest.approx(
        (0.05 * wanted[0], 0.05 * wanted[1]), abs=1e-12
    )
    assert at_V.w == pytest.approx(0.05 * wanted[2])
    assert guidance.error == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert not guidance.saturated


@settings(max_examples=40)  # each is a drive of 2,500 ticks
@given(x=small, y=small, yaw=st.floats(-0.08, 0.08))
def test_errors_are_gone_at_the_end_whatever_they_were(
    x: float, y: float, yaw: float
) -> None:
    off = drive(HolonomicTracker(X_BV, SURFACE, DECAY), PATH, Pose2(x, y, yaw))
    assert off[-1][1] < 2e-5


@pytest.mark.parametrize("speed", [0.01, 0.1])
def test_an_error_falls_to_1_over_e_over_the_same_way_at_any_speed(
    speed: float,
) -> None:
    path = TwistPath.between((Pose2(), Pose2(0.5, 0.0, 0.0)), 0.15)
    off = drive(
        HolonomicTracker(X_BV, SURFACE, DECAY),
        path,
        Pose2(0.0, 0.002, 0.0),
        speed,
        0.0002 / speed,
    )
    way = next(s for s, e in off if e < 0.002 / math.e)
    assert way == pytest.approx(DECAY, rel=0.02)


def test_a_large_error_is_taken_down_by_half_the_speed_and_by_less_with_less_grip() -> (
    None
):
    path = TwistPath.between((Pose2(), Pose2(0.5, 0.0, 0.0)), 0.15)
    for steering_scale in (1.0, 0.4):
        guidance = HolonomicTracker(Pose2(), SURFACE, DECAY).step(
            path, Pose2(0.1, 0.2, 0.0), 0.1, 0.05, steering_scale
        )
        assert guidance.saturated
        assert guidance.twist.vx == pytest.approx(0.05)
        assert guidance.twist.vy == pytest.approx(-0.5 * steering_scale * 0.05)


def test_the_wrench_is_on_the_surface_and_drives_the_twist() -> None:
    tracker = HolonomicTracker(X_BV, SURFACE, DECAY)
    for s in (0.0, 0.1, 0.4):
        X_WB = PATH.pose(s).compose(Pose2(0.003, -0.006, 0.05)).compose(X_BV.inverse())
        guidance = tracker.step(PATH, X_WB, s, 0.05, 1.0)
        assert guidance.wrench.about == SURFACE.center
        fx, fy, tau = guidance.wrench[:3]
        assert math.hypot(fx, fy, tau / SURFACE.rho) == pytest.approx(SURFACE.max_force)
        driven = SURFACE.twist_direction(guidance.wrench)
        twist = guidance.twist.moved_to(SURFACE.center)
        k = twist.vx / driven.vx
        assert k > 0.0
        assert twist[:3] == pytest.approx((k * driven.vx, k * driven.vy, k * driven.w))


class HalfSpace:
    """Contacts that can only give forces with fy <= 0."""

    def nearest(self, wrench: Wrench) -> Wrench | None:
        return wrench._replace(fy=0.0) if wrench.fy > 0.0 else None


def test_what_the_contacts_cannot_give_is_left_out_and_the_rest_kept() -> None:
    surface = DraggedSurface(6.0, 0.12)
    path = TwistPath.between((Pose2(), Pose2(0.5, 0.0, 0.3)), 0.15)
    free = HolonomicTracker(Pose2(), surface, DECAY)
    held = HolonomicTracker(Pose2(), surface, DECAY, HalfSpace().nearest)
    X_WB = path.pose(0.1).compose(Pose2(0.0, -0.02, 0.0))  # the path is to the left
    wanted, given = (
        tracker.step(path, X_WB, 0.1, 0.05, 1.0) for tracker in (free, held)
    )
    assert wanted.wrench.fy > 0.5
    assert given.wrench.fy == 0.0
    assert given.twist.vy == pytest.approx(0.0, abs=1e-12)
    # without lift the projection of the wrench is that of the twist: the rest of it is
    # as it was
    assert given.twist.vx == pytest.approx(wanted.twist.vx)
    assert given.twist.w == pytest.approx(wanted.twist.w)
    assert given.saturated
    fx, fy, tau = given.wrench[:3]
    assert math.hypot(fx, fy, tau / surface.rho) == pytest.approx(surface.max_force)


def test_progress_never_goes_back() -> None:
    off = drive(HolonomicTracker(X_BV, SURFACE, DECAY), PATH, Pose2(-0.02, 0.01, -0.1))
    assert all(a <= b for (a, _), (b, _) in pairwise(off))


@pytest.mark.parametrize("yaw", [0.6, -0.6])
def test_on_a_turn_on_the_spot_errors_are_those_along_the_axes_of_the_vehicle(
    yaw: float,
) -> None:
    path = TwistPath.between((Pose2(), Pose2(0.0, 0.0, yaw)), 0.15)
    at = path.pose(0.04).compose(Pose2(0.002, -0.003, 0.0))
    guidance = HolonomicTracker(Pose2(), SURFACE, DECAY).step(path, at, 0.04, 0.05, 1.0)
    assert guidance.error == pytest.approx((-0.002, 0.003, 0.0), abs=1e-9)


@pytest.mark.parametrize("s", [0.05, 0.2, 0.4])
def test_the_steering_is_the_angle_of_the_force_in_the_vehicle(s: float) -> None:
    at = PATH.pose(s).compose(Pose2(0.001, -0.004, 0.02)).compose(X_BV.inverse())
    guidance = HolonomicTracker(X_BV, SURFACE, DECAY).step(PATH, at, s, 0.05, 1.0)
    fx, fy = X_BV.unrotate(guidance.wrench[:2])
    assert guidance.steering == pytest.approx(math.atan2(fy, fx))
