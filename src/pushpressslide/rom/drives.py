"""The drives: the reduced-model data of a segment, one frozen class each.

A drive contains the data that tracker, allocator, replanning and report need
(``core.drive.Drive``). Lengths are in [m], angles in [rad], forces in [N], and points
in the body frame B.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.rom.unicycle import Unicycle

ORIGIN = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class VehicleDrive:
    """Base class of all vehicle drives: the friction and rho of the car."""

    car: RearSteerCar | PushedCar | Unicycle
    max_friction: float  # [N]

    @property
    def rho(self) -> float:
        """Rho [m] of the car."""
        return self.car.rho

    @property
    def center(self) -> Point:
        """The CoM."""
        return ORIGIN

    @property
    def skew(self) -> float:
        """Angle [rad] of the heading from the line through the contact."""
        return 0.0


def _further(X_BV: Pose2, offset: Point) -> Pose2:
    """Pose ``X_BV`` with its origin displaced by ``offset`` [m]."""
    return Pose2(X_BV.x + offset[0], X_BV.y + offset[1], X_BV.yaw)


@dataclass(frozen=True, slots=True)
class RearSteerDrive(VehicleDrive):
    """One side push: a rear-steer car tracked at its virtual front axle."""

    car: RearSteerCar
    shift: float  # [m] ahead by which the push's height moves the CoP
    # share of the friction-limited curvature that the path uses
    curvature_share: float = 1.0
    run_in: float = 0.0  # [m] straight end of the path
    nudges: bool = False  # whether its path ends within the tolerances, not at the goal

    @property
    def X_BV(self) -> Pose2:
        """Frame at the virtual front axle, including the shift caused by the height of
        the contact.
        """
        X = self.car.X_BV
        dx = self.shift * math.cos(X.yaw)
        dy = self.shift * math.sin(X.yaw)
        return Pose2(X.x + dx, X.y + dy, X.yaw)

    @property
    def center(self) -> Point:
        """The CoM of the car's model."""
        return self.car.cop


@dataclass(frozen=True, slots=True)
class PressedDrive(VehicleDrive):
    """Base class of all drives of one press."""

    car: Unicycle

    @property
    def center(self) -> Point:
        """The CoP."""
        return self.car.cop

    def shifted(self, offset: Point) -> Self:
        """The drive displaced by ``offset`` [m] in B."""
        return replace(self, car=self.car.shifted(offset))


@dataclass(frozen=True, slots=True)
class UnicycleDrive(PressedDrive):
    """One press, steered along a path by the angle of its force.

    All steered drives have the relation tan(force angle - angle) = effective_wheelbase
    (curvature - turn). The force at an angle phi from the axis is max_friction / sqrt(1
    + stiffness sin^2 phi).
    """

    steepest: float  # [rad] force angle from the motion that it may be steered with
    look_ahead: float  # [m]
    curvature: float  # [1/m] of the path's turns
    run_in: float  # [m] straight end of the path

    @property
    def X_BV(self) -> Pose2:
        """Frame at the virtual axle."""
        return self.car.X_BV

    @property
    def angle(self) -> float:
        """Angle [rad] in B of the force that drives straight."""
        return self.car.X_BV.yaw

    @property
    def turn(self) -> float:
        """Curvature [1/m] without steering. Zero for a straight drive."""
        return 0.0

    @property
    def effective_wheelbase(self) -> float:
        """Effective wheelbase of the car [m], signed."""
        return self.car.effective_wheelbase

    @property
    def right(self) -> float:
        """Largest steering [rad] of the force to the right, negative."""
        return -self.steepest

    @property
    def left(self) -> float:
        """Largest steering [rad] of the force to the left, positive."""
        return self.steepest

    @property
    def stiffness(self) -> float:
        """Square (d / rho)^2 of the ratio of the lever to rho."""
        return self.car.lever / self.car.effective_wheelbase


@dataclass(frozen=True, slots=True)
class TurnDrive(PressedDrive):
    """One press that turns the object by a force at one angle: a segment of a
    manoeuvre, or its run-in.
    """

    X_BV: Pose2  # at the turn's axle, x along its motion
    look_ahead: float  # [m]
    axis_angle: float  # [rad] of the force from the heading axis
    angle: float  # [rad] of the force in B
    turn: float  # [1/m] curvature as driven
    effective_wheelbase: float  # [m] signed
    right: float  # [rad] < 0
    left: float  # [rad] > 0
    stiffness: float
    last: bool = False  # the run-in: a path of its own is steered for

    @property
    def skew(self) -> float:
        """Angle [rad] of the heading from the line through the contact."""
        return math.remainder(self.X_BV.yaw - self.car.X_BV.yaw, math.pi)

    @property
    def steepest(self) -> float:
        """Largest steering [rad] of the force to either side."""
        return min(-self.right, self.left)

    def shifted(self, offset: Point) -> Self:
        """The drive displaced by ``offset`` [m] in B."""
        X_BV = _further(self.X_BV, offset)
        return replace(self, car=self.car.shifted(offset), X_BV=X_BV)


@dataclass(frozen=True, slots=True)
class SpinDrive(PressedDrive):
    """One press with the force across the axis: a turn on the spot."""

    X_BV: Pose2  # at the pivot, which stays in its place, x along the axis

    def shifted(self, offset: Point) -> Self:
        """The drive displaced by ``offset`` [m] in B."""
        X_BV = _further(self.X_BV, offset)
        return replace(self, car=self.car.shifted(offset), X_BV=X_BV)


@dataclass(frozen=True, slots=True)
class CarDrive(VehicleDrive):
    """Two pushes on one face that drive the object as a car."""

    car: PushedCar
    curvature: float  # [1/m] tightest that a path may use

    @property
    def X_BV(self) -> Pose2:
        """Frame at the axle, x along the pushes."""
        return self.car.X_BV


SteeredDrive = UnicycleDrive | TurnDrive
"""A press whose force is steered like a unicycle."""


@dataclass(frozen=True, slots=True)
class SurfaceDrive:
    """Base class of all drives by twists."""

    surface: DraggedSurface  # the limit surface near the planned twist
    radius: float  # [m] weight of turns in the path's length

    @property
    def max_friction(self) -> float:
        """Maximum friction [N] of the surface."""
        return self.surface.max_force

    @property
    def rho(self) -> float:
        """Rho of the surface [m]."""
        return self.surface.rho

    @property
    def center(self) -> Point:
        """Reference point of wrenches: the CoP without drag."""
        return self.surface.center


@dataclass(frozen=True, slots=True)
class TwistDrive(SurfaceDrive):
    """Two pushes that drive any twist in a cone. The vehicle frame V is the body frame
    B.
    """

    normal_force: float = 0.0  # [N] largest force of a contact, if planned
    offset: Point = ORIGIN  # [m] of the centre of mass, as identified, from B's origin

    def with_center(self, offset: Point) -> Self:
        """The drive with the centre of mass at another ``offset`` [m]."""
        x, y = self.surface.center
        was_x, was_y = self.offset
        center = (x + offset[0] - was_x, y + offset[1] - was_y)
        return replace(
            self, surface=replace(self.surface, center=center), offset=offset
        )

    @property
    def X_BV(self) -> Pose2:
        """The body frame: a constant twist is the same motion about any point."""
        return Pose2()


@dataclass(frozen=True, slots=True)
class HeldDrive(SurfaceDrive):
    """Two contacts that hold the object and move it along one twist."""

    point: Point  # [m] in B, that is tracked
    lever: float  # [m/N] height of the tips above the CoM over the load
    friction_utilisation: float  # of the presses' friction

    @property
    def X_BV(self) -> Pose2:
        """Frame at the tracking point, with axes along those of B."""
        return Pose2(*self.point)


@dataclass(frozen=True, slots=True)
class PinnedDrive(SurfaceDrive):
    """A press that pins a point, and a push that turns the object about it."""

    pin: Point  # [m] in B
    pressure: Point  # [m] in B, centre of pressure under way
    friction_utilisation: float  # of the press's friction
    push: Point  # [m] in B, where it is pushed
    push_normal: Point  # unit, in B

    @property
    def X_BV(self) -> Pose2:
        """Frame at the pin, with axes along those of B."""
        return Pose2(*self.pin)

    @property
    def axle(self) -> Point:
        """Point [m] in B about which the push alone would turn the object, under a
        press that loads the object but does not hold it.
        """
        x, y = self.surface.center
        nx, ny = self.push_normal
        arm = (self.push[0] - x) * ny - (self.push[1] - y) * nx
        distance = self.surface.rho**2 / arm
        return (x - ny * distance, y + nx * distance)
