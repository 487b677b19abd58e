"""A task as typed, frozen data: what is to be moved, on what, from where to where, and
by which robots.

Built in one place, ``taskfile/load.py``, which checks every field;
docs/task-file.md documents the file. SI units and radians throughout (the file has
degrees where its key ends in ``_deg``).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.shapes import Box as Box
from pushpressslide.core.shapes import Cylinder as Cylinder
from pushpressslide.core.shapes import Prism as Prism
from pushpressslide.core.shapes import Shape as Shape
from pushpressslide.core.support_frame import TABLE, SupportFrame

FIT = 1e-6  # [m] by which what just fits an opening may be larger
Vehicle = Literal["unicycle", "car", "forklift", "pivot"]
Cop = Literal["balanced", "left", "right"] | float
"""Where two presses put the centre of pressure: "balanced" (equal presses); as far
"left" or "right" as a turn on the spot allows at the press that the motion takes; or a
fraction in [0, 1] of the way from left to right contact.
"""


@dataclass(frozen=True, slots=True)
class Opening:
    """A rectangular opening in a wall, closed at its back."""

    size: tuple[float, float]  # [m] along x and y
    center: Point  # [m] in the wall's plane
    depth: float  # [m] of the back behind the wall's face

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """Left, right, low and high edge [m]: x, x, y and y in the wall's plane."""
        w, h = self.size
        cx, cy = self.center
        return cx - 0.5 * w, cx + 0.5 * w, cy - 0.5 * h, cy + 0.5 * h

    def holds(self, pose: Pose2, shape: Shape) -> bool:
        """Return whether a shape at ``pose`` fits the opening's outline."""
        x_min, x_max, y_min, y_max = shape.bounds(pose)
        w, h = self.size
        cx, cy = self.center
        return all(abs(x - cx) <= 0.5 * w + FIT for x in (x_min, x_max)) and all(
            abs(y - cy) <= 0.5 * h + FIT for y in (y_min, y_max)
        )


@dataclass(frozen=True, slots=True)
class Support:
    """What the object slides on."""

    kind: Literal["table", "wall"] = "table"
    friction: float = 0.3  # coefficient of the pair object/support, in (0, 2)
    frame: SupportFrame = TABLE  # of all poses, in the world
    opening: Opening | None = None  # in a wall


@dataclass(frozen=True, slots=True)
class ObjectModel:
    """The object to be moved."""

    shape: Shape
    mass: float  # [kg] > 0
    # [m] in G, projected on the support (the centroid if the file does not say)
    center_of_mass: Point

    @property
    def X_GB(self) -> Pose2:
        """Pose of the body frame B (origin at the projected centre of mass) in the
        shape's frame G.
        """
        return Pose2(self.center_of_mass[0], self.center_of_mass[1], 0.0)


@dataclass(frozen=True, slots=True)
class Tolerance:
    """When the goal counts as reached."""

    position: float = 0.01  # [m]
    yaw: float = 0.03490658503988659  # [rad]; 2 degrees


@dataclass(frozen=True, slots=True)
class Robot:
    """One arm (or a free tip, ``hand``) and where its base stands."""

    model: str  # "panda" | "iiwa7" | "hand" | path of a URDF or SDF file
    base: tuple[float, float, float]  # [m] position of the base in the world
    base_yaw: float = 0.0  # [rad]
    # name of the frame at the tip's centre; needed for a model given by path
    tip_frame: str | None = None
    tip_radius: float = 0.02  # [m] radius of the spherical tip
    # [m] from the flange to the tip's centre (generated models)
    tip_length: float = 0.15


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A box in the scene, fixed or free to move."""

    name: str
    size: tuple[float, float, float]  # [m]
    pose: Pose2  # of its centre, in the world (on a wall: in the wall's plane)
    movable: bool = False
    mass: float = 1.0  # [kg]; used if movable
    friction: float = 0.3  # against the support; used if movable


@dataclass(frozen=True, slots=True)
class ToolUse:
    """The object is a tool: with a side face it pushes another body to that body's
    goal.
    """

    body: str  # name of a movable obstacle
    goal: Pose2  # of that body's centre, in the world
    face: int  # index of the edge of the tool's footprint that pushes
    straight: float  # [m] of way from the touch to the goal


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of the run."""

    time: float = 60.0  # [s] simulated
    normal_force: float = 40.0  # [N] per contact
    # [m] x_min, x_max, y_min, y_max of G
    workspace: tuple[float, float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Belief:
    """What planner and controller are told; resolved: equals the truth where the file
    does not differ.
    """

    support_friction: float
    contact_friction: float
    mass: float
    rho: float | None = None  # [m] None: computed from the shape


@dataclass(frozen=True, slots=True)
class Sensing:
    """Imperfections of what the controller is given: standard deviations, and one delay
    for all.
    """

    position_noise: float = 0.0  # [m]
    yaw_noise: float = 0.0  # [rad]
    force_noise: float = 0.0  # [N]
    delay: float = 0.0  # [s]


@dataclass(frozen=True, slots=True)
class Motion:
    """How the motion is to be done; defaults suit the shipped robots."""

    speed: float = 0.05  # [m/s] along the path of the tracking point, in (0, 0.2]
    # [m/s^2] of the ramps; far below mu_s g keeps the motion quasi-static
    acceleration: float = 0.1
    # of the steering law, in units of the largest without overshoot
    tracking_gain: float = 2.0
    servo_damping: float = 500.0  # [N s/m] of the contact velocity servo
    joint_stiffness: float = 10.0  # [N m/rad] of the joint-tracking term
    # on the feed-forward force; None: 1 with the servo, 1.05 without
    force_gain: float | None = None
    # [m] above the support; None: chosen by the mode
    contact_height: float | None = None
    approach_distance: float = 0.05  # [m] free way before the touch
    # add the joint impedance about the planned joint path, felt at the tip (paper, sec.
    # IV-A)
    joint_tracking: bool = False
    # add the contact velocity servo to the feed-forward force
    velocity_servo: bool = True
    # share of the friction-limited curvature that the path may use, in (0, 1]
    curvature_margin: float = 0.55
    run_in: float = 0.16  # [m] straight end of the path
    control_period: float = 0.004  # [s] of the controller
    time_step: float = 0.004  # [s] of the physics engine; at most the control period
    face: int | None = None  # index of the pushed edge of the footprint; None: chosen
    contacts: tuple[Point, ...] | None = None  # [m] in G, of top contacts; None: chosen
    press_force: float | None = None  # [N] of a top contact; None: chosen by the mode
    cop: Cop | None = None  # of two top contacts; None: chosen by the mode
    # how a pressed object is driven; None: as a unicycle
    vehicle: Vehicle | None = None
    # [m] of the alignment with the path; None: chosen by the mode
    look_ahead: float | None = None
    # the paper's literal target beyond the goal, for comparison
    fixed_target: bool = False


@dataclass(frozen=True, slots=True)
class Leg:
    """One part of a task that is done in several: a mode, and where it takes the
    object.
    """

    mode: str
    goal: Pose2  # X_WG at its end
    motion: Motion  # how it is done


@dataclass(frozen=True, slots=True)
class Task:
    """One manipulation task, complete and checked."""

    name: str
    object: ObjectModel
    start: Pose2  # X_WG that the plan is made for (on a wall: in the wall's plane)
    goal: Pose2  # X_WG
    robots: tuple[Robot, ...]
    support: Support = field(default_factory=Support)
    contact_friction: float = 0.6  # pair end effector/object, in (0, 2)
    tolerance: Tolerance = field(default_factory=Tolerance)
    obstacles: tuple[Obstacle, ...] = ()
    # then ``goal`` is where the tool has the other body at its goal
    tool: ToolUse | None = None
    modes: tuple[str, ...] | None = None  # None: every mode that the robots allow
    # in order, the last one to ``goal``; empty: one mode does it all
    legs: tuple[Leg, ...] = ()
    limits: Limits = field(default_factory=Limits)
    belief: Belief | None = None  # never None once loaded
    # the true start is start + this, in world axes
    start_error: Pose2 = field(default_factory=Pose2)
    sensing: Sensing = field(default_factory=Sensing)
    motion: Motion = field(default_factory=Motion)
    description: str = ""
    # the file it came from, for messages
    source: str = field(default="", compare=False)

    @property
    def believed(self) -> Belief:
        """What planner and controller are told."""
        if self.belief is not None:
            return self.belief
        return Belief(self.support.friction, self.contact_friction, self.object.mass)

    @property
    def weight_in_plane(self) -> Point:
        """What of the weight, as believed, acts along the support [N]: none on a table."""
        x, y, _ = self.support.frame.components(
            (0.0, 0.0, -GRAVITY * self.believed.mass)
        )
        return (x, y)

    @property
    def weight_on_support(self) -> float:
        """What of the weight, as believed, presses the object on its support [N]: none
        on a wall.
        """
        return -self.support.frame.components(
            (0.0, 0.0, -GRAVITY * self.believed.mass)
        )[2]

    @property
    def bases(self) -> tuple[tuple[float, float, float], ...]:
        """Where the robots' bases are: x, y and height about the support [m]."""
        return tuple(
            self.support.frame.coordinates(robot.base) for robot in self.robots
        )

    @property
    def enters(self) -> bool:
        """Whether the goal lies in an opening of the support."""
        opening = self.support.opening
        return opening is not None and opening.holds(self.goal, self.object.shape)

    @property
    def parts(self) -> tuple[Task, ...]:
        """The task of each leg, from where the one before it ends; of a task without
        legs itself.
        """
        out = []
        begin = replace(self, legs=())
        for i, leg in enumerate(self.legs):
            part = replace(begin, goal=leg.goal, modes=(leg.mode,), motion=leg.motion)
            out.append(replace(part, source=f"{self.source}: legs[{i}]"))
            begin = replace(begin, start=leg.goal, start_error=Pose2())
        return tuple(out) or (self,)

    @property
    def true_start(self) -> Pose2:
        """X_WG at which the object really starts."""
        e = self.start_error
        return Pose2(self.start.x + e.x, self.start.y + e.y, self.start.yaw + e.yaw)
