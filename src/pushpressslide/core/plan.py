"""What selection and planning return: contacts, a choice of mode, a plan, a joint path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from pushpressslide.core.control import Vector3
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MotionPath = ArcPath | TwistPath


@dataclass(frozen=True, slots=True)
class Contact:
    """Where one arm touches the object."""

    arm: int  # index into the task's robots
    kind: Literal["side", "top"]
    point: Point  # [m] in B
    # unit, in B: inward face normal of a side contact; (0, 0) for a top contact
    normal: Point
    height: float  # [m] of the contact above the support
    load: float = 0.0  # [N] that a top contact is pressed with, as planned

    def same_place(self, other: Contact) -> bool:
        """Return whether the same arm touches the same place, however hard."""
        return replace(self, load=0.0) == replace(other, load=0.0)

    def direction(self, X_WB: Pose2) -> Vector3:
        """Return the unit vector from the tip into the object: in the plane, and up
        from the support.
        """
        if self.kind == "top":
            return (0.0, 0.0, -1.0)
        x, y = X_WB.rotate(self.normal)
        return (x, y, 0.0)

    def tip_place(self, radius: float, gap: float = 0.0) -> tuple[Point, float]:
        """Return where the centre of a tip of ``radius`` [m] is, ``gap`` [m] before the
        contact.

        Its place in B [m] and its height above the support [m].
        """
        out = radius + gap
        if self.kind == "top":
            return self.point, self.height + out
        return (
            self.point[0] - out * self.normal[0],
            self.point[1] - out * self.normal[1],
        ), self.height


@dataclass(frozen=True, slots=True)
class Choice:
    """One mode at one placement of its contacts, judged for a task."""

    mode: str
    feasible: bool
    reason: str  # one line: why it can, or the number that decides why it cannot
    contacts: tuple[Contact, ...] = ()
    path_length: float | None = None  # [m] of the tracking point
    time: float | None = None  # [s] estimated
    # [rad] least distance of the planned force angle to the cone's edge
    friction_margin: float | None = None
    # the mode's own figures, by name, SI
    parameters: Mapping[str, float] = field(default_factory=dict)
    path: MotionPath | None = None  # of the vehicle frame V
    goal: Pose2 | None = None  # X_WG at the path's end; None: the task's goal
    # the next stretch of motion, with the same contacts
    following: Choice | None = None
    leg: int = 0  # of the task, that it is for
    # in full; else it was passed over, as one that is no slower was found
    judged: bool = True

    @property
    def verdict(self) -> str:
        """What was found, in a word or two."""
        return (
            "possible" if self.feasible else "refused" if self.judged else "passed over"
        )

    @property
    def stretches(self) -> tuple[Choice, ...]:
        """This choice and those that follow it."""
        return (self,) if self.following is None else (self, *self.following.stretches)

    def goes_on(self, before: Choice) -> bool:
        """Return whether its contacts are those of the choice ``before`` it, pressed as
        they may be.
        """
        pairs = zip(self.contacts, before.contacts, strict=False)
        return len(self.contacts) == len(before.contacts) and all(
            a.same_place(b) for a, b in pairs
        )


@dataclass(frozen=True, slots=True)
class Plan:
    """A task, the chosen mode, and the timed path of the tracking point."""

    task: Task
    choice: Choice
    # of the vehicle frame V (origin: tracking point, x: heading) in the world
    path: MotionPath
    profile: SpeedProfile
    X_BV: Pose2  # the vehicle frame in the body frame
    following: Plan | None = None  # the next stretch of motion, with the same contacts
    next_grasp: Plan | None = None  # the next grasp, from where the last stretch ends

    @property
    def goal(self) -> Pose2:
        """X_WG that the path leads to."""
        return self.task.goal if self.choice.goal is None else self.choice.goal

    @property
    def stretches(self) -> tuple[Plan, ...]:
        """This plan and those that follow it."""
        return (self,) if self.following is None else (self, *self.following.stretches)

    @property
    def grasps(self) -> tuple[Plan, ...]:
        """The plan of each grasp, in order: this one, and those for which arms let go
        in between.
        """
        return (self,) if self.next_grasp is None else (self, *self.next_grasp.grasps)

    def kept(self, after: Plan) -> frozenset[int]:
        """Return the arms that need not let go for the grasp ``after`` it."""
        pairs = [(c, d) for c in self.choice.contacts for d in after.choice.contacts]
        return frozenset(c.arm for c, d in pairs if c.same_place(d))

    @property
    def way(self) -> tuple[Plan, ...]:
        """The stretches of all grasps."""
        return tuple(stretch for grasp in self.grasps for stretch in grasp.stretches)

    @property
    def contacts_by_leg(self) -> dict[int, tuple[Contact, ...]]:
        """The contacts that the arms have in each leg."""
        return {
            part.choice.leg: grasp.choice.contacts
            for grasp in self.grasps
            for part in grasp.stretches
        }

    def object_pose(self, s: float) -> Pose2:
        """Return the planned X_WG at arc length ``s`` [m]."""
        X_WB = self.path.pose(s).compose(self.X_BV.inverse())
        return X_WB.compose(self.task.object.X_GB.inverse())


@dataclass(frozen=True, slots=True)
class JointPath:
    """Joint positions of one arm, as samples: on the way to the object by time, along
    the path by arc length.
    """

    approach_time: NDArray[np.float64]  # (m,) [s]
    approach: NDArray[np.float64]  # (m, n) [rad]
    arc_length: NDArray[np.float64]  # (k,) [m]
    move: NDArray[np.float64]  # (k, n) [rad]
    tool_yaw_offset: float  # [rad] tool yaw minus object yaw while in contact
    joint_margin: float  # [rad] least distance to a joint limit
    condition: float  # largest condition number of the tip's 6 x n Jacobian
    clearance: float  # [m] least distance of the arm to table, object and obstacles
    gap: float  # [m] free way before the touch that the approach leaves
