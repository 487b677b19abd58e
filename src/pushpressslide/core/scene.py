"""The physical scene of a task, as believed by planner and controller.

It consists of a body on a support, with arms and obstacles around it. It does not
include the motion of the body. Units are SI and radians; docs/task-file.md documents
the fields with the units of a task file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pushpressslide.core import margins
from pushpressslide.core.checks import check_fields
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import InputError
from pushpressslide.core.field_spec import FRICTIONS, documented, field_spec, setting
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.geometry.shapes import Shape

if TYPE_CHECKING:
    from shapely import Polygon

FIT = 1e-6  # [m] tolerance for an outline that just fits an opening
LEDGE_GAP = 2e-3  # [m] gap to a ledge below which an object counts as lying on it
Value = TypeVar("Value")


ArmName = Literal["left", "right"]
ARM_NAMES: tuple[ArmName, ...] = ("left", "right")
"""Names of a task's arms, in the order of its robots."""


def arm_title(arm: int, count: int = 2) -> str:
    """Name of a robot's arm in a task with ``count`` robots."""
    return "arm" if count == 1 else f"{ARM_NAMES[arm]} arm"


@documented
@dataclass(frozen=True, slots=True)
class Opening:
    """A rectangular opening in a wall, closed at its back."""

    size: tuple[float, float] = field(
        metadata=field_spec("size along x and y", "m", "(0, 10]")
    )
    center: Point = field(
        metadata=field_spec("position of its centre", key="pose")
    )  # in the wall's plane
    depth: float = field(
        metadata=field_spec("distance of its back from the wall's face", "m", "(0, 10]")
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """Left and right edge (x [m]), lower and upper edge (y [m]), in the wall's
        plane.
        """
        w, h = self.size
        cx, cy = self.center
        return cx - 0.5 * w, cx + 0.5 * w, cy - 0.5 * h, cy + 0.5 * h

    def holds(self, pose: Pose2, shape: Shape) -> bool:
        """Whether a shape at ``pose`` fits the opening's outline."""
        x_min, x_max, y_min, y_max = shape.bounds(pose)
        w, h = self.size
        cx, cy = self.center
        return all(abs(x - cx) <= 0.5 * w + FIT for x in (x_min, x_max)) and all(
            abs(y - cy) <= 0.5 * h + FIT for y in (y_min, y_max)
        )


@documented
@dataclass(frozen=True, slots=True)
class Support:
    """The surface that the object slides on."""

    kind: Literal["table", "wall", "incline"] = setting("table", "kind of support")
    friction: float = setting(
        0.3, "friction coefficient between object and support", within=FRICTIONS
    )
    # of all poses, in the world
    frame: SupportFrame = setting(
        TABLE,
        "frame of a wall, required for one: its origin in the world, and the heading "
        "of its normal, which points at the robots",
        key="pose",
        default_in_file=None,
    )
    opening: Opening | None = setting(
        None, "a rectangular opening in a wall, closed at its back"
    )
    angle: float | None = setting(
        None,
        "slope of an incline, required for one; it rises along x",
        "deg",
        "(0, 45]",
    )
    region: tuple[Point, ...] | None = setting(
        None,
        "corners of a table's top in the world: in order, either sense, concave too; "
        "null: it has no edge",
        "m",
        "[-10, 10]",
        count=(3, 64),
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def name(self) -> str:
        """Kind of the support with an article, for messages."""
        return f"an {self.kind}" if self.kind[0] in "aeiou" else f"a {self.kind}"


CENTROID: Point = (math.nan, math.nan)
"""Placeholder for a centre of mass that is not given."""


@documented
@dataclass(frozen=True, slots=True)
class ObjectModel:
    """The object to be moved. Without ``center_of_mass`` its density is uniform."""

    shape: Shape = field(
        metadata=field_spec("exactly one shape; it defines the frame G")
    )
    mass: float = field(
        metadata=field_spec(
            "mass; null: that in the shape's URDF, SDF or MJCF file",
            "kg",
            "(0, 1000]",
            default_in_file=None,
        )
    )
    center_of_mass: Point = field(
        default=CENTROID,
        metadata=field_spec(
            "centre of mass in G, projected on the support, inside the footprint's hull; null: "
            "the centroid",
            "m",
            "[-5, 5]",
            default_in_file=None,
        ),
    )

    def __post_init__(self) -> None:
        """Set a missing centre of mass to the centroid, and check the numbers.

        Shapes given in another form are converted, or refused, by ``check_task``.
        """
        if not isinstance(self.shape, Shape):
            return
        if self.center_of_mass is CENTROID:
            object.__setattr__(self, "center_of_mass", self.shape.centroid)
        check_fields(self)

    @property
    def X_GB(self) -> Pose2:
        """Pose of the body frame B (origin at the projected centre of mass) in the
        shape's frame G.
        """
        return Pose2(self.center_of_mass[0], self.center_of_mass[1], 0.0)

    @property
    def radius(self) -> float:
        """Distance [m] of the farthest corner from the centre of mass."""
        return self.shape.farthest(self.center_of_mass)

    def likeliest_center(self, error: float) -> Point:
        """Point [m] in G within an ``error`` [m] of the centre of mass that is nearest
        to that of a uniform density.
        """
        x, y = self.center_of_mass
        dx = self.shape.centroid[0] - x
        dy = self.shape.centroid[1] - y
        share = min(1.0, error / max(math.hypot(dx, dy), 1e-9))
        return x + share * dx, y + share * dy


MODELS: tuple[str, ...] = (
    "panda",
    "iiwa7",
    "ur5e",
    "ur10",
    "xarm7",
    "fr3",
    "gen3",
    "hand",
)
"""Robots with a description in the package. ``hand`` is a tip without an arm."""
FILES = (".urdf", ".sdf", ".xml", ".mjcf")
"""Suffixes of a robot's file. URDF and MJCF may both be XML."""
PATHS = "the path of a URDF, SDF or MJCF file (.urdf, .sdf, .xml)"
TIP_RADIUS = 0.02
"""Default radius [m] of a tip."""
TIP_LENGTH = 0.15
"""Default length [m] of the rod from the flange to a tip."""


def is_robot_file(path: Path) -> bool:
    """Whether a path has the suffix of a robot's file."""
    return path.suffix.lower() in FILES


@documented
@dataclass(frozen=True, slots=True)
class Tip:
    """A rod with a spherical tip on a link of a robot's file."""

    link: str = field(metadata=field_spec("link or frame that carries it"))
    xyz: tuple[float, float, float] = setting(
        (0.0, 0.0, 0.0), "foot of the rod in the link's frame", "m", "[-2, 2]"
    )
    rpy: tuple[float, float, float] = setting(
        (0.0, 0.0, 0.0),
        "roll, pitch and yaw of the rod's frame in the link's; its z axis points out "
        "of the flange",
        "deg",
        "[-360, 360]",
    )
    radius: float = setting(
        TIP_RADIUS, "radius of the spherical tip", "m", "[0.002, 0.1]"
    )
    length: float = setting(
        TIP_LENGTH, "distance from the foot to the tip's centre", "m", "[0, 0.5]"
    )

    def __post_init__(self) -> None:
        check_fields(self)


@documented
@dataclass(frozen=True, slots=True)
class JointLimits:
    """Limits of one joint, which override or complete those of its file."""

    joint: str = field(metadata=field_spec("name of the joint"))
    position: tuple[float, float] | None = setting(
        None,
        "lower and upper end of its range, of a slide in m; null: those of the file",
        "deg",
        "[-1440, 1440]",
    )
    speed: float | None = setting(
        None,
        "largest speed, of a slide in m/s; null: that of the file",
        "deg/s",
        "(0, 10000]",
        key="speed_deg_s",
    )
    torque: float | None = setting(
        None,
        "largest torque, of a slide its force in N; null: that of the file",
        "N m",
        "(0, 100000]",
    )

    def __post_init__(self) -> None:
        check_fields(self)


def doubled_by_tip(
    robot: Mapping[str, Any], radius: float, length: float
) -> str | None:
    """Name of a field of ``robot`` that duplicates a property of its tip. None if no
    field does.

    The tip has ``radius`` and ``length`` [m].
    """
    if robot["tip_frame"] is not None:
        return "tip_frame"
    if robot["tip_radius"] not in (TIP_RADIUS, radius):
        return "tip_radius"
    if robot["tip_length"] not in (TIP_LENGTH, length):
        return "tip_length"
    return None


@documented
@dataclass(frozen=True, slots=True)
class Robot:
    """One arm (or a free tip, ``hand``) and the pose of its base.

    If the robot has a ``tip``, ``tip_radius`` and ``tip_length`` are those of the tip.
    """

    model: str = field(
        metadata=field_spec(
            f"{', '.join(MODELS)} (a free force-controlled tip), or the path of a "
            "URDF, SDF or MJCF file"
        )
    )
    # [m] position in the world
    base: tuple[float, float, float] = field(
        default=(0.0, 0.0, 0.0), metadata=field_spec("pose of the base")
    )
    base_yaw: float = 0.0  # [rad]; part of ``base`` in the file
    tip_frame: str | None = setting(
        None,
        "frame at the tip's centre; a model given by its path needs this or tip",
    )
    tip_radius: float = setting(
        TIP_RADIUS, "radius of the spherical tip", "m", "[0.002, 0.1]"
    )
    tip_length: float = setting(
        TIP_LENGTH,
        "distance from the flange to the tip's centre, in the generated models",
        "m",
        "[0, 0.5]",
    )
    tip: Tip | None = setting(
        None,
        "rod and tip on a link of a model given by its path, in place of tip_frame, "
        "tip_radius and tip_length",
    )
    home: tuple[float, ...] | None = setting(
        None,
        "ready posture of a model given by its path, from the base to the tip; null: "
        "found, with the tool down",
        "deg",
        "[-1440, 1440]",
        count=(1, 16),
    )
    rotor_inertia: tuple[float, ...] | None = setting(
        None,
        "inertia of the rotors of a model given by its path, from the base to the tip; "
        "if gear_ratio is null, the motor's times the gear ratio squared; null: that of "
        "the file, or 0.003 kg m^2 for each N m of effort",
        "kg m^2",
        "[0, 1000]",
        count=(1, 16),
    )
    gear_ratio: tuple[float, ...] | None = setting(
        None,
        "gear ratios of a model given by its path, from the base to the tip; their "
        "squares multiply the inertia of the rotors; null: those of the file, or 1",
        "",
        "(0, 10000]",
        count=(1, 16),
    )
    joint_friction: tuple[float, ...] | None = setting(
        None,
        "viscous friction of the joints of a model given by its path, from the base to "
        "the tip, in engines with arms; null: that of the file",
        "N m s/rad",
        "[0, 10000]",
        count=(1, 16),
    )
    limits: tuple[JointLimits, ...] | None = setting(
        None,
        "limits of joints of a model given by its path, in place of those of the file; "
        "required where the file has none",
        count=(1, 16),
    )
    interface: Literal["torque", "velocity", "position"] = setting(
        "torque", "kind of command that the arm takes"
    )
    rate: float = setting(
        250.0, "rate of its commands, unless they are torques", "Hz", "[20, 2000]"
    )
    lag: float = setting(
        0.0,
        "time constant of its servo, which follows a command with a first-order lag, "
        "unless it takes torques",
        "s",
        "[0, 0.5]",
    )
    delay: float = setting(
        0.0,
        "time until it begins to obey a command, as its controller knows; of an arm that "
        "takes torques at most 0.016 s, in engines with arms",
        "s",
        "[0, 0.5]",
    )
    packages: tuple[str, ...] = setting(
        (), "folders of the packages that contain a model's meshes", count=(0, 16)
    )

    def __post_init__(self) -> None:
        check_fields(self)
        tip = self.tip
        if tip is not None:
            names = ("tip_frame", "tip_radius", "tip_length")
            stated = {name: getattr(self, name) for name in names}
            doubled = doubled_by_tip(stated, tip.radius, tip.length)
            if doubled is not None:
                raise InputError(f"{doubled} and tip: give one of them")
            object.__setattr__(self, "tip_radius", tip.radius)
            object.__setattr__(self, "tip_length", tip.length)

    @property
    def reaction(self) -> float:
        """Time [s] until the arm follows a command; 0 for one that takes torques."""
        if self.interface == "torque":
            return 0.0
        return 1.0 / self.rate + self.delay + self.lag


@documented
@dataclass(frozen=True, slots=True)
class Obstacle:
    """An upright body in the scene, fixed or free to move."""

    name: str = field(metadata=field_spec("unique; not 'object'", is_name=True))
    shape: Shape = field(
        metadata=field_spec("exactly one shape; it stands on the support")
    )
    # in the world (on a wall: in the wall's plane)
    pose: Pose2 = field(metadata=field_spec("pose of the shape's frame G"))
    movable: bool = setting(
        False, "whether it can be pushed away; otherwise it is fixed"
    )
    mass: float = setting(1.0, "mass, if movable", "kg", "(0, 1000]")
    friction: float = setting(
        0.3,
        "friction coefficient between obstacle and support, if movable",
        within=FRICTIONS,
    )
    believed_mass: float | None = setting(
        None, "mass that the planner assumes; null: the true one", "kg", "(0, 1000]"
    )
    believed_friction: float | None = setting(
        None, "friction that the planner assumes; null: the true one", within=FRICTIONS
    )
    may_move: bool = setting(
        False,
        "whether the object may push it along if no path leads past it; only if movable",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def footprint(self) -> Polygon:
        """Footprint in W as a Shapely polygon."""
        return self.shape.placed(self.pose)

    @property
    def nominal(self) -> Obstacle:
        """The obstacle as planner and controller believe it to be."""
        return replace(
            self,
            mass=assumption(self.believed_mass, self.mass),
            friction=assumption(self.believed_friction, self.friction),
            believed_mass=None,
            believed_friction=None,
        )


@documented
@dataclass(frozen=True, slots=True)
class Belief:
    """Assumptions of planner and controller. None means that the true value is assumed."""

    support_friction: float | None = setting(
        None, "support.friction; null: the true one", within=FRICTIONS
    )
    contact_friction: float | None = setting(
        None, "contact.friction; null: the true one", within=FRICTIONS
    )
    mass: float | None = setting(
        None, "object.mass; null: the true one", "kg", "(0, 1000]"
    )
    center_of_mass: Point | None = setting(
        None, "object.center_of_mass; null: the true one", "m", "[-5, 5]"
    )
    rho: float | None = setting(
        None, "rho of the limit surface; null: that of the shape", "m", "(0, 10]"
    )
    # uncertainties: a motion is planned for every value within them
    friction_error: float = setting(
        0.0,
        "share by which both frictions may be wrong, up or down",
        within="[0, 0.5]",
    )
    center_error: float = setting(
        0.0,
        "distance by which the centre of mass may be elsewhere, in any direction",
        "m",
        "[0, 0.5]",
    )
    mass_error: float = setting(
        0.0,
        "share by which the mass may be wrong, up or down; plans keep no margin for it, "
        "control, `pps plan --odds`, `motion.risk` and what is tried after a refusal use it",
        within="[0, 0.9]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def planned_for_errors(self) -> bool:
        """Whether it states errors that motions are planned for."""
        return self.friction_error > 0.0 or self.center_error > 0.0

    @property
    def states_errors(self) -> bool:
        """Whether it states any errors."""
        return self.planned_for_errors or self.mass_error > 0.0


def assumption(belief: Value | None, true: Value) -> Value:
    """Believed value, or the true value if the belief is None."""
    return true if belief is None else belief


@dataclass(frozen=True, slots=True)
class Scene:
    """The believed scene, with derived quantities that do not depend on the motion."""

    body: ObjectModel
    support: Support
    contact_friction: float  # of the pair tip/object
    robots: tuple[Robot, ...]
    obstacles: tuple[Obstacle, ...]
    rho: float | None = None  # [m] of the limit surface; None: that of the shape
    friction_error: float = 0.0  # relative error of both frictions
    center_error: float = 0.0  # [m] uncertainty of the centre of mass
    mass_error: float = 0.0  # relative error of the mass
    arm: int | None = None  # the only arm that may touch the body; None: any
    # whether motions are planned as if frictions and centre of mass were certain
    dares: bool = False

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def planned_for_errors(self) -> bool:
        """Whether motions are planned for errors of friction or centre of mass."""
        return self.friction_error > 0.0 or self.center_error > 0.0

    @property
    def arms(self) -> tuple[int, ...]:
        """The arms that may touch the body."""
        return tuple(range(len(self.robots))) if self.arm is None else (self.arm,)

    @property
    def tips(self) -> tuple[Robot, ...]:
        """The robots whose tips may touch the body."""
        return tuple(self.robots[arm] for arm in self.arms)

    @property
    def weight(self) -> Point:
        """Components [N] of the weight along the support and normal to it."""
        return math.hypot(*self.weight_along), self.weight_on

    @property
    def weight_along(self) -> Point:
        """Component of the weight along x and y of the support [N]. Zero on a table."""
        x, y, _ = self._weight()
        return (x, y)

    @property
    def weight_on(self) -> float:
        """Component [N] of the weight that presses the object onto its support. Zero on
        a wall.
        """
        return -self._weight()[2]

    @property
    def inset(self) -> float:
        """Distance [m] of contacts inside the edges of a face or of the top."""
        return margins.inset(self.tip_radius)

    @property
    def tip_radius(self) -> float:
        """Radius [m] of the largest tip that may touch the object."""
        return max(robot.tip_radius for robot in self.tips)

    @property
    def planned_friction_error(self) -> float:
        """Relative error of both frictions that motions are planned for."""
        return 0.0 if self.dares else self.friction_error

    @property
    def planned_center_error(self) -> float:
        """Uncertainty [m] of the centre of mass that motions are planned for."""
        return 0.0 if self.dares else self.center_error

    @property
    def surest_drag(self) -> float:
        """Smallest share of the support's believed friction force that errors allow."""
        return (1.0 - self.friction_error) * (1.0 - self.mass_error)

    @property
    def sure(self) -> float:
        """Factor that lowers the allowed friction utilisation if frictions are
        uncertain.

        It is the ratio of the smallest contact friction to the largest support
        friction, divided by the same ratio of the believed values.
        """
        error = self.planned_friction_error
        return (1.0 - error) / (1.0 + error)

    @property
    def least_contact_friction(self) -> float:
        """Lower bound of the tip/object friction, from its uncertainty."""
        return (1.0 - self.planned_friction_error) * self.contact_friction

    @property
    def friction_uses(self) -> tuple[float, ...]:
        """Friction utilisations that a motion may have at its contacts, the best first."""
        return tuple(self.sure * use for use in margins.FRICTION_USES)

    @property
    def run_ins(self) -> tuple[float, ...]:
        """Lengths of a manoeuvre's run-in, in look-aheads."""
        return margins.RUN_INS_UNSURE if self.planned_center_error else margins.RUN_INS

    @property
    def pin_uses(self) -> tuple[float, ...]:
        """Friction utilisations of a press that holds a point, the best first."""
        return tuple(self.sure * use for use in margins.PIN_USES)

    @property
    def most_friction(self) -> float:
        """Largest friction coefficient of the support that the belief allows."""
        return self.support.friction * (1.0 + self.planned_friction_error)

    def max_friction(self, press: float = 0.0) -> float:
        """Friction [N] of the support against straight sliding, with a ``press`` [N] on
        top.
        """
        return self.support.friction * (self.weight_on + press)

    @property
    def rests(self) -> bool:
        """Whether the support's friction holds the object."""
        along, on = self.weight
        return along <= self.support.friction * on

    @property
    def bases(self) -> tuple[tuple[float, float, float], ...]:
        """Positions of the robots' bases: x, y and height above the support [m]."""
        frame = self.support.frame
        return tuple(frame.coordinates(robot.base) for robot in self.robots)

    def lowered(self, X_WG: Pose2, distance: float) -> Pose2:
        """Pose displaced by ``distance`` [m] along the weight's component in the plane."""
        x, y = self.weight_along
        size = math.hypot(x, y)
        return replace(
            X_WG, x=X_WG.x + distance * x / size, y=X_WG.y + distance * y / size
        )

    def on_ledge(self, X_WG: Pose2, within: float = LEDGE_GAP) -> bool:
        """Whether a fixed obstacle lies at most ``within`` [m] below the object at a
        pose.
        """
        fixed = [obstacle for obstacle in self.obstacles if not obstacle.movable]
        if not fixed:
            return False
        below = self.body.shape.placed(self.lowered(X_WG, within))
        return any(
            below.intersection(obstacle.footprint).area > 0.0 for obstacle in fixed
        )

    def carried(self, X_WG: Pose2) -> bool:
        """Whether an object released at a pose stays there: by the support's friction,
        on a ledge or in the opening.
        """
        return self.rests or self.on_ledge(X_WG) or self.enters(X_WG)

    def enters(self, X_WG: Pose2) -> bool:
        """Whether the object at a pose lies in an opening of the support."""
        opening = self.support.opening
        return opening is not None and opening.holds(X_WG, self.body.shape)

    def _weight(self) -> tuple[float, float, float]:
        weight = GRAVITY * self.body.mass
        return self.support.frame.components((0.0, 0.0, -weight))
