"""Ways of holding an arm while its tip follows a contact: candidates from a grid, by
continuation, and how far from allowed the others are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import Matrix3
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.inverse import IkSolution, solve_ik
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.reach import REACH_MARGIN
from pushpressslide.robots.tool import SIDES, TOOL_TILTS, ToolAttitude

Held = tuple[ToolAttitude, Array]  # with tool yaw offsets (b,)

# [rad] kept from every joint limit, as the reach check of the selection does
JOINT_MARGIN = REACH_MARGIN
# of the 6 x n Jacobian in rad and m: beyond it a singularity is near
CONDITION_LIMIT = 100.0
GOOD_CONDITION = 60.0  # that a stretched arm's is beyond, whose tip is harder to lead
ENOUGH = 6  # best candidates of each attitude that are handed on
HELD = 0.1  # [rad] of any joint of an arm that holds on, from where its contact is
LARGEST_STEP = 0.3  # [rad] of any joint between two samples
# [rad] tool yaw minus object yaw
YAW_OFFSETS = np.linspace(-math.pi, math.pi, 24, endpoint=False)
YAW_APART = 0.6  # [rad] between the yaws of tools that are not held alike
POSE = 6  # joints that can hold the tool any way; an arm with fewer keeps it upright
LEANING = math.radians(95.0)  # from behind the contact, of a turning tool


@dataclass(frozen=True)
class TipPath:
    """What a tip in contact has to follow, as k samples."""

    positions: Array  # (k, 3) [m] of the tip's centre
    yaws: Array  # (k,) [rad] of the object
    objects: Sequence[Pose2]  # X_WG


@dataclass(frozen=True)
class Posture:
    """How an arm follows a tip path."""

    attitude: ToolAttitude
    offset: float  # [rad] tool yaw minus object yaw
    q: Array  # (k, n)

    def like(self, other: Posture) -> bool:
        """Whether the tool is held much as in another."""
        mine = self.attitude
        theirs = other.attitude
        turn = self.offset - other.offset
        # the same leaning counts, whichever side of the tool leans
        if mine.turns and theirs.turns:
            return (
                mine.tilt == theirs.tilt
                and _turned(turn + mine.azimuth - theirs.azimuth) < YAW_APART
            )
        return mine == theirs and _turned(turn) < YAW_APART


def _turned(angle: float) -> float:
    return abs(math.remainder(angle, math.tau))


@dataclass(frozen=True)
class Move:
    """A posture with the figures that it is judged by."""

    posture: Posture
    margin: float  # [rad] least, to a joint limit
    condition: float  # largest, of the Jacobian
    step: float  # [rad] largest, of any joint between two samples
    turn: float  # [rad] of the joint that has to turn most on the way from home

    @classmethod
    def of(cls, kin: ArmKinematics, posture: Posture) -> Move:
        """Return the move with its figures."""
        q = posture.q
        return cls(
            posture,
            float(kin.joint_margin(q).min()),
            float(np.linalg.cond(kin.jacobian(q)).max()),
            float(np.abs(np.diff(q, axis=0)).max()),
            float(np.abs(q[0] - kin.facts.home).max()),
        )

    @property
    def allowed(self) -> bool:
        """Whether every figure is; the tip is not looked at."""
        return (
            self.margin >= JOINT_MARGIN
            and self.condition < CONDITION_LIMIT
            and self.step <= LARGEST_STEP
        )

    @property
    def score(self) -> float:
        """Joint margin and distance from singularity, saturated where more is of no
        use; upright and near home preferred.
        """
        safe = min(self.margin, 0.4) - 0.01 * min(self.condition, 40.0)
        return safe - 0.15 * self.posture.attitude.tilt - 0.05 * self.turn


@dataclass(frozen=True)
class Miss:
    """A posture that is not allowed."""

    short: float  # by how much: mean over the path, in radians and tenths of a metre
    why: str
    posture: Posture
    on_the_way: bool = False  # to the object; what comes after is good


def held_at(kin: ArmKinematics, q: Array, axes: Matrix3) -> tuple[ToolAttitude, float]:
    """Return how the tool is held in posture ``q`` (n,) about a support's ``axes``, and
    its yaw [rad].
    """
    R = np.asarray(kin.tip_pose(q)[0])
    x, y, z = R[:, 2] @ np.array(axes)
    attitude = ToolAttitude(math.acos(min(max(-z, 0.1), 1.0)), math.atan2(y, x), axes)
    return attitude, float(attitude.yaw(R))


def held_on(
    kin: ArmKinematics, tip: TipPath, q: Array, axes: Matrix3, *, force: bool
) -> tuple[list[Move], list[Miss]]:
    """Return the way of following a tip path that begins in posture ``q`` (n,), or else
    what it lacks.
    """
    attitude, yaw = held_at(kin, q, axes)
    found, misses = _followed(
        kin, tip, [(attitude, yaw - float(tip.yaws[0]))], q[None], force
    )
    posture = [*(move.posture for move in found), *(miss.posture for miss in misses)][0]
    off = float(np.abs(posture.q[0] - q).max())
    if off > HELD and not force:
        why = f"the arm that holds on is elsewhere: a joint is {off:.2f} rad off, allowed {HELD:g}"
        return [], [Miss(off, why, posture)]
    return found, misses


def moves(
    kin: ArmKinematics, tip: TipPath, held: Sequence[Held], *, force: bool
) -> tuple[list[Move], list[Move], list[Miss]]:
    """Return the allowed ways of following a tip path, those of each attitude best
    first; those with a worse condition, best first; and the others. All are followed at
    once; ``force`` allows all.
    """
    each = [
        (attitude, float(offset)) for attitude, offsets in held for offset in offsets
    ]
    turning = [of for of in each if of[0].turns]
    if turning:  # many are tried: those that reach the end too
        reached = iter(_held(kin, tip, -1, turning).converged)
        each = [of for of in each if not of[0].turns or next(reached)]
    if not each:
        return [], [], []
    found, misses = _followed(kin, tip, each, _held(kin, tip, 0, each).q, force)
    good = list[Move]()
    worse = [move for move in found if move.condition >= GOOD_CONDITION]
    for of, _ in held:
        alike = (
            move
            for move in found
            if move.posture.attitude == of and move.condition < GOOD_CONDITION
        )
        good += islice(alike, ENOUGH)
    return good, worse[:ENOUGH], misses


def _held(
    kin: ArmKinematics, tip: TipPath, i: int, each: Sequence[tuple[ToolAttitude, float]]
) -> IkSolution:
    """Postures at one sample of a tip path, of b attitudes with their tool yaw offsets."""
    rotations = np.array(
        [held.rotation_at(tip.yaws[i] + offset) for held, offset in each]
    ).reshape(-1, 3, 3)
    place = np.tile(tip.positions[i], (len(each), 1))
    return solve_ik(kin, place, rotations, joint_margin=JOINT_MARGIN)


def _followed(
    kin: ArmKinematics,
    tip: TipPath,
    each: Sequence[tuple[ToolAttitude, float]],
    starts: Array,
    force: bool,
) -> tuple[list[Move], list[Miss]]:
    """Follow a tip path with b attitudes and their tool yaw offsets from postures (b,
    n).
    """
    yaws = tip.yaws + np.array([offset for _, offset in each])[:, None]
    attitudes = [attitude for attitude, _ in each]
    paths = continuations(
        kin, tip.positions, yaws, starts, attitudes, JOINT_MARGIN, LARGEST_STEP
    )
    found = []
    misses = []
    for (attitude, offset), path in zip(each, paths, strict=True):
        posture = Posture(attitude, offset, path.q)
        if force or (path.ok and path.condition < CONDITION_LIMIT):
            found.append(Move.of(kin, posture))
        else:
            misses.append(Miss(shortfall(path), problem(path, tip.positions), posture))
    return sorted(found, key=lambda move: -move.score), misses


def shortfall(path: Continuation, count: int | None = None) -> float:
    """Return how far a path, or its first ``count`` samples, is from allowed: a mean
    over them.
    """
    steps = np.append(0.0, np.abs(np.diff(path.q, axis=0)).max(axis=1))
    short = (
        10.0 * path.position_residual
        + path.angle_residual
        + np.maximum(0.0, JOINT_MARGIN - path.joint_margins)
        + np.maximum(0.0, steps - LARGEST_STEP)
        + 0.1 * np.clip(path.conditions / CONDITION_LIMIT - 1.0, 0.0, 1.0)
    )
    return float(short[:count].mean())


def problem(path: Continuation, positions: Array) -> str:
    """Return in one line what is wrong with a path that is not allowed."""
    if path.failed_at is None:
        return f"condition number {path.condition:.0f} of the Jacobian, allowed below {CONDITION_LIMIT:.0f}"
    i = path.failed_at
    x, y, z = positions[i]
    place = f"with the tip at ({x:.3f}, {y:.3f}, {z:.3f})"
    if path.status == "joint_limit":
        return (
            f"a joint {path.joint_margins[i]:.3f} rad inside its limit {place}, "
            f"allowed from {JOINT_MARGIN:g}"
        )
    if path.status == "unreachable":
        return f"{path.position_residual[i] * 1e3:.1f} mm short of reach {place}"
    turn = float(np.abs(path.q[i] - path.q[i - 1]).max())
    return f"a joint turns by {turn:.2f} rad in one step {place}, allowed {LARGEST_STEP:.2f}"


def attitudes(
    azimuths: Sequence[float], yaw: float, axes: Matrix3, *, rolls: bool
) -> list[Held]:
    """Return the ways of holding the tool with their yaw offsets (b,), the preferred
    first.

    ``azimuths`` [rad] to which the tip may lean when the object is at ``yaw`` [rad], in
    the middle of its path; ``axes`` are the support's. ``rolls``: a tool that leans one
    way all the time would roll its tip over the object, so that one which turns with it
    is preferred.
    """
    tilted = [(tilt, azimuth) for tilt in TOOL_TILTS[1:] for azimuth in azimuths]
    fixed = [(ToolAttitude(*held, axes), YAW_OFFSETS) for held in tilted]
    turning = []
    for tilt in TOOL_TILTS[1 if rolls else 2 :]:
        for side in SIDES:
            off = np.array(
                [
                    [math.remainder(o + side + yaw - a, math.tau) for a in azimuths]
                    for o in YAW_OFFSETS
                ]
            )
            near = np.abs(off).min(axis=1) < LEANING
            turning.append(
                (ToolAttitude(tilt, side, axes, turns=True), YAW_OFFSETS[near])
            )
    upright = (ToolAttitude(0.0, azimuths[0], axes), YAW_OFFSETS)
    return [upright, *turning, *fixed] if rolls else [upright, *fixed, *turning]
