"""Planning of pushes past a post: the search over pushes compared with OMPL's planners.

A box must be pushed from behind to the other side of a post. OMPL's planners search for
a single push on one face, in OMPL's space of Dubins curves, with the turning radius of
the face's car. The search of this package may also let go and push another face. Both
keep the same footprint clear of the same post. Neither plans joint paths.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, ObjectModel, Obstacle, Task
from pushpressslide.modes import MODES
from pushpressslide.planning.free_space import FreeSpace
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.rear_car import axle_ends
from pushpressslide.rom.drives import RearSteerDrive
from pushpressslide.selection.placement_planner import PlansAlone
from pushpressslide.selection.solve import solve
from pushpressslide.selection.waypoints import free_space
from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.bench.compared import Row, missing, not_installed

PROBLEMS = 20
MODE = "rear_push"
WIDTHS = (0.08, 0.16)  # [m] of the box
POST = (0.06, 0.12)  # [m] wide
ASIDE = 0.05  # [m] of the post from the middle of the straight way
START = (0.45, 0.28)  # [m] x and y; the goal is on the other side of y = 0
SPREAD = 0.08  # [m] of start and goal
TURNED = math.radians(40.0)  # of start and goal, from where the way leads
ROOM = 0.5  # [m] round the box of start and goal, in which OMPL's planners look
PATIENCE = 10.0  # [s] that one of OMPL's planners may take
PLANNERS = ("RRTConnect", "RRT", "KPIECE1", "BITstar")
OURS = "search over pushes"
NO_OMPL = not_installed("pushpressslide-studies[bench]")


class PlannerResult(NamedTuple):
    """Result of one problem."""

    wall_time: float  # [s]
    length: float | None  # [m] of the virtual axle's way; None: no plan
    takes: float = 0.0  # [s] at full speed, and for each push anew
    pushes: int = 1
    checks: int = 0  # of whether a pose is free


def planners(seed: int) -> list[Row]:
    """A row for each planner: the number of solved problems, the planning time [s], the
    medians of the plans' path lengths [m], times [s] and numbers of pushes, and the
    number of checked poses.
    """
    tasks = list(problems(seed))
    rows = [_row(OURS, [ours(task) for task in tasks])]
    try:
        from ompl import util
    except ModuleNotFoundError:
        return rows + [missing(f"OMPL, {name}", NO_OMPL) for name in PLANNERS]
    util.setLogLevel(util.LogLevel.LOG_ERROR)
    util.RNG.setSeed(seed + 1)
    for name in PLANNERS:
        rows.append(_row(f"OMPL, {name}", [_with_ompl(name, task) for task in tasks]))
    return rows


def problems(seed: int) -> Iterator[Task]:
    """Yield tasks with a post on the straight path of a box."""
    base = load_task("rear-push-rear")
    rng = np.random.default_rng(seed)
    made = 0
    while made < PROBLEMS:
        task = _problem(base, rng)
        space = free_space(task.query)
        ends = [task.start, task.goal]
        if space.free(ends).all() and not space.straight(*ends):
            made += 1
            yield task


def _problem(base: Task, rng: np.random.Generator) -> Task:
    """One random problem. Its start or its goal may collide with the obstacle."""
    ahead = -0.5 * math.pi
    ends = []
    for side in (1.0, -1.0):
        x, y = rng.uniform(-SPREAD, SPREAD, 2)
        yaw = ahead + float(rng.uniform(-TURNED, TURNED))
        ends.append(Pose2(START[0] + x, side * START[1] + y, yaw))
    start, goal = ends
    x, y = rng.uniform(-ASIDE, ASIDE, 2)
    middle = (0.5 * (start.x + goal.x) + x, 0.5 * (start.y + goal.y) + y)
    width = float(rng.uniform(*POST))
    turn = float(rng.uniform(0.0, math.pi))
    post = Obstacle("post", Box((width, width, 0.15)), Pose2(*middle, turn))
    length, depth = rng.uniform(*WIDTHS, 2).tolist()
    body = ObjectModel(Box((length, depth, 0.08)), 0.8, (0.0, 0.0))
    task = replace(base, object=body, start=start, goal=goal, obstacles=(post,))
    return replace(task, modes=(MODE,), motion=base.motion.freed)


def ours(task: Task) -> PlannerResult:
    """Result of this package's search for a task, with its time."""
    began = perf_counter()
    try:
        plan = solve(PlansAlone(), task, 1).plan
    except InfeasibleTaskError:
        return PlannerResult(perf_counter() - began, None)
    spent = perf_counter() - began
    length = sum(segment.path.length for segment in plan.segments)
    pushes = len(plan.placements)
    anew = (pushes - 1) * overhead(task.motion)
    return PlannerResult(spent, length, length / task.motion.speed + anew, pushes)


def _with_ompl(name: str, task: Task) -> PlannerResult:
    """Result of an OMPL planner, with its time.

    The face is the one with the shortest push path if there were no post.
    """
    from ompl import base as ob
    from ompl import geometric as og

    began = perf_counter()
    segment = _unhindered(task)
    drive = segment.drive
    assert isinstance(drive, RearSteerDrive)
    low, high = drive.car.curvature_limits
    tightest = task.motion.curvature_margin * min(high, -low)
    space = ob.DubinsStateSpace(1.0 / tightest)
    space.setBounds(_bounds(ob, (task.start, task.goal)))
    free = _Free(free_space(task.query), task, drive)
    setup = og.SimpleSetup(space)
    setup.setStateValidityChecker(free)
    ends = [_state(space, X_WV) for X_WV in axle_ends(task.query.body_ends, drive)]
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(getattr(og, name)(setup.getSpaceInformation()))
    setup.solve(PATIENCE)
    spent = perf_counter() - began
    if not setup.haveExactSolutionPath():
        return PlannerResult(spent, None, checks=free.checks)
    length = setup.getSolutionPath().length()
    return PlannerResult(spent, length, length / task.motion.speed, checks=free.checks)


def _unhindered(task: Task) -> Segment:
    """Fastest push of a task without its post."""
    alone = replace(task, obstacles=()).query
    (segment,) = MODES[MODE].choices(alone, 1)[0].segments
    return segment


def _bounds(ob: Any, ends: Sequence[Pose2]) -> Any:
    """Region that OMPL searches for the axle."""
    bounds = ob.RealVectorBounds(2)
    for axis, values in enumerate(zip(*(X.position for X in ends), strict=True)):
        bounds.setLow(axis, min(values) - ROOM)
        bounds.setHigh(axis, max(values) + ROOM)
    return bounds


def _state(space: Any, X: Pose2) -> Any:
    """A pose as an OMPL state."""
    state = space.allocState()
    state.setXY(X.x, X.y)
    state.setYaw(X.yaw)
    return state


class _Free:
    """Check whether the footprint is free for a position of the axle. It counts its
    calls.
    """

    def __init__(self, space: FreeSpace, task: Task, drive: RearSteerDrive) -> None:
        self.checks = 0
        self._space = space
        self._X_VG = drive.X_BV.inverse().compose(task.X_GB.inverse())

    def __call__(self, state: Any) -> bool:
        """Whether an OMPL state is free."""
        self.checks += 1
        X_WV = Pose2(state.getX(), state.getY(), state.getYaw())
        return bool(self._space.free([X_WV.compose(self._X_VG)])[0])


def _row(what: str, results: Sequence[PlannerResult]) -> Row:
    """Row of one planner."""
    times = [one.wall_time for one in results]
    done = [one for one in results if one.length is not None]
    return {
        "what": what,
        "planned": len(done),
        "of": len(results),
        "median_s": float(np.median(times)),
        "p95_s": float(np.percentile(times, 95)),
        "way_m": _middle([one.length for one in done if one.length is not None]),
        "takes_s": _middle([one.takes for one in done]),
        "pushes": _middle([float(one.pushes) for one in done]),
        "checks": float(np.median([one.checks for one in results])),
        "note": "",
    }


def _middle(values: Sequence[float]) -> float | None:
    """Median of some values. None if there are none."""
    return float(np.median(values)) if values else None
