"""Many runs: one task under random variations, or many random tasks; in parallel,
resumable, one table at the end.
"""

from __future__ import annotations

import json
import math
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any, Literal

from pushpressslide.core.errors import InfeasibleTaskError, SimulationError
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.jobs.interrupt import blocked_for_children
from pushpressslide.jobs.run import Engine, simulate, versions
from pushpressslide.jobs.sampling import random_task, varied_task

Vary = Literal["truth", "tasks"]
Progress = Callable[[int, int], None]


def sample_task(task: Task, vary: Vary, index: int, seed: int) -> Task:
    """Return sample ``index`` of a sweep over ``task``."""
    draw = varied_task if vary == "truth" else random_task
    return draw(task, index, seed)


def run_sample(
    task: Task, vary: Vary, index: int, seed: int, engine: Engine, anyway: bool
) -> dict[str, Any]:
    """Run one sample and return its row; ``anyway`` runs it even where it was judged
    infeasible.
    """
    from pushpressslide.report.metrics import result as measure

    sample = sample_task(task, vary, index, seed)
    row: dict[str, Any] = {"index": index, "task": sample.name, "forced": anyway}
    try:
        plan, record, choices = simulate(sample, engine=engine, seed=seed, force=anyway)
    except InfeasibleTaskError as error:
        return {**row, "status": "refused", "reason": str(error)}
    except (SimulationError, ValueError, RuntimeError) as error:
        if not anyway:
            raise
        return {**row, "status": "missed", "reason": f"could not even be run: {error}"}
    measured = measure(sample, plan, record, versions())
    kept = (
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
    return {
        **row,
        "status": "reached" if measured["success"] else "missed",
        "reason": measured["reason"]["text"] or measured["reason"]["code"],
        "choice": plan.chosen(choices)[0].reason,
        **{name: measured[name] for name in kept},
    }


def sweep(
    task: Task,
    *,
    samples: int,
    out: Path,
    progress: Progress | None = None,
    engine: Engine = "drake",
    jobs: int = 0,
    seed: int = 0,
    force: bool = False,
    vary: Vary = "truth",
    check_refusals: int = 0,
) -> dict[str, Any]:
    """Run ``samples`` variations of ``task`` and return the summary; every finished
    sample is kept in ``out``/samples.

    ``vary``: "truth" keeps the task and changes what is true of it, "tasks" draws new
    tasks for the same robots. The first ``check_refusals`` refused samples are run all
    the same: a refusal is true if that run misses the goal. Samples that are already
    there are not run again, unless ``force``. Raises TaskError where no new tasks can
    be drawn for ``task``.
    """
    sample_task(task, vary, 0, seed)
    folder = out / "samples"
    folder.mkdir(parents=True, exist_ok=True)
    settings = {
        "task": task.name,
        "samples": samples,
        "seed": seed,
        "engine": engine,
        "vary": vary,
    }
    rows: dict[int, dict[str, Any]] = {}
    if not force:
        for path in folder.glob("[0-9]*.json"):
            row = json.loads(path.read_text())
            if row.get("settings") == settings:
                rows[int(row["index"])] = row
    forced: dict[int, dict[str, Any]] = {}
    total = samples + check_refusals
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs or os.cpu_count() or 1, mp_context=context) as pool:

        def work(
            indices: list[int], anyway: bool, into: dict[int, dict[str, Any]]
        ) -> None:
            with blocked_for_children():
                waiting = {
                    pool.submit(run_sample, task, vary, i, seed, engine, anyway): i
                    for i in indices
                }
            try:
                for future in as_completed(waiting):
                    row = {**future.result(), "settings": settings}
                    into[waiting[future]] = row
                    if not anyway:
                        write_whole(
                            folder / f"{row['index']:05d}.json",
                            json.dumps(row, indent=1).encode(),
                        )
                    if progress is not None:
                        progress(len(rows) + len(forced), total)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                for process in multiprocessing.active_children():
                    # its sample is lost; the finished ones are on disk
                    process.terminate()
                raise

        work([i for i in range(samples) if i not in rows], False, rows)
        refused = [i for i in sorted(rows) if rows[i]["status"] == "refused"][
            :check_refusals
        ]
        work(refused, True, forced)
    ordered = [rows[i] for i in sorted(rows)]
    summary = {
        **settings,
        **summarise(ordered, [forced[i] for i in sorted(forced)]),
        "versions": versions(),
    }
    write_whole(out / "table.md", table(ordered, list(forced.values())).encode())
    write_whole(
        out / "result.json", json.dumps({**summary, "rows": ordered}, indent=1).encode()
    )
    return summary


def summarise(
    rows: list[dict[str, Any]], forced: list[dict[str, Any]]
) -> dict[str, Any]:
    """Return counts and spreads; None where there is nothing to count."""
    reached = [r for r in rows if r["status"] == "reached"]
    accepted = [r for r in rows if r["status"] != "refused"]

    def spread(name: str) -> dict[str, float] | None:
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
        "accepted_share": len(accepted) / len(rows) if rows else None,
        "reached_share_of_accepted": len(reached) / len(accepted) if accepted else None,
        "refusals_run_anyway": len(forced),
        "refusals_that_failed": sum(r["status"] != "reached" for r in forced),
        "final_position_error": spread("final_position_error"),
        "final_yaw_error": spread("final_yaw_error"),
        "duration": spread("duration"),
        "slip_distance": spread("slip_distance"),
    }


def table(rows: list[dict[str, Any]], forced: list[dict[str, Any]]) -> str:
    """Return the rows as a Markdown table, and below it the refusals that were run all
    the same.
    """

    def line(r: dict[str, Any]) -> str:
        position, yaw, time = (
            r.get(n) for n in ("final_position_error", "final_yaw_error", "duration")
        )
        figures = " | | "
        if position is not None and yaw is not None and time is not None:
            figures = f"{1e3 * position:.1f} | {math.degrees(yaw):.2f} | {time:.1f}"
        why = r.get("choice") if r["status"] == "reached" else r["reason"]
        return f"| {r['index']} | {r['status']} | {figures} | {str(why).replace('|', '/')[:160]} |"

    head = "| sample | outcome | position error [mm] | yaw error [deg] | time [s] | why |\n"
    head += "|---|---|---|---|---|---|\n"
    text = head + "\n".join(line(r) for r in rows) + "\n"
    if forced:
        text += (
            "\nRefused, but run anyway:\n\n"
            + head
            + "\n".join(line(r) for r in forced)
            + "\n"
        )
    return text
