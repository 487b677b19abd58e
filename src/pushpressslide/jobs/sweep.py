"""Many runs of one task under random variations, or of many random tasks.

The runs are parallel and can be resumed, and end in one table.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, Literal

from pushpressslide.core.errors import PushPressSlideError, Shown, TaskError
from pushpressslide.core.task import Task
from pushpressslide.core.truth import TierName
from pushpressslide.core.whole_file import write_whole
from pushpressslide.jobs.cluster import cluster
from pushpressslide.jobs.engines import DEFAULT, engine_named
from pushpressslide.jobs.interrupt import blocked_for_children, terminated_as_interrupt
from pushpressslide.jobs.parallel import worker_pool
from pushpressslide.jobs.rows import Row, Rows, key_of, source_hash
from pushpressslide.jobs.sample import FORCED, run_forced, run_sample, sample_task
from pushpressslide.jobs.sampling import Draw
from pushpressslide.jobs.summary import ATTEMPTED, summarise, write_table
from pushpressslide.report.metrics import installed_versions

Vary = Literal["truth", "tasks", "start", "knocks"]
World = Literal["known", "uncertain", "tier1", "tier2", "tier3"]
Progress = Callable[[int, int], None]
Work = Callable[[], Row]
HARDLY = 50  # drawn tasks for each attempted one, beyond which drawing ends


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """Number and kind of a sweep's samples, and how they are run."""

    samples: int = 0  # number of samples, if no ``attempts`` are given
    attempts: int = 0  # samples that are not refused: drawn until there are so many
    # varied quantity: the true parameters, the whole task, the start, or time and side
    # of a knock by another body
    vary: Vary = "truth"
    draw: Draw = "ahead"  # kind of new tasks
    # whether new tasks are as believed, or the tier of all samples
    world: World = "known"
    seed: int = 0
    engine: str = DEFAULT
    check_refusals: int = 0  # refused samples to run all the same
    sample_time: float = 0.0  # [s] largest wall time of a sample; 0: unlimited
    jobs: int = 0  # processes; 0: one for each core
    cluster: str = ""  # address of a Dask scheduler whose workers run the samples
    force: bool = False  # run finished samples again
    batched: bool = False  # one plan and all samples on arrays, without engine and arms

    @property
    def engine_name(self) -> str:
        """Name of the engine that runs the samples."""
        return "batched" if self.batched else str(self.engine)

    @property
    def tier(self) -> TierName | None:
        """Tier of the samples' worlds. None without one."""
        if self.world == "known" or self.world == "uncertain":
            return None
        return self.world

    def settings(self, task: Task) -> dict[str, Any]:
        """Settings that must agree for a finished sample to be reused."""
        from pushpressslide.taskfile.dump import task_data

        return {
            "task": task_data(task),
            "seed": self.seed,
            "engine": self.engine_name,
            "vary": self.vary,
            "draw": self.draw,
            "world": self.world,
            "versions": installed_versions(),
            "source": source_hash(),
        }


def sweep(
    task: Task, options: SweepOptions, out: Path, progress: Progress | None = None
) -> dict[str, Any]:
    """Run the samples of ``task`` and return the summary.

    Every finished sample is a row in ``out``/rows.jsonl and is not run again without
    ``force``. Rows of other tasks, options or sources in that file are ignored. For the
    first ``check_refusals`` refused samples, the best choices are run nevertheless. A
    refusal is true if these runs miss the goal. Raises TaskError if no new tasks can be
    drawn for ``task``.
    """
    if options.vary == "knocks" and not engine_named(options.engine).has_arms:
        raise PushPressSlideError(
            f"engine: {options.engine!s} has no body that knocks; allowed: {DEFAULT!s}"
        )
    if options.world == "uncertain" and options.vary != "tasks":
        raise PushPressSlideError(
            f"--world: 'uncertain' is not allowed with --vary {options.vary}; allowed: "
            "with --vary tasks, or a tier"
        )
    if task.goals:
        bodies = [goal.body for goal in task.goals]
        reason = "allowed: null; a sweep varies tasks of one goal"
        raise TaskError(task.source or task.name, "goals", bodies, reason)
    if options.batched:
        _check_batched(options)
        if task.disturbances:
            raise TaskError(
                task.source or task.name,
                "disturbances",
                Shown("given"),
                "allowed with --batched: []",
            )
    else:
        engine_named(options.engine)
    sample_task(task, options, 0)
    path = out / "rows.jsonl"
    if options.force:
        path.unlink(missing_ok=True)
    settings = options.settings(task)
    rows = Rows(path, key_of(settings))
    if options.batched:
        return _batched(task, options, out, rows)
    with terminated_as_interrupt(), _pool(options) as (pool, processes):
        drawn = _draw(pool, processes, task, options, rows, progress)
        _check_refusals(pool, task, options, rows, drawn)
    return _write_results(out, task, options, rows, drawn)


def _check_batched(options: SweepOptions) -> None:
    """Raise PushPressSlideError for options that batches do not support."""
    checks = (
        ("--vary", options.vary, "truth"),
        ("--world", options.world, "known"),
        ("--attempts", options.attempts, 0),
        ("--check-refusals", options.check_refusals, 0),
        ("--sample-time", options.sample_time, 0.0),
        ("--cluster", options.cluster, ""),
    )
    for name, value, allowed in checks:
        if value != allowed:
            raise PushPressSlideError(
                f"{name}: {value!r} is not allowed with --batched; allowed: {allowed!r}"
            )


def _batched(
    task: Task, options: SweepOptions, out: Path, rows: Rows
) -> dict[str, Any]:
    """Run the samples on arrays if rows are missing, and return the summary."""
    from pushpressslide.jobs.batched import batched_rows, batched_samples

    samples = batched_samples(task, options.seed, options.samples)
    made = batched_rows(task, options.seed, samples.outcomes)
    rows.extend(row for row in made if row["index"] not in rows)
    summary = _write_results(out, task, options, rows, options.samples)
    spent = samples.drawing_time + samples.running_time
    return summary | {"time_per_sample": spent / options.samples}


@contextmanager
def _pool(options: SweepOptions) -> Iterator[tuple[Executor, int]]:
    """Open the pool that runs the samples. Yield it with the number of samples run at a
    time.
    """
    if options.cluster:
        if options.sample_time:
            raise PushPressSlideError(
                f"--sample-time: {options.sample_time:g} is not allowed with --cluster, "
                "whose workers have no alarms; allowed: 0"
            )
        with cluster(options.cluster) as (pool, processes):
            yield pool, processes
        return
    with worker_pool(options.jobs) as own:
        yield own, options.jobs or os.cpu_count() or 1


def _draw(
    pool: Executor,
    processes: int,
    task: Task,
    options: SweepOptions,
    rows: Rows,
    progress: Progress | None,
) -> int:
    """Run samples until enough of them are complete. Return the number of complete
    samples.
    """
    running: set[Future[Row]] = set()
    numbers = count()
    drawn = _CompleteSamples(options, rows)
    while not drawn.complete():
        while len(running) < processes:
            index = next(i for i in numbers if i not in rows)
            if options.samples and index >= options.samples:
                break
            with blocked_for_children():
                running.add(pool.submit(run_sample, task, options, index))
        finished, running = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            rows.add(future.result())
        if progress is not None:
            progress(drawn.done, options.samples or options.attempts)
    for future in running:
        if not future.cancel():
            rows.add(future.result())
    return drawn.number


class _CompleteSamples:
    """The complete samples: from the first on without a gap, up to the requested
    number.
    """

    def __init__(self, options: SweepOptions, rows: Rows) -> None:
        self._options = options
        self._rows = rows
        self.number = 0
        self.attempted = 0

    def complete(self) -> bool:
        """Whether enough samples are complete. Raises PushPressSlideError if hardly any
        of the drawn tasks could be attempted.
        """
        options = self._options
        while not self._enough():
            if self.number not in self._rows:
                return False
            self.attempted += self._rows.status(self.number) in ATTEMPTED
            self.number += 1
            if options.attempts and self.number > HARDLY * max(self.attempted, 2):
                raise PushPressSlideError(
                    f"only {self.attempted} of {self.number} drawn tasks could be "
                    f"attempted, {options.attempts} are wanted"
                )
        return True

    def _enough(self) -> bool:
        options = self._options
        if options.attempts:
            return self.attempted >= options.attempts
        return self.number >= options.samples

    @property
    def done(self) -> int:
        """Number of requested samples, or attempts, that are done."""
        return self.attempted if self._options.attempts else self.number


def _check_refusals(
    pool: Executor, task: Task, options: SweepOptions, rows: Rows, sample_count: int
) -> None:
    """Run the best choices of the first refused samples nevertheless."""
    refused = [i for i in range(sample_count) if rows.status(i) == "refused"]
    work = [
        partial(run_forced, task, options, index, rank)
        for index in refused[: options.check_refusals]
        for rank in range(FORCED)
        if not rows.has_forced(index, rank)
    ]
    for row in _in_order(pool, work):
        rows.add(row)


def _in_order(pool: Executor, work: Sequence[Work]) -> Iterator[Row]:
    """Yield the rows of ``work`` in the same order."""
    with blocked_for_children():
        futures = [pool.submit(piece) for piece in work]
    for future in futures:
        yield future.result()


def _write_results(
    out: Path, task: Task, options: SweepOptions, rows: Rows, sample_count: int
) -> dict[str, Any]:
    """Write table and result files, and return the summary."""
    summary = {
        "task": task.name,
        "seed": options.seed,
        "engine": options.engine_name,
        "vary": options.vary,
        "draw": options.draw,
        "world": options.world,
        **summarise(rows.read(sample_count), rows.read_forced(sample_count)),
        "source": source_hash(),
        "versions": installed_versions(),
    }
    write_table(
        out / "table.md", rows.read(sample_count), rows.read_forced(sample_count)
    )
    write_whole(out / "result.json", json.dumps(summary, indent=1).encode())
    return summary
