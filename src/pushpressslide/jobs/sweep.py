"""Many runs of one task under random variations, or of many random tasks.

They run in parallel, are resumable, and leave one table at the end.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pushpressslide.core.errors import InfeasibleTaskError, SimulationError
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.jobs.engines import DEFAULT
from pushpressslide.jobs.interrupt import blocked_for_children
from pushpressslide.jobs.parallel import worker_pool
from pushpressslide.jobs.run import simulate, versions
from pushpressslide.jobs.sampling import random_task, varied_task

Vary = Literal["truth", "tasks"]
Progress = Callable[[int, int], None]
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
"""Of a run's result, what its row holds."""


def sample_task(task: Task, vary: Vary, index: int, seed: int) -> Task:
    """Return sample ``index`` of a sweep over ``task``."""
    draw = varied_task if vary == "truth" else random_task
    return draw(task, index, seed)


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """What a sweep draws, and how it runs the samples."""

    samples: int
    vary: Vary = "truth"  # what is true of the task, or new tasks for its robots
    seed: int = 0
    engine: str = DEFAULT
    check_refusals: int = 0  # refused samples to run all the same
    jobs: int = 0  # processes; 0: one for each core
    force: bool = False  # run finished samples again

    def settings(self, task: Task) -> dict[str, Any]:
        """Return what a finished sample must agree with to stand for a new run."""
        return {
            "task": task.name,
            "samples": self.samples,
            "seed": self.seed,
            "engine": self.engine,
            "vary": self.vary,
        }


def run_sample(
    task: Task, options: SweepOptions, index: int, anyway: bool
) -> dict[str, Any]:
    """Run one sample and return its row.

    ``anyway`` runs it even where it was judged infeasible.
    """
    from pushpressslide.report.metrics import result as measure

    seed = options.seed
    sample = sample_task(task, options.vary, index, seed)
    row: dict[str, Any] = {"index": index, "task": sample.name, "forced": anyway}
    try:
        plan, record, choices = simulate(
            sample, engine=options.engine, seed=seed, force=anyway
        )
    except InfeasibleTaskError as error:
        return {**row, "status": "refused", "reason": str(error)}
    except (SimulationError, ValueError, RuntimeError) as error:
        if not anyway:
            raise
        return {**row, "status": "missed", "reason": f"could not even be run: {error}"}
    measured = measure(sample, plan, record, versions())
    return {
        **row,
        "status": "reached" if measured["success"] else "missed",
        "reason": measured["reason"]["text"] or measured["reason"]["code"],
        "choice": plan.chosen(choices)[0].reason,
        **{name: measured[name] for name in FIGURES},
    }


def sweep(
    task: Task, options: SweepOptions, out: Path, progress: Progress | None = None
) -> dict[str, Any]:
    """Run the samples of ``task`` and return the summary.

    Every finished sample is kept in ``out``/samples and is not run again, unless
    ``force``. The first ``check_refusals`` refused samples are run all the same: a
    refusal is true if that run misses the goal. Raises TaskError where no new tasks can
    be drawn for ``task``.
    """
    sample_task(task, options.vary, 0, options.seed)
    folder = out / "samples"
    folder.mkdir(parents=True, exist_ok=True)
    settings = options.settings(task)
    rows = {} if options.force else _finished(folder, settings)
    forced: list[dict[str, Any]] = []

    def count() -> None:
        """Report how many runs are done."""
        if progress is not None:
            total = options.samples + options.check_refusals
            progress(len(rows) + len(forced), total)

    with worker_pool(options.jobs) as pool:
        missing = [i for i in range(options.samples) if i not in rows]
        for sample in _run_samples(pool, task, options, missing, anyway=False):
            index = sample["index"]
            rows[index] = {**sample, "settings": settings}
            text = json.dumps(rows[index], indent=1)
            write_whole(folder / f"{index:05d}.json", text.encode())
            count()
        refused = [i for i in sorted(rows) if rows[i]["status"] == "refused"]
        checked = refused[: options.check_refusals]
        for sample in _run_samples(pool, task, options, checked, anyway=True):
            forced.append(sample)
            count()
    forced.sort(key=lambda row: row["index"])  # they came as they finished
    return _write_results(out, settings, [rows[i] for i in sorted(rows)], forced)


def _finished(folder: Path, settings: dict[str, Any]) -> dict[int, dict[str, Any]]:
    """Return the rows in ``folder`` that an earlier sweep with ``settings`` left."""
    rows = [json.loads(path.read_text()) for path in folder.glob("[0-9]*.json")]
    return {int(row["index"]): row for row in rows if row.get("settings") == settings}


def _run_samples(
    pool: ProcessPoolExecutor,
    task: Task,
    options: SweepOptions,
    indices: list[int],
    *,
    anyway: bool,
) -> Iterator[dict[str, Any]]:
    """Yield the rows of some samples, the first to finish first."""
    with blocked_for_children():
        futures = [pool.submit(run_sample, task, options, i, anyway) for i in indices]
    for future in as_completed(futures):
        yield future.result()


def _write_results(
    out: Path,
    settings: dict[str, Any],
    rows: list[dict[str, Any]],
    forced: list[dict[str, Any]],
) -> dict[str, Any]:
    """Write table and result, and return the summary."""
    summary = {**settings, **summarise(rows, forced), "versions": versions()}
    write_whole(out / "table.md", table(rows, forced).encode())
    text = json.dumps({**summary, "rows": rows}, indent=1)
    write_whole(out / "result.json", text.encode())
    return summary


def summarise(
    rows: list[dict[str, Any]], forced: list[dict[str, Any]]
) -> dict[str, Any]:
    """Return counts and spreads; None where there is nothing to count."""
    reached = [r for r in rows if r["status"] == "reached"]
    accepted = [r for r in rows if r["status"] != "refused"]

    def share(part: list[Any], whole: list[Any]) -> float | None:
        """Return a share of rows; None of none."""
        return len(part) / len(whole) if whole else None

    def spread(name: str) -> dict[str, float] | None:
        """Return the spread of a figure over rows."""
        values = sorted(float(r[name]) for r in accepted if r.get(name) is not None)
        if not values:
            return None
        return {
            "median": values[len(values) // 2],
            "p95": values[int(0.95 * (len(values) - 1))],
            "max": values[-1],
        }

    return {
        "accepted": len(accepted),
        "reached": len(reached),
        "refused": len(rows) - len(accepted),
        "accepted_share": share(accepted, rows),
        "reached_share_of_accepted": share(reached, accepted),
        "refusals_run_anyway": len(forced),
        "refusals_that_failed": sum(r["status"] != "reached" for r in forced),
        "final_position_error": spread("final_position_error"),
        "final_yaw_error": spread("final_yaw_error"),
        "duration": spread("duration"),
        "slip_distance": spread("slip_distance"),
    }


def table(rows: list[dict[str, Any]], forced: list[dict[str, Any]]) -> str:
    """Return the rows as a Markdown table.

    The refusals that were run all the same are below it.
    """

    def line(r: dict[str, Any]) -> str:
        """Return one row of the table."""
        position, yaw, time = (
            r.get(n) for n in ("final_position_error", "final_yaw_error", "duration")
        )
        figures = " | | "
        if position is not None and yaw is not None and time is not None:
            figures = f"{1e3 * position:.1f} | {math.degrees(yaw):.2f} | {time:.1f}"
        why = r.get("choice") if r["status"] == "reached" else r["reason"]
        cell = str(why).replace("|", "/")[:160]
        return f"| {r['index']} | {r['status']} | {figures} | {cell} |"

    head = "| sample | outcome | position error [mm] | yaw error [deg] | time [s] | why |\n"
    head += "|---|---|---|---|---|---|\n"

    def listed(part: list[dict[str, Any]]) -> str:
        """Return the rows of a list."""
        return head + "\n".join(line(r) for r in part) + "\n"

    if not forced:
        return listed(rows)
    return f"{listed(rows)}\nRefused, but run anyway:\n\n{listed(forced)}"
