"""A task as typed, frozen data: what is to be moved, on what, from where to where, and
by which robots.

Built in one place, ``taskfile/load.py``, which checks every field;
docs/task-file.md documents the file. SI units and radians throughout (the file has
degrees where its key ends in ``_deg``). The metadata of a field is all that the file's
reader, dump and documentation know of it: name it here, and they have it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from pushpressslide.core import margins
from pushpressslide.core.checks import check_fields
from pushpressslide.core.control import Vector3
from pushpressslide.core.entry import FRICTIONS, entry, setting
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import ARM_NAMES, ArmName
from pushpressslide.core.scene import Belief as Belief
from pushpressslide.core.scene import ObjectModel as ObjectModel
from pushpressslide.core.scene import Obstacle as Obstacle
from pushpressslide.core.scene import Opening as Opening
from pushpressslide.core.scene import Robot as Robot
from pushpressslide.core.scene import Scene as Scene
from pushpressslide.core.scene import Support as Support
from pushpressslide.core.scene import assumption as assumption
from pushpressslide.geometry.shapes import Box as Box
from pushpressslide.geometry.shapes import Compound as Compound
from pushpressslide.geometry.shapes import Cylinder as Cylinder
from pushpressslide.geometry.shapes import MeshSolid as MeshSolid
from pushpressslide.geometry.shapes import Part as Part
from pushpressslide.geometry.shapes import Prism as Prism
from pushpressslide.geometry.shapes import Shape as Shape

Vehicle = Literal[
    "unicycle", "car", "forklift", "pivot", "mixed", "differential", "synchronised"
]
"""Reduced model that a mode drives the object as, one of its ``Mode.vehicles``."""

Cop = Literal["balanced", "left", "right"] | float
"""Where two presses put the centre of pressure: "balanced" (equal presses); as far
"left" or "right" as a turn on the spot allows at the press that the motion takes; or a
fraction in [0, 1] of the way from left to right contact.
"""


PLANNED_SHARE = 0.9  # of limits.normal_force
FORCE_ALLOWED = f"allowed {{allowed:Ng}}, {PLANNED_SHARE:g} of limits.normal_force"
"""End of the text of a refusal for too large a normal force."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """When the goal counts as reached."""

    position: float = setting(0.01, "largest position error", "m", "(0, 1]")
    yaw: float = setting(math.radians(2.0), "largest yaw error", "deg", "(0, 180]")
    bodies: float = setting(
        0.005,
        "that movable obstacles may be displaced, but for a tool's and those that may move",
        "m",
        "(0, 1]",
    )

    def __post_init__(self) -> None:
        check_fields(self)


ON_THE_WAY = Tolerance(margins.ARM.via, margins.ARM.turned_via)
"""Of poses that a search leads the object by: nobody asked for them."""


@dataclass(frozen=True, slots=True)
class ToolUse:
    """The object is a tool: with a side face it pushes another body to that body's
    goal.
    """

    body: str  # name of a movable obstacle
    goal: Pose2  # of that body's centre, in the world
    face: int = field(
        metadata=entry(
            "index of the edge of the tool's footprint that pushes, as in motion.face",
            within="[0, 255]",
            default_in_file=1,
        )
    )
    straight: float  # [m] of way from the touch to the goal

    def __post_init__(self) -> None:
        check_fields(self)


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
        "motions, one after the other, that are searched for where one does not lead to "
        "the goal; 1: no other than one",
        within="[1, 20]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def planned_force(self) -> float:
        """Normal force [N] that plans keep to: the rest is for the regulator's ripple."""
        return PLANNED_SHARE * self.normal_force


@dataclass(frozen=True, slots=True)
class Sensing:
    """Imperfections of each sensor: the object's pose, the tips by the joints, and the
    contact forces. Noise is white: its standard deviation at every control period.
    """

    position_noise: float = setting(
        0.0, "standard deviation of the object's x and y", "m", "[0, 0.1]"
    )
    yaw_noise: float = setting(
        0.0, "standard deviation of the object's yaw", "deg", "[0, 45]"
    )
    tip_noise: float = setting(
        0.0, "standard deviation of a tip's place, each axis", "m", "[0, 0.01]"
    )
    force_noise: float = setting(
        0.0, "standard deviation of a contact force, each axis", "N", "[0, 100]"
    )
    position_bias: Point = setting(
        (0.0, 0.0), "constant error of the object's x and y", "m", "[-0.1, 0.1]"
    )
    yaw_bias: float = setting(
        0.0, "constant error of the object's yaw", "deg", "[-45, 45]"
    )
    tip_bias: Vector3 = setting(
        (0.0, 0.0, 0.0), "constant error of every tip's place", "m", "[-0.01, 0.01]"
    )
    force_bias: Vector3 = setting(
        (0.0, 0.0, 0.0), "constant error of every contact force", "N", "[-20, 20]"
    )
    delay: float = setting(0.0, "of every sensor", "s", "[0, 1]")
    pose_delay: float | None = setting(
        None, "of the object's pose; null: `delay`", "s", "[0, 1]"
    )
    tip_delay: float | None = setting(
        None, "of the tips' places; null: `delay`", "s", "[0, 1]"
    )
    force_delay: float | None = setting(
        None, "of the contact forces; null: `delay`", "s", "[0, 1]"
    )
    pose_dropout: float = setting(
        0.0,
        "probability that a control period brings no pose of the object",
        within="[0, 0.95]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def felt_force(self) -> float:
        """Normal force [N] from which on a contact is felt."""
        return max(margins.ARM.felt_force, margins.FELT_SIGMAS * self.force_noise)

    @property
    def seen_motion(self) -> float:
        """Way [m] from which on an object is seen to have moved."""
        return max(margins.ARM.slid, margins.FELT_SIGMAS * self.position_noise)

    @property
    def delay_of_pose(self) -> float:
        """Delay [s] of the object's pose."""
        return self.delay if self.pose_delay is None else self.pose_delay

    @property
    def delay_of_tips(self) -> float:
        """Delay [s] of the tips' places."""
        return self.delay if self.tip_delay is None else self.tip_delay

    @property
    def delay_of_force(self) -> float:
        """Delay [s] of the contact forces."""
        return self.delay if self.force_delay is None else self.force_delay


@dataclass(frozen=True, slots=True)
class Motion:
    """How the motion is to be done; defaults suit the shipped robots."""

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
        3,
        "how often the arms may let go and the motion be planned anew, where contact or "
        "goal was missed or a limit was broken",
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
        "gap that the object keeps from obstacles; where it stands nearer at start or "
        "goal, the gap that it has there, growing to this one on 5 cm of way",
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
        "reduced model that the object is driven as. press_slide: unicycle (pulled or "
        "pushed), car (pulled), forklift (pushed), pivot (turned about its virtual "
        "axle); null: unicycle. parallel_push: mixed (any twist inside the motion "
        "cone), differential (turned by the difference of the normal forces), "
        "synchronised (by equal friction forces); null: mixed, else differential",
    )
    look_ahead: float | None = setting(
        None,
        "look-ahead with which a pressed object is aligned with its path; null: chosen "
        "by the mode",
        "m",
        "(0, 1]",
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def freed(self) -> Motion:
        """The motion with the choice of face, contacts and vehicle left to the mode."""
        return replace(self, face=None, contacts=None, vehicle=None)


@dataclass(frozen=True, slots=True)
class Leg:
    """One part of a task that is done in several: a mode, and where it takes the
    object.
    """

    mode: str = field(metadata=entry("contact mode", is_name=True))
    goal: Pose2 = field(
        metadata=entry(
            "pose of G at the end of the leg; null, for the last leg: the goal",
            key="pose",
            default_in_file=None,
        )
    )
    motion: Motion = field(metadata=entry("fields of `motion` that differ in this leg"))

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True, slots=True)
class BodyGoal:
    """Where one of several bodies is to be brought."""

    body: str  # "object", or the name of a movable obstacle
    pose: Pose2  # X_WG of that body

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True, slots=True)
class Restart:
    """Where a task goes on after a recovery, and what is believed by then."""

    leg: int  # of the task, that is not done
    pose: Pose2  # X_WG as seen
    center_of_mass: Point  # [m] in G
    support_friction: float
    rho: float | None  # [m]; None: that of the base's pressure
    # whether face, contacts and vehicle are free that the task names for its first attempt
    free: bool = False
    # that were found for the rest, in place of the task's; None: the task's go on
    legs: tuple[Leg, ...] | None = None


@dataclass(frozen=True)
class Task:
    """One manipulation task, complete and checked."""

    name: str = field(
        metadata=entry("name of the task, and of its folders of results", is_name=True)
    )
    object: ObjectModel = field(metadata=entry("the object to be moved"))
    # X_WG (on a wall: in the wall's plane)
    start: Pose2 = field(
        metadata=entry("pose of the shape's frame G at which the plan begins")
    )
    # X_WG; of a tool, where it has the other body at that body's goal; with ``goals``
    # the start
    goal: Pose2 = field(
        metadata=entry(
            "wanted pose of the shape's frame G; a task has this or `goals`",
            default_in_file=None,
        )
    )
    robots: tuple[Robot, ...] = field(
        metadata=entry("the arms; of two, the first is the left one", count=(1, 2))
    )
    support: Support = setting(Support(), "surface on which the object slides")
    contact_friction: float = setting(
        0.6,
        "friction coefficient between tip and object",
        within=FRICTIONS,
        key="contact.friction",
        section="contact between tips and object",
    )
    tolerance: Tolerance = setting(
        Tolerance(), "largest errors with which the goal counts as reached"
    )
    obstacles: tuple[Obstacle, ...] = setting((), "bodies in the scene", count=(0, 32))
    tool: ToolUse | None = setting(
        None,
        "how the object pushes `goal.body`, where that is another body",
        default_in_file={},
    )
    modes: tuple[str, ...] | None = setting(
        None,
        "contact modes to choose from; null: all that need no more arms than there are",
        count=(1, math.inf),
    )
    goals: tuple[BodyGoal, ...] = setting(
        (),
        "in place of `goal`, where each of several bodies is to be brought, or one body "
        "to several poses, one after the other; null: `goal` is the only one",
        count=(1, 64),
        default_in_file=None,
    )
    # the last one to ``goal``
    legs: tuple[Leg, ...] = setting(
        (),
        "legs of the task in order, in place of `modes`. An arm whose contact changes "
        "from one leg to the next lets go; the others keep theirs. null: one mode for "
        "the whole task",
        count=(1, 20),
        default_in_file=None,
    )
    limits: Limits = setting(Limits(), "limits of the run")
    belief: Belief = setting(
        Belief(),
        "what planner and controller assume where it differs from the truth",
        default_in_file={},
    )
    # the true start is start + this
    start_error: Pose2 = setting(
        Pose2(), "true start pose minus `start`, in world axes"
    )
    sensing: Sensing = setting(
        Sensing(), "noise and delay of what the controller measures"
    )
    motion: Motion = setting(Motion(), "how the object is moved")
    description: str = setting("", "one line, shown by `pps tasks`")
    # the file it came from, for messages
    source: str = field(default="", compare=False)
    # whether its legs were found, not prescribed, or it is one of many motions that are
    # looked at to find them
    searched: bool = field(default=False, compare=False)
    # whether it is planned to push what may move
    pushes: bool = field(default=False, compare=False)

    def __post_init__(self) -> None:
        check_fields(self)

    def __repr__(self) -> str:
        """Return one line; ``dump_task`` returns all of it."""
        shape = type(self.object.shape).__name__
        arms = ", ".join(robot.model for robot in self.robots)
        return f"Task({self.name!r}: {shape} of {self.object.mass:g} kg; {arms})"

    @property
    def yielding(self) -> tuple[Obstacle, ...]:
        """The obstacles that the object may push on the way that is planned."""
        if not self.pushes:
            return ()
        return tuple(obstacle for obstacle in self.obstacles if obstacle.may_move)

    @property
    def believed(self) -> Belief:
        """What planner and controller assume, with every field but rho given."""
        told = self.told
        return Belief(
            told.support.friction,
            told.contact_friction,
            told.object.mass,
            told.object.center_of_mass,
            told.belief.rho,
            told.belief.friction_error,
            told.belief.center_error,
        )

    @cached_property
    def told(self) -> Task:
        """The task as planner and controller are told it: what is believed stands in
        place of what is true.
        """
        belief = self.belief
        body = self.object
        support = self.support
        mass = assumption(belief.mass, body.mass)
        center = assumption(belief.center_of_mass, body.center_of_mass)
        friction = assumption(belief.support_friction, support.friction)
        return replace(
            self,
            object=replace(body, mass=mass, center_of_mass=center),
            support=replace(support, friction=friction),
            contact_friction=assumption(belief.contact_friction, self.contact_friction),
            obstacles=tuple(obstacle.told for obstacle in self.obstacles),
            belief=Belief(
                rho=belief.rho,
                friction_error=belief.friction_error,
                center_error=belief.center_error,
            ),
            start_error=Pose2(),
        )

    @cached_property
    def scene(self) -> Scene:
        """The physical question, as believed."""
        told = self.told
        name = told.motion.arm
        return Scene(
            told.object,
            told.support,
            told.contact_friction,
            told.robots,
            told.obstacles,
            told.belief.rho,
            told.belief.friction_error,
            told.belief.center_error,
            None if name is None else ARM_NAMES.index(name),
        )

    @property
    def X_GB(self) -> Pose2:
        """Pose of the body frame B, in which contacts and drives are given, in the
        shape's frame G: its origin is the centre of mass as believed.
        """
        x, y = assumption(self.belief.center_of_mass, self.object.center_of_mass)
        return Pose2(x, y, 0.0)

    @property
    def center_error(self) -> Point:
        """Where the centre of mass is believed to be, from where it is, in G [m]."""
        x, y = self.object.center_of_mass
        believed = self.X_GB
        return (believed.x - x, believed.y - y)

    @property
    def body_ends(self) -> tuple[Pose2, Pose2]:
        """X_WB at start and goal."""
        X_GB = self.X_GB
        return self.start.compose(X_GB), self.goal.compose(X_GB)

    @property
    def enters(self) -> bool:
        """Whether the goal lies in an opening of the support."""
        opening = self.support.opening
        return opening is not None and opening.holds(self.goal, self.object.shape)

    @property
    def parts(self) -> tuple[Task, ...]:
        """One task for each leg, from where the leg before it ends.

        A task without legs is its own only part.
        """
        out = []
        begin = replace(self, legs=())
        for i, leg in enumerate(self.legs):
            if self.searched and i + 1 < len(self.legs):
                begin = replace(begin, tolerance=ON_THE_WAY)
            else:
                begin = replace(begin, tolerance=self.tolerance)
            part = replace(begin, goal=leg.goal, modes=(leg.mode,), motion=leg.motion)
            out.append(replace(part, source=f"{self.source}: legs[{i}]"))
            begin = replace(begin, start=leg.goal, start_error=Pose2())
        return tuple(out) or (self,)

    def resumed(self, restart: Restart) -> Task:
        """Return the task as it goes on from ``restart``; the goals of what is done
        are where the object was left.
        """
        belief = replace(
            self.belief,
            center_of_mass=restart.center_of_mass,
            support_friction=restart.support_friction,
            rho=restart.rho,
        )
        task = replace(self, belief=belief, start_error=Pose2())
        if restart.free:
            legs = (replace(leg, motion=leg.motion.freed) for leg in self.legs)
            task = replace(task, motion=self.motion.freed, legs=tuple(legs))
        if restart.legs is not None:
            found = restart.legs
            return replace(task, start=restart.pose, legs=found, searched=True)
        if restart.leg == 0:
            return replace(task, start=restart.pose)
        begun = list(task.legs)
        begun[restart.leg - 1] = replace(begun[restart.leg - 1], goal=restart.pose)
        return replace(task, legs=tuple(begun))

    @property
    def true_start(self) -> Pose2:
        """X_WG at which the object really starts."""
        e = self.start_error
        return Pose2(self.start.x + e.x, self.start.y + e.y, self.start.yaw + e.yaw)
