"""Joint paths: the object's planned path, with the arm attached to it at the contact, as motion of the joints.

The tip must follow its contact point, the tool's yaw must follow the object (a tip that does not turn with the face rolls
along it), and the tool's axis keeps a constant direction. What is free is the tool's yaw relative to the object, the
tilt, and the elbow. All combinations of a grid are followed by continuation, with the elbow kept away from the joint limits;
the best that is clear of table, object and obstacles is taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.inverse import solve_ik
from pushpressslide.robots.kinematics import ArmKinematics, arm_kinematics
from pushpressslide.robots.tool import ToolAttitude
from pushpressslide.sim.clearance import ClearanceModel

Array = NDArray[np.float64]

STEP = 0.015  # [m] of the tip between samples
JOINT_MARGIN = 0.08  # [rad] kept from every joint limit
CONDITION_LIMIT = 60.0  # of the 6 x n Jacobian in rad and m: beyond it a singularity is near
CLEARANCE = 0.01  # [m] least distance of the arm to table, object and obstacles
TILTS = (0.0, math.radians(15.0), math.radians(30.0))  # of the tool, the wrist behind the contact
YAW_OFFSETS = np.linspace(-math.pi, math.pi, 24, endpoint=False)  # [rad] tool yaw minus object yaw
APPROACH_SPEED = 0.6  # [rad/s] of the fastest joint in free space
DESCENT_SPEED = 0.15  # [m/s] of the tip
HOVER_ROOM = 0.06  # [m] above the object's top before the tip goes down beside it
ENOUGH = 4  # clear candidates that are compared


@dataclass(frozen=True)
class _Candidate:
    attitude: ToolAttitude
    offset: float
    move: Continuation

    @property
    def score(self) -> float:
        """The least of joint margin and distance from singularity, saturated where more is of no use; upright preferred."""
        return min(self.move.joint_margin, 0.5) - 0.01 * min(self.move.condition, 40.0) - 0.15 * self.attitude.tilt


def joint_path(plan: Plan, arm: int = 0, *, force: bool = False) -> tuple[JointPath, ToolAttitude]:
    """Return the joint path of one arm and how its tool is held; ``force`` takes the best there is, however bad.

    Raises InfeasibleTaskError, with the figure that decides, where no tried posture does it.
    """
    robot, contact = plan.task.robots[arm], plan.choice.contacts[arm]
    kin = arm_kinematics(robot)
    count = max(8, math.ceil(plan.path.length / STEP)) + 1
    s = np.linspace(0.0, plan.path.length, count)
    bodies = [plan.path.pose(float(x)).compose(plan.X_BV.inverse()) for x in s]
    inside = (
        contact.point[0] - robot.tip_radius * contact.normal[0],
        contact.point[1] - robot.tip_radius * contact.normal[1],
    )
    positions = np.array([(*X.apply(inside), contact.height) for X in bodies])
    yaws = np.unwrap(np.array([X.yaw for X in bodies]))
    middle = bodies[len(bodies) // 2].rotate(contact.normal)
    azimuth = math.atan2(middle[1], middle[0])
    found: list[_Candidate] = []
    best_failure = ""
    tilts = TILTS if kin.facts.size > 6 else (0.0,)
    for tilt in tilts:
        attitude = ToolAttitude(tilt, azimuth)
        offsets = YAW_OFFSETS if kin.facts.size > 6 else np.zeros(1)
        tool_yaws = yaws[None, :] + offsets[:, None]
        starts = solve_ik(kin, np.tile(positions[0], (len(offsets), 1)), attitude, tool_yaws[:, 0], joint_margin=JOINT_MARGIN)
        good = np.flatnonzero(starts.converged)
        if len(good) == 0:
            best_failure = best_failure or "no posture reaches the first contact"
            continue
        for j, path in zip(
            good,
            continuations(kin, positions, tool_yaws[good], starts.q[good], attitude, JOINT_MARGIN),
            strict=True,
        ):
            if force or (path.ok and path.condition < CONDITION_LIMIT):
                found.append(_Candidate(attitude, float(offsets[j]), path))
            elif not path.ok:
                at = positions[path.failed_at if path.failed_at is not None else 0]
                best_failure = f"{path.status} at tip ({at[0]:.3f}, {at[1]:.3f}, {at[2]:.3f})"
            else:
                best_failure = f"condition number {path.condition:.0f}, allowed below {CONDITION_LIMIT:.0f}"
        if found and max(c.score for c in found) > 0.0:
            break
    if not found:
        raise InfeasibleTaskError(
            f"{plan.task.source or plan.task.name}: robots: no joint path of the {kin.facts.name} follows the contact with "
            f"{JOINT_MARGIN:g} rad of joint margin ({best_failure})"
        )
    found.sort(key=lambda c: -c.score)
    model = ClearanceModel(plan, arm)
    least: float = -math.inf
    where = ""
    for candidate in found[: 3 * ENOUGH]:
        approach_time, approach = _approach(plan, kin, candidate, positions[0], yaws[0], contact.height, bodies[0].rotate(contact.normal))
        if approach is None or approach_time is None:
            where = "the way down beside the object cannot be reached"
            continue
        X_BG = plan.task.object.X_GB.inverse()
        poses = [X.compose(X_BG) for X in bodies]
        move_clear, move_pair = model.least(candidate.move.q, poses)
        way_clear, way_pair = model.least(approach[::3], [poses[0]] * len(approach[::3]))
        clear, pair = min((move_clear, move_pair), (way_clear, way_pair))
        if clear >= CLEARANCE or force:
            return (
                JointPath(
                    approach_time, approach, s, candidate.move.q, candidate.offset, candidate.move.joint_margin,
                    candidate.move.condition, clear,
                ),
                candidate.attitude,
            )  # fmt: skip
        if clear > least:
            least, where = clear, pair
    raise InfeasibleTaskError(
        f"{plan.task.source or plan.task.name}: robots: every joint path comes too near: {where} at {least * 1e3:.0f} mm, "
        f"allowed from {CLEARANCE * 1e3:.0f} mm"
    )


def _approach(
    plan: Plan,
    kin: ArmKinematics,
    candidate: _Candidate,
    first: Array,
    yaw: float,
    height: float,
    normal: tuple[float, float],
) -> tuple[Array | None, Array | None]:
    """Return times (m,) and postures (m, n): home, over the place beside the object, down to it."""
    gap = plan.task.motion.approach_distance
    beside = first - gap * np.array([normal[0], normal[1], 0.0])
    tops = [plan.task.object.shape.height, *(o.size[2] for o in plan.task.obstacles)]
    hover_height = max(max(tops) + HOVER_ROOM, height + 0.08)
    back = np.linspace(0.0, 1.0, 5)[:, None] * (beside - first) + first
    up = np.linspace(beside[2], hover_height, max(4, math.ceil((hover_height - height) / 0.02)))[1:]
    rise = np.column_stack([np.full(len(up), beside[0]), np.full(len(up), beside[1]), up])
    points = np.concatenate([back, rise])
    path = continuations(
        kin, points, np.full((1, len(points)), yaw + candidate.offset), candidate.move.q[:1], candidate.attitude, 0.03
    )[0]
    down = path.q[::-1][: len(rise) + 1] if path.ok else None
    if down is None:
        # the wrist does not reach that high: come from lower, the clearance check decides whether it may
        reached = path.failed_at if path.failed_at is not None else len(points)
        if reached < 6:
            return None, None
        down = path.q[4:reached][::-1]
    home = kin.facts.home
    way = float(np.max(np.abs(down[0] - home)))
    free_time = max(1.0, 1.875 * way / APPROACH_SPEED)
    u = np.linspace(0.0, 1.0, 60)
    blend = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    free = home + blend[:, None] * (down[0] - home)
    length = float(hover_height - height)
    down_time = max(0.5, 1.875 * length / DESCENT_SPEED)
    grid = np.linspace(0.0, 1.0, len(down))
    dense = blend
    lowered = np.column_stack([np.interp(dense, grid, down[:, i]) for i in range(down.shape[1])])
    times = np.concatenate([free_time * u, free_time + down_time * u[1:]])
    return times, np.concatenate([free, lowered[1:]])
