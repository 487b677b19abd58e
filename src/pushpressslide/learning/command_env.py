"""Any task of one placement as a Gymnasium environment, on either engine.

Observations and actions are the inputs and outputs of the controller at each tick.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pushpressslide.control.cell import Cell
from pushpressslide.control.run_loop import RunLoop
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Measurement
from pushpressslide.core.errors import (
    InfeasibleTaskError,
    TaskError,
)
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.learning.command_rows import (
    FAR,
    FAST,
    SEEN,
    STRONG,
    WIDTH,
    CommandScale,
    observation_row,
)
from pushpressslide.learning.options import METADATA, checked_mode, poses_asked
from pushpressslide.learning.picture import CommandCamera, Pixels
from pushpressslide.learning.push_task import Threshold, with_threshold
from pushpressslide.learning.pushing import errors
from pushpressslide.learning.registration import MISSING
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_fit
from pushpressslide.modes.base import ENOUGH
from pushpressslide.selection.placement_planner import PlansAlone
from pushpressslide.selection.solve import solve
from pushpressslide.taskfile.load import check_task, load_task
from pushpressslide.taskfile.place import nearest

try:
    import gymnasium
except ImportError as error:
    raise ImportError(MISSING) from error

SPREAD = (0.01, 0.01, math.radians(5.0))
"""Largest offset of a random start from the task's start, to either side: x, y [m] and
yaw [rad].
"""
ENGINES = ("drake", "planar")
DRAWS = 20
"""Largest number of starts that are drawn until one has a plan."""


class CommandEnv(gymnasium.Env):
    """One task whose tips an agent commands in place of the controller, from just
    before the touch.

    Observations (7 + 9 A,) and actions (25 A,) for A arms are laid out as in
    ``command_rows``. Rows of arms without a contact in the plan are ignored. A step is
    one control period. The reward [m] is the negative sum of the distance to the goal
    and rho times the angle to the goal. ``success`` in ``info`` says that the object is
    within the task's tolerance. Success ends the episode, and so does a failure of the
    engine. ``limits.time`` truncates it.
    """

    metadata: ClassVar[dict[str, Any]] = {**METADATA, "render_fps": 250}

    def __init__(
        self,
        task: Task | str | Path = "press-slide",
        engine: str = "planar",
        render_mode: str | None = None,
        threshold: Threshold | None = None,
    ) -> None:
        """Prepare a task, given directly, by the name of a shipped task, or by the path
        of a file.

        ``render_mode`` is None, or "rgb_array" for pictures from above. ``threshold``
        replaces the task's tolerance: position [m] and yaw [rad]. Raises TaskError for
        a task with several goals and for an unknown engine, and MissingPackageError for
        an engine that is not installed.
        """
        loaded = check_task(task) if isinstance(task, Task) else load_task(task)
        self.task = with_threshold(loaded, threshold)
        self.render_mode = checked_mode(render_mode)
        self._camera = CommandCamera(self.task)
        if self.task.goals:
            raise TaskError(self.task.name, "goals", "several", "allowed: one goal")
        if engine not in ENGINES:
            raise TaskError("", "engine", engine, nearest(engine, ENGINES))
        self.engine = engine
        arms = len(self.task.robots)
        load = support_pressure(
            self.task.object.shape, center_of_mass=self.task.object.center_of_mass
        )
        self._rho = rho_fit(load)
        tip = np.repeat([FAR, FAST, STRONG], 3)
        turns = 1e3  # [rad]
        seen = [self.task.limits.time + 1.0, *2 * (FAR, FAR, turns)]
        high = np.concatenate([seen, np.tile(tip, arms)])
        low = -high
        low[0] = 0.0
        self.observation_space = gymnasium.spaces.Box(low, high, dtype=np.float64)
        self.scale = CommandScale(self.task.motion, self.task.limits)
        size = (WIDTH * arms,)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, size, dtype=np.float64)
        self.loop: RunLoop  # of the current episode
        self._touching: frozenset[int] = frozenset()

    @property
    def plan(self) -> Plan:
        """Plan of the current episode."""
        return self.loop.plan

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start an episode: replan, and move the tips to the points before their
        contacts.

        The start is near that of the task, or ``options["start"]``: x, y [m] and yaw
        [rad] of X_WG. The goal is that of the task, or ``options["goal"]``. Raises
        InfeasibleTaskError if no plan leads from the start to the goal.
        """
        super().reset(seed=seed)
        asked = poses_asked(options, 1)
        goal = (
            self.task.goal if asked.goal is None else Pose2(*map(float, asked.goal[0]))
        )
        cell, plan = self._made(None if asked.start is None else asked.start[0], goal)
        self.loop = RunLoop(cell, plan)
        self._touching = frozenset(contact.arm for contact in plan.contacts)
        while self.loop.approaching:
            self.loop.step()
        measurement, _ = self.loop.measure()
        return self._observe(measurement)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Command the tips for one control period."""
        rows = np.reshape(action, (-1, WIDTH))
        commands = tuple(
            self.scale.command(row) if arm in self._touching else None
            for arm, row in enumerate(rows)
        )
        measurement = self.loop.drive(commands)
        observation, info = self._observe(measurement)
        reward = -info["distance"] - self._rho * info["angle"]
        over = info["success"] or self.loop.cell.clock.failure() is not None
        late = measurement.time >= self.task.limits.time
        return observation, reward, over, late, info

    def render(self) -> Pixels | None:
        """Picture (96, 96, 3) of the current state. None if the environment has no
        render mode.
        """
        if self.render_mode is None:
            return None
        measurement, _ = self.loop.measure()
        return self._camera.picture(observation_row(measurement, self.plan.task.goal))

    def _observe(self, measurement: Measurement) -> tuple[Array, dict[str, Any]]:
        """The observation, clipped to its bounds, and the ``info`` with it."""
        space = self.observation_space
        row = observation_row(measurement, self.plan.task.goal)
        distance, angle = errors(row[1:SEEN])
        tolerance = self.task.tolerance
        success = distance <= tolerance.position and angle <= tolerance.yaw
        info = {
            "success": bool(success),
            "distance": float(distance),
            "angle": float(angle),
        }
        return np.clip(row, space.low, space.high), info

    def _made(
        self, start: Sequence[float] | Array | None, goal: Pose2
    ) -> tuple[Cell, Plan]:
        """A cell, and a plan from a start to a goal. The start is random if none is
        given.

        Objects that need an arm or a ledge to carry them start at the task's own start.
        """
        own = self.task.start
        if start is not None:
            return self._from(Pose2(*map(float, start)), goal)
        if not self.task.scene.rests:
            return self._from(own, goal)
        for draw in range(DRAWS):
            x, y, yaw = self.np_random.uniform(-1.0, 1.0, 3) * SPREAD
            try:
                drawn = Pose2(own.x + x, own.y + y, own.yaw + yaw)
                return self._from(drawn, goal)
            except (InfeasibleTaskError, TaskError):
                if draw == DRAWS - 1:
                    raise
        raise AssertionError

    def _from(self, start: Pose2, goal: Pose2) -> tuple[Cell, Plan]:
        task = replace(self.task, start=start, goal=goal)
        check_task(task)
        if self.engine == "planar":
            from pushpressslide.planar.cell import planar_cell

            plan = _lone(solve(PlansAlone(), task, 1).plan)
            return planar_cell(plan), plan
        from pushpressslide.arms.paths.placements import PlacementPaths
        from pushpressslide.sim.arm_library import DRAKE
        from pushpressslide.sim.cell import drake_cell
        from pushpressslide.sim.station import Station

        paths = PlacementPaths(DRAKE)
        plan = _lone(solve(paths, task, ENOUGH).plan)
        station = Station(plan, time_step=task.motion.time_step)
        return drake_cell(plan, station, paths.paths), plan


def _lone(plan: Plan) -> Plan:
    """The plan, if it has only one placement. Raises InfeasibleTaskError otherwise."""
    if len(plan.placements) > 1:
        count = len(plan.placements)
        raise InfeasibleTaskError(f"{plan.task.name}: takes {count} placements, not 1")
    return plan
