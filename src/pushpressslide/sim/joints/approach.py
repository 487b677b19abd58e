"""Ways of an arm from its ready posture to the place beside the object, where the touch
begins.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import JointPath
from pushpressslide.core.task import Task
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.facts import RobotFacts
from pushpressslide.robots.inverse import IkSearch, solve_ik
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude
from pushpressslide.sim.joints.connect import connect
from pushpressslide.sim.joints.postures import held_at

APPROACH_SPEED = 1.2  # [rad/s] of the fastest joint in free space
SLIDE_SPEED = 0.4  # [m/s] of the fastest slide
DESCENT_SPEED = 0.15  # [m/s] of the tip
HOVER_ROOM = 0.06  # [m] above all tops before the tip goes down beside the object
DESCENT_MARGIN = 0.03  # [rad] kept from the joint limits on the way down
FASTEST = 1.875  # times the mean speed: the middle of a minimum-jerk move
FINEST = 0.04  # [rad] or [m] of any joint between two postures of a way
DRAWN = 480
# postures to begin with where the ready one is not free; [rad] or [m] about it
SPREAD = 1.2
BACK = 11  # samples of the straight way from the contact to beside the object
LEAST_GAP = 0.015  # [m] of that way, where the arm cannot do it all

Way = tuple[Array, Array]


@dataclass(frozen=True)
class Descent:
    """The end of a way in reverse: back from the contact, as far as asked for or the
    arm can, then up.
    """

    points: Array  # (k, 3) [m] of the tip, drawn back
    back: Continuation
    needed: int  # samples of it, for the least gap
    gap: float  # [m] between the contact and the place beside the object
    # (m, n) postures from beside the object upwards; none where the gap is too small
    up: Array
    heights: Array  # (m,) [m] above the place beside the object

    def down(self, count: int) -> tuple[Array, float]:
        """Return the last ``count`` postures (count, n) down to beside the object, and
        the drop [m].
        """
        return self.up[:count][::-1], float(self.heights[count - 1])


class Approach:
    """Ways to one place: over it and down, as high as the arm can; turned first, lifted
    first, or round.
    """

    def __init__(
        self,
        task: Task,
        kin: ArmKinematics,
        free: Callable[[Array], bool],
        start: Array | None = None,
    ) -> None:
        """Choose the postures to come from: ``start`` (n,) and above it, else the ready
        one, or lifted.

        ``free`` says whether one (n,) is clear of everything.
        """
        self.task = task
        self.kin = kin
        frame = task.support.frame
        self._axes, self._up = frame.axes, np.array(frame.direction((0.0, 0.0, 1.0)))
        # [m] of the support along ``_up``
        self._level = float(np.dot(frame.origin, self._up))
        tops = [task.object.shape.height, *(o.size[2] for o in task.obstacles)]
        self.hover = (
            max(tops) + HOVER_ROOM + max(robot.tip_radius for robot in task.robots)
        )
        # [m/s] beside the object
        self._rise_speed = math.inf if start is None else DESCENT_SPEED
        if start is not None:
            risen = self._risen(start)
            self._rises = [
                risen[:count]
                for count in dict.fromkeys((len(risen), (len(risen) + 1) // 2, 1))
            ]
            return
        home = kin.facts.home
        lifted = self._lifted(home)
        ready = (
            q for q in chain((home, lifted), self._high()) if q is not None and free(q)
        )
        first = next(ready, home)
        self._rises = [first[None]]
        if lifted is not None and lifted is not first:
            self._rises.append(np.stack([first, lifted]))

    def descent(
        self,
        first: Array,
        yaw: float,
        normal: Vector3,
        q: Array,
        attitude: ToolAttitude,
        least_gap: float = LEAST_GAP,
    ) -> Descent:
        """Return the last part of every way to ``first`` (3,), seen from its end.

        ``first`` [m] is the tip at the touch, in posture ``q`` (n,) at tool yaw
        ``yaw``; ``normal`` points from the tip into the object; ``least_gap`` [m] is
        what the tip must be drawn back at least.
        """
        wanted = self.task.motion.approach_distance
        points = np.linspace(first, first - wanted * np.array(normal), BACK)
        back = self._follow(points, yaw, q, attitude)
        gap = wanted * (_reached(back) - 1) / (BACK - 1)
        needed = 1 + math.ceil((BACK - 1) * min(1.0, least_gap / wanted))
        if _reached(back) < needed:
            return Descent(
                points, back, needed, gap, np.zeros((0, len(q))), np.zeros(0)
            )
        beside = points[_reached(back) - 1]
        at = back.q[_reached(back) - 1]
        height = self._height(beside)
        levels = _levels(height, max(self.hover, height + 0.08))
        rise = self._follow(
            beside + (levels - height)[:, None] * self._up, yaw, at, attitude
        )
        count = _reached(rise)
        return Descent(
            points, back, needed, gap, rise.q[:count], levels[:count] - height
        )

    def _follow(
        self, points: Array, yaw: float, q: Array, attitude: ToolAttitude
    ) -> Continuation:
        yaws = np.full((1, len(points)), yaw)
        return continuations(self.kin, points, yaws, q[None], attitude, DESCENT_MARGIN)[
            0
        ]

    def ways(self, descent: Descent) -> Iterator[Way]:
        """Yield times (m,) and postures (m, n) of ways to beside the object, the most
        careful first.
        """
        high = len(descent.up)
        for count in dict.fromkeys((high, (high + 1) // 2, 1)) if high else ():
            down = descent.up[count - 1]
            for rise in self._rises:
                yield self._timed(rise, [rise[-1], down], descent, count)
                if self.kin.facts.moving[0].kind == "revolute":
                    turned = rise[-1].copy()
                    turned[0] = down[0]
                    yield self._timed(rise, [rise[-1], turned, down], descent, count)

    def ways_round(
        self, descent: Descent, free: Callable[[Array], bool]
    ) -> Iterator[Way]:
        """Yield ways that are searched for, where ``free`` says whether a posture is
        clear of everything.
        """
        facts = self.kin.facts
        high = len(descent.up)
        for count in dict.fromkeys((high, 1)) if high else ():
            for rise in self._rises:
                found = connect(
                    rise[-1], descent.up[count - 1], free, facts.lower, facts.upper
                )
                if found is not None:
                    yield self._timed(rise, list(found), descent, count)

    def _height(self, place: Array) -> float:
        """Height [m] of a place (3,) above the support."""
        return float(place @ self._up) - self._level

    def _lifted(self, home: Array) -> Array | None:
        """The ready posture with its tip straight above, higher than everything; None
        where it cannot be.
        """
        p = np.asarray(self.kin.tip_pose(home)[1])
        rise = self.hover - self._height(p)
        if rise <= 0.0:
            return None
        upright = ToolAttitude(axes=self._axes)
        found = solve_ik(
            self.kin,
            p + rise * self._up,
            upright,
            q_seed=home,
            search=IkSearch(first_found=True),
        )
        return np.asarray(found.q[0]) if found.converged[0] else None

    def _risen(self, start: Array) -> Array:
        """Postures (k, n) straight up from ``start``, as high as need be or the arm
        can.
        """
        p = np.asarray(self.kin.tip_pose(start)[1])
        height = self._height(p)
        levels = _levels(height, max(self.hover, height + 0.08))
        attitude, yaw = held_at(self.kin, start, self._axes)
        rise = self._follow(
            p + (levels - height)[:, None] * self._up, yaw, start, attitude
        )
        return np.concatenate([start[None], rise.q[1 : _reached(rise)]])

    def _high(self) -> Iterator[Array]:
        """Postures about the ready one with the tip high up, spread over the joints;
        always the same.
        """
        facts = self.kin.facts
        rng = np.random.default_rng(0)
        spread = SPREAD * (2.0 * rng.random((DRAWN, facts.size)) - 1.0)
        drawn = np.clip(facts.home + spread, facts.lower + 0.1, facts.upper - 0.1)
        yield from drawn[
            np.asarray(self.kin.tip_pose(drawn)[1]) @ self._up
            > self._level + self.hover
        ]

    def _timed(
        self, rise: Array, corners: list[Array], descent: Descent, count: int
    ) -> Way:
        """Return times and postures: up, from rest to rest from corner to corner, and
        down.
        """
        bottom, top = (
            self._height(np.asarray(self.kin.tip_pose(q)[1]))
            for q in (rise[0], rise[-1])
        )
        down, drop = descent.down(count)
        legs = [(rise, (top - bottom) / self._rise_speed)]
        legs += [(np.stack(pair), 0.0) for pair in pairwise(corners)]
        legs.append((down, drop / DESCENT_SPEED))
        times = [np.zeros(1)]
        postures = [rise[:1]]
        for leg, least in legs:
            if len(leg) < 2:
                continue
            span, way = rest_to_rest(self.kin.facts, leg, least)
            times.append(times[-1][-1] + span * np.linspace(0.0, 1.0, len(way))[1:])
            postures.append(way[1:])
        return np.concatenate(times), np.concatenate(postures)


def rest_to_rest(
    facts: RobotFacts, corners: Array, least: float = 0.0
) -> tuple[float, Array]:
    """Return the time [s] and the postures (m, n) of one leg through ``corners`` (k,
    n), minimum jerk: as fast as the joints may, at a mean speed for ``least`` [s] or
    slower.
    """
    slides = np.array([joint.kind == "prismatic" for joint in facts.moving])
    speeds = np.where(slides, SLIDE_SPEED, APPROACH_SPEED)
    rates = (len(corners) - 1) * np.abs(np.diff(corners, axis=0)).max(axis=0)
    blend = _blend(max(50, math.ceil(FASTEST * float(rates.max()) / FINEST)))
    span = max(0.5, FASTEST * float(np.max(rates / speeds)), FASTEST * least)
    grid = np.linspace(0.0, 1.0, len(corners))
    return span, np.column_stack(
        [np.interp(blend, grid, column) for column in corners.T]
    )


def led_in(
    paths: Sequence[JointPath], facts: Sequence[RobotFacts], postures: Sequence[Array]
) -> list[JointPath]:
    """Return each arm's path with a way from its posture (n,) [rad] to where the path
    begins before it.

    All ways take the same time, so that the arms keep clear of each other as planned.
    """
    gaps = [
        np.stack([q, path.approach[0]]) for q, path in zip(postures, paths, strict=True)
    ]
    longest = max(rest_to_rest(of, gap)[0] for of, gap in zip(facts, gaps, strict=True))
    out = []
    for path, of, gap in zip(paths, facts, gaps, strict=True):
        _, way = rest_to_rest(of, gap)
        times = np.linspace(0.0, longest, len(way))[:-1]
        out.append(
            replace(
                path,
                approach_time=np.concatenate([times, longest + path.approach_time]),
                approach=np.concatenate([way[:-1], path.approach]),
            )
        )
    return out


def _levels(low: float, high: float) -> Array:
    """Heights [m] from ``low`` to ``high`` in steps of 2 cm."""
    return np.linspace(low, high, max(4, math.ceil((high - low) / 0.02)) + 1)


def _reached(path: Continuation) -> int:
    """Samples that the arm can follow, the first taken for granted."""
    return len(path.q) if path.failed_at is None else max(1, path.failed_at)


def _blend(count: int) -> Array:
    """Minimum-jerk ramp from 0 to 1 in ``count`` samples."""
    u = np.linspace(0.0, 1.0, count)
    out: Array = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    return out
