"""What selection and planning return: contacts, a choice of mode, a plan, a joint path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Contact:
    """Where one arm touches the object."""

    arm: int  # index into the task's robots
    kind: Literal["side", "top"]
    point: Point  # [m] in B
    normal: Point  # unit, in B: inward face normal of a side contact; (0, 0) for a top contact
    height: float  # [m] of the contact above the support


@dataclass(frozen=True, slots=True)
class Choice:
    """One mode at one placement of its contacts, judged for a task."""

    mode: str
    feasible: bool
    reason: str  # one line: why it can, or the number that decides why it cannot
    contacts: tuple[Contact, ...] = ()
    path_length: float | None = None  # [m] of the tracking point
    time: float | None = None  # [s] estimated
    friction_margin: float | None = None  # [rad] least distance of the planned force angle to the cone's edge
    parameters: Mapping[str, float] = field(default_factory=dict)  # the mode's own figures, by name, SI
    path: ArcPath | None = None  # of the vehicle frame V


@dataclass(frozen=True, slots=True)
class Plan:
    """A task, the chosen mode, and the timed path of the tracking point."""

    task: Task
    choice: Choice
    path: ArcPath  # of the vehicle frame V (origin: tracking point, x: heading) in the world
    profile: SpeedProfile
    X_BV: Pose2  # the vehicle frame in the body frame

    def object_pose(self, s: float) -> Pose2:
        """Return the planned X_WG at arc length ``s`` [m]."""
        X_WB = self.path.pose(s).compose(self.X_BV.inverse())
        return X_WB.compose(self.task.object.X_GB.inverse())


@dataclass(frozen=True, slots=True)
class JointPath:
    """Joint positions of one arm, as samples: on the way to the object by time, along the path by arc
    length.
    """

    approach_time: NDArray[np.float64]  # (m,) [s]
    approach: NDArray[np.float64]  # (m, n) [rad]
    arc_length: NDArray[np.float64]  # (k,) [m]
    move: NDArray[np.float64]  # (k, n) [rad]
    tool_yaw_offset: float  # [rad] tool yaw minus object yaw while in contact
    joint_margin: float  # [rad] least distance to a joint limit
    condition: float  # largest condition number of the tip's 6 x n Jacobian
    clearance: float  # [m] least distance of the arm to table, object and obstacles
