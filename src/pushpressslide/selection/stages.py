"""Stages of a task with several goals: the order in which bodies move so that all end
at their goals.

The order is found by search. A body can move to its goal if the goal is free. If no
body can, a body that blocks another one is put aside first. Orders with fewer stages
are tried first, then those with shorter paths. All stages are planned before anything
moves, each from the end state of the previous one. Plans of common first stages are
reused between orders.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from pushpressslide.core import margins
from pushpressslide.core.bodies import (
    OBJECT,
    Stage,
    body_shape,
    stage_task,
    start_state,
)
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.motion import Limits
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import Task
from pushpressslide.planning.free_space import displacement
from pushpressslide.selection.placement_planner import PlacementPlanner, PlansAlone
from pushpressslide.selection.put_aside import Moment, in_the_way, spots
from pushpressslide.selection.solve import Solution, rest, solve

ORDERS = 400  # orders compared for each number of stages
REFUSALS = 16  # refused single motions after which no more orders are tried
# failed searches for a sequence of motions after which no more are made; each takes
# seconds
SEARCHES = 3
SHARED = 1e-8  # [m^2] that two footprints may share and still count as touching


@dataclass(frozen=True)
class PlannedStage:
    """A stage, its solution, and its joint paths."""

    stage: Stage
    solution: Solution
    planner: PlacementPlanner


def plan_stages(
    task: Task,
    planner: PlacementPlanner | None = None,
    enough: int = 1,
    *,
    force: bool = False,
) -> list[PlannedStage]:
    """Stages that bring all bodies of ``task`` to their goals, each planned from the
    end state of the previous one.

    A task without ``goals`` is one stage. ``planner`` is an empty planner with the arms
    at their start; by default no joint paths are planned. ``enough`` and ``force`` are
    as in ``solve``. Raises InfeasibleTaskError, with the body and the reason, if no
    order of stages has a plan.
    """
    first = PlansAlone() if planner is None else planner
    if not task.goals:
        there = Plan(task).at_goal
        solution = rest(task) if there else solve(first, task, enough, force=force)
        return [PlannedStage(Stage(OBJECT, task.goal), solution, first)]
    search = _OrderSearch(task, first, enough, force)
    moment = Moment(task, start_state(task), goals_of(task))
    bodies = len(moment.goals)
    for asides in range(bodies + 1 if bodies > 1 else 1):
        orders = list(islice(_orders(moment, asides), ORDERS))
        orders.sort(key=lambda order: estimate(task, order))
        for thorough in (False, True):
            for order in orders:
                planned = search.planned(order, thorough)
                if planned is not None:
                    return planned or [_at_goal(task, first)]
    raise search.refusal or InfeasibleTaskError(_shut_in(moment))


def _at_goal(task: Task, planner: PlacementPlanner) -> PlannedStage:
    """Stage of a task whose bodies are all at their goals."""
    stage = Stage(task.goals[-1].body, task.goals[-1].pose)
    return PlannedStage(
        stage, rest(stage_task(task, stage, start_state(task))), planner
    )


def plan_stage(
    task: Task,
    stage: Stage,
    start: WorldState,
    planner: PlacementPlanner,
    enough: int,
    *,
    force: bool = False,
) -> PlannedStage:
    """A stage planned from the state ``start``. ``planner`` plans the arms' joint
    paths.

    Raises InfeasibleTaskError if there is no plan to the stage's goal.
    """
    solution = solve(planner, stage_task(task, stage, start), enough, force=force)
    return PlannedStage(stage, solution, planner)


def goals_of(task: Task) -> dict[str, tuple[Pose2, ...]]:
    """Goals of each body that has any, in order."""
    out: dict[str, tuple[Pose2, ...]] = {}
    for goal in task.goals:
        out[goal.body] = (*out.get(goal.body, ()), goal.pose)
    return out


def after(state: WorldState, stage: Stage) -> WorldState:
    """State after a stage that went as planned."""
    return state.with_body_at(stage.body, stage.goal)


def estimate(task: Task, order: Sequence[Stage]) -> tuple[int, float]:
    """Ranking key of an order: the number of stages, and the time [s] of straight paths
    with the arms' transfers between stages.
    """
    state = start_state(task)
    time = 0.0
    before: Pose2 | None = None
    for stage in order:
        here = state.poses[stage.body]
        far = displacement(body_shape(task, stage.body), here, stage.goal)
        if before is not None:
            far += math.dist(before.position, here.position)
        time += far / task.motion.speed + margins.ARM.regrasp
        before = stage.goal
        state = after(state, stage)
    return len(order), round(time, 6)


def _orders(
    moment: Moment, asides: int, done: tuple[Stage, ...] = ()
) -> Iterator[tuple[Stage, ...]]:
    """Yield orders that bring all bodies to their goals.

    In each order, ``asides`` bodies are put aside in between, each at most once.
    """
    moment = _visited(moment)
    if _all_there(moment):
        if asides == 0:
            yield done
        return
    for body, goals in moment.goals.items():
        if goals and _is_free(moment, body) and not _stays(moment, body):
            stage = Stage(body, goals[0])
            left = {**moment.goals, body: goals[1:]}
            ahead = replace(moment, state=after(moment.state, stage), goals=left)
            yield from _orders(ahead, asides, (*done, stage))
    if asides == 0:
        return
    put = {stage.body for stage in done if stage.aside}
    for body in in_the_way(moment):
        if body in put:
            continue
        for X in spots(moment, body):
            stage = Stage(body, X, aside=True)
            ahead = replace(moment, state=after(moment.state, stage))
            yield from _orders(ahead, asides - 1, (*done, stage))


def _visited(moment: Moment) -> Moment:
    """The moment without goals that bodies with several goals have already reached. The
    last goal of each body stays.
    """
    tolerance = moment.task.tolerance
    left: dict[str, tuple[Pose2, ...]] = {}
    for body, goals in moment.goals.items():
        here = moment.state.poses[body]
        while len(goals) > 1 and tolerance.holds(here, goals[0]):
            goals = goals[1:]
        left[body] = goals
    return replace(moment, goals=left)


def _stays(moment: Moment, body: str) -> bool:
    """Whether a body is at its last goal."""
    goals = moment.goals[body]
    here = moment.state.poses[body]
    return len(goals) == 1 and moment.task.tolerance.holds(here, goals[0])


def _all_there(moment: Moment) -> bool:
    return all(not goals or _stays(moment, b) for b, goals in moment.goals.items())


def _is_free(moment: Moment, body: str) -> bool:
    """Whether no other body stands in the next goal of ``body``."""
    goal = moment.goal_outlines(body)[0]
    others = (moment.outline(other) for other in moment.state.poses if other != body)
    return all(goal.intersection(other).area <= SHARED for other in others)


def _shut_in(moment: Moment) -> str:
    """One line that names a body that can neither go to its goal nor be put aside."""
    task = moment.task
    for body, goals in moment.goals.items():
        if goals and not _is_free(moment, body):
            standing = [
                other
                for other in moment.state.poses
                if other != body
                and moment.outline(other).intersects(moment.goal_outlines(body)[0])
            ]
            return (
                f"{task.source or task.name}: {body!r} cannot go to its goal: "
                f"{standing[0]!r} stands there and cannot be put aside"
            )
    return f"{task.source or task.name}: no order brings all bodies to their goals"


class _OrderSearch:
    """Planner of orders of stages. First stages that several orders share are planned
    only once.

    At first each stage must be a single motion. If no order succeeds, sequences of
    motions are also searched.
    """

    def __init__(
        self, task: Task, first: PlacementPlanner, enough: int, force: bool
    ) -> None:
        self.task = task
        self.enough = enough
        self.force = force
        self.first = first
        self._refused: dict[bool, list[InfeasibleTaskError]] = {True: [], False: []}
        self._known: dict[tuple[Stage, ...], PlannedStage] = {}
        self._tried: set[tuple[bool, tuple[Stage, ...]]] = set()

    @property
    def refusal(self) -> InfeasibleTaskError | None:
        """The refusal of the first stage that has no plan."""
        refused = self._refused[True] or self._refused[False]
        return refused[0] if refused else None

    def planned(
        self, order: Sequence[Stage], thorough: bool
    ) -> list[PlannedStage] | None:
        """Plans of all stages, or None if a stage has none."""
        out: list[PlannedStage] = []
        state = start_state(self.task)
        for number, stage in enumerate(order, start=1):
            key = tuple(order[:number])
            if key not in self._known:
                before = out[-1].planner if out else self.first
                self._plan(key, state, before.after(), thorough)
            if key not in self._known:
                return None
            out.append(self._known[key])
            state = after(state, stage)
        return out

    def _plan(
        self,
        key: tuple[Stage, ...],
        start: WorldState,
        planner: PlacementPlanner,
        thorough: bool,
    ) -> None:
        """Plan the last stage of ``key``, unless it was tried before or too many stages
        had no plan.
        """
        refused = self._refused[thorough]
        most = SEARCHES if thorough else REFUSALS
        if (thorough, key) in self._tried or len(refused) >= most:
            return
        self._tried.add((thorough, key))
        task = self.task
        limits = task.limits if thorough else replace(task.limits, legs=1)
        if thorough and limits.legs == 1:
            return
        try:
            planned = plan_stage(
                replace(task, limits=limits),
                key[-1],
                start,
                planner,
                self.enough,
                force=self.force,
            )
        except InfeasibleTaskError as error:
            refused.append(error)
            return
        self._known[key] = _within(planned, task.limits)


def _within(planned: PlannedStage, limits: Limits) -> PlannedStage:
    """The planned stage with the ``limits`` of the task."""
    plan = planned.solution.plan
    plan = replace(plan, task=replace(plan.task, limits=limits))
    return replace(planned, solution=replace(planned.solution, plan=plan))
