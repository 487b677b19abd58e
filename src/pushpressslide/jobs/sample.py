"""One sample of a sweep: draw the task, run it, and summarise the result in a row."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from types import FrameType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from pushpressslide.core.errors import InfeasibleTaskError, SimulationError
from pushpressslide.core.footprint import overlap_area
from pushpressslide.core.knock import Ball, Knock
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.jobs.cluttered import cluttered_task, started_task
from pushpressslide.jobs.rows import Row
from pushpressslide.jobs.run import forced_choices, run_choice, simulate
from pushpressslide.jobs.sampling import random_task, uncertain_task, varied_task
from pushpressslide.jobs.tiers import drawn_world

if TYPE_CHECKING:
    from pushpressslide.core.plan import Plan
    from pushpressslide.core.record import Record
    from pushpressslide.jobs.sweep import SweepOptions

Status = Literal["reached", "missed", "refused", "failed", "not run"]
FIGURES = (
    "final_position_error",
    "final_yaw_error",
    "duration",
    "rms_position_error",
    "rms_yaw_error",
    "max_normal_force",
    "slip_distance",
    "cone_violation_fraction",
    "torque_limit_violation_fraction",
    "realtime_factor",
)
"""Figures of a run's result that its row contains."""
OURS = (
    SimulationError,
    ArithmeticError,
    AssertionError,
    AttributeError,
    LookupError,
    RuntimeError,
    SystemExit,
    TypeError,
    ValueError,
)
"""Errors of the software that become rows and do not end a sweep. An engine may give up
with SystemExit.
"""
KNOCKED = (0.25, 0.65)
"""Range in which the object is knocked, as a share of the direct path."""
FORCED = 3
"""Number of choices of a refused task that are run nevertheless: the best that have a
path.
"""


class SampleTimeoutError(RuntimeError):
    """A sample took longer than its time limit."""


def sample_task(task: Task, options: SweepOptions, index: int) -> Task:
    """Task of sample ``index`` of a sweep over ``task``, in the tier of its world.

    The tier changes nothing else of the task, so that tiers are compared on the same
    tasks. Raises TaskError if no tasks can be drawn for ``task``.
    """
    drawn = _varied(task, options, index)
    if options.tier is None:
        return drawn
    return replace(drawn, truth=replace(drawn.truth, tier=options.tier))


def sample_seed(task: Task, options: SweepOptions, index: int) -> int:
    """Seed of the run of a sample's ``task``: that of the sweep, or in a tier one of its
    own, which gives each sample its own world.
    """
    if task.truth.tier is None:
        return options.seed
    return int(np.random.SeedSequence([options.seed, index]).generate_state(1)[0])


def _varied(task: Task, options: SweepOptions, index: int) -> Task:
    """Task of a sample before its world is drawn."""
    if options.vary == "truth":
        if options.tier is not None:
            name = f"{task.name}-varied-{options.seed}-{index:03d}"
            return replace(task, name=name)
        return varied_task(task, index, options.seed)
    if options.vary == "knocks":
        name = f"{task.name}-knocked-{options.seed}-{index:03d}"
        return replace(task, name=name, disturbances=(_knock(options, index),))
    if options.vary == "start":
        return started_task(task, index, options.seed)
    if options.draw == "cluttered":
        drawn = cluttered_task(task, index, options.seed)
    else:
        drawn = random_task(task, index, options.seed, options.draw)
    if options.world == "uncertain":
        return uncertain_task(drawn, index, options.seed)
    return drawn


class _Sample(NamedTuple):
    """A sample in its world, with the seed of its run."""

    task: Task
    seed: int


def _sample(task: Task, options: SweepOptions, index: int, row: Row) -> _Sample:
    """Sample ``index``. Its ``row`` gets its name, and in a tier also tier and seed."""
    sample = sample_task(task, options, index)
    seed = sample_seed(sample, options, index)
    row["task"] = sample.name
    if sample.truth.tier is not None:
        row["tier"] = sample.truth.tier
        row["seed"] = seed
    return _Sample(drawn_world(sample, seed, options.engine), seed)


def run_sample(task: Task, options: SweepOptions, index: int) -> Row:
    """Run one sample and return its row: reached, missed, refused, or failed after an
    internal error.
    """
    row: Row = {"index": index}
    try:
        sample, seed = _sample(task, options, index, row)
        with _at_most(options.sample_time):
            plan, record, choices = simulate(sample, engine=options.engine, seed=seed)
    except InfeasibleTaskError as error:
        return {**row, "status": "refused", "reason": str(error)}
    except OURS as error:
        reason = f"{type(error).__name__}: {error}"
        return {**row, "status": "failed", "reason": reason}
    chosen = plan.chosen(choices)
    figures = _figures(sample, plan, record)
    return {**row, **figures, "choice": chosen[0].reason if chosen else ""}


def _knock(options: SweepOptions, index: int) -> Knock:
    """Disturbance of a sample's object."""
    rng = np.random.default_rng([options.seed, index])
    share = float(rng.uniform(*KNOCKED))
    return Knock(share=share, ball=Ball("left" if rng.choice([-1, 1]) > 0 else "right"))


def run_forced(task: Task, options: SweepOptions, index: int, rank: int) -> Row:
    """Run the choice with the given ``rank`` of a refused sample. Return its row:
    reached, missed, or not run, with the reason.
    """
    row: Row = {"index": index, "rank": rank}
    try:
        sample, seed = _sample(task, options, index, row)
        # this choice is evaluated, not what follows it
        sample = replace(sample, motion=replace(sample.motion, recoveries=0))
        choices = forced_choices(sample, FORCED)
        if rank >= len(choices):
            reason = f"has {len(choices)} choices with a path"
            return {**row, "status": "not run", "reason": reason}
        row["choice"] = choices[rank].reason
        with _at_most(options.sample_time):
            plan, record = run_choice(
                sample, choices[rank], engine=options.engine, seed=seed
            )
    except (InfeasibleTaskError, *OURS) as error:
        reason = f"{type(error).__name__}: {error}"
        return {**row, "status": "not run", "reason": reason}
    return {**row, **_figures(sample, plan, record)}


def _figures(sample: Task, plan: Plan, record: Record) -> dict[str, Any]:
    """Figures of a run in a row."""
    from pushpressslide.report.metrics import result as measure

    measured = measure(sample, plan, record)
    return {
        "status": "reached" if measured["success"] else "missed",
        "verified": measured["verified"],
        "code": measured["reason"]["code"],
        "reason": measured["reason"]["text"] or measured["reason"]["code"],
        "modes": measured["modes"],
        "legs": max(1, len(plan.task.legs)),
        "planning_time": sum((measured["planning_time"] or {}).values()),
        "knocked": record.meta.get("knocked"),
        "overlap": _overlap(sample, measured),
        "recoveries": sum(event["recovered"] for event in measured["events"]),
        **{name: measured[name] for name in FIGURES},
    }


def _overlap(sample: Task, measured: Mapping[str, Any]) -> float | None:
    """Share of the object's footprint at the goal that the object covers at the end.
    None if it was not recorded.
    """
    body = measured["bodies"].get("object")
    if body is None or body["final_pose"] is None:
        return None
    shape = sample.object.shape
    goal = sample.goal
    covered = overlap_area(shape, Pose2(*body["final_pose"]), shape, goal)
    return covered / overlap_area(shape, goal, shape, goal)


@contextmanager
def _at_most(seconds: float) -> Iterator[None]:
    """Raise SampleTimeoutError if the block takes longer than ``seconds``; 0 means no
    limit.

    It works only in the main thread of a process, since other threads have no alarms.
    """
    alarms = hasattr(signal, "SIGALRM")
    main = threading.current_thread() is threading.main_thread()
    if not (seconds and alarms and main):
        yield
        return

    def ring(number: int, frame: FrameType | None) -> None:
        """Interrupt the block."""
        raise SampleTimeoutError(f"took longer than {seconds:g} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
