"""Options, limits and tolerances of a motion.

SI units and radians; docs/task-file.md documents the fields with the units of a task
file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from pushpressslide.core import margins
from pushpressslide.core.checks import check_fields
from pushpressslide.core.field_spec import documented, field_spec, setting
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import ARM_NAMES, ArmName

Vehicle = Literal[
    "unicycle", "car", "forklift", "pivot", "mixed", "differential", "synchronised"
]
"""Reduced model with which a mode drives the object: one of its ``Mode.vehicles``."""

Cop = Literal["balanced", "left", "right"] | float
"""Position of the centre of pressure between two presses. "balanced" means equal
presses. "left" and "right" mean as far to that side as a turn on the spot allows with
the loads of the motion. A fraction in [0, 1] is measured from the left contact to the
right one.
"""


PLANNED_SHARE = 0.9  # share of limits.normal_force
FORCE_ALLOWED = "allowed {allowed:Ng} by limits.normal_force"
"""End of the text that refuses too large a normal force."""


@documented
@dataclass(frozen=True, slots=True)
class Tolerance:
    """Errors within which the goal counts as reached."""

    position: float = setting(0.01, "largest position error", "m", "(0, 1]")
    yaw: float = setting(math.radians(2.0), "largest yaw error", "deg", "(0, 180]")
    bodies: float = setting(
        0.005,
        "largest displacement of movable obstacles, except a tool's and those with `may_move`",
        "m",
        "(0, 1]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    def holds(self, X: Pose2, goal: Pose2) -> bool:
        """Whether a pose is within the tolerance of a goal."""
        turn = abs(math.remainder(X.yaw - goal.yaw, math.tau))
        near = math.dist(X.position, goal.position) <= self.position
        return near and turn <= self.yaw


ON_THE_WAY = Tolerance(margins.ARM.via, margins.ARM.turned_via)
"""Tolerance of via poses, which the search chooses and the task does not prescribe."""


@documented
@dataclass(frozen=True, slots=True)
class ToolUse:
    """Use of the object as a tool: one of its side faces pushes another body to that
    body's goal.
    """

    body: str  # name of a movable obstacle
    goal: Pose2  # pose of that body's centre in the world
    face: int = field(
        metadata=field_spec(
            "index of the edge of the tool's footprint that pushes, as in motion.face",
            within="[0, 255]",
            default_in_file=1,
        )
    )
    straight: float  # [m] length of the straight push from the touch to the goal

    def __post_init__(self) -> None:
        check_fields(self)


@documented
@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of the run."""

    time: float = setting(120.0, "largest simulated time", "s", "(0, 3600]")
    normal_force: float = setting(
        40.0, "largest normal force of a contact", "N", "(0, 1000]"
    )
    # [m] x_min, x_max, y_min, y_max
    workspace: tuple[float, float, float, float] | None = setting(
        None, "region in which the origin of G stays; null: unbounded"
    )
    legs: int = setting(
        5,
        "largest number of motions in a sequence, searched if one motion does not reach "
        "the goal; 1: no sequences",
        within="[1, 20]",
    )
    # of normal_force; less after a force limit
    planned_share: float = PLANNED_SHARE

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def planned_force(self) -> float:
        """Normal force [N] allowed in plans. The remainder up to the limit is for the
        regulator's ripple.
        """
        return self.planned_share * self.normal_force


@documented
@dataclass(frozen=True, slots=True)
class Motion:
    """Options of the motion. Defaults suit the shipped robots."""

    speed: float = setting(
        0.05, "speed of the tracking point along its path", "m/s", "(0, 0.2]"
    )
    # far below mu_s g, which keeps the motion quasi-static
    acceleration: float = setting(
        0.1, "acceleration and deceleration along the path", "m/s^2", "(0, 2]"
    )
    tracking_gain: float = setting(
        2.0,
        "gain of the steering law, as a multiple of the largest without overshoot",
        within="(0, 10]",
    )
    servo_damping: float = setting(
        500.0, "damping of the contact velocity servo", "N s/m", "[0, 10000]"
    )
    contact_height: float | None = setting(
        None,
        "height of a side contact above the support, below the object's top; null: "
        "chosen by the mode",
        "m",
        "(0, 10]",
    )
    approach_distance: float = setting(
        0.05, "distance from the contact at which the touch begins", "m", "[0.005, 0.5]"
    )
    recoveries: int = setting(
        6,
        "how often the arms may let go and replan, after a missed contact, a missed goal "
        "or a broken limit",
        within="[0, 20]",
    )
    curvature_margin: float = setting(
        0.55,
        "largest planned curvature, as a share of the one that friction allows",
        within="(0, 1]",
    )
    run_in: float = setting(
        0.16, "length of the straight end of the path", "m", "[0, 1]"
    )
    clearance: float = setting(
        0.01,
        "gap that the object keeps from obstacles; if start or goal is closer, the gap "
        "there, growing to this one over 5 cm of path",
        "m",
        "[0.001, 0.1]",
    )
    control_period: float = setting(0.004, "control period", "s", "[0.0005, 0.01]")
    # at most the control period
    time_step: float = setting(
        0.004, "time step of the physics engine", "s", "[0.0002, 0.01]"
    )
    face: int | None = setting(
        None,
        "index of the pushed edge of the footprint, edge i from corner i to i + 1 "
        "counter-clockwise (box: 0 is -y, 1 is +x, 2 is +y, 3 is -x); null: chosen by "
        "the mode",
        within="[0, 255]",
    )
    arm: ArmName | None = setting(
        None,
        "the only arm that may touch the object, in a mode that needs one; null: chosen "
        "by the mode",
    )
    contacts: tuple[Point, ...] | None = setting(
        None,
        "points of the top contacts in G. Of two, the first is the left arm's unless "
        "the arms would cross; null: chosen by the mode",
        "m",
        "[-5, 5]",
        count=(1, 2),
    )
    press_force: float | None = setting(
        None,
        "normal force of a top contact; null: chosen by the mode",
        "N",
        "(0, 1000]",
    )
    cop: Cop | None = setting(
        None,
        "where two presses put the centre of pressure on a table: balanced (equal "
        "presses), as far left or right as a turn on the spot allows, or a fraction of "
        "the distance from the left contact to the right one; null: balanced",
        within="[0, 1]",
    )
    vehicle: Vehicle | None = setting(
        None,
        "reduced model as which the object is driven. press_slide: unicycle (pulled or "
        "pushed), car (pulled), forklift (pushed), pivot (turned about its virtual "
        "axle); null: unicycle. parallel_push: mixed (any twist inside the motion "
        "cone), differential (turned by the difference of the normal forces), "
        "synchronised (by equal friction forces); null: mixed, otherwise differential",
    )
    look_ahead: float | None = setting(
        None,
        "look-ahead with which a pressed object is aligned with its path; null: chosen "
        "by the mode",
        "m",
        "(0, 1]",
    )
    risk: float | None = setting(
        None,
        "choices whose odds fall short of the best by more than this rank last, whatever "
        "their time; null: choices rank by time alone",
        within="(0, 1]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def only_arm(self) -> int | None:
        """Index of the only arm that may touch the object, or None if any may."""
        return None if self.arm is None else ARM_NAMES.index(self.arm)

    @property
    def freed(self) -> Motion:
        """The motion with face, contacts and vehicle left to the mode."""
        return replace(self, face=None, contacts=None, vehicle=None)
