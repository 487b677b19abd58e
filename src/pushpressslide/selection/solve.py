"""Solution of a task: a single motion if one leads to the goal, otherwise a sequence
found by search, with the joint paths of each placement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from time import perf_counter
from typing import Any

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Choice, Plan, Segment
from pushpressslide.core.task import Leg, Task
from pushpressslide.selection.leg_search import LegSearch, Step
from pushpressslide.selection.placement_planner import (
    PlacementPlanner,
    PlansAlone,
    Problems,
    add_first,
    prepared,
)
from pushpressslide.selection.planner import infeasible, selectable
from pushpressslide.selection.reach_screen import ReachScreen
from pushpressslide.selection.search_notes import SearchNotes
from pushpressslide.selection.select import (
    choices_at_goal,
    evaluate_motion,
    nudges,
    of_leg,
    placements,
)
from pushpressslide.selection.waypoints import free_space, push_successors, waypoints

TRIES = 4  # single motions whose joint paths are sought before sequences
SEQUENCES = 16  # sequences whose joint paths are sought
# the same when a task continues after a recovery, with plans for several beliefs
TRIES_ANEW = 2
SEQUENCES_ANEW = 6
JUDGED = 320  # budget for evaluating motions between two poses in a search
MOST_FORCE = 1000.0  # [N] largest limit that a task file may allow
MOST_FURTHER = 640  # the same if pushes from the via poses are evaluated too
# the same when a task continues after a recovery: the arms wait for several plans
JUDGED_ANEW = 100
MOST_FURTHER_ANEW = 100


@dataclass
class Solution:
    """The solution of a task."""

    plan: Plan
    choices: list[Choice]  # all choices, evaluated or skipped
    planning_time: dict[str, float] = field(default_factory=dict)  # [s] by stage
    search_notes: SearchNotes | None = None  # None if one motion suffices

    @property
    def notes(self) -> dict[str, Any]:
        """Notes for the record of a run."""
        searched = None if self.search_notes is None else self.search_notes.notes
        return {"planning_time": self.planning_time, "search": searched}


def solve(
    planner: PlacementPlanner, task: Task, enough: int, *, force: bool = False
) -> Solution:
    """Solution of ``task``. The plans of its placements, with their joint paths, are
    left in ``planner``.

    At first ``enough`` choices of each mode are evaluated. With ``force``, infeasible
    choices are also used. Movable obstacles are pushed only if no path avoids them.
    Raises InfeasibleTaskError if no motion or sequence leads to the goal.
    """
    return solved(planner, Plan(task), enough, force=force)


def rest(task: Task) -> Solution:
    """Solution of a task whose object is at its goal already: nothing moves."""
    return Solution(Plan(task), choices_at_goal(task))


def solved(
    planner: PlacementPlanner,
    empty: Plan,
    enough: int,
    *,
    force: bool = False,
    sequences: bool = True,
) -> Solution:
    """Solution, as from ``solve``, for the task of the plan ``empty``, which has no
    segments yet.

    A task that was already started is continued from the plan's ``restart``. Without
    ``sequences``, one motion must lead to the goal.
    """
    clock = _Clock()
    try:
        return _solved(planner, empty, enough, force, sequences, clock)
    except InfeasibleTaskError:
        task = empty.task
        may = any(obstacle.may_move for obstacle in task.obstacles)
        if empty.may_push or task.legs or not may:
            raise
        planner.keep(0)
        pushing = replace(empty, may_push=True)
        choices = _pushing(planner, pushing, enough)
        if not choices:
            raise
    clock.lap("pushing")
    return Solution(joined(planner, pushing), choices, clock.laps)


def nudged(planner: PlacementPlanner, empty: Plan) -> Plan | None:
    """Plan of one short push for the last leg of the plan ``empty``, which has no
    segments yet. It ends within the goal's tolerances. None if there is none.
    """
    queries = empty.queries
    query = queries[-1]
    alone = query.resisted_by_friction_alone and query.scene.rests
    if not alone or empty.first + 1 < len(queries):
        return None
    choices = [of_leg(choice, empty.first) for choice in nudges(query)]
    if not add_first(planner, empty, choices, False, {}):
        return None
    return joined(planner, empty)


def _pushing(planner: PlacementPlanner, pushing: Plan, enough: int) -> list[Choice]:
    """Plan one motion that may push movable obstacles, and add it to ``planner``.

    Returns the evaluated choices, or nothing if there is no such motion.
    """
    choices = _selected(pushing, enough)
    problems: Problems = {}
    if add_first(planner, pushing, choices, False, problems, TRIES):
        return choices
    return []


def _selected(empty: Plan, enough: int) -> list[Choice]:
    """Choices for the remaining legs."""
    return list(chain.from_iterable(placements(empty.queries, enough, empty.first)))


def _solved(
    planner: PlacementPlanner,
    empty: Plan,
    enough: int,
    force: bool,
    sequences: bool,
    clock: _Clock,
) -> Solution:
    """Solution for the task of the plan ``empty``, which has no segments yet. ``clock``
    records the time of each stage.
    """
    choices = _selected(empty, enough)
    clock.lap("selection")
    if force:
        choices = _beyond_limits(empty, choices, enough)
    if force or not searchable(empty.task):
        choices = prepared(planner, empty, choices, force, empty.first)
        clock.lap("joint_paths")
        return Solution(joined(planner, empty), choices, clock.laps)
    problems: Problems = {}
    tries = TRIES if empty.restart is None else TRIES_ANEW
    added = add_first(planner, empty, choices, False, problems, tries)
    clock.lap("joint_paths")
    if added:
        return Solution(joined(planner, empty), choices, clock.laps)
    if not sequences:
        raise infeasible(empty, choices)
    plan, searched = _search_sequence(planner, empty, choices)
    clock.lap("search")
    return Solution(plan, choices, clock.laps, searched)


def _beyond_limits(empty: Plan, choices: list[Choice], enough: int) -> list[Choice]:
    """``choices``, extended by choices that exceed the limits, for placements without a
    path.

    Their paths are planned without limits on force and workspace. Their refusals refer
    to the true limits.
    """
    with_path = {choice.leg for choice in choices if choice.segments}
    lacking = {choice.leg for choice in choices} - with_path
    if not lacking:
        return choices
    limits = replace(empty.task.limits, normal_force=MOST_FORCE, workspace=None)
    free = replace(empty, task=replace(empty.task, limits=limits))
    refusals = {(one.leg, one.mode): one.refusal for one in reversed(choices)}
    beyond = [
        choice.refused(refusals.get((choice.leg, choice.mode), choice.refusal))
        for choice in _selected(free, enough)
        if choice.segments and choice.leg in lacking
    ]
    found = {choice.leg for choice in beyond}
    kept = [choice for choice in choices if choice.leg not in found]
    return sorted([*kept, *beyond], key=lambda choice: choice.leg)


def plan(task: Task, choice: Choice | None = None, *, force: bool = False) -> Plan:
    """Plan for ``choice``. By default it is the best choice, or the best sequence of
    motions if no single choice does the task.

    Joint paths are not checked here but in ``jobs.run.run``. In a task with legs, all
    other placements take their best choices. With ``force`` an infeasible choice is
    planned too, if it has a path. Raises InfeasibleTaskError, with one reason per
    choice, if no choice or sequence can do the task.
    """
    if Plan(task).at_goal:
        return Plan(task)
    if choice is None:
        return solve(PlansAlone(), task, 1, force=force).plan
    empty = Plan(task)
    if not task.legs:
        return empty.of_choices(selectable(empty, [choice], force=force))
    chosen = []
    for candidates in placements(empty.queries):
        if choice.leg == candidates[0].leg:
            candidates = [choice]
        chosen.append(selectable(empty, candidates, force=force)[0])
    return empty.of_choices(chosen)


def searchable(task: Task) -> bool:
    """Whether sequences of motions may be searched for a task that no single motion
    solves.
    """
    free = not task.legs and task.tool is None
    return free and task.limits.legs > 1 and task.scene.rests


def _search_sequence(
    planner: PlacementPlanner, empty: Plan, choices: Sequence[Choice]
) -> tuple[Plan, SearchNotes]:
    """Plan of the quickest sequence of motions that has joint paths, and a summary of
    the search.

    Raises InfeasibleTaskError if no sequence is found.
    """
    (query,) = empty.queries
    paths = free_space(query).paths_to(query.goal)
    poses = [query.start, query.goal, *waypoints(query, paths)]
    begun = empty.restart is not None
    judged = JUDGED_ANEW if begun else JUDGED
    search = LegSearch(query, paths, poses, ReachScreen(query), evaluate_motion, judged)
    search.know(choices)
    lacking = ""
    for _ in range(SEQUENCES_ANEW if begun else SEQUENCES):
        steps = search.soonest()
        if not steps and search.successors is None:
            search.successors = partial(push_successors, query, paths)
            search.max_work += MOST_FURTHER_ANEW if begun else MOST_FURTHER
            steps = search.soonest()
        if not steps:
            break
        plan = _plan(empty, steps)
        failed, lacking = _prepare(planner, plan)
        if failed is None:
            return plan, search.tried
        search.ban(steps, failed[0], failed[-1], lacking)
    raise _infeasible(empty, choices, search, lacking)


def _plan(empty: Plan, steps: Sequence[Step]) -> Plan:
    """Plan of a sequence. Each of its motions becomes a leg of the plan's task."""
    task = empty.task
    start = empty.restart
    segments: list[Segment] = []
    legs = []
    for i, step in enumerate(steps):
        led = of_leg(step.choice, i).segments
        segments += led
        end = task.goal if step is steps[-1] else led[-1].goal.wrapped
        legs.append(Leg(step.choice.mode, end, task.motion))
    found = tuple(legs) if len(legs) > 1 else ()
    if start is not None:
        start = replace(start, leg=0, legs=found)
    return Plan(replace(task, legs=found), tuple(segments), start, from_search=True)


def _prepare(planner: PlacementPlanner, plan: Plan) -> tuple[list[int] | None, str]:
    """Plan the joint paths of a plan's placements. Paths of placements in common with
    the previous plan are kept.

    Returns the legs of the first placement without a joint path, and its refusal. The
    legs are None if all placements have joint paths.
    """
    placements = plan.by_placement
    same = 0
    for before, after in zip(planner.plans, placements, strict=False):
        if before.segments != after.segments:
            break
        same += 1
    planner.keep(same)
    for placement in placements[same:]:
        try:
            planner.add(placement)
        except InfeasibleTaskError as error:
            lacking = str(error).split(": ", 1)[-1]
            return sorted({segment.leg for segment in placement.segments}), lacking
    return None, ""


def joined(planner: PlacementPlanner, empty: Plan) -> Plan:
    """One plan made of all prepared placements, from the plan ``empty``, which has no
    segments yet.
    """
    segments = chain.from_iterable(part.segments for part in planner.plans)
    return replace(empty, segments=tuple(segments))


def _infeasible(
    empty: Plan, choices: Sequence[Choice], search: LegSearch, shortfall: str
) -> InfeasibleTaskError:
    """Error that explains why neither a single motion nor a sequence solves the task."""
    refused = [choice for choice in choices if not choice.feasible]
    searched = (
        f"; nor does a sequence through up to {len(search.poses) - 2} poses "
        f"({search.evaluated} motions evaluated)"
    )
    last = ""
    if shortfall:
        last = f", the last of {len(search.banned)} that might: {shortfall}"
    return infeasible(empty, refused or choices, searched, last)


class _Clock:
    """Time [s] taken by each stage."""

    def __init__(self) -> None:
        """Start the first stage."""
        self.laps: dict[str, float] = {}
        self._since = perf_counter()

    def lap(self, stage: str) -> None:
        """End a stage, and start the next."""
        now = perf_counter()
        self.laps[stage] = now - self._since
        self._since = now
