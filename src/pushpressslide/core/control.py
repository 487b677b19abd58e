"""Input and output of a controller at every tick, for any engine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple

from pushpressslide.core.pose import Pose2

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Vector3 = tuple[float, float, float]
Phase = Literal["approach", "touch", "move", "release", "done"]
PHASES: tuple[Phase, ...] = ("approach", "touch", "move", "release", "done")


@dataclass(frozen=True, slots=True)
class TipState:
    """Position [m] and velocity [m/s] of a tip's centre, and its force [N] ON the
    object.

    All are along x, y and height of the support's frame, which is the world frame on a
    table.
    """

    position: Vector3
    velocity: Vector3
    force: Vector3


@dataclass(frozen=True, slots=True)
class Measurement:
    """All measurements that a robot has."""

    time: float  # [s]
    object_pose: Pose2  # X_WG
    tips: tuple[TipState, ...]
    # False: the camera missed this tick, and ``object_pose`` is the last one seen
    pose_seen: bool = True
    pose_time: float | None = None  # [s] time of that pose; None: now
    pictures: int = 1  # of an object at rest, of which the pose is the middle


@dataclass(frozen=True, slots=True)
class TipCommand:
    """Commanded behaviour of one tip: a force plus an impedance about a moving
    reference.

    Force on the object: force + stiffness * (position - measured) + damping * (velocity
    - measured), the last two per axis of the contact frame (n: in the plane at
    ``normal_yaw``; t: left of n; z: height).
    """

    force: Vector3  # [N] of the support's frame, feed-forward, ON the object
    position: Vector3  # [m], reference of the tip's centre
    velocity: Vector3  # [m/s]
    stiffness: Vector3  # [N/m] along n, t, z
    damping: Vector3  # [N s/m] along n, t, z
    normal_yaw: float  # [rad] in the plane
    # [rad] wanted yaw of the tool in the plane, less the joint path's offset
    tool_yaw: float
    tool_yaw_rate: float  # [rad/s]
    # [N] bound on the impedance force along the support, and on that along the height
    servo_cap: float
    progress: float  # [m] arc length on the planned path, for the joint reference
    acceleration: Vector3 = (0.0, 0.0, 0.0)  # [m/s^2] of the reference
    tool_yaw_acceleration: float = 0.0  # [rad/s^2] of the reference
    # whether the servo along the support is made as quick as the arm is heavy there
    catches_up: bool = True
    # (n,) [rad] joint reference; None: that of the joint path at ``progress``
    posture: NDArray[np.float64] | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, eq=False)
class JointCommand:
    """Commanded joint motion of one arm in free space."""

    position: NDArray[np.float64]  # (n,) [rad]
    velocity: NDArray[np.float64]  # (n,) [rad/s]


@dataclass(frozen=True, slots=True)
class BrakeCommand:
    """Command to brake: the arm's weight is held, and its joints are damped."""


# None: the arm rests where its joint path along the contact begins
ArmCommand = TipCommand | JointCommand | BrakeCommand | None
# one per robot of the task
TipCommands = tuple[TipCommand | None, ...]
Commands = tuple[ArmCommand, ...]


class Thought(NamedTuple):
    """Internal quantities of a controller at one tick, for the record."""

    reference: Pose2  # X_WG at the same TIME
    # along [m], left [m], heading [rad]; reference minus actual
    tracking_error: Vector3 = (0.0, 0.0, 0.0)
    # fx, fy [N], tau [N m] in B, about the CoM
    wanted_wrench: Vector3 = (0.0, 0.0, 0.0)
    allocated_wrench: Vector3 = (0.0, 0.0, 0.0)
    steering: float = 0.0  # [rad] force angle from the heading axis


class ControlLog(NamedTuple):
    """Log of one tick of a controller."""

    phase: Phase
    progress: float  # [m]
    # computes the rest after the run: a tick has no time for it
    thought: Callable[[], Thought]
    wall_times: tuple[float, float] = (0.0, 0.0)  # [s] to track, to allocate
