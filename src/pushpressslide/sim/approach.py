"""Ways of an arm from its ready posture to the place beside the object, where the touch begins."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.control import Vector3
from pushpressslide.core.task import Task
from pushpressslide.robots.continuation import continuations
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

Way = tuple[Array, Array]


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

    def ways(
        self, first: Array, yaw: float, normal: Vector3, q: Array, attitude: ToolAttitude
    ) -> Iterator[Way]:
        """Yield times (m,) and postures (m, n) of ways to beside ``first`` (3,), the most careful first.

        ``first`` [m] is the tip at the touch, in posture ``q`` (n,) at tool yaw ``yaw``; ``normal`` points
        from the tip into the object.
        """
        frame = self.task.support.frame
        place = frame.coordinates((float(first[0]), float(first[1]), float(first[2])))
        gap = self.task.motion.approach_distance
        start = np.array(place)
        beside = start - gap * np.array(normal)
        height = float(beside[2])
        hover = max(self.hover, height + 0.08)
        back = np.linspace(0.0, 1.0, 5)[:, None] * (beside - start) + start
        levels = np.linspace(height, hover, max(4, math.ceil((hover - height) / 0.02)))[1:]
        rise = np.column_stack([np.full((len(levels), 2), beside[:2]), levels])
        points = np.concatenate([back, rise]) @ np.array(frame.axes).T + np.array(frame.origin)
        path = continuations(
            self.kin, points, np.full((1, len(points)), yaw), q[None], attitude, DESCENT_MARGIN
        )[0]
        reached = len(points) if path.failed_at is None else path.failed_at
        if reached < len(back):
            return
        for top in dict.fromkeys((reached, len(back) + (reached - len(back)) // 2, len(back))):
            down = path.q[len(back) - 1 : top][::-1]
            drop = float(levels[top - len(back) - 1] - height) if top > len(back) else 0.0
            for corners in self._plain:
                yield self._timed([*corners, down[0]], down, drop)
                if self.kin.facts.moving[0].kind == "revolute":
                    turned = corners[-1].copy()
                    turned[0] = down[0][0]
                    yield self._timed([*corners, turned, down[0]], down, drop)
        down = path.q[len(back) - 1 : reached][::-1]
        drop = float(levels[reached - len(back) - 1] - height) if reached > len(back) else 0.0
        for corners in self._round:
            yield self._timed([*corners, down[0]], down, drop)

    def _tip_height(self, q: Array) -> Array:
        frame = self.task.support.frame
        place = np.asarray(self.kin.tip_pose(q)[1]) - np.array(frame.origin)
        return np.asarray(place @ np.array(frame.axes)[:, 2])

    def _lifted(self, home: Array) -> Array | None:
        """The ready posture with its tip straight above, higher than everything; None where it cannot be."""
        frame = self.task.support.frame
        x, y, height = frame.coordinates(tuple(self.kin.tip_pose(home)[1].tolist()))
        if height >= self.hover:
            return None
        above = np.array(frame.point((x, y, self.hover)))
        upright = ToolAttitude(axes=frame.axes)
        found = solve_ik(self.kin, above, upright, q_seed=home, best_margin=False)
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
        slides = np.array([joint.kind == "prismatic" for joint in self.kin.facts.moving])
        speeds = np.where(slides, SLIDE_SPEED, APPROACH_SPEED)
        times, postures = [np.zeros(1)], [corners[0][None]]
        for a, b in pairwise(corners):
            way = np.abs(b - a)
            blend = _blend(max(50, math.ceil(FASTEST * float(way.max()) / FINEST)))
            span = max(0.5, FASTEST * float(np.max(way / speeds)))
            times.append(times[-1][-1] + span * np.linspace(0.0, 1.0, len(blend))[1:])
            postures.append(a + blend[1:, None] * (b - a))
        if len(down) > 1:
            blend = _blend(50)
            span = max(0.5, FASTEST * drop / DESCENT_SPEED)
            grid = np.linspace(0.0, 1.0, len(down))
            times.append(times[-1][-1] + span * np.linspace(0.0, 1.0, len(blend))[1:])
            postures.append(np.column_stack([np.interp(blend[1:], grid, column) for column in down.T]))
        return np.concatenate(times), np.concatenate(postures)


def _blend(count: int) -> Array:
    """Minimum-jerk ramp from 0 to 1 in ``count`` samples."""
    u = np.linspace(0.0, 1.0, count)
    out: Array = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    return out
