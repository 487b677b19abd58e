"""Joint paths: the object's planned path, with the arm attached to it at the contact,
as motion of the joints.

The tip must follow its contact point, the tool's yaw must follow the object (a tip that
does not turn with the face rolls along it), and the tool's axis keeps a constant
direction. What is free is the tool's yaw relative to the object, the tilt, and the
elbow. All combinations of a grid are followed by continuation, with the elbow kept away
from the joint limits (postures.py); the best that is clear of table, object and
obstacles is taken. Where there is none, the nearest misses are refined (refine.py) and
judged again. An arm without a contact stays where it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain, pairwise
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.modes.base import TURNING, tool_azimuths
from pushpressslide.robots.kinematics import arm_kinematics
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude
from pushpressslide.sim.arm_model import ArmModel
from pushpressslide.sim.joints.approach import LEAST_GAP, Approach
from pushpressslide.sim.joints.clearance import ClearanceModel
from pushpressslide.sim.joints.effort import largest_share
from pushpressslide.sim.joints.postures import (
    JOINT_MARGIN,
    POSE,
    Miss,
    Move,
    Posture,
    TipPath,
    attitudes,
    held_on,
    moves,
    problem,
    shortfall,
)
from pushpressslide.sim.joints.refine import refined_move

Array = NDArray[np.float64]

STEP = 0.015  # [m] of the way between samples
TURN_ARM = 0.2  # [m] of way that a turn by one radian counts for
# [m] least distance of the arm's capsules, which hold the real outline with 1 cm to
# spare
CLEARANCE = 0.005
GLANCE = 8  # of so many postures of a way one is looked at first
REFINED = 4  # misses that are tried to be made good
# share of a torque limit for the contact at rest; the rest is for control
MOST_EFFORT = 0.8
# of a press's distance from the CoM: its heading axis turns by no more than is steered
MOST_ROLLED = 0.25
NEAR = 0.1  # shortfall of a near miss
SHORT = attrgetter("short")

ArmPath = tuple[JointPath, ToolAttitude]


def joint_path(plan: Plan, arm: int = 0, *, force: bool = False) -> ArmPath:
    """Return the joint path of one arm and how its tool is held, as if it were alone;
    ``force`` takes the best there is, however bad.

    Raises InfeasibleTaskError, with the figure that decides, where no tried posture
    does it.
    """
    search = ArmSearch(plan, arm)
    for move, path in search.paths(force=force):
        return path, move.posture.attitude
    raise search.refusal()


class ArmSearch:
    """What one arm can do in a plan: its moves along the contact, and its ways to where
    they begin.
    """

    def __init__(
        self,
        plan: Plan,
        arm: int,
        start: Array | None = None,
        *,
        holds: bool = False,
        others: Mapping[int, Array] | None = None,
    ) -> None:
        """Look at a plan from where the arm is: ``start`` (n,), else its ready posture.

        ``holds``: at the start it has its contact already. ``others`` are the postures
        of arms that stand still.
        """
        self.plan, self.arm, self.others = plan, arm, dict(others or {})
        robot = plan.task.robots[arm]
        self.kin = arm_kinematics(robot)
        self.contact = next((c for c in plan.contacts if c.arm == arm), None)
        self.stays = holds or self.contact is None
        self.arc_length, bodies = _body_path(plan)
        self.robot = robot
        self.bodies = bodies
        X_BG = plan.task.object.X_GB.inverse()
        self.objects = [X.compose(X_BG) for X in bodies]
        self.model = ClearanceModel(plan, arm, self.others)
        self.misses: list[Miss] = []
        self.start = self.kin.facts.home if start is None else start
        if self.contact is None:
            return
        inside, height = self.contact.tip_place(robot.tip_radius)
        frame = plan.task.support.frame
        positions = np.array([frame.point((*X.apply(inside), height)) for X in bodies])
        yaws = np.unwrap(np.array([X.yaw for X in bodies]))
        self.tip = TipPath(positions, yaws, self.objects)
        self.normal = frame.direction(self.contact.direction(bodies[0]))
        middle = len(bodies) // 2
        azimuths = tool_azimuths(self.contact, bodies[middle], plan.task.bases[arm])
        # aside only with the tools that turn, which come last
        if self.contact.kind == "side":
            azimuths = azimuths[:1]
        self.attitudes = [(ToolAttitude(0.0, azimuths[0], frame.axes), np.zeros(1))]
        if self.kin.facts.size >= POSE:
            rolls = self.contact.kind == "top" and float(np.ptp(yaws)) > TURNING
            self.attitudes = attitudes(
                azimuths, float(yaws[middle]), frame.axes, rolls=rolls
            )
        if not holds:
            self.approach = Approach(
                plan.task, self.kin, lambda q: self._free(self.model, q), start
            )

    def paths(self, *, force: bool = False) -> Iterator[tuple[Move, JointPath]]:
        """Yield the moves with the joint path, the preferred first; refined ones where
        there is no other.
        """
        found = False
        stopped = list[Miss]()
        for move in self._moves(force):
            done = self.path(move, force=force)
            if isinstance(done, JointPath):
                found = True
                yield move, done
            else:
                stopped.append(done)
        self.misses = sorted(stopped, key=SHORT) + sorted(self.misses, key=SHORT)
        too_hard = bool(stopped) and self.misses[0].short > NEAR + MOST_EFFORT
        if found or self.kin.facts.size < POSE or self.stays or too_hard:
            return
        near = [self._with_clearance(miss) for miss in self.misses if miss.short < NEAR]
        for miss in _diverse(
            sorted((miss for miss in near if miss.short < NEAR), key=SHORT)
        ):
            better = (
                Move.of(self.kin, miss.posture)
                if miss.on_the_way
                else self._refined(miss)
            )
            refined = None if better is None else self.path(better, thorough=True)
            if better is not None and isinstance(refined, JointPath):
                yield better, refined

    def path(
        self,
        move: Move,
        *,
        others: Mapping[int, Array] | None = None,
        force: bool = False,
        thorough: bool = False,
    ) -> JointPath | Miss:
        """Return the whole joint path of a move, the way to the object included.

        ``others`` are the postures of further arms that stand still on the way;
        ``thorough`` also looks for ways round what is in the way.
        """
        posture = move.posture
        objects = self.objects
        clear, pair = self.model.least(posture.q, objects, touching=True)
        if clear < CLEARANCE and not force:
            return Miss(10.0 * (CLEARANCE - clear), _near(pair, clear), posture)
        share = self._effort(posture.q)
        if share > MOST_EFFORT and not force:
            why = f"holding its contact takes {share:.2f} of a joint's torque limit, allowed {MOST_EFFORT:g}"
            return Miss(NEAR + share, why, posture)
        rolled, allowed = self._rolled(posture.attitude)
        if rolled > allowed and not force:
            why = f"a tool that leans and does not turn rolls its tip by {rolled * 1e3:.0f} mm"
            return Miss(
                NEAR + rolled, f"{why}, allowed {allowed * 1e3:.0f} mm", posture
            )
        if self.stays:
            times = np.array([0.0, 0.5])
            way = np.repeat(self.start[None], 2, axis=0)
            return self._joint_path(move, times, way, clear, math.inf)
        model = (
            self.model
            if others is None
            else ClearanceModel(self.plan, self.arm, {**self.others, **others})
        )
        tip = self.tip
        yaw = float(tip.yaws[0]) + posture.offset
        descent = self.approach.descent(
            tip.positions[0],
            yaw,
            self.normal,
            posture.q[0],
            posture.attitude,
            0.0 if force else LEAST_GAP,
        )
        ways = self.approach.ways(descent)
        if thorough:
            ways = chain(
                ways, self.approach.ways_round(descent, lambda q: self._free(model, q))
            )
        best = -math.inf
        why = ""
        for times, way in ways:
            way_clear, way_pair = self._clear(model, way[::GLANCE])
            if way_clear >= CLEARANCE:
                way_clear, way_pair = self._clear(model, way)
            if way_clear >= CLEARANCE or force:
                return self._joint_path(
                    move, times, way, min(clear, way_clear), descent.gap
                )
            if way_clear > best:
                best = way_clear
                why = _near(way_pair, way_clear)
        if best == -math.inf:
            why = problem(descent.back, descent.points)
            return Miss(
                shortfall(descent.back, descent.needed),
                f"before the contact, {why}",
                posture,
            )
        return Miss(
            10.0 * (CLEARANCE - best),
            f"on the way to the object {why}",
            posture,
            on_the_way=True,
        )

    def _effort(self, postures: Array) -> float:
        """The largest share of a joint's torque that holding the contact takes."""
        if self.contact is None:
            return 0.0
        return largest_share(
            self.plan, self.contact, ArmModel(self.robot), postures, self.bodies
        )

    def _rolled(self, attitude: ToolAttitude) -> tuple[float, float]:
        """Return how far a single press rolls from where it began, and how far it may
        [m].
        """
        if (
            self.contact is None
            or self.contact.kind == "side"
            or len(self.plan.contacts) > 1
        ):
            return 0.0, math.inf
        turned = 0.0 if attitude.turns else min(float(np.ptp(self.tip.yaws)), math.pi)
        rolled = (
            2.0
            * self.robot.tip_radius
            * math.sin(attitude.tilt)
            * math.sin(0.5 * turned)
        )
        return rolled, MOST_ROLLED * math.hypot(*self.contact.point)

    def refusal(self) -> InfeasibleTaskError:
        """Return the error that says what the nearest miss lacked."""
        task = self.plan.task
        return InfeasibleTaskError(
            f"{task.source or task.name}: robots: the {self.kin.facts.name} has no "
            "joint path "
            f"along the contact: {self.misses[0].why}"
        )

    def _moves(self, force: bool) -> Iterator[Move]:
        """Yield the moves that keep off limits, upright ones first, each time the best
        first.
        """
        if self.contact is None:
            yield Move.of(
                self.kin,
                Posture(
                    UPRIGHT, 0.0, np.repeat(self.start[None], len(self.objects), 0)
                ),
            )
            return
        if self.stays:
            axes = self.plan.task.support.frame.axes
            found, failed = held_on(self.kin, self.tip, self.start, axes, force=force)
            self.misses += failed
            yield from found
            return
        stretched: list[Move] = []
        for held in (self.attitudes[:1], self.attitudes[1:]):  # the preferred one first
            found, worse, failed = moves(self.kin, self.tip, held, force=force)
            self.misses = self.misses + failed
            stretched = stretched + worse
            yield from found
        yield from stretched

    def _with_clearance(self, miss: Miss) -> Miss:
        """Return a miss of what the joints can do with what it lacks of clearance
        besides.
        """
        clear, _ = self.model.least(miss.posture.q, self.objects, touching=True)
        return replace(miss, short=max(miss.short, 10.0 * (CLEARANCE - clear)))

    def _refined(self, miss: Miss) -> Move | None:
        """Return an allowed move near a missed one, drawn back from the object as well,
        or None.
        """
        tip = self.tip
        posture = miss.posture
        before = 3
        first = tip.positions[0]
        gap = min(LEAST_GAP, self.plan.task.motion.approach_distance)
        back = np.linspace(first - gap * np.array(self.normal), first, before + 1)[:-1]
        whole = TipPath(
            np.concatenate([back, tip.positions]),
            np.concatenate([np.repeat(tip.yaws[:1], before), tip.yaws]),
            [*self.objects[:1] * before, *self.objects],
        )
        guess = replace(
            posture,
            q=np.concatenate([np.repeat(posture.q[:1], before, axis=0), posture.q]),
        )
        found = refined_move(
            self.kin, self.model, whole, guess, JOINT_MARGIN, CLEARANCE
        )
        if found is None:
            return None
        move = Move.of(self.kin, replace(found, q=found.q[before:]))
        return move if move.allowed else None

    def _clear(self, model: ClearanceModel, way: Array) -> tuple[float, str]:
        """Least distance on the way to the object, and between what."""
        return model.least(way, self.objects[:1] * len(way), touching=False)

    def _free(self, model: ClearanceModel, q: Array) -> bool:
        return self._clear(model, q[None])[0] >= CLEARANCE

    def _joint_path(
        self, move: Move, times: Array, way: Array, clear: float, gap: float
    ) -> JointPath:
        posture = move.posture
        return JointPath(
            times,
            way,
            self.arc_length,
            posture.q,
            posture.offset,
            move.margin,
            move.condition,
            clear,
            gap,
        )


def _diverse(misses: list[Miss]) -> list[Miss]:
    """Return the nearest of near misses, not too like each other."""
    out: list[Miss] = []
    for miss in misses:
        if not any(miss.posture.like(chosen.posture) for chosen in out):
            out.append(miss)
    return out[:REFINED]


def _near(pair: str, clear: float) -> str:
    return f"{pair} come as near as {clear * 1e3:.1f} mm, allowed from {CLEARANCE * 1e3:.0f} mm"


def _body_path(plan: Plan) -> tuple[Array, list[Pose2]]:
    """Return arc lengths (k,) [m] over all stretches of ``plan``, and X_WB there."""
    lengths: list[float] = []
    bodies: list[Pose2] = []
    done = 0.0
    for stretch in plan.segments:
        length = stretch.path.length
        X_VB = stretch.X_BV.inverse()
        turned = sum(
            abs(b.yaw - a.yaw) for (_, a), (_, b) in pairwise(stretch.path.starts)
        )
        count = max(8, math.ceil((length + TURN_ARM * turned) / STEP))
        grid = np.linspace(0.0, length, count + 1)[0 if not lengths else 1 :]
        lengths += [done + float(s) for s in grid]
        bodies += [stretch.path.pose(float(s)).compose(X_VB) for s in grid]
        done += length
    return np.array(lengths), bodies
