"""A task of several goals through the whole pipeline: order, stages, result, files."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pushpressslide.core.bodies import goal_places
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.engines import ArmOptions, engine_named
from pushpressslide.jobs.interrupt import Interrupt, Interrupted
from pushpressslide.jobs.monitor import Output, interrupted
from pushpressslide.jobs.stages import StageOptions, StageRunner
from pushpressslide.report.metrics import result as measure
from pushpressslide.report.series import finite_part
from pushpressslide.report.stage_figures import stages_result
from pushpressslide.report.stage_files import (
    clear_stages,
    save_stage,
    save_stages,
    stage_folder,
)
from pushpressslide.report.stages import StageRun, joined_record, replayed_record


def run_goals(
    task: Task, options: StageOptions, out: Output | None = None
) -> tuple[dict[str, Any], Record]:
    """Run a task of several goals; return its result, and the records of its stages as
    one.

    With ``out`` all files of the run are written there, each stage's as soon as it has
    ended. Raises InfeasibleTaskError before anything moves where nothing brings all
    bodies to their goals, and Interrupted on Ctrl-C once a stage runs, after record and
    result so far are written.
    """
    interrupt = Interrupt()
    monitor = replace(options.monitor, interrupt=interrupt)
    runner = StageRunner(task, replace(options, monitor=monitor))
    runs: list[StageRun] = []
    results: list[dict[str, Any]] = []
    if out is not None:
        out.folder.mkdir(parents=True, exist_ok=True)
        clear_stages(out.folder)
    for run in runner.run():
        with interrupt.held():
            results.append(measure(run.plan.task, run.plan, run.record))
            runs.append(run)
            if out is not None:
                save_stage(out.folder, len(runs) - 1, run, results[-1])
    with interrupt.held():
        stages = [planned.stage for planned in runner.planned]
        result = stages_result(task, stages, runs, results, runner.lacking)
        reason = result["reason"]
        ending = Ending(reason["code"], reason["text"])
        record = joined_record(runs, ending, options.seed)
        if out is not None:
            result["command"] = out.command
            save_stages(out.folder, task, stages, runs, record, result)
    if interrupt():
        raise interrupted(out)
    if out is not None:
        _write_pages(out, task, runs, record, options.models)
    return result, record


def _write_pages(
    out: Output, task: Task, runs: list[StageRun], record: Record, models: str
) -> None:
    """Write the replay of the whole run, the pages of each stage, and the report."""
    from pushpressslide.report.plan_files import write_plan
    from pushpressslide.report.stage_page import write_stages_report

    try:
        for index, run in enumerate(runs):
            write_plan(run.plan, stage_folder(out.folder, index), run.choices)
        _write_replays(out, task, runs, record, models)
        write_stages_report(out.folder)
    except KeyboardInterrupt:
        raise Interrupted(
            f"interrupted; record and result are in {out.folder}, its pages not all"
        ) from None


def _write_replays(
    out: Output, task: Task, runs: list[StageRun], record: Record, models: str
) -> None:
    """Write the replay of the whole run where the engine records all bodies, else those
    of its stages.
    """
    engine = engine_named(record.engine)
    goals = [(shape, pose) for _, shape, pose in goal_places(task)]
    if engine.has_arms:
        arms = ArmOptions(models, video=out.video, goals=goals)
        shown = finite_part(replayed_record(runs, record))
        engine.write_replay(record.plan, shown, out.folder, arms)
        return
    for index, run in enumerate(runs):
        folder = stage_folder(out.folder, index)
        arms = ArmOptions(video=out.video, goals=goals)
        engine.write_replay(run.plan, finite_part(run.record), folder, arms)
