"""What a run leaves behind: time series, and why it ended. Names, shapes and units are
listed in docs/record.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ReasonCode = Literal[
    "goal_reached",
    "goal_missed",
    "time_limit",
    "contact_lost",
    "force_limit",
    "torque_limit",
    "joint_limit",
    "reference_jump",
    "diverged",
    "interrupted",
]


@dataclass(frozen=True, slots=True)
class Ending:
    """Why a run ended: a code, and one line of text with the number that decided."""

    code: ReasonCode
    text: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """Time series of one run, N ticks.

    time (N,) [s]; phase (N,) index into core.control.PHASES; leg (N,); stretch (N,)
    that is followed; vehicle_frame (N, 3) X_BV of that stretch; object_pose (N, 3) X_WG
    [m, rad]; object_twist (N, 3) of G's origin in world axes; object_pose_3d (N, 7)
    quaternion wxyz and position; reference_pose (N, 3) X_WG at the same time;
    tracking_error (N, 3) along, left [m], heading [rad]; progress (N,) [m]; steering
    (N,) [rad]; wanted_wrench, allocated_wrench (N, 3) in B about the CoM; for A arms:
    command_force (N, A, 3), measured_force (N, A, 3), both of the tip ON the object in
    world axes [N]; tip_position (N, A, 3) of the tip's centre [m]; tip_reference (N, A,
    3) [m]; contact_point (N, A, 3) [m], NaN without contact; and per arm i:
    joint_position_i, joint_velocity_i, joint_torque_i, joint_reference_i (N, n_i); per
    movable body: body_<name> (N, 7); tick_track, tick_allocate, tick_execute,
    tick_total (N,) [s] wall time. Of the plan: plan_path (K, 3) of the vehicle frame V
    in the world, plan_stretch (K,).
    """

    arrays: Mapping[str, NDArray[np.float64]]
    reason: ReasonCode
    reason_text: str
    engine: str  # the plant's name
    seed: int
    wall_time: float  # [s] of the whole loop
    modes: tuple[str, ...]
    # versions, time step, joint margin, clearance, ...
    meta: Mapping[str, Any] = field(default_factory=dict)
