"""A run as a sequence of stages, by default a single one, without a reset between them.

Each stage runs on its own plant, which starts with the arms and all bodies exactly as
in the last sample of the previous stage. The planner knows only the measured poses of
the bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.bodies import OBJECT, SET_DOWN, in_stage, start_state
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.sensing import Sensing
from pushpressslide.core.state import Joints, WorldState
from pushpressslide.core.task import Belief, Obstacle, Task
from pushpressslide.jobs.engines import ArmOptions, engine_named
from pushpressslide.jobs.monitor import Monitor
from pushpressslide.modes.base import ENOUGH
from pushpressslide.report.at_rest import record_at_rest
from pushpressslide.report.metrics import result as measure
from pushpressslide.report.stage_figures import staged_result
from pushpressslide.report.stages import (
    StagePlan,
    StageRun,
    body_positions,
    final_poses,
    joined_record,
)
from pushpressslide.selection.placement_planner import PlacementPlanner
from pushpressslide.selection.stages import (
    PlannedStage,
    after,
    plan_stage,
    plan_stages,
)

OF_CENTER = ("center_of_mass", "center_error")
"""Fields of a belief that the frame B of a plan depends on."""


@dataclass(frozen=True, slots=True)
class StageOptions:
    """Options for planning and running the stages of a task."""

    engine: str
    # seed of the first stage's noise; later stages use the following ones
    seed: int = 0
    # run the best choice that has a path, even if it is infeasible
    force: bool = False
    models: str = "generated"  # of the robots
    monitor: Monitor = field(default_factory=Monitor)
    # options of the run loop; seed, progress and stop are set for each stage
    loop: RunOptions = field(default_factory=RunOptions)


@dataclass(frozen=True, slots=True)
class Done:
    """Result of a run."""

    task: Task  # as executed, with the motions found by search
    stages: tuple[StagePlan, ...]  # in order, with stages that were not started last
    record: Record
    result: dict[str, Any]  # empty if the run was not measured


class StageRunner:
    """Plans all stages of a task, and then runs them."""

    def __init__(self, task: Task, options: StageOptions) -> None:
        """Plan all stages before anything moves.

        Raises InfeasibleTaskError, with the body and the reason, if no plan brings all
        bodies to their goals.
        """
        self.task = task
        self.options = options
        self.engine = engine_named(options.engine)
        self.enough = ENOUGH if self.engine.has_arms else 1
        self.planned: Sequence[PlannedStage] = plan_stages(
            task,
            self.engine.placement_planner(options.force),
            self.enough,
            force=options.force,
        )
        self.runs: list[StageRun] = []  # finished runs
        self.lacking: Ending | None = None  # why a stage was not started
        self._time = 0.0  # [s] since the start of the first stage
        self._expected = start_state(task)  # state expected by the plans
        # tolerances of bodies that finished stages have moved
        self._within: dict[str, Tolerance] = {}
        self._state = start_state(task).with_body_at(
            OBJECT, task.true_start
        )  # current state
        self._learnt: dict[str, Belief] = {}

    def run(self) -> Iterator[StageRun]:
        """Run the stages and yield each as soon as it has ended.

        A stage that fails is the last one. If a stage is not started, ``lacking``
        contains the reason.
        """
        for number in range(len(self.planned)):
            done = self._run(number)
            if done is None:
                return
            self.runs.append(done)
            yield done
            interrupt = self.options.monitor.interrupt
            if not done.reached or (interrupt is not None and interrupt()):
                return

    @property
    def is_over(self) -> bool:
        """Whether no stage remains."""
        return len(self.runs) == len(self.planned)

    def done(self) -> Done:
        """Result of the finished run."""
        runs = self.runs
        stages = [planned.stage for planned in self.planned]
        if not self.task.goals:
            (run,) = runs
            return self._done(run.record, measure(self.task, run.plan, run.record))
        results = [measure(run.plan.task, run.plan, run.record) for run in runs]
        result = staged_result(self.task, stages, runs, results, self.lacking)
        ending = Ending(result["reason"]["code"], result["reason"]["text"])
        return self._done(joined_record(runs, ending, self.options.seed), result)

    def so_far(self) -> Done:
        """Result of the finished stages."""
        text = f"stage {len(self.runs)} of {len(self.planned)} has ended"
        ending = Ending("interrupted", text)
        return self._done(joined_record(self.runs, ending, self.options.seed), {})

    def _done(self, record: Record, result: dict[str, Any]) -> Done:
        task = self.task if self.task.goals else record.plan.task
        ahead = self.planned[len(self.runs) :]
        stages = (*self.runs, *map(planned_part, ahead))
        return Done(task, stages, record, result)

    def _run(self, number: int) -> StageRun | None:
        limit = self.task.limits.time
        if self._time >= limit:
            self.lacking = Ending("time_limit", f"limits.time of {limit:g} s is over")
            return None
        try:
            planned = self._planned(number)
        except InfeasibleTaskError as error:
            self.lacking = Ending("goal_missed", str(error))
            return None
        record = self._record(planned, number)
        done = StageRun(
            planned.stage,
            record.plan,
            tuple(planned.solution.choices),
            record,
            self._time,
            self._state,
            planned is not self.planned[number],
        )
        if number + 1 < len(self.planned):
            self._go_on(done)
        return done

    def _planned(self, number: int) -> PlannedStage:
        """Plan of a stage, replanned if the measured pose of a body differs from the
        planned one.
        """
        planned = self.planned[number]
        seen = self._measured_pose()
        if number == 0 or all(map(self._as_expected, seen.poses, seen.poses.values())):
            return planned
        preparation = self.engine.placement_planner(self.options.force, seen)
        return plan_stage(self.task, planned.stage, seen, preparation, self.enough)

    def _as_expected(self, body: str, pose: Pose2) -> bool:
        within = self._within.get(body, self.task.tolerance)
        return within.holds(pose, self._expected.poses[body])

    def _measured_pose(self) -> WorldState:
        """State with the measured poses of the bodies at rest. Noise averages out, but
        a bias remains.
        """
        sensing = self.task.sensing
        poses = {
            body: _measured_pose(X, sensing) for body, X in self._state.poses.items()
        }
        return replace(self._state, poses=poses)

    def _record(self, planned: PlannedStage, number: int) -> Record:
        """Run a planned stage from the current state."""
        monitor = self.options.monitor
        if not planned.solution.plan.segments:
            return record_at_rest(planned.solution.plan, self.options.engine)
        goes_on = number > 0
        preparation: PlacementPlanner = planned.planner
        plan = self._as_it_is(planned)
        with monitor.deferred_interrupt():
            record = self.engine.run(
                plan,
                replace(
                    self.options.loop,
                    seed=self.options.seed + number,
                    world_seed=self.options.seed,
                    progress=self._progress(number),
                    stop=monitor.interrupt or bool,
                    begin=in_stage(self._state, planned.stage.body)
                    if goes_on
                    else None,
                ),
                ArmOptions(
                    self.options.models,
                    preparation.paths,
                    monitor.live,
                ),
            )
        return replace(record, meta={**record.meta, **planned.solution.notes})

    def _as_it_is(self, planned: PlannedStage) -> Plan:
        """The plan with the bodies at their current poses: the true pose of the object,
        the measured poses of the others.
        """
        plan = planned.solution.plan
        if not self.task.goals:
            return plan
        task = plan.task
        others = self._measured_pose() if self.runs else self._state
        true = self._state.poses[planned.stage.body]
        turn = np.arctan2(
            np.sin(true.yaw - task.start.yaw), np.cos(true.yaw - task.start.yaw)
        )
        error = Pose2(true.x - task.start.x, true.y - task.start.y, float(turn))
        obstacles = tuple(_at_its_pose(obstacle, others) for obstacle in task.obstacles)
        limits = replace(task.limits, time=self.task.limits.time - self._time)
        belief = task.belief
        learnt = self._learnt.get(planned.stage.body)
        if learnt is not None:  # the stage was planned with its own centre of mass
            center = {one: getattr(belief, one) for one in OF_CENTER}
            belief = replace(learnt, **center)
        task = replace(
            task, start_error=error, obstacles=obstacles, limits=limits, belief=belief
        )
        return replace(plan, task=task)

    def _progress(self, number: int) -> Callable[[float, float], None] | None:
        """Report a stage's progress as progress of the whole run."""
        report = self.options.monitor.progress
        if report is None:
            return None
        before = self._time
        ahead = sum(s.solution.plan.duration for s in self.planned[number + 1 :])
        return lambda time, whole: report(before + time, before + whole + ahead)

    def _go_on(self, done: StageRun) -> None:
        """Start the next stage from the final state of this one."""
        body = done.stage.body
        arrays = done.record.arrays
        task = done.plan.task
        period = task.motion.control_period
        self._time += float(arrays["time"][-1] - arrays["time"][0]) + period
        positions = {b: q[-1].tolist() for b, q in body_positions(done).items()}
        self._state = WorldState(
            final_poses(done),
            _of_arms(done.record, "joint_position"),
            speeds=_of_arms(done.record, "joint_velocity"),
            tips=tuple((x, y, z) for x, y, z in arrays["tip_position"][-1].tolist()),
            spatial={body: tuple(q) for body, q in positions.items()},
        )
        self._expected = after(self._expected, done.stage)
        self._within[body] = task.tolerance
        learnt = _learnt(done.plan)
        if learnt is not None:
            self._learnt[body] = learnt


def planned_part(planned: PlannedStage) -> StagePlan:
    """Plan of a stage that was not started."""
    solution = planned.solution
    return StagePlan(planned.stage, solution.plan, tuple(solution.choices))


def _of_arms(record: Record, name: str) -> tuple[Joints, ...]:
    """Last sample of each arm in an array of the record. Empty for a plant without
    arms.
    """
    arms = range(len(record.plan.task.robots))
    keys = (f"{name}_{arm}" for arm in arms)
    arrays = record.arrays
    return tuple(tuple(arrays[key][-1].tolist()) for key in keys if key in arrays)


def _at_its_pose(obstacle: Obstacle, state: WorldState) -> Obstacle:
    body = OBJECT if obstacle.name == SET_DOWN else obstacle.name
    return replace(obstacle, pose=state.poses.get(body, obstacle.pose))


def _measured_pose(X: Pose2, sensing: Sensing) -> Pose2:
    dx, dy = sensing.position_bias
    return Pose2(X.x + dx, X.y + dy, X.yaw + sensing.yaw_bias).wrapped


def _learnt(plan: Plan) -> Belief | None:
    """Belief about a body after a stage that identified its friction, apart from its
    centre of mass. None if the stage was not replanned.
    """
    if not plan.later:
        return None
    plan = plan.later[-1]
    if plan.restart is None:
        return None
    return replace(
        plan.task.belief,
        support_friction=plan.restart.support_friction,
        rho=plan.restart.rho,
    )
