"""Every drive keeps the data of its model that tracker, allocator and report need."""

import math

import pytest

from pushpressslide.core.drive import Drive
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.modes import MODES
from pushpressslide.rom.drives import (
    CarDrive,
    HeldDrive,
    PinnedDrive,
    PressedDrive,
    RearSteerDrive,
    SpinDrive,
    TurnDrive,
    TwistDrive,
    UnicycleDrive,
)
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.rom.unicycle import Unicycle

CAR = RearSteerCar((-0.1, 0.02), (1.0, 0.0), (0.0, 0.0), 0.06, 0.5)
PRESSED = Unicycle((0.08, 0.03), (0.03, 0.01), 0.07)
PUSHED = PushedCar(0.4, 0.05, 0.04, 0.08, 3.0, 4.0)
SURFACE = DraggedSurface(6.0, 0.11, 0.0, (0.02, -0.01))
AXLE = Pose2(-0.04, 0.05, 0.9)
REAR = RearSteerDrive(CAR, 4.0, 0.012)
UNICYCLE = UnicycleDrive(PRESSED, 5.0, 0.4, 0.06, 3.0, 0.05)
TURN = TurnDrive(PRESSED, 5.0, AXLE, 0.06, 0.7, 1.2, 4.0, 0.1, -0.3, 0.2, 1.5)
SPIN = SpinDrive(PRESSED, 5.0, AXLE)
PUSH = CarDrive(PUSHED, 4.0, 2.0)
TWIST = TwistDrive(SURFACE, 0.15)
HELD = HeldDrive(SURFACE, 0.15, (0.03, 0.02), 0.01, 0.6)
PINNED = PinnedDrive(
    SURFACE, 0.15, (-0.1, 0.08), (0.0, 0.01), 0.5, (0.15, -0.12), (-0.6, 0.8)
)
DRIVES = [REAR, UNICYCLE, TURN, SPIN, PUSH, TWIST, HELD, PINNED]


def velocity(force: Point, place: Point, spot: Point, drive: Drive) -> Point:
    """How point ``spot`` [m] in B moves under a force at ``place``, on the ellipsoid."""
    assert drive.rho is not None
    surface = EllipsoidLimitSurface(drive.max_friction, drive.rho, drive.center)
    wrench = Wrench(*force, place[0] * force[1] - place[1] * force[0])
    twist = surface.twist_direction(wrench.moved_to(drive.center)).moved_to(spot)
    return twist.vx, twist.vy


def test_every_drive_of_the_library_is_among_these() -> None:
    kinds = {kind for mode in MODES.values() for kind in mode.drives}
    assert {type(drive) for drive in DRIVES} == kinds


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: type(drive).__name__)
def test_every_drive_answers_what_all_of_them_are_asked(drive: Drive) -> None:
    assert isinstance(drive.X_BV, Pose2)
    assert drive.max_friction > 0.0
    assert drive.rho is not None
    assert drive.rho > 0.0
    assert len(drive.center) == 2
    assert hash(drive) == hash(drive)


def test_a_push_is_tracked_beyond_the_com_on_the_line_from_its_contact() -> None:
    lever = math.hypot(*CAR.contact)
    ahead = CAR.rho**2 / lever + REAR.shift
    X_BV = REAR.X_BV
    assert X_BV.position == pytest.approx([-ahead * c / lever for c in CAR.contact])
    assert X_BV.yaw == pytest.approx(math.atan2(-CAR.contact[1], -CAR.contact[0]))
    assert CAR.X_BV.unapply(X_BV.position) == pytest.approx((REAR.shift, 0.0))


@pytest.mark.parametrize("angle", [-1.1, -0.3, 0.0, 0.6, 2.5])
def test_under_no_force_of_its_press_does_a_unicycles_axle_slip_aside(
    angle: float,
) -> None:
    X_BV = UNICYCLE.X_BV
    force = X_BV.rotate((math.cos(angle), math.sin(angle)))
    moved = velocity(force, PRESSED.contact, X_BV.position, UNICYCLE)
    _, across = X_BV.unrotate(moved)
    assert across == pytest.approx(0.0, abs=1e-12)
    assert UNICYCLE.center == PRESSED.cop


def test_the_force_that_steers_a_unicycle_turns_by_its_effective_wheelbase() -> None:
    assert UNICYCLE.effective_wheelbase == pytest.approx(PRESSED.rho**2 / PRESSED.lever)
    assert UNICYCLE.stiffness == pytest.approx((PRESSED.lever / PRESSED.rho) ** 2)
    assert (UNICYCLE.right, UNICYCLE.left) == (-0.4, 0.4)
    assert (UNICYCLE.angle, UNICYCLE.turn) == (UNICYCLE.X_BV.yaw, 0.0)


def test_turns_and_spins_are_tracked_where_they_were_planned() -> None:
    assert TURN.X_BV == SPIN.X_BV == AXLE
    assert TURN.center == SPIN.center == PRESSED.cop
    assert TURN.steepest == 0.2  # to the nearer of its two sides


def test_a_pushed_car_is_tracked_at_its_axle_along_the_pushes() -> None:
    X_BV = PUSH.X_BV
    assert X_BV.yaw == PUSHED.heading
    assert X_BV.rotate((PUSHED.axle, 0.0)) == pytest.approx(X_BV.position)
    assert PUSH.center == (0.0, 0.0)


def test_drives_by_twists_are_of_their_surface_and_tracked_at_their_point() -> None:
    assert Pose2() == TWIST.X_BV
    assert Pose2(0.03, 0.02, 0.0) == HELD.X_BV
    assert Pose2(-0.1, 0.08, 0.0) == PINNED.X_BV
    for drive in (TWIST, HELD, PINNED):
        assert drive.max_friction == SURFACE.max_force
        assert (drive.rho, drive.center) == (SURFACE.rho, SURFACE.center)


def test_the_axle_of_a_pinned_object_stays_where_the_push_alone_would_turn_it() -> None:
    moved = velocity(PINNED.push_normal, PINNED.push, PINNED.axle, PINNED)
    assert moved == pytest.approx((0.0, 0.0), abs=1e-12)
    beside = (PINNED.axle[0] + 0.01, PINNED.axle[1])
    assert math.hypot(*velocity(PINNED.push_normal, PINNED.push, beside, PINNED)) > 1e-3


@pytest.mark.parametrize("drive", [UNICYCLE, TURN, SPIN])
def test_a_drive_further_on_is_tracked_further_on(drive: PressedDrive) -> None:
    there = drive.shifted((0.03, -0.02))
    x, y = drive.X_BV.position
    assert there.X_BV.position == pytest.approx((x + 0.03, y - 0.02))
    x, y = drive.center
    assert there.center == pytest.approx((x + 0.03, y - 0.02))
