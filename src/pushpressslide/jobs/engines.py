"""Engines that can run a task, by name.

An engine's modules are imported at first use.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.place import nearest

if TYPE_CHECKING:
    from pushpressslide.arms.paths.joint_path import ArmPath
    from pushpressslide.control.run_loop import RunOptions
    from pushpressslide.core.plan import Plan
    from pushpressslide.core.pose import Pose2
    from pushpressslide.core.record import Record
    from pushpressslide.core.state import WorldState
    from pushpressslide.core.task import Shape
    from pushpressslide.report.stages import StageRun
    from pushpressslide.selection.placement_planner import PlacementPlanner

    JointPaths = Sequence[tuple[ArmPath, ...]]  # of the arms, for each placement


class EngineName(StrEnum):
    """Name of an engine."""

    drake = "drake"
    mujoco = "mujoco"
    planar = "planar"


DEFAULT = EngineName.drake


@dataclass(frozen=True, slots=True)
class ArmOptions:
    """Options of engines with arms; an engine without arms ignores them."""

    models: str = "generated"  # of the robots
    # joint paths from planning; None: they are planned here
    paths: JointPaths | None = None
    # called with the address of a page that shows the run
    live: Callable[[str], None] | None = None
    video: bool = False  # also write an animation
    # drawn in a replay instead of the object's goal: shapes at poses X_WG
    goals: Sequence[tuple[Shape, Pose2]] = ()


class Engine(Protocol):
    """Interface of an engine to the jobs."""

    # a plan needs joint paths, and a run can be filmed
    has_arms: bool
    shows_live: bool  # a run can be watched

    def placement_planner(
        self, force: bool, start: WorldState | None = None
    ) -> PlacementPlanner:
        """An empty joint-path planner.

        With ``force`` it takes the best path available, however bad. The arms start in
        the joint positions of ``start`` if it has any, otherwise in their ready
        postures.
        """

    def run(self, plan: Plan, options: RunOptions, arms: ArmOptions) -> Record:
        """Run ``plan`` and return its record."""

    def write_replay(
        self, runs: Sequence[StageRun], record: Record, out: Path, arms: ArmOptions
    ) -> None:
        """Write the replay and the pictures of a run in stages into the folder ``out``,
        with an animation if requested.

        ``record`` covers all ``runs``.
        """


class _Drake:
    has_arms = True
    shows_live = True

    def placement_planner(
        self, force: bool, start: WorldState | None = None
    ) -> PlacementPlanner:
        """A joint-path planner that searches for paths."""
        import numpy as np

        from pushpressslide.arms.paths.placements import PlacementPaths
        from pushpressslide.sim.arm_library import DRAKE

        if start is None or not start.joints:
            return PlacementPaths(DRAKE, force)
        return PlacementPaths(DRAKE, force, tuple(map(np.array, start.joints)))

    def run(self, plan: Plan, options: RunOptions, arms: ArmOptions) -> Record:
        """Run a plan and return its record."""
        from pushpressslide.sim.engine import run

        view = None
        if arms.live is not None:
            from pushpressslide.view.drake.live import LiveView

            view = LiveView(plan, arms.live)
        return run(plan, options, paths=arms.paths, models=arms.models, view=view)

    def write_replay(
        self, runs: Sequence[StageRun], record: Record, out: Path, arms: ArmOptions
    ) -> None:
        """Write the replay page of a run."""
        from pushpressslide.report.series import finite_part
        from pushpressslide.report.stages import replayed_record
        from pushpressslide.view.drake.run_film import FilmedRun, write_video
        from pushpressslide.view.drake.second_half import second_half

        record = finite_part(replayed_record(runs, record))
        if not arms.video:
            self._write_stills(record, out, arms)
            return
        run = FilmedRun(record.plan, record, arms.models, arms.goals)
        with second_half(run, out) as later:
            self._write_stills(record, out, arms)
            write_video(run, out, later)

    def _write_stills(self, record: Record, out: Path, arms: ArmOptions) -> None:
        """Write the replay page, and pictures if this machine can render them."""
        from pushpressslide.core.errors import SimulationError
        from pushpressslide.view.drake.frames import write_pictures
        from pushpressslide.view.drake.replay import write_replay

        plan = record.plan
        write_replay(plan, record, out, arms.models, arms.goals)
        # a replay needs no renderer on this machine; an animation only on request
        with suppress(SimulationError):
            write_pictures(plan, record, out, arms.models, arms.goals)


class _Mujoco(_Drake):
    """MuJoCo's physics. Joint paths and pictures are Drake's."""

    shows_live = False

    def run(self, plan: Plan, options: RunOptions, arms: ArmOptions) -> Record:
        """Run a plan and return its record."""
        from pushpressslide.mujoco_sim.engine import run
        from pushpressslide.sim.arm_library import DRAKE, joint_paths_of
        from pushpressslide.sim.driven import with_clearance

        if arms.models != "generated":
            source = plan.task.source or plan.task.name
            allowed = "allowed with engine mujoco: generated"
            raise TaskError(source, "models", arms.models, allowed)
        paths = joint_paths_of(plan) if arms.paths is None else arms.paths
        record = run(plan, DRAKE, paths, options)
        return with_clearance(record, options.true_world_seed)


class _Planar:
    has_arms = False
    shows_live = False

    def placement_planner(
        self, force: bool, start: WorldState | None = None
    ) -> PlacementPlanner:
        """Placement planner that accepts any plan, since there are no arms to plan for."""
        from pushpressslide.selection.placement_planner import PlansAlone

        return PlansAlone()

    def run(self, plan: Plan, options: RunOptions, arms: ArmOptions) -> Record:
        """Run a plan and return its record."""
        from pushpressslide.planar.engine import run

        return run(plan, options)

    def write_replay(
        self, runs: Sequence[StageRun], record: Record, out: Path, arms: ArmOptions
    ) -> None:
        """Write the replay page of a run."""
        from pushpressslide.report.series import finite_part
        from pushpressslide.view.planar.replay import write_replay
        from pushpressslide.view.planar.video import write_pictures, write_video

        plan = record.plan
        record = finite_part(record)
        parts = []
        if "stage" in record.arrays:
            parts = [finite_part(run.record) for run in runs]
        write_replay(plan, record, out, arms.goals, parts)
        if not len(record.arrays["time"]):
            return
        write_pictures(plan, record, out, arms.goals, parts)
        if arms.video:
            write_video(plan, record, out, arms.goals, parts)


ENGINES: Mapping[str, Engine] = {
    EngineName.drake: _Drake(),
    EngineName.mujoco: _Mujoco(),
    EngineName.planar: _Planar(),
}


PACKAGES: Mapping[str, tuple[str, ...]] = {
    EngineName.drake: ("pushpressslide.sim",),
    EngineName.mujoco: ("pushpressslide.mujoco_sim", "pushpressslide.sim"),
}
"""Packages that raise MissingPackageError if an engine's library is not installed."""


def engine_named(name: str) -> Engine:
    """Engine with the given name.

    Raises TaskError for an unknown engine, and MissingPackageError for an engine that
    is not installed.
    """
    if not isinstance(name, str) or name not in ENGINES:
        raise TaskError("", "engine", name, nearest(name, map(str, ENGINES)))
    for package in PACKAGES.get(name, ()):
        importlib.import_module(package)
    return ENGINES[name]
