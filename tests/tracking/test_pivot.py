"""Laws of the turn on the spot (docs/mechanics.md, sections 2 and 4)."""

import math

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath, integrate
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.rom.drives import SpinDrive
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.unicycle import PIVOT_SHARE, PivotTracker

CAR = Unicycle((0.08, 0.03), (0.03, 0.01), 0.07)
DRIVE = SpinDrive(CAR, 5.0, CAR.X_BV)
TRACKER = PivotTracker(DRIVE)
PLACE = Pose2(0.4, -0.3, 0.5)
SPEED = 0.05


def path(turn: float) -> TwistPath:
    return TwistPath.between((PLACE, Pose2(PLACE.x, PLACE.y, PLACE.yaw + turn)), 0.15)


def step(turn: float, off: Pose2, speed: float = SPEED):
    """Guidance with V at ``off`` from its reference pose, after a third of the path."""
    way = path(turn)
    s = way.length / 3.0
    X_WB = way.pose(s).compose(off).compose(DRIVE.X_BV.inverse())
    return TRACKER.step(way, X_WB, s, speed, 1.0)


def at_pivot(guidance) -> tuple[float, float, float]:
    """Return the twist of the pivot in the axes of V."""
    twist = guidance.twist.moved_to(DRIVE.X_BV.position)
    return (*DRIVE.X_BV.unrotate((twist.vx, twist.vy)), twist.w)


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_on_its_place_it_turns_about_the_pivot_by_a_force_across_the_axis(
    turn: float,
) -> None:
    guidance = step(turn, Pose2())
    assert at_pivot(guidance) == pytest.approx((0.0, 0.0, turn * SPEED / 0.15))
    along, across = DRIVE.X_BV.unrotate(guidance.wrench[:2])
    assert along == pytest.approx(0.0, abs=1e-9)
    assert across * turn > 0.0
    assert not guidance.saturated
    assert guidance.steering == pytest.approx(math.copysign(0.5 * math.pi, turn))
    assert guidance.error == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("turn", [1.0, -1.0])
@pytest.mark.parametrize("ahead", [0.001, -0.002, 0.05, -0.05])
def test_the_pivot_is_pulled_back_along_the_axis_with_a_share_of_the_force(
    turn: float, ahead: float
) -> None:
    guidance = step(turn, Pose2(ahead, 0.0, 0.0))
    along, aside, _ = at_pivot(guidance)
    assert along * ahead < 0.0
    assert aside == pytest.approx(0.0, abs=1e-12)
    most = PIVOT_SHARE * CAR.effective_wheelbase * SPEED / 0.15
    assert abs(along) <= most + 1e-12
    assert (abs(along) == pytest.approx(most)) == (abs(ahead) > 0.01)
    assert guidance.error == pytest.approx((-ahead, 0.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("turn", [1.0, -1.0])
@pytest.mark.parametrize("off", [Pose2(), Pose2(0.003, 0.002, 0.1), Pose2(-0.05)])
def test_the_wrench_is_on_the_ellipsoid_and_drives_the_twist(
    turn: float, off: Pose2
) -> None:
    guidance = step(turn, off)
    surface = EllipsoidLimitSurface(DRIVE.max_friction, CAR.rho, CAR.cop)
    assert guidance.wrench.about == CAR.cop
    assert surface.level(guidance.wrench) == pytest.approx(1.0)
    driven = surface.twist_direction(guidance.wrench)
    twist = guidance.twist.moved_to(CAR.cop)
    size = math.hypot(twist.vx, twist.vy, CAR.rho * twist.w)
    assert twist[:3] == pytest.approx([size * part for part in driven[:3]])
    fx, fy = DRIVE.X_BV.unrotate(guidance.wrench[:2])
    assert guidance.steering == pytest.approx(math.atan2(fy, fx))


def test_at_rest_nothing_is_asked_for() -> None:
    guidance = step(1.0, Pose2(0.01, 0.0, 0.0), speed=0.0)
    assert guidance.twist[:3] == (0.0, 0.0, 0.0)
    assert guidance.wrench[:3] == (0.0, 0.0, 0.0)
    assert guidance.steering == 0.0


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_an_error_along_the_axis_is_gone_after_a_turn(turn: float) -> None:
    way = path(turn)
    X_WB = PLACE.compose(Pose2(0.003, 0.0, 0.0)).compose(DRIVE.X_BV.inverse())
    guidance = TRACKER.step(way, X_WB, 0.0, SPEED, 1.0)
    while guidance.progress < way.length - 1e-4:
        X_WB = integrate(X_WB, guidance.twist[:3], 0.01)
        guidance = TRACKER.step(way, X_WB, guidance.progress, SPEED, 1.0)
    assert abs(guidance.error[0]) < 1e-3
