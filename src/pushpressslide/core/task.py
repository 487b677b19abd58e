"""A task as typed, frozen data: the object, its support, start and goal, and the
robots.

Tasks are built by ``taskfile/load.py``, which checks every field; docs/task-file.md
documents the file. Units are SI and radians throughout (in the file, keys that end in
``_deg`` are in degrees). Reader, dump and documentation of the file are all derived
from the metadata of the fields.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

from pushpressslide.core.checks import check_fields
from pushpressslide.core.errors import TaskError
from pushpressslide.core.field_spec import FRICTIONS, documented, field_spec, setting
from pushpressslide.core.knock import Knock
from pushpressslide.core.motion import ON_THE_WAY
from pushpressslide.core.motion import Limits as Limits
from pushpressslide.core.motion import Motion as Motion
from pushpressslide.core.motion import Tolerance as Tolerance
from pushpressslide.core.motion import ToolUse as ToolUse
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Belief as Belief
from pushpressslide.core.scene import ObjectModel as ObjectModel
from pushpressslide.core.scene import Obstacle as Obstacle
from pushpressslide.core.scene import Opening as Opening
from pushpressslide.core.scene import Robot as Robot
from pushpressslide.core.scene import Scene as Scene
from pushpressslide.core.scene import Support as Support
from pushpressslide.core.scene import assumption as assumption
from pushpressslide.core.sensing import Sensing as Sensing
from pushpressslide.core.state import WorldState
from pushpressslide.core.truth import EXACT
from pushpressslide.core.truth import Truth as Truth
from pushpressslide.geometry.shapes import Box as Box
from pushpressslide.geometry.shapes import Compound as Compound
from pushpressslide.geometry.shapes import Cylinder as Cylinder
from pushpressslide.geometry.shapes import MeshSolid as MeshSolid
from pushpressslide.geometry.shapes import Part as Part
from pushpressslide.geometry.shapes import Prism as Prism
from pushpressslide.geometry.shapes import Shape as Shape


@documented
@dataclass(frozen=True, slots=True)
class Leg:
    """One leg of a task with several: a mode, and the object's pose at the end of the
    leg.
    """

    mode: str = field(metadata=field_spec("contact mode", is_name=True))
    goal: Pose2 = field(
        metadata=field_spec(
            "pose of G at the end of the leg; null, for the last leg: the goal",
            key="pose",
            default_in_file=None,
        )
    )
    motion: Motion = field(
        metadata=field_spec("fields of `motion` that differ in this leg")
    )

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True, slots=True)
class BodyGoal:
    """Goal pose of one body, in a task with several goals."""

    body: str  # "object", or the name of a movable obstacle
    pose: Pose2  # X_WG of that body

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True, slots=True)
class Restart:
    """State and beliefs from which a task is continued after a recovery."""

    state: WorldState  # as seen
    leg: int  # first leg of the task that is not done
    center_of_mass: Point  # [m] in G
    support_friction: float
    rho: float | None  # [m]; None: that of the base's pressure
    # whether face, contacts and vehicle of the first attempt may change
    free: bool = False
    # whether it is planned as if the belief were free of errors
    dares: bool = False
    # legs found for the rest; None: those of the task
    legs: tuple[Leg, ...] | None = None
    center_error: float | None = None  # [m]; None: that of the task
    mass: float | None = None  # [kg]; None: that of the task
    mass_error: float | None = None  # None: that of the task
    contact_friction: float | None = None  # None: that of the task
    planned_share: float | None = None  # of the force limit; None: that of the task
    # lower bound of the support's friction, from forces that the object withstood
    least_friction: float = 0.0


@documented
@dataclass(frozen=True)
class Task:
    """One manipulation task, complete and checked."""

    name: str = field(
        metadata=field_spec(
            "name of the task, and of its folders of results", is_name=True
        )
    )
    object: ObjectModel = field(metadata=field_spec("the object to be moved"))
    # X_WG (on a wall: in the wall's plane)
    start: Pose2 = field(
        metadata=field_spec("pose of the shape's frame G at which the plan begins")
    )
    # X_WG; for a tool, the pose at which the other body is at its goal; with ``goals``,
    # the start
    goal: Pose2 = field(
        metadata=field_spec(
            "wanted pose of the shape's frame G; a task has this or `goals`",
            default_in_file=None,
        )
    )
    robots: tuple[Robot, ...] = field(
        metadata=field_spec("the arms; of two, the first is the left one", count=(1, 2))
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
    obstacles: tuple[Obstacle, ...] = setting(
        (),
        "bodies in the scene, each as {name: post, box: [0.06, 0.06, 0.2], "
        "pose: {x: 0.6, y: 0.1}}",
        count=(0, 32),
    )
    tool: ToolUse | None = setting(
        None,
        "how the object pushes `goal.body`, if that is another body",
        default_in_file={},
    )
    modes: tuple[str, ...] | None = setting(
        None,
        "contact modes to choose from; null: all for which there are enough arms",
        count=(1, math.inf),
    )
    goals: tuple[BodyGoal, ...] = setting(
        (),
        "in place of `goal`: goals of several bodies, or several goals of one body in "
        "order; null: `goal` is the only one",
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
        "assumptions of planner and controller that differ from the truth",
        default_in_file={},
    )
    # the true start is start + this
    start_error: Pose2 = setting(
        Pose2(), "true start pose minus `start`, in world axes"
    )
    sensing: Sensing = setting(
        Sensing(), "noise and delay of the controller's measurements"
    )
    truth: Truth = setting(
        EXACT, "how the real arms and the real world differ from what is believed"
    )
    motion: Motion = setting(Motion(), "how the object is moved")
    disturbances: tuple[Knock, ...] = setting(
        (),
        "simulated knocks, each as {time: 9, push: {force: [5, 0], duration: 0.3}}",
        count=(0, 64),
    )
    description: str = setting("", "one line, shown by `pps tasks`")
    # its file, for messages
    source: str = field(default="", compare=False)
    # whether motions are planned as if the belief were free of errors
    dares: bool = False

    def __post_init__(self) -> None:
        check_fields(self)

    def __repr__(self) -> str:
        """Summary in one line. ``dump_task`` returns the whole task."""
        shape = type(self.object.shape).__name__
        arms = ", ".join(robot.model for robot in self.robots)
        return f"Task({self.name!r}: {shape} of {self.object.mass:g} kg; {arms})"

    @property
    def full_belief(self) -> Belief:
        """Assumptions of planner and controller. All fields except rho are filled in."""
        scene = self.scene
        return Belief(
            scene.support.friction,
            scene.contact_friction,
            scene.body.mass,
            scene.body.center_of_mass,
            scene.rho,
            scene.friction_error,
            scene.center_error,
            scene.mass_error,
        )

    @cached_property
    def scene(self) -> Scene:
        """The scene as believed by planner and controller: believed values replace true
        ones.
        """
        belief = self.belief
        mass = assumption(belief.mass, self.object.mass)
        friction = assumption(belief.support_friction, self.support.friction)
        return Scene(
            replace(self.object, mass=mass, center_of_mass=self.X_GB.position),
            replace(self.support, friction=friction),
            assumption(belief.contact_friction, self.contact_friction),
            self.robots,
            tuple(obstacle.nominal for obstacle in self.obstacles),
            belief.rho,
            belief.friction_error,
            belief.center_error,
            belief.mass_error,
            self.motion.only_arm,
            self.dares,
        )

    @property
    def query(self) -> MotionQuery:
        """Query of one motion from the start to the goal, without legs."""
        return MotionQuery(
            self.scene,
            self.start,
            self.goal,
            self.motion,
            self.limits,
            self.tolerance,
            self.sensing,
            self.tool,
            self.modes,
            self.source or self.name,
        )

    def queries(
        self, *, from_search: bool = False, may_push: bool = False
    ) -> tuple[MotionQuery, ...]:
        """One query for each leg, from the end of the previous leg, or one for a task
        without legs.

        Raises TaskError for a task with several goals, which is executed in stages.
        ``from_search`` says that the legs were found by a search and not prescribed,
        ``may_push`` that the object may push movable obstacles.
        """
        if self.goals:
            reason = "allowed: null; selection.stages makes stages of a task with goals"
            bodies = [goal.body for goal in self.goals]
            raise TaskError(self.source or self.name, "goals", bodies, reason)
        whole = replace(self.query, from_search=from_search, may_push=may_push)
        out = []
        start = self.start
        for i, leg in enumerate(self.legs):
            on_the_way = from_search and i + 1 < len(self.legs)
            out.append(
                replace(
                    whole.moved_by(leg.motion),
                    start=start,
                    goal=leg.goal,
                    modes=(leg.mode,),
                    tolerance=ON_THE_WAY if on_the_way else self.tolerance,
                    source=f"{self.source}: legs[{i}]",
                )
            )
            start = leg.goal
        return tuple(out) or (whole,)

    @property
    def X_GB(self) -> Pose2:
        """Pose of the body frame B in the shape's frame G.

        Contacts and drives are given in B. Its origin is the believed centre of mass.
        """
        x, y = assumption(self.belief.center_of_mass, self.object.center_of_mass)
        return Pose2(x, y, 0.0)

    @property
    def center_error(self) -> Point:
        """Error [m] of the believed centre of mass (believed minus true), in G."""
        x, y = self.object.center_of_mass
        believed = self.X_GB
        return (believed.x - x, believed.y - y)

    def resumed(self, restart: Restart) -> Task:
        """The remaining task after ``restart``. The goals of completed legs become the
        poses in which the object was left.
        """
        belief = replace(
            self.belief,
            center_of_mass=restart.center_of_mass,
            support_friction=max(restart.support_friction, restart.least_friction),
            rho=restart.rho,
        )
        if restart.center_error is not None:
            belief = replace(belief, center_error=restart.center_error)
        if restart.mass is not None:
            belief = replace(belief, mass=restart.mass)
        if restart.mass_error is not None:
            belief = replace(belief, mass_error=restart.mass_error)
        if restart.contact_friction is not None:
            belief = replace(belief, contact_friction=restart.contact_friction)
        limits = self.limits
        if restart.planned_share is not None:
            limits = replace(limits, planned_share=restart.planned_share)
        dares = restart.dares and belief.planned_for_errors
        task = replace(
            self, belief=belief, limits=limits, start_error=Pose2(), dares=dares
        )
        if restart.free:
            legs = (replace(leg, motion=leg.motion.freed) for leg in self.legs)
            task = replace(task, motion=self.motion.freed, legs=tuple(legs))
        if restart.legs is not None:
            found = restart.legs
            return replace(task, start=restart.state.object, legs=found)
        if restart.leg == 0:
            return replace(task, start=restart.state.object)
        begun = list(task.legs)
        begun[restart.leg - 1] = replace(
            begun[restart.leg - 1], goal=restart.state.object
        )
        return replace(task, legs=tuple(begun))

    @property
    def true_start(self) -> Pose2:
        """X_WG at which the object really starts."""
        e = self.start_error
        return Pose2(self.start.x + e.x, self.start.y + e.y, self.start.yaw + e.yaw)
