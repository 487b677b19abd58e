"""One task through the whole pipeline: select, plan, run on an engine, measure, write
everything that a user looks at.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.knock import Knock
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.record import Figures, Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.ask import checked
from pushpressslide.jobs.engines import DEFAULT, ArmOptions, engine_named
from pushpressslide.jobs.goals import run_goals
from pushpressslide.jobs.interrupt import Interrupt, Interrupted
from pushpressslide.jobs.monitor import Monitor as Monitor
from pushpressslide.jobs.monitor import Output as Output
from pushpressslide.jobs.monitor import interrupted
from pushpressslide.jobs.stages import StageOptions
from pushpressslide.modes.base import ENOUGH
from pushpressslide.selection.planner import plan_of
from pushpressslide.selection.select import MANY, select
from pushpressslide.selection.solve import joined, solve


def simulate(
    task: Task,
    *,
    engine: str = DEFAULT,
    seed: int = 0,
    force: bool = False,
    models: str = "generated",
    monitor: Monitor | None = None,
    knock: Knock | None = None,
    execution: Execution = USUAL,
) -> tuple[Plan, Record, list[Choice]]:
    """Select, plan and run, and return the plan, the record and all choices.

    Choices that were passed over say why. Where the engine has arms a choice must also
    have a joint path: the first that has one is run. ``force`` runs the best choice
    that has a path even where it was judged infeasible. ``knock``: another body pushes
    the object aside, on an engine with arms. ``execution`` may change the laws. Raises
    InfeasibleTaskError where nothing can do the task.
    """
    monitor = monitor or Monitor()
    chosen = engine_named(engine)
    preparation = chosen.preparation(force)
    # choices after the first are for where that has no joint path
    enough = ENOUGH if chosen.has_arms else 1
    solution = solve(preparation, task, enough, force=force)
    plan = solution.plan
    with monitor.held():
        record = chosen.run(
            plan,
            RunOptions(
                seed, monitor.progress, monitor.interrupt or bool, execution=execution
            ),
            ArmOptions(models, preparation.paths, monitor.live, knock=knock),
        )
    meta = {**record.meta, **solution.notes}
    return record.plan, replace(record, meta=meta), solution.choices


def forced_choices(task: Task, count: int) -> list[Choice]:
    """Return the ``count`` best-ranked choices that have a path, feasible or not."""
    return [choice for choice in select(task, MANY) if choice.segments][:count]


def run_choice(
    task: Task, choice: Choice, *, engine: str = DEFAULT, seed: int = 0
) -> tuple[Plan, Record]:
    """Run one choice of ``task``, whatever was judged of it.

    Raises InfeasibleTaskError where an arm has no joint path at all for it.
    """
    chosen = engine_named(engine)
    preparation = chosen.preparation(True)
    for placement in plan_of(task, [choice]).by_placement:
        preparation.add(placement)
    plan = joined(preparation, task)
    options = ArmOptions(paths=preparation.paths)
    record = chosen.run(plan, RunOptions(seed), options)
    return record.plan, record


def run(
    what: Task | Plan,
    *,
    engine: str = DEFAULT,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
    models: str = "generated",
) -> Record:
    """Run a plan, or select, plan and run a task, and return the record of what
    happened, measured: ``success`` and ``figures``.

    Raises TaskError for a task that a file could not say, and InfeasibleTaskError
    before anything moves where it cannot be done.
    """
    if not isinstance(what, Plan):
        task = checked(what)
        monitor = Monitor(progress)
        if task.goals:
            options = StageOptions(engine, seed, False, models, monitor)
            figures, record = run_goals(task, options)
            return replace(record, figures=figures)
        _, record, _ = simulate(
            task, engine=engine, seed=seed, models=models, monitor=monitor
        )
        return measured(record, task)
    record = engine_named(engine).run(
        what, RunOptions(seed, progress), ArmOptions(models)
    )
    return measured(record, what.task)


def measured(record: Record, task: Task) -> Record:
    """Return a record of a run of ``task`` with its figures."""
    return replace(record, figures=measured_figures(record, task))


def measured_figures(record: Record, task: Task | None = None) -> Figures:
    """Return what result.json holds for a record: SI units and radians, None where a
    figure does not apply; of a run of ``task``, by default that of its plan.
    """
    from pushpressslide.report.metrics import result

    measures = result(task or record.plan.task, record.plan, record)
    return Figures(measures)


def run_task(
    task: Task,
    *,
    engine: str = DEFAULT,
    seed: int = 0,
    force: bool = False,
    models: str = "generated",
    out: Output | None = None,
    monitor: Monitor | None = None,
    execution: Execution = USUAL,
) -> dict[str, Any]:
    """Run ``task``, one of a single goal with another ``execution``, and return its
    result.

    With ``out`` all files of the run are written there. Raises InfeasibleTaskError
    before anything moves where nothing can do the task, and Interrupted on Ctrl-C once
    the engine runs, after record and result so far are written.
    """
    from pushpressslide.report.metrics import result as measure

    if task.goals:
        options = StageOptions(engine, seed, force, models, monitor or Monitor())
        return run_goals(task, options, out)[0]
    interrupt = Interrupt()
    plan, record, choices = simulate(
        task,
        engine=engine,
        seed=seed,
        force=force,
        models=models,
        monitor=replace(monitor or Monitor(), interrupt=interrupt),
        execution=execution,
    )
    with interrupt.held():
        result = measure(task, plan, record)
        if out is not None:
            result["command"] = out.command
            write_data(out.folder, plan, record, result, choices)
    if interrupt():
        raise interrupted(out)
    if out is not None:
        write_pages(out, plan, record, choices, models=models)
    return result


PAGES = ("replay.html", "report.html", "run.webp", "plan.png", "legs.png")


def write_data(
    out: Path,
    plan: Plan,
    record: Record,
    result: dict[str, Any],
    choices: list[Choice],
) -> None:
    """Write task, plan, record and result of a run into ``out``, after taking away an
    older run's pages.
    """
    from pushpressslide.report.files import save_run

    out.mkdir(parents=True, exist_ok=True)
    for name in PAGES:
        (out / name).unlink(missing_ok=True)
    for picture in (*out.glob("plots/*.png"), *out.glob("pictures/*.webp")):
        picture.unlink()
    save_run(out, plan, record, result, choices)


def write_pages(
    out: Output,
    plan: Plan,
    record: Record,
    choices: list[Choice],
    *,
    models: str = "generated",
) -> None:
    """Write the pictures, replay and report of a run whose data are in ``out``.

    Each is whole or not there. Raises Interrupted on Ctrl-C.
    """
    folder = out.folder
    engine = engine_named(record.engine)
    try:
        from pushpressslide.report.page import write_report
        from pushpressslide.report.plan_files import write_plan
        from pushpressslide.report.series import finite_part

        write_plan(plan, folder, choices)
        arms = ArmOptions(models, video=out.video)
        engine.write_replay(plan, finite_part(record), folder, arms)
        write_report([folder])
    except KeyboardInterrupt:
        raise Interrupted(
            f"interrupted; record and result are in {folder}, its pages not all"
        ) from None
