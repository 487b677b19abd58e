"""Samples of one planned push from behind: together on arrays, and one by one in the
run loop on the planar engine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

from pushpressslide.batch.fast import installed
from pushpressslide.core.plan import Plan
from pushpressslide.core.task import Task
from pushpressslide_studies.bench.compared import Row, rows_of_runs
from pushpressslide_studies.bench.engines import NO_NUMBA

TASK = "rear-push-rear"
SAMPLES = 10_000  # in a batch
LOOPS = 3  # runs of the loop in a round
ROUNDS = 3


def truths(seed: int) -> list[Row]:
    """A row for each method: the time of a sample, its ratio to the compiled batch, and
    the time [s] for ``SAMPLES`` of them.

    The time includes drawing the samples, but not planning, which is done once.
    """
    from pushpressslide.jobs.batched import planned
    from pushpressslide.taskfile.load import load_task

    task = load_task(TASK)
    plan = planned(task)
    makers: dict[str, Callable[[], float | str]] = {
        "batch, compiled": lambda: (
            _batch(plan, task, seed) if installed() else NO_NUMBA
        ),
        "run loop, planar engine": lambda: _loop(plan, task, seed),
    }
    if installed():
        _batch(plan, task, seed, 1)  # compiled at the first use
    return rows_of_runs(
        makers,
        ROUNDS,
        seconds=lambda time: time,
        figures=lambda _, median: {"samples_s": SAMPLES * median},
    )


def _batch(plan: Plan, task: Task, seed: int, count: int | None = None) -> float:
    """Time [s] per sample."""
    from pushpressslide.jobs.batched import batched, drawn_truths

    count = count or SAMPLES
    began = perf_counter()
    batched(plan, drawn_truths(task, seed, count), seed)
    return (perf_counter() - began) / count


def _loop(plan: Plan, task: Task, seed: int) -> float:
    from pushpressslide.jobs.sampling import varied_task
    from pushpressslide.planar.engine import run

    began = perf_counter()
    for index in range(LOOPS):
        run(replace(plan, task=varied_task(task, index, seed)))
    return (perf_counter() - began) / LOOPS
