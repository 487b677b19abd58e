"""Ways of an arm from its ready posture to the place beside the object, where the touch begins."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.control import Vector3
from pushpressslide.core.task import Task
from pushpressslide.robots.continuation import Continuation, continuations
from pushpressslide.robots.inverse import solve_ik
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude

Array = NDArray[np.float64]

APPROACH_SPEED = 1.2  # [rad/s] of the fastest joint in free space
SLIDE_SPEED = 0.4  # [m/s] of the fastest slide
DESCENT_SPEED = 0.15  # [m/s] of the tip
HOVER_ROOM = 0.06  # [m] above all tops before the tip goes down beside the object
DESCENT_MARGIN = 0.03  # [rad] kept from the joint limits on the way down
FASTEST = 1.875  # times the mean speed: the middle of a minimum-jerk move
FINEST = 0.04  # [rad] or [m] of any joint between two postures of a way
VIAS = 24  # postures that are tried between start and descent where no plain way is free
VIA_SPREAD = 1.2  # [rad] or [m] of any joint about the ready posture
DRAWN = 20 * VIAS
BACK = 11  # samples of the straight way from the contact to beside the object
LEAST_GAP = 0.015  # [m] of that way, where the arm cannot do it all

Way = tuple[Array, Array]


@dataclass(frozen=True)
class Descent:
    """The end of a way in reverse: back from the contact, as far as asked for or the arm can, then up."""

    points: Array  # (k, 3) [m] of the tip, drawn back
    back: Continuation
    needed: int  # samples of it, for the least gap
    gap: float  # [m] between the contact and the place beside the object
    up: Array  # (m, n) postures from beside the object upwards; none where the gap is too small
    heights: Array  # (m,) [m] above the place beside the object

    def down(self, count: int) -> tuple[Array, float]:
        """Return the last ``count`` postures (count, n) down to beside the object, and the drop [m]."""
        return self.up[:count][::-1], float(self.heights[count - 1])


class Approach:
    """Ways to one place: over it and down, as high as the arm can; turned first, lifted first, or round."""

    def __init__(self, task: Task, kin: ArmKinematics, free: Callable[[Array], bool]) -> None:
        """Choose the postures to come from; ``free`` says whether one (n,) is clear of everything."""
        self.task, self.kin = task, kin
        tops = [task.object.shape.height, *(o.size[2] for o in task.obstacles)]
        self.hover = max(tops) + HOVER_ROOM + max(robot.tip_radius for robot in task.robots)
        home = kin.facts.home
        vias = self._vias()
        lifted = self._lifted(home)
        starts = [q for q in (home, lifted, *vias) if q is not None and free(q)]
        self.start = starts[0] if starts else home
        plain = [self.start]
        if lifted is not None and lifted is not self.start:
            plain.append(lifted)
        self._plain = [[self.start], plain] if len(plain) > 1 else [plain]
        self._round = [[*plain, via] for via in vias if via is not self.start]

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

        ``first`` [m] is the tip at the touch, in posture ``q`` (n,) at tool yaw ``yaw``; ``normal`` points
        from the tip into the object; ``least_gap`` [m] is what the tip must be drawn back at least.
        """
        wanted = self.task.motion.approach_distance
        points = np.linspace(first, first - wanted * np.array(normal), BACK)
        back = self._follow(points, yaw, q, attitude)
        gap = wanted * (_reached(back) - 1) / (BACK - 1)
        needed = 1 + math.ceil((BACK - 1) * min(1.0, least_gap / wanted))
        if _reached(back) < needed:
            return Descent(points, back, needed, gap, np.zeros((0, len(q))), np.zeros(0))
        beside, at = points[_reached(back) - 1], back.q[_reached(back) - 1]
        height = float(beside[2])
        hover = max(self.hover, height + 0.08)
        levels = np.linspace(height, hover, max(4, math.ceil((hover - height) / 0.02)) + 1)
        rise = self._follow(
            np.column_stack([np.full((len(levels), 2), beside[:2]), levels]), yaw, at, attitude
        )
        count = _reached(rise)
        return Descent(points, back, needed, gap, rise.q[:count], levels[:count] - height)

    def _follow(self, points: Array, yaw: float, q: Array, attitude: ToolAttitude) -> Continuation:
        yaws = np.full((1, len(points)), yaw)
        return continuations(self.kin, points, yaws, q[None], attitude, DESCENT_MARGIN)[0]

    def ways(self, descent: Descent) -> Iterator[Way]:
        """Yield times (m,) and postures (m, n) of ways to beside the object, the most careful first."""
        high = len(descent.up)
        if high == 0:
            return
        for count in dict.fromkeys((high, (high + 1) // 2, 1)):
            down, drop = descent.down(count)
            for corners in self._plain:
                yield self._timed([*corners, down[0]], down, drop)
                if self.kin.facts.moving[0].kind == "revolute":
                    turned = corners[-1].copy()
                    turned[0] = down[0][0]
                    yield self._timed([*corners, turned, down[0]], down, drop)
        down, drop = descent.down(high)
        for corners in self._round:
            yield self._timed([*corners, down[0]], down, drop)

    def bent_ways(self, descent: Descent, bend: Callable[[Array, Array], Array]) -> Iterator[Way]:
        """Yield ways whose first part is a curve: ``bend(start, end)`` gives its postures (m, n)."""
        for count in dict.fromkeys((len(descent.up), min(1, len(descent.up)))):
            if count:
                down, drop = descent.down(count)
                yield self._timed_legs([bend(self.start, down[0])], down, drop)

    def _tip_height(self, q: Array) -> Array:
        return np.asarray(self.kin.tip_pose(q)[1])[..., 2]

    def _lifted(self, home: Array) -> Array | None:
        """The ready posture with its tip straight above, higher than everything; None where it cannot be."""
        p = np.asarray(self.kin.tip_pose(home)[1])
        if p[2] >= self.hover:
            return None
        found = solve_ik(self.kin, np.array([p[0], p[1], self.hover]), q_seed=home, best_margin=False)
        return np.asarray(found.q[0]) if found.converged[0] else None

    def _vias(self) -> list[Array]:
        """Postures about the ready one with the tip high up, spread over the joints; always the same."""
        facts = self.kin.facts
        spread = VIA_SPREAD * (2.0 * np.random.default_rng(0).random((DRAWN, facts.size)) - 1.0)
        drawn = np.clip(facts.home + spread, facts.lower + 0.1, facts.upper - 0.1)
        high = drawn[self._tip_height(drawn) > self.hover]
        return list(high[:VIAS])

    def _timed(self, corners: list[Array], down: Array, drop: float) -> Way:
        """Return times and postures: rest to rest from corner to corner, then down by ``drop`` [m]."""
        return self._timed_legs([np.stack(leg) for leg in pairwise(corners)], down, drop)

    def _timed_legs(self, legs: list[Array], down: Array, drop: float) -> Way:
        """Return times and postures: along each leg (k, n) from rest to rest, then down by ``drop`` [m]."""
        slides = np.array([joint.kind == "prismatic" for joint in self.kin.facts.moving])
        speeds = np.where(slides, SLIDE_SPEED, APPROACH_SPEED)
        times, postures = [np.zeros(1)], [legs[0][:1]]
        for leg in legs:
            steps = np.abs(np.diff(leg, axis=0))
            share = steps.max(axis=1) / max(float(steps.max(axis=1).sum()), 1e-12)
            rates = steps / np.maximum(share, 1e-12)[:, None]  # per unit of the leg
            blend = _blend(max(50, math.ceil(FASTEST * float(rates.max()) / FINEST)))
            span = max(0.5, FASTEST * float(np.max(rates / speeds)))
            times.append(times[-1][-1] + span * np.linspace(0.0, 1.0, len(blend))[1:])
            postures.append(_along(np.append(0.0, np.cumsum(share)), leg, blend[1:]))
        if len(down) > 1:
            blend = _blend(50)
            span = max(0.5, FASTEST * drop / DESCENT_SPEED)
            times.append(times[-1][-1] + span * np.linspace(0.0, 1.0, len(blend))[1:])
            postures.append(_along(np.linspace(0.0, 1.0, len(down)), down, blend[1:]))
        return np.concatenate(times), np.concatenate(postures)


def _reached(path: Continuation) -> int:
    """Samples that the arm can follow, the first taken for granted."""
    return len(path.q) if path.failed_at is None else max(1, path.failed_at)


def _along(grid: Array, postures: Array, at: Array) -> Array:
    """Return postures (k, n), given on ``grid`` (k,), at other places (m,)."""
    return np.column_stack([np.interp(at, grid, column) for column in postures.T])


def _blend(count: int) -> Array:
    """Minimum-jerk ramp from 0 to 1 in ``count`` samples."""
    u = np.linspace(0.0, 1.0, count)
    out: Array = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    return out
