"""Many objects pushed at once, step by step, as the basis of every environment.

If numba is installed, a step is compiled; otherwise it runs object by object.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.pushed_bodies import PushedBodies, Pushes
from pushpressslide.core.arrays import Array
from pushpressslide.learning.push_task import FIELD, PERIOD, SPREAD, PushTask

Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]

OBSERVATION = ("x", "y", "yaw", "goal_x", "goal_y", "goal_yaw", "tip_x", "tip_y")
"""Names of an observation's values, in the world: the pose of the shape's frame G and
the goal, in [m] and [rad] in [-pi, pi], and the contact point [m] of the tip.
"""
TURN = 2.0 * math.pi


class Outcome(NamedTuple):
    """Result of a step."""

    observations: Array  # (n, 8)
    rewards: Array  # (n,) [m]
    terminated: Flags  # (n,)
    truncated: Flags  # (n,)
    success: Flags  # (n,)


class Pushing:
    """Objects of one task, each with its own tip, all at the task's start initially."""

    def __init__(self, push: PushTask, count: int) -> None:
        """Prepare ``count`` objects."""
        self.push = push
        self.count = count
        friction = push.task.contact_friction
        self._bodies = PushedBodies(
            push.foot, push.normal, push.ends, friction, push.rho
        )
        self._goals = np.tile(goal_of(push), (count, 1))
        self._most_steps = np.full(count, push.steps)
        self._pushes = self._bodies.initial_states(np.zeros((count, 3)))
        self._tips = np.zeros((count, 2))
        self._steps = np.zeros(count, dtype=np.intp)
        start = push.task.true_start
        everyone = np.arange(count, dtype=np.intp)
        self.place(everyone, np.array([start.x, start.y, start.yaw]))

    def place(
        self,
        rows: Indices,
        start_poses: ArrayLike,
        goals: Array | None = None,
        along: float = 0.0,
    ) -> None:
        """Start episodes of ``rows`` with the objects at ``start_poses`` (..., 3) X_WG.

        The tips start at ``along`` [m] from the middle of their faces. ``goals`` (...,
        3) X_WG are those of the task by default.
        """
        self._goals[rows] = (
            goal_of(self.push) if goals is None else wrapped_poses(goals)
        )
        self._most_steps[rows] = self.push.steps
        if goals is not None:
            self._most_steps[rows] = steps_to(self.push, start_poses, goals)
        poses = np.array(self._pushes.poses)
        X_WG = np.asarray(start_poses, dtype=np.float64)
        poses[rows] = displaced(X_WG, self.push.center, 1.0)
        places = np.array(self._pushes.places)
        gaps = np.array(self._pushes.gaps)
        places[rows] = along
        gaps[rows] = 0.0
        self._pushes = Pushes(poses, places, gaps)
        self._tips = self._touching(self._tips)
        self._steps[rows] = 0

    def observations(self) -> Array:
        """Observation of each object (n, 8)."""
        out = np.empty((self.count, len(OBSERVATION)))
        out[:, :3] = displaced(self._pushes.poses, self.push.center, -1.0)
        out[:, 2] = wrapped(out[:, 2])
        out[:, 3:6] = self._goals
        out[:, 6:] = self._tips
        return out

    def step(self, velocities: ArrayLike) -> Outcome:
        """Move the tips for one period at ``velocities`` (n, 2) [m/s] in the world,
        clipped to the speed limit.

        Raises ValueError if a velocity is NaN.
        """
        v = clipped(self.push, velocities)
        self._pushes = self._bodies.advance(self._pushes, v, PERIOD)
        self._tips = self._touching(self._tips + PERIOD * v)
        self._steps += 1
        passed = np.isinf(self._pushes.gaps)
        over = self._steps >= self._most_steps
        return outcome(self.push, self.observations(), passed, over)

    def _touching(self, tips: Array) -> Array:
        """Contact points (n, 2) [m] of the tips in the world. For a tip that has left
        its face, it is the point in ``tips``.
        """
        poses, places, gaps = self._pushes
        nx, ny = self.push.normal
        ahead = np.isfinite(gaps)
        gap = np.where(ahead, gaps, 0.0)
        x = self.push.foot[0] - ny * places - nx * gap
        y = self.push.foot[1] + nx * places - ny * gap
        c = np.cos(poses[:, 2])
        s = np.sin(poses[:, 2])
        points = np.stack(
            [poses[:, 0] + c * x - s * y, poses[:, 1] + s * x + c * y], axis=1
        )
        return np.where(ahead[:, None], points, tips)


def clipped(push: PushTask, velocities: ArrayLike) -> Array:
    """Velocities [m/s] within the speed limit.

    Raises ValueError if a velocity is NaN.
    """
    asked = np.asarray(velocities, dtype=np.float64)
    if np.isnan(asked).any():
        raise ValueError("velocity nan m/s is not allowed; allowed: numbers")
    return np.clip(asked, -push.speed_limit, push.speed_limit)


def outcome(push: PushTask, observations: Array, passed: Flags, over: Flags) -> Outcome:
    """Result of a step, for tips that have ``passed`` their faces (n,) and episodes
    whose time is ``over`` (n,).
    """
    distance, turn = errors(observations)
    tolerance = push.task.tolerance
    success = (distance <= tolerance.position) & (turn <= tolerance.yaw)
    terminated = success | passed
    rewards = -(distance + push.rho * turn)
    return Outcome(observations, rewards, terminated, over & ~terminated, success)


def goal_of(push: PushTask) -> Array:
    """Goal X_WG (3,)."""
    goal = push.task.goal
    return np.array([goal.x, goal.y, float(wrapped(np.array(goal.yaw)))])


def steps_to(
    push: PushTask, start_poses: ArrayLike, goals: ArrayLike
) -> NDArray[np.intp]:
    """Largest number of steps of episodes with other goals.

    It is proportional to the distance, and at least that for the task's goal.
    """
    start = push.task.true_start
    own = (start.x, start.y, start.yaw)
    share = _distance(push, start_poses, goals) / _distance(push, own, goal_of(push))
    steps = np.ceil(push.steps * np.maximum(share, 1.0))
    return np.asarray(steps, dtype=np.intp)


def _distance(push: PushTask, start_poses: ArrayLike, goals: ArrayLike) -> Array:
    """Distance [m] between poses (..., 3), with rho times the angle included."""
    off = np.asarray(goals) - np.asarray(start_poses)
    far = np.hypot(off[..., 0], off[..., 1])
    return np.asarray(far + push.rho * np.abs(wrapped(off[..., 2])))


def wrapped_poses(poses: ArrayLike) -> Array:
    """Poses (..., 3), each with its yaw between -pi and pi."""
    out = np.array(poses, dtype=np.float64)
    out[..., 2] = wrapped(out[..., 2])
    return out


def drawn_start(push: PushTask, rng: np.random.Generator) -> Array:
    """A random start X_WG (3,) near the task's start."""
    start = push.task.true_start
    offset = rng.uniform(-1.0, 1.0, 3) * SPREAD
    return np.array([start.x, start.y, start.yaw]) + offset


def checked_poses(poses: ArrayLike, count: int, name: str = "start") -> Array:
    """Starts or goals (count, 3) X_WG, checked.

    Raises ValueError for any other shape, and for poses outside the field.
    """
    X = np.asarray(poses, dtype=np.float64)
    if X.shape not in ((3,), (count, 3)):
        reason = "is not allowed; allowed: x, y, yaw"
        raise ValueError(f"{name} of shape {X.shape} {reason}")
    if not (np.isfinite(X).all() and (np.abs(X[..., :2]) <= FIELD).all()):
        raise ValueError(
            f"{name} {X.tolist()} is not allowed; allowed: x and y in [-{FIELD:g}, "
            f"{FIELD:g}] m"
        )
    return np.broadcast_to(X, (count, 3))


def errors(observations: Array) -> tuple[Array, Array]:
    """Errors of objects from their goals: distance [m] and angle [rad]."""
    dx = observations[..., 3] - observations[..., 0]
    dy = observations[..., 4] - observations[..., 1]
    turn = np.abs(wrapped(observations[..., 5] - observations[..., 2]))
    return np.sqrt(dx * dx + dy * dy), turn


def wrapped(angles: Array) -> Array:
    """Angles [rad], each between -pi and pi."""
    out: Array = angles - TURN * np.round(angles / TURN)
    return out


def displaced(poses: Array, offset: tuple[float, float], sign: float) -> Array:
    """Poses (..., 3) with their origins displaced by ``sign`` times ``offset`` [m], in
    their own axes.
    """
    c = sign * np.cos(poses[..., 2])
    s = sign * np.sin(poses[..., 2])
    x, y = offset
    return np.stack(
        [
            poses[..., 0] + c * x - s * y,
            poses[..., 1] + s * x + c * y,
            poses[..., 2],
        ],
        axis=-1,
    )
