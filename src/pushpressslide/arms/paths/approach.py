"""Approaches of an arm from its posture to the place near the object where the touch
starts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np

from pushpressslide.arms.paths.connect import Free, connect
from pushpressslide.arms.paths.postures import (
    CONDITION_LIMIT,
    JOINT_MARGIN,
    Posture,
    TipPath,
    tool_attitude,
)
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import JointPath
from pushpressslide.core.scene import Scene
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.facts import RobotFacts
from pushpressslide.robots.inverse import IkSearch, solve_ik
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude

APPROACH_SPEED = 1.2  # [rad/s] of the fastest joint in free space
SLIDE_SPEED = 0.4  # [m/s] of the fastest slide
SPEED_SHARE = 0.7  # of a joint's own limit, in free space
DESCENT_SPEED = 0.25  # [m/s] of the tip
# [m/s^2] of the tip: a stretched arm needs most of a torque to hold itself
DESCENT_ACCELERATION = 0.4
HOVER_ROOM = 0.06  # [m] above all tops, from where the tip descends beside the object
LEAST_RISE = 0.08  # [m] length of a descent if the tip is above all tops already
RISE_STEP = 0.02  # [m] of the tip between two samples of a rise
DESCENT_MARGIN = 0.03  # [rad] to the joint limits while moving down
# peak acceleration of a minimum-jerk motion, as a multiple of length over time squared
HARDEST = 10.0 / math.sqrt(3.0)
FASTEST = 1.875  # peak over mean speed of a minimum-jerk motion
FINEST = 0.04  # [rad] or [m] of any joint between two postures of a trajectory
DRAWN = 480  # random postures to begin with where the ready one is not free
SPREAD = 1.2  # [rad] or [m] of these about the ready posture
# [rad] turns of the first joint that are tried to avoid obstacles
TURNS = (0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0)
BACK = 11  # samples of the straight line from the contact to beside the object
LEAST_GAP = 0.015  # [m] smallest length of that line if the arm cannot follow all of it


@dataclass(frozen=True)
class Care:
    """Required quality of an arm's posture during the touch."""

    margin: float  # [rad] to the joint limits
    # of the Jacobian: the spring of the tip moves a stretched arm's joints by its square
    condition: float


# with which a tip follows its reference at the speed of a touch
CAREFUL = Care(DESCENT_MARGIN, 30.0)
# as along the contact, where nothing better is found
BARELY = Care(JOINT_MARGIN, CONDITION_LIMIT)


@dataclass(frozen=True)
class Trajectory:
    """Joint positions over time."""

    times: Array  # (m,) [s]
    postures: Array  # (m, n) [rad; m of slides]


@dataclass(frozen=True)
class Descent:
    """The end of an approach in reverse: from the contact back to a place near the
    object, then up.
    """

    points: Array  # (k, 3) [m] of the tip, drawn back
    retreat: Continuation  # along the points
    reached: int  # samples of it on which the arm can feel for its contact
    needed: int  # number of these for the smallest gap
    gap: float  # [m] between the contact and the place beside the object
    # (m, n) postures from beside the object upwards; none where the gap is too small
    up: Array
    heights: Array  # (m,) [m] above the place beside the object

    @property
    def touch(self) -> Array:
        """Postures (k, n), evenly spaced, from the place near the object to the
        contact.
        """
        return self.retreat.q[: self.reached][::-1]

    def down(self, count: int) -> tuple[Array, float]:
        """Last ``count`` postures (count, n) down to the place near the object, and the
        drop [m].
        """
        return self.up[:count][::-1], float(self.heights[count - 1])


class Approach:
    """Approaches of an arm: up, over the object, and down next to it.

    The rise is tried as high as the arm can go, half as high, and not at all.
    """

    def __init__(
        self,
        scene: Scene,
        kin: ArmKinematics,
        free: Free,
        before: float,
        start: Array | None = None,
    ) -> None:
        """Choose the rises from ``start`` (n,), or from the ready posture if None.

        The touch starts ``before`` [m] off the contact. ``free`` is True for a posture
        (n,) clear of everything. The ready posture may be replaced by a free one near
        it.
        """
        self.scene = scene
        self.kin = kin
        self.before = before
        frame = scene.support.frame
        self._axes = frame.axes
        self._up = np.array(frame.normal)
        # [m] of the support along ``_up``
        self._level = float(np.dot(frame.origin, self._up))
        tops = [scene.body.shape.height, *(o.shape.height for o in scene.obstacles)]
        widest = max(robot.tip_radius for robot in scene.robots)
        self.hover = max(tops) + HOVER_ROOM + widest
        # an arm that starts in free space needs no care
        self._starts_beside = start is not None
        if start is None:
            self._rises = self._ready_rises(free)
        else:
            self._rises = self._rises_from(start)

    def _rises_from(self, start: Array) -> list[Array]:
        """Rises (k, n) straight up from ``start``: full, half and none."""
        attitude, yaw = tool_attitude(self.kin, start, self._axes)
        rise, _ = self._rise(self._tip(start), yaw, start, attitude)
        rise = np.concatenate([start[None], rise[1:]])
        return [rise[:count] for count in _counts(len(rise))]

    def _ready_rises(self, free: Free) -> list[Array]:
        """Rises from the ready posture, or from a free one near it."""
        home = self.kin.facts.home
        lifted = self._lifted(home)
        ready = (
            q for q in chain((home, lifted), self._high()) if q is not None and free(q)
        )
        first = next(ready, home)
        rises = [first[None]]
        if lifted is not None and lifted is not first:
            rises.append(np.stack([first, lifted]))
        return rises

    def descent(
        self,
        tip: TipPath,
        normal: Vector3,
        posture: Posture,
        least_gap: float = LEAST_GAP,
        care: Care = CAREFUL,
    ) -> Descent:
        """Last part of every approach to the start of a tip path.

        ``normal`` points from the tip into the object, in the world. ``posture`` is the
        arm's posture along the path. The tip must be able to retreat by ``least_gap``
        [m] at least, in postures of the quality ``care``.
        """
        first = tip.positions[0]
        yaw = float(tip.yaws[0]) + posture.offset
        q = posture.q[0]
        wanted = self.before
        points = np.linspace(first, first - wanted * np.array(normal), BACK)
        retreat = self._follow(points, yaw, q, posture.attitude, care.margin)
        reached = _touching(retreat, care.condition)
        gap = wanted * (reached - 1) / (BACK - 1)
        needed = 1 + math.ceil((BACK - 1) * min(1.0, least_gap / wanted))
        up = np.zeros((0, len(q)))
        heights = np.zeros(0)
        if reached >= needed:
            beside = points[reached - 1]
            up, heights = self._rise(
                beside, yaw, retreat.q[reached - 1], posture.attitude, care.margin
            )
        return Descent(points, retreat, reached, needed, gap, up, heights)

    def _rise(
        self,
        place: Array,
        yaw: float,
        q: Array,
        attitude: ToolAttitude,
        margin: float = DESCENT_MARGIN,
    ) -> tuple[Array, Array]:
        """Postures (m, n) of a motion straight up from a place (3,), and their heights
        (m,) [m] above it.

        The motion ends at the required height, or at the largest that the arm can
        reach.
        """
        height = self._height(place)
        top = max(self.hover, height + LEAST_RISE)
        steps = max(4, math.ceil((top - height) / RISE_STEP))
        levels = np.linspace(height, top, steps + 1)
        above = place + (levels - height)[:, None] * self._up
        rise = self._follow(above, yaw, q, attitude, margin)
        count = _reached(rise)
        return rise.q[:count], levels[:count] - height

    def _follow(
        self,
        points: Array,
        yaw: float,
        q: Array,
        attitude: ToolAttitude,
        margin: float,
    ) -> Continuation:
        yaws = np.full((1, len(points)), yaw)
        (path,) = continuations(self.kin, points, yaws, q[None], attitude, margin)
        return path

    @property
    def start_posture(self) -> Array:
        """The posture (n,) at the start of every approach."""
        start: Array = self._rises[0][0]
        return start

    def direct(self, descent: Descent) -> Iterator[Trajectory]:
        """Yield approaches straight through joint space, the highest first: all joints
        at once, then the base joint before the others.
        """
        for count in _counts(len(descent.up)):
            yield from self._direct(*descent.down(count))

    def around(self, descent: Descent, free: Free) -> Iterator[Trajectory]:
        """Yield approaches around obstacles, by RRT-Connect.

        ``free`` is True for a posture (n,) clear of everything.
        """
        high = len(descent.up)
        for count in dict.fromkeys((high, 1)) if high else ():
            yield from self._around(*descent.down(count), free)

    def to(self, posture: Array, free: Free | None = None) -> Iterator[Trajectory]:
        """Yield motions to a ``posture`` (n,) away from the object: straight through
        joint space, or with ``free`` also around obstacles.
        """
        end = posture[None]
        yield from (
            self._direct(end, 0.0) if free is None else self._around(end, 0.0, free)
        )

    def high_postures(self) -> Iterator[Array]:
        """Yield postures (n,) with the tip above everything: the lifted ready posture,
        variants with the base joint turned, then random ones.
        """
        facts = self.kin.facts
        raised = facts.home
        lifted = self._lifted(raised)
        if lifted is not None:
            raised = lifted
            yield raised
        if facts.moving[0].kind == "revolute":
            for turn in TURNS:
                turned = raised.copy()
                turned[0] += turn
                if self.kin.joint_margin(turned) >= DESCENT_MARGIN:
                    yield turned
        yield from self._high()

    def _direct(self, down: Array, drop: float) -> Iterator[Trajectory]:
        """Yield the direct motions to the first of postures ``down`` (m, n), which drop
        the tip by ``drop`` [m], and along them.
        """
        for rise in self._rises:
            yield self._timed(rise, [rise[-1], down[0]], down, drop)
            if self.kin.facts.moving[0].kind == "revolute":
                turned = rise[-1].copy()
                turned[0] = down[0, 0]
                yield self._timed(rise, [rise[-1], turned, down[0]], down, drop)

    def _around(self, down: Array, drop: float, free: Free) -> Iterator[Trajectory]:
        """Yield the motions to ``down`` as in ``_direct``, by RRT-Connect."""
        facts = self.kin.facts
        for rise in self._rises:
            corners = connect(rise[-1], down[0], free, facts.lower, facts.upper)
            if corners is not None:
                yield self._timed(rise, list(corners), down, drop)

    def _tip(self, q: Array) -> Array:
        """Tip position (..., 3) [m] in postures (..., n)."""
        return np.asarray(self.kin.tip_pose(q)[1])

    def _height(self, place: Array) -> float:
        """Height [m] of a place (3,) above the support."""
        return float(place @ self._up) - self._level

    def _lifted(self, home: Array) -> Array | None:
        """Ready posture with its tip lifted above everything. None if the tip is
        already there, or the arm cannot lift it that far.
        """
        p = self._tip(home)
        rise = self.hover - self._height(p)
        if rise <= 0.0:
            return None
        upright = ToolAttitude(axes=self._axes)
        lifted = solve_ik(
            self.kin,
            p + rise * self._up,
            upright,
            q_seed=home,
            search=IkSearch(first_found=True),
        )
        if not lifted.converged[0]:
            return None
        return np.asarray(lifted.q[0])

    def _high(self) -> Iterator[Array]:
        """Yield random postures about the ready one with the tip above everything. The
        seed is fixed.
        """
        facts = self.kin.facts
        rng = np.random.default_rng(0)
        spread = SPREAD * (2.0 * rng.random((DRAWN, facts.size)) - 1.0)
        drawn = np.clip(facts.home + spread, facts.lower + 0.1, facts.upper - 0.1)
        yield from drawn[self._tip(drawn) @ self._up > self._level + self.hover]

    def _timed(
        self, rise: Array, corners: list[Array], down: Array, drop: float
    ) -> Trajectory:
        """Trajectory up, from corner to corner, and down by ``drop`` [m]. The arm stops
        at each corner.
        """
        bottom = self._height(self._tip(rise[0]))
        top = self._height(self._tip(rise[-1]))
        lift = top - bottom if self._starts_beside else 0.0
        legs = [(rise, _slow(lift))]
        legs += [(np.stack(pair), 0.0) for pair in pairwise(corners)]
        legs.append((down, _slow(drop)))
        times = [np.zeros(1)]
        postures = [rise[:1]]
        for leg, lower in legs:
            if len(leg) < 2:
                continue
            span, moved = rest_to_rest(self.kin.facts, leg, lower)
            times.append(times[-1][-1] + span * np.linspace(0.0, 1.0, len(moved))[1:])
            postures.append(moved[1:])
        return Trajectory(np.concatenate(times), np.concatenate(postures))


def rest_to_rest(
    facts: RobotFacts, corners: Array, min_duration: float = 0.0
) -> tuple[float, Array]:
    """Duration [s] and postures (m, n) of a minimum-jerk motion through ``corners`` (k,
    n).

    It is as fast as the joints allow, but no faster than a motion that takes
    ``min_duration`` [s] at constant speed.
    """
    slides = np.array([joint.kind == "prismatic" for joint in facts.moving])
    speeds = np.minimum(
        np.where(slides, SLIDE_SPEED, APPROACH_SPEED),
        SPEED_SHARE * facts.velocity_limit,
    )
    rates = (len(corners) - 1) * np.abs(np.diff(corners, axis=0)).max(axis=0)
    blend = _blend(max(50, math.ceil(FASTEST * float(rates.max()) / FINEST)))
    span = max(0.5, FASTEST * float(np.max(rates / speeds)), FASTEST * min_duration)
    grid = np.linspace(0.0, 1.0, len(corners))
    return span, np.column_stack(
        [np.interp(blend, grid, column) for column in corners.T]
    )


def led_in(
    paths: Sequence[JointPath], facts: Sequence[RobotFacts], postures: Sequence[Array]
) -> list[JointPath]:
    """Path of each arm, preceded by a motion from the arm's posture (n,) [rad] to the
    start of the path.

    These motions take the same time, so that the arms keep clear of each other as
    planned.
    """
    motions = [
        rest_to_rest(arm, np.stack([q, path.approach[0]]))
        for q, path, arm in zip(postures, paths, facts, strict=True)
    ]
    longest = max(span for span, _ in motions)
    out = []
    for path, (_, motion) in zip(paths, motions, strict=True):
        times = np.linspace(0.0, longest, len(motion))[:-1]
        out.append(
            replace(
                path,
                approach_time=np.concatenate([times, longest + path.approach_time]),
                approach=np.concatenate([motion[:-1], path.approach]),
            )
        )
    return out


def _slow(length: float) -> float:
    """Shortest time [s], at constant speed, of a careful motion of the tip along a
    straight ``length`` [m].
    """
    accelerating = math.sqrt(HARDEST * length / DESCENT_ACCELERATION) / FASTEST
    return max(length / DESCENT_SPEED, accelerating)


def _counts(high: int) -> tuple[int, ...]:
    """Numbers of samples of a rise of ``high`` to try: all, half and one."""
    if not high:
        return ()
    return tuple(dict.fromkeys((high, (high + 1) // 2, 1)))


def _reached(path: Continuation) -> int:
    """Number of samples that the arm can follow. The first is assumed reached."""
    if path.failed_at is None:
        return len(path.q)
    return max(1, path.failed_at)


def _touching(retreat: Continuation, condition: float) -> int:
    """Number of samples on which an arm can make the touch.

    An arm can follow these samples with a condition number of at most ``condition``, or
    of at most the one at the contact if that is larger.
    """
    count = _reached(retreat)
    allowed = max(condition, retreat.conditions[0])
    beyond = np.flatnonzero(retreat.conditions[:count] > allowed)
    return count if len(beyond) == 0 else int(beyond[0])


def _blend(count: int) -> Array:
    """Minimum-jerk profile from 0 to 1 in ``count`` samples."""
    u = np.linspace(0.0, 1.0, count)
    out: Array = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    return out
