"""Joint paths: the object's planned path, with the arm attached to it at the contact, as motion of the
joints.

The tip must follow its contact point, the tool's yaw must follow the object (a tip that does not turn with
the face rolls along it), and the tool's axis keeps a constant direction. What is free is the tool's yaw
relative to the object, the tilt, and the elbow. All combinations of a grid are followed by continuation, with
the elbow kept away from the joint limits (postures.py); the best that is clear of table, object and obstacles
is taken. Where there is none, the nearest misses are refined (refine.py) and judged again.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import chain, pairwise

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Contact, JointPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.modes.base import tool_azimuths
from pushpressslide.robots.kinematics import ArmKinematics, arm_kinematics
from pushpressslide.robots.tool import TOOL_TILTS, UPRIGHT, ToolAttitude
from pushpressslide.sim.approach import LEAST_GAP, Approach
from pushpressslide.sim.clearance import ClearanceModel
from pushpressslide.sim.postures import (
    JOINT_MARGIN,
    POSE,
    Miss,
    Move,
    TipPath,
    moves,
    problem,
    shortfall,
)
from pushpressslide.sim.refine import refined_move, refined_way

Array = NDArray[np.float64]

STEP = 0.015  # [m] of the way between samples
TURN_ARM = 0.2  # [m] of way that a turn by one radian counts for
CLEARANCE = 0.005  # [m] least distance of the arm's capsules, which hold the real outline with 1 cm to spare
GLANCE = 8  # of so many postures of a way one is looked at first
ENOUGH = 6  # best candidates of each tilt whose clearance is computed
REFINED = 4  # misses that are tried to be made good
NEAR = 0.03  # shortfall of a near miss
YAW_APART = 0.6  # [rad] between the tool yaws of two that are tried at one tilt


def joint_path(plan: Plan, arm: int = 0, *, force: bool = False) -> tuple[JointPath, ToolAttitude]:
    """Return the joint path of one arm and how its tool is held; ``force`` takes the best there is, however
    bad.

    Raises InfeasibleTaskError, with the figure that decides, where no tried posture does it.
    """
    kin = arm_kinematics(plan.task.robots[arm])
    contact = next((c for c in plan.choice.contacts if c.arm == arm), None)
    if contact is None:
        return _at_rest(kin)
    search = _Search(plan, kin, contact)
    misses: list[Miss] = []
    for attitude in search.attitudes:
        found, failed = moves(kin, search.tip, attitude, force=force)
        misses += failed
        for move in found[:ENOUGH]:
            done = search.finished(move, force=force)
            if isinstance(done, JointPath):
                return done, attitude
            misses.append(done)
    misses.sort(key=lambda miss: miss.short)
    for miss in _diverse(misses) if kin.facts.size >= POSE else ():
        refined = search.refined(miss)
        if refined is not None:
            done = search.finished(refined, thorough=True)
            if isinstance(done, JointPath):
                return done, refined.posture.attitude
    raise InfeasibleTaskError(
        f"{plan.task.source or plan.task.name}: robots: the {kin.facts.name} has no joint path "
        f"along the contact: {misses[0].why}"
    )


def _diverse(misses: list[Miss]) -> list[Miss]:
    """Return the nearest of near misses, not too like each other."""
    out: list[Miss] = []
    for miss in misses:
        posture = miss.posture
        like = (
            chosen.posture.attitude == posture.attitude
            and abs(math.remainder(chosen.posture.offset - posture.offset, 2.0 * math.pi)) < YAW_APART
            for chosen in out
        )
        if miss.short < NEAR and len(out) < REFINED and not any(like):
            out.append(miss)
    return out


class _Search:
    """What there is to know about one contact of one arm, and the judging of its moves."""

    def __init__(self, plan: Plan, kin: ArmKinematics, contact: Contact) -> None:
        self.plan, self.kin, self.contact = plan, kin, contact
        robot = plan.task.robots[contact.arm]
        self.arc_length, bodies = _body_path(plan)
        self.tip = self._tip_path(bodies)
        self.normal = contact.direction(bodies[0])
        self.model, self.start = ClearanceModel(plan, contact.arm), self.tip.objects[0]
        self.approach = Approach(plan.task, kin, lambda q: self._clear(q[None])[0] >= CLEARANCE)
        azimuths = tool_azimuths(contact, bodies[len(bodies) // 2], robot.base)
        self.attitudes = [ToolAttitude(0.0, azimuths[0])]
        if kin.facts.size >= POSE:
            self.attitudes += [ToolAttitude(tilt, azimuth) for tilt in TOOL_TILTS[1:] for azimuth in azimuths]

    def finished(self, move: Move, *, force: bool = False, thorough: bool = False) -> JointPath | Miss:
        """Return the whole joint path, the way to the object included; ``thorough`` tries curved ways too."""
        posture, tip = move.posture, self.tip
        clear, pair = self.model.least(posture.q, tip.objects, touching=True)
        if clear < CLEARANCE and not force:
            return Miss(10.0 * (CLEARANCE - clear), _near(pair, clear), posture)
        yaw = float(tip.yaws[0]) + posture.offset
        descent = self.approach.descent(
            tip.positions[0], yaw, self.normal, posture.q[0], posture.attitude, 0.0 if force else LEAST_GAP
        )
        ways = self.approach.ways(descent)
        if thorough:
            ways = chain(ways, self.approach.bent_ways(descent, self._bent))
        best, why = -math.inf, ""
        for times, way in ways:
            way_clear, way_pair = self._clear(way[::GLANCE])
            if way_clear >= CLEARANCE:
                way_clear, way_pair = self._clear(way)
            if way_clear >= CLEARANCE or force:
                return JointPath(
                    times, way, self.arc_length, posture.q, posture.offset, move.margin, move.condition,
                    min(clear, way_clear), descent.gap,
                )  # fmt: skip
            if way_clear > best:
                best, why = way_clear, _near(way_pair, way_clear)
        if best == -math.inf:
            why = problem(descent.back, descent.points)
            short = shortfall(descent.back, descent.needed)
            return Miss(short, f"before the contact, {why}", posture)
        return Miss(10.0 * (CLEARANCE - best), f"on the way to the object {why}", posture, on_the_way=True)

    def _clear(self, way: Array) -> tuple[float, str]:
        """Least distance on the way to the object, and between what."""
        return self.model.least(way, [self.start] * len(way), touching=False)

    def refined(self, miss: Miss) -> Move | None:
        """Return an allowed move near a missed one, drawn back from the object as well, or None."""
        if miss.on_the_way:
            return Move.of(self.kin, miss.posture)
        tip, posture, before = self.tip, miss.posture, 3
        first = tip.positions[0]
        gap = min(LEAST_GAP, self.plan.task.motion.approach_distance)
        whole = TipPath(
            np.concatenate(
                [np.linspace(first - gap * np.array(self.normal), first, before + 1)[:-1], tip.positions]
            ),
            np.concatenate([np.repeat(tip.yaws[:1], before), tip.yaws]),
            [self.start] * before + list(tip.objects),
        )
        guess = replace(posture, q=np.concatenate([np.repeat(posture.q[:1], before, axis=0), posture.q]))
        found = refined_move(self.kin, self.model, whole, guess, JOINT_MARGIN, CLEARANCE)
        if found is None:
            return None
        move = Move.of(self.kin, replace(found, q=found.q[before:]))
        return move if move.allowed else None

    def _bent(self, start: Array, end: Array) -> Array:
        return refined_way(self.kin, self.model, self.start, start, end, CLEARANCE)

    def _tip_path(self, bodies: list[Pose2]) -> TipPath:
        task, contact = self.plan.task, self.contact
        inside, height = contact.tip_place(task.robots[contact.arm].tip_radius)
        X_BG = task.object.X_GB.inverse()
        return TipPath(
            np.array([(*X.apply(inside), height) for X in bodies]),
            np.unwrap(np.array([X.yaw for X in bodies])),
            [X.compose(X_BG) for X in bodies],
        )


def _near(pair: str, clear: float) -> str:
    return f"{pair} come as near as {clear * 1e3:.1f} mm, allowed from {CLEARANCE * 1e3:.0f} mm"


def _at_rest(kin: ArmKinematics) -> tuple[JointPath, ToolAttitude]:
    """Return the joint path of an arm that has nothing to do."""
    q, none = kin.facts.home[None], np.zeros(1)
    margin = float(kin.joint_margin(q)[0])
    return JointPath(
        np.array([0.0, 0.5]), np.repeat(q, 2, 0), none, q, 0.0, margin, 1.0, math.inf, math.inf
    ), UPRIGHT


def _body_path(plan: Plan) -> tuple[Array, list[Pose2]]:
    """Return arc lengths (k,) [m] over all stretches of ``plan``, and X_WB there."""
    lengths: list[float] = []
    bodies: list[Pose2] = []
    done = 0.0
    for stretch in plan.stretches:
        length, X_VB = stretch.path.length, stretch.X_BV.inverse()
        turned = sum(abs(b.yaw - a.yaw) for (_, a), (_, b) in pairwise(stretch.path.starts))
        count = max(8, math.ceil((length + TURN_ARM * turned) / STEP))
        grid = np.linspace(0.0, length, count + 1)[0 if not lengths else 1 :]
        lengths += [done + float(s) for s in grid]
        bodies += [stretch.path.pose(float(s)).compose(X_VB) for s in grid]
        done += length
    return np.array(lengths), bodies
