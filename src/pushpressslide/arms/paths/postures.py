"""Moves of an arm whose tip follows a contact, and the shortfalls of postures that
fail.

Candidates come from a grid of tool attitudes and are followed by continuation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import Matrix3
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.inverse import (
    POSITION_TOLERANCE,
    IkSolution,
    default_seeds,
    solve_ik,
)
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.reach import REACH_MARGIN
from pushpressslide.robots.tool import SIDES, TOOL_TILTS, ToolAttitude

ToolOption = tuple[ToolAttitude, Array]  # with tool yaw offsets (b,) [rad]
HeldTool = tuple[ToolAttitude, float]  # with one tool yaw offset [rad]

# [rad] least distance to every joint limit, as in the reach check of the selection
JOINT_MARGIN = REACH_MARGIN
# condition number of the 6 x n Jacobian in rad and m; a singularity is near beyond it
CONDITION_LIMIT = 100.0
GOOD_CONDITION = 60.0  # a stretched arm, whose tip is harder to control, exceeds it
ENOUGH = 6  # best candidates of each attitude that are returned
HELD = 0.1  # [rad] largest deviation of any joint of an arm that keeps its contact
LARGEST_STEP = 0.3  # [rad] of any joint between two samples
GLANCE = 3  # every third sample is followed before all of them are
# [rad] tool yaw minus object yaw
YAW_OFFSETS = np.linspace(-math.pi, math.pi, 24, endpoint=False)
YAW_APART = 0.6  # [rad] tools whose yaws differ by less are held alike
POSE = 6  # joints that a free choice of the tool's orientation takes
LEANING = math.radians(95.0)  # largest lean of a turning tool from behind the contact


@dataclass(frozen=True)
class TipPath:
    """Path of a tip in contact, as k samples."""

    positions: Array  # (k, 3) [m] of the tip's centre
    yaws: Array  # (k,) [rad] of the object
    objects: Sequence[Pose2]  # X_WG


@dataclass(frozen=True)
class Posture:
    """Joint positions with which an arm follows a tip path."""

    attitude: ToolAttitude
    offset: float  # [rad] tool yaw minus object yaw
    q: Array  # (k, n)

    def resembles(self, other: Posture) -> bool:
        """Whether the tool attitude is similar to that of another posture."""
        mine = self.attitude
        theirs = other.attitude
        turn = self.offset - other.offset
        # the direction of the lean counts, whichever side of the tool leans
        if mine.turns and theirs.turns:
            return (
                mine.tilt == theirs.tilt
                and _size(turn + mine.azimuth - theirs.azimuth) < YAW_APART
            )
        return mine == theirs and _size(turn) < YAW_APART


def _size(angle: float) -> float:
    return abs(math.remainder(angle, math.tau))


@dataclass(frozen=True)
class Move:
    """A posture along the contact, with the figures of its evaluation."""

    posture: Posture
    margin: float  # [rad] least, to a joint limit
    condition: float  # largest, of the Jacobian
    step: float  # [rad] largest, of any joint between two samples
    turn: float  # [rad] largest, of any joint from home to the first sample

    @classmethod
    def from_posture(cls, kin: ArmKinematics, posture: Posture) -> Move:
        """Move along the contact in a posture, with its margins and its condition
        number computed.
        """
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
        """Whether all figures are within their limits. The tip's error is not checked."""
        return (
            self.margin >= JOINT_MARGIN
            and self.condition < CONDITION_LIMIT
            and self.step <= LARGEST_STEP
        )

    @property
    def score(self) -> float:
        """Figure of merit: saturated joint margin, minus penalties for nearness to a
        singularity, for tilt and for distance from home.
        """
        safe = min(self.margin, 0.4) - 0.01 * self.condition
        return safe - 0.15 * self.posture.attitude.tilt - 0.05 * self.turn


@dataclass(frozen=True)
class Miss:
    """A posture that is not feasible, with its shortfall and the reason."""

    # mean violation over the path, in radians and tenths of a metre
    shortfall: float
    reason: str
    posture: Posture
    in_approach: bool = False  # only the approach fails; the contact path is allowed
    drawn_back: bool = True  # False: the tip cannot be drawn back from its contact


def tool_attitude(
    kin: ArmKinematics, q: Array, axes: Matrix3
) -> tuple[ToolAttitude, float]:
    """Tool attitude about a support's ``axes``, and its yaw [rad], in posture ``q``
    (n,).
    """
    R = np.asarray(kin.tip_pose(q)[0])
    x, y, z = R[:, 2] @ np.array(axes)
    tilt = math.acos(min(max(-z, 0.1), 1.0))
    attitude = ToolAttitude(tilt, math.atan2(y, x), axes)
    return attitude, float(attitude.yaw(R))


def continued_moves(
    kin: ArmKinematics, tip: TipPath, q: Array, axes: Matrix3, *, force: bool
) -> list[Move | Miss]:
    """Move along a tip path that starts in posture ``q`` (n,), or the miss."""
    attitude, yaw = tool_attitude(kin, q, axes)
    held = [(attitude, yaw - float(tip.yaws[0]))]
    allowed, misses = _followed(kin, tip, held, q[None], force)
    outcome = allowed[0] if allowed else misses[0]
    posture = outcome.posture
    off = float(np.abs(posture.q[0] - q).max())
    if off > HELD and not force:
        reason = f"the arm that holds on is elsewhere: a joint is {off:.2f} rad off, allowed {HELD:g}"
        return [Miss(off, reason, posture)]
    return [outcome]


def moves(
    kin: ArmKinematics, tip: TipPath, options: Sequence[ToolOption], *, force: bool
) -> tuple[list[Move], list[Move], list[Miss]]:
    """Good moves along a tip path, ill-conditioned moves, and misses.

    Good moves are grouped by attitude in the order of ``options``, with the best of
    each group first. All options are followed at once. With ``force``, no move is
    refused for exceeding a limit.
    """
    held = [(tool, float(offset)) for tool, offsets in options for offset in offsets]
    turning = [pair for pair in held if pair[0].turns]
    if turning:  # there are many: only those that also reach the end are followed
        reached = iter(_first_postures(kin, tip, -1, turning).converged)
        held = [pair for pair in held if not pair[0].turns or next(reached)]
    if not held:
        return [], [], []
    starts = _first_postures(kin, tip, 0, held).q
    allowed, misses = _followed(kin, tip, held, starts, force)
    stretched = [move for move in allowed if move.condition >= GOOD_CONDITION]
    good = [move for move in allowed if move.condition < GOOD_CONDITION]
    best = list[Move]()
    for tool, _ in options:
        alike = (move for move in good if move.posture.attitude == tool)
        best += islice(alike, ENOUGH)
    return best, stretched[:ENOUGH], misses


def _first_postures(
    kin: ArmKinematics, tip: TipPath, i: int, tools: Sequence[HeldTool]
) -> IkSolution:
    """Postures at sample ``i`` of a tip path, one for each of b tool attitudes.

    For an arm with ``home_first``, a posture that continues the ready posture comes
    first: in others the elbow may be below the table.
    """
    yaw = tip.yaws[i]
    rotations = np.array([tool.rotation_at(yaw + offset) for tool, offset in tools])
    rotations = rotations.reshape(-1, 3, 3)
    positions = np.tile(tip.positions[i], (len(tools), 1))
    search = partial(solve_ik, kin, positions, rotations, joint_margin=JOINT_MARGIN)
    if not kin.facts.home_first:
        return search()
    near = search(q_seed=default_seeds(kin, positions)[:, :1])
    return near if near.converged.all() else near.or_else(search())


def _followed(
    kin: ArmKinematics,
    tip: TipPath,
    tools: Sequence[HeldTool],
    start_postures: Array,
    force: bool,
) -> tuple[list[Move], list[Miss]]:
    """Moves and misses along a tip path with b tool attitudes from postures (b, n),
    best first.

    Attitudes that miss a coarse path by far are not followed on the fine one.
    """
    k = len(tip.yaws)
    coarse = np.unique(np.append(np.arange(0, k, GLANCE), k - 1))
    lost: list[Miss] = []
    if not force and k > GLANCE:
        near = []
        paths = _continued(kin, tip, coarse, tools, start_postures)
        for i, path in enumerate(paths):
            if path.lost:
                lost.append(_lost(tip, coarse, tools[i], path))
            else:
                near.append(i)
        tools = [tools[i] for i in near]
        start_postures = start_postures[near]
    allowed = []
    misses = []
    paths = _continued(kin, tip, np.arange(k), tools, start_postures)
    for (tool, offset), path in zip(tools, paths, strict=True):
        posture = Posture(tool, offset, path.q)
        if force or (path.ok and path.condition < CONDITION_LIMIT):
            allowed.append(Move.from_posture(kin, posture))
        else:
            reason = problem_text(path, tip.positions)
            misses.append(Miss(shortfall(path), reason, posture))
    return sorted(allowed, key=lambda move: -move.score), misses + lost


def _continued(
    kin: ArmKinematics,
    tip: TipPath,
    samples: NDArray[np.intp],
    tools: Sequence[HeldTool],
    start_postures: Array,
) -> Sequence[Continuation]:
    """Joint paths of b tool attitudes along some samples of a tip path, from postures
    (b, n).
    """
    if not tools:
        return ()
    yaws = tip.yaws[samples] + np.array([offset for _, offset in tools])[:, None]
    attitudes = [tool for tool, _ in tools]
    step = LARGEST_STEP * float(np.diff(samples).max())
    return continuations(
        kin, tip.positions[samples], yaws, start_postures, attitudes, JOINT_MARGIN, step
    )


def _lost(
    tip: TipPath, samples: NDArray[np.intp], tools: HeldTool, path: Continuation
) -> Miss:
    """Miss for a tool attitude that is far off the tip path at some ``samples``."""
    tool, offset = tools
    every = np.arange(len(tip.yaws))
    q = np.column_stack([np.interp(every, samples, column) for column in path.q.T])
    reason = problem_text(path, tip.positions[samples])
    return Miss(shortfall(path), reason, Posture(tool, offset, q))


def shortfall(path: Continuation, count: int | None = None) -> float:
    """Mean limit violation of a path, or of its first ``count`` samples."""
    steps = np.append(0.0, np.abs(np.diff(path.q, axis=0)).max(axis=1))
    violation = (
        10.0 * path.position_residual
        + path.angle_residual
        + np.maximum(0.0, JOINT_MARGIN - path.joint_margins)
        + np.maximum(0.0, steps - LARGEST_STEP)
        + 0.1 * np.clip(path.conditions / CONDITION_LIMIT - 1.0, 0.0, 1.0)
    )
    return float(violation[:count].mean())


def problem_text(path: Continuation, positions: Array) -> str:
    """Reason in one line why a path is not feasible."""
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
        if path.position_residual[i] <= POSITION_TOLERANCE:
            angle = math.degrees(path.angle_residual[i])
            return f"{angle:.1f} deg short of the tool's attitude {place}"
        return f"{path.position_residual[i] * 1e3:.1f} mm short of reach {place}"
    turn = float(np.abs(path.q[i] - path.q[i - 1]).max())
    return f"a joint turns by {turn:.2f} rad in one step {place}, allowed {LARGEST_STEP:.2f}"


def tool_options(
    azimuths: Sequence[float], yaw: float, axes: Matrix3, *, rolls: bool
) -> list[ToolOption]:
    """Tool attitudes with their yaw offsets (b,) [rad], the preferred first.

    The tip may lean towards ``azimuths`` [rad] while the object is at ``yaw`` [rad], in
    the middle of its path. ``axes`` are those of the support. With ``rolls``, a tool
    with a constant lean would roll its tip over the object; tools that turn with the
    object are then preferred.
    """
    fixed = [
        (ToolAttitude(tilt, azimuth, axes), YAW_OFFSETS)
        for tilt in TOOL_TILTS[1:]
        for azimuth in azimuths
    ]
    turning = [
        (
            ToolAttitude(tilt, side, axes, turns=True),
            _offsets_behind(side, yaw, azimuths),
        )
        for tilt in TOOL_TILTS[1 if rolls else 2 :]
        for side in SIDES
    ]
    upright = (ToolAttitude(0.0, azimuths[0], axes), YAW_OFFSETS)
    if rolls:
        return [upright, *turning, *fixed]
    return [upright, *fixed, *turning]


def _offsets_behind(side: float, yaw: float, azimuths: Sequence[float]) -> Array:
    """Yaw offsets [rad] at which a tool that turns with the object leans back from its
    contact.
    """
    off = np.array(
        [
            [math.remainder(o + side + yaw - a, math.tau) for a in azimuths]
            for o in YAW_OFFSETS
        ]
    )
    out: Array = YAW_OFFSETS[np.abs(off).min(axis=1) < LEANING]
    return out
