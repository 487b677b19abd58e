"""Joint paths: the object's planned path, with the arm attached to it at the contact, as motion of the
joints.

The tip must follow its contact point, the tool's yaw must follow the object (a tip that does not turn with
the face rolls along it), and the tool's axis keeps a constant direction. What is free is the tool's yaw
relative to the object, the tilt, and the elbow. All combinations of a grid are followed by continuation, with
the elbow kept away from the joint limits; the best that is clear of table, object and obstacles is taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.modes.base import tool_azimuths
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.inverse import solve_ik
from pushpressslide.robots.kinematics import ArmKinematics, arm_kinematics
from pushpressslide.robots.reach import REACH_MARGIN
from pushpressslide.robots.tool import TOOL_TILTS, UPRIGHT, ToolAttitude
from pushpressslide.sim.approach import Approach
from pushpressslide.sim.clearance import ClearanceModel

Array = NDArray[np.float64]

STEP = 0.015  # [m] of the way between samples
TURN_ARM = 0.2  # [m] of way that a turn by one radian counts for
JOINT_MARGIN = REACH_MARGIN  # [rad] kept from every joint limit, as the reach check of the selection does
CONDITION_LIMIT = 60.0  # of the 6 x n Jacobian in rad and m: beyond it a singularity is near
CLEARANCE = 0.005  # [m] least distance of the arm's capsules, which hold the real outline with 1 cm to spare
YAW_OFFSETS = np.linspace(-math.pi, math.pi, 24, endpoint=False)  # [rad] tool yaw minus object yaw
POSE = 6  # joints that can hold the tool any way; an arm with fewer keeps it upright
ENOUGH = 6  # best candidates of each tilt whose clearance is computed


@dataclass(frozen=True)
class _Candidate:
    attitude: ToolAttitude
    offset: float
    move: Continuation
    way: float  # [rad] of the joint that has to turn most on the way from home

    @property
    def score(self) -> float:
        """Joint margin and distance from singularity, saturated where more is of no use; upright and near
        home preferred.
        """
        safe = min(self.move.joint_margin, 0.4) - 0.01 * min(self.move.condition, 40.0)
        return safe - 0.15 * self.attitude.tilt - 0.05 * self.way


def joint_path(plan: Plan, arm: int = 0, *, force: bool = False) -> tuple[JointPath, ToolAttitude]:
    """Return the joint path of one arm and how its tool is held; ``force`` takes the best there is, however
    bad.

    Raises InfeasibleTaskError, with the figure that decides, where no tried posture does it.
    """
    robot = plan.task.robots[arm]
    kin = arm_kinematics(robot)
    contact = next((c for c in plan.choice.contacts if c.arm == arm), None)
    if contact is None:
        return _at_rest(kin)
    s, bodies = _body_path(plan)
    inside, height = contact.tip_place(robot.tip_radius)
    frame = plan.task.support.frame
    positions = np.array([frame.point((*X.apply(inside), height)) for X in bodies])
    yaws = np.unwrap(np.array([X.yaw for X in bodies]))
    azimuths = tool_azimuths(contact, bodies[len(bodies) // 2], plan.task.bases[arm])
    model = ClearanceModel(plan, arm)
    X_BG = plan.task.object.X_GB.inverse()
    poses = [X.compose(X_BG) for X in bodies]
    normal = contact.direction(bodies[0])
    approach = Approach(
        plan.task, kin, lambda q: model.least(q[None], [poses[0]], touching=False)[0] >= CLEARANCE
    )
    x, y, z = positions[0]
    problem = (
        f"no posture brings the tip to the first contact at ({x:.3f}, {y:.3f}, {z:.3f}), "
        f"with joints {JOINT_MARGIN:g} rad inside their limits"
    )
    least = -math.inf
    attitudes = [ToolAttitude(0.0, azimuths[0], frame.axes)]
    if kin.facts.size >= POSE:
        tilts = TOOL_TILTS[1:]
        attitudes += [ToolAttitude(tilt, azimuth, frame.axes) for tilt in tilts for azimuth in azimuths]
    for attitude in attitudes:
        candidates, why = _candidates(kin, positions, yaws, attitude, force)
        if not candidates and least == -math.inf:
            problem = why or problem
        for candidate in candidates[:ENOUGH]:
            clear, pair = model.least(candidate.move.q, poses, touching=True)
            if clear >= CLEARANCE or force:
                move, yaw = candidate.move, float(yaws[0]) + candidate.offset
                for times, way in approach.ways(positions[0], yaw, normal, move.q[0], candidate.attitude):
                    way_clear, way_pair = model.least(way, [poses[0]] * len(way), touching=False)
                    if way_clear >= CLEARANCE or force:
                        path = JointPath(
                            times, way, s, move.q, candidate.offset, move.joint_margin, move.condition,
                            min(clear, way_clear),
                        )  # fmt: skip
                        return path, candidate.attitude
                    if way_clear > least:
                        least, problem = way_clear, f"on the way to the object {way_pair}"
            elif clear > least:
                least, problem = clear, pair
    if least > -math.inf:
        problem = f"{problem} come as near as {least * 1e3:.1f} mm, allowed from {CLEARANCE * 1e3:.0f} mm"
    raise InfeasibleTaskError(
        f"{plan.task.source or plan.task.name}: robots: the {kin.facts.name} has no joint path "
        f"along the contact: {problem}"
    )


def _at_rest(kin: ArmKinematics) -> tuple[JointPath, ToolAttitude]:
    """Return the joint path of an arm that has nothing to do."""
    q, none = kin.facts.home[None], np.zeros(1)
    margin = float(kin.joint_margin(q)[0])
    return JointPath(np.array([0.0, 0.5]), np.repeat(q, 2, 0), none, q, 0.0, margin, 1.0, math.inf), UPRIGHT


def _body_path(plan: Plan) -> tuple[Array, list[Pose2]]:
    """Return arc lengths (k,) [m] over all stretches of ``plan``, and X_WB there."""
    lengths: list[float] = []
    bodies: list[Pose2] = []
    done = 0.0
    for stretch in plan.stretches:
        length, X_VB = stretch.path.length, stretch.X_BV.inverse()
        ends = stretch.path.pieces
        turned = sum(
            abs(piece[0] if isinstance(piece[0], float) else piece[0][2]) * piece[1] for piece in ends
        )
        count = max(8, math.ceil((length + TURN_ARM * turned) / STEP))
        grid = np.linspace(0.0, length, count + 1)[0 if not lengths else 1 :]
        lengths += [done + float(s) for s in grid]
        bodies += [stretch.path.pose(float(s)).compose(X_VB) for s in grid]
        done += length
    return np.array(lengths), bodies


def _candidates(
    kin: ArmKinematics, positions: Array, yaws: Array, attitude: ToolAttitude, force: bool
) -> tuple[list[_Candidate], str]:
    """Return the joint paths of all tool yaw offsets at one tilt, best first, and why the last of the others
    failed.
    """
    offsets = YAW_OFFSETS if kin.facts.size >= POSE else np.zeros(1)
    tool_yaws = yaws[None, :] + offsets[:, None]
    starts = solve_ik(
        kin, np.tile(positions[0], (len(offsets), 1)), attitude, tool_yaws[:, 0], joint_margin=JOINT_MARGIN
    )
    good = np.flatnonzero(starts.converged | force)
    if len(good) == 0:
        return [], ""
    found, why = [], ""
    paths = continuations(kin, positions, tool_yaws[good], starts.q[good], attitude, JOINT_MARGIN)
    for j, path in zip(good, paths, strict=True):
        if force or (path.ok and path.condition < CONDITION_LIMIT):
            way = float(np.max(np.abs(path.q[0] - kin.facts.home)))
            found.append(_Candidate(attitude, float(offsets[j]), path, way))
        elif not path.ok:
            at = positions[path.failed_at if path.failed_at is not None else 0]
            where = f"({at[0]:.3f}, {at[1]:.3f}, {at[2]:.3f})"
            why = f"{path.status} at tip {where}, {JOINT_MARGIN:g} rad of margin asked"
        else:
            why = (
                f"condition number {path.condition:.0f} of the Jacobian, allowed below {CONDITION_LIMIT:.0f}"
            )
    return sorted(found, key=lambda c: -c.score), why
