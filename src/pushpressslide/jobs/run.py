"""Complete pipeline for one task: select, plan, run on an engine, measure, and write
all files.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import Any

from pushpressslide.control.controller import Controller
from pushpressslide.control.estimator import Estimator, ObjectEstimator
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.control.tracker import ObjectTracker
from pushpressslide.core.bodies import goal_places
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.record import Figures, Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.ask import AnyTask, checked
from pushpressslide.jobs.engines import DEFAULT, ArmOptions, engine_named
from pushpressslide.jobs.hopes import hopeful_runner
from pushpressslide.jobs.interrupt import Interrupt, Interrupted
from pushpressslide.jobs.monitor import Monitor as Monitor
from pushpressslide.jobs.monitor import Output as Output
from pushpressslide.jobs.monitor import interrupted
from pushpressslide.jobs.remedy import remedies_named
from pushpressslide.jobs.stages import Done, StageOptions
from pushpressslide.report.at_rest import record_at_rest
from pushpressslide.report.files import OLDER_STAGES, save_run
from pushpressslide.report.stages import StageRun
from pushpressslide.selection.select import MANY, select
from pushpressslide.selection.solve import joined
from pushpressslide.taskfile.yaml_text import Overrides


def simulate(
    task: Task,
    *,
    engine: str = DEFAULT,
    seed: int = 0,
    force: bool = False,
    models: str = "generated",
    monitor: Monitor | None = None,
    execution: Execution = USUAL,
) -> tuple[Plan, Record, list[Choice]]:
    """Select, plan and run a task with one goal. Return the plan, the record and all
    choices.

    Skipped choices give the reason. On an engine with arms a choice also needs a joint
    path; the first choice that has one is run. With ``force``, the best choice that has
    a path is run even if it is infeasible. ``execution`` may change the laws. Raises
    InfeasibleTaskError if the task is infeasible.
    """
    monitor = monitor or Monitor()
    loop = RunOptions(execution=execution)
    options = StageOptions(engine, seed, force, models, monitor, loop)
    runner = hopeful_runner(task, options)
    (run,) = runner.run()
    return run.plan, run.record, list(run.choices)


def forced_choices(task: Task, count: int) -> list[Choice]:
    """The ``count`` best-ranked choices that have a path, feasible or not."""
    return [choice for choice in select(task, MANY) if choice.segments][:count]


def run_choice(
    task: Task, choice: Choice, *, engine: str = DEFAULT, seed: int = 0
) -> tuple[Plan, Record]:
    """Run one choice of ``task``, feasible or not.

    Raises InfeasibleTaskError if an arm has no joint path at all for it.
    """
    chosen = engine_named(engine)
    preparation = chosen.placement_planner(True)
    for placement in Plan(task).of_choices([choice]).by_placement:
        preparation.add(placement)
    plan = joined(preparation, Plan(task))
    options = ArmOptions(paths=preparation.paths)
    record = chosen.run(plan, RunOptions(seed), options)
    return record.plan, record


def run(
    what: AnyTask | Plan,
    *,
    mode: str | None = None,
    overrides: Overrides = (),
    engine: str = DEFAULT,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
    models: str = "generated",
    controller: type[Controller] = Controller,
    tracker: Callable[[ObjectTracker], ObjectTracker] | None = None,
    estimator: Callable[[MotionQuery], Estimator] = ObjectEstimator,
) -> Record:
    """Run a plan, or select, plan and run a task. Return the record, with ``success``
    and ``figures``.

    A task may be given as to ``load_task``, with ``overrides``; ``mode`` is the name of
    the only mode to consider. ``engine`` is "drake", "mujoco" or "planar". ``controller`` may be
    a class derived from ``Controller``. ``tracker`` receives the engine's object
    tracker and returns the tracker to use. ``estimator`` makes the estimator of the
    object's pose and parameters for a motion query.

    Raises TaskError for a task that no task file could describe. Raises
    InfeasibleTaskError before anything moves if the task is infeasible.
    """
    chosen = engine_named(engine)
    check_seed(seed)
    loop = RunOptions(controller=controller, tracker=tracker, estimator=estimator)
    if isinstance(what, Plan):
        for name, value in (("mode", mode), ("overrides", overrides)):
            if value:
                raise TaskError(
                    "", name, value, "allowed: with a task, not with a Plan"
                )
        seeded = replace(loop, seed=seed, progress=progress)
        if what.segments:
            record = chosen.run(what, seeded, ArmOptions(models))
        else:
            record = record_at_rest(what, engine)
        return measured(record, what.task)
    task = checked(what, overrides, mode=mode)
    monitor = Monitor(progress)
    options = StageOptions(engine, seed, models=models, monitor=monitor, loop=loop)
    with remedies_named(task):
        runner = hopeful_runner(task, options)
    for _ in runner.run():
        pass
    done = runner.done()
    return replace(done.record, figures=Figures(done.result))


def check_seed(seed: Any) -> None:
    """Raise TaskError unless ``seed`` is a non-negative integer."""
    whole = isinstance(seed, Integral) and not isinstance(seed, bool)
    if not whole or seed < 0:
        raise TaskError("", "seed", seed, "allowed: a whole number, 0 or greater")


def measured(record: Record, task: Task) -> Record:
    """``record`` of a run of ``task``, with the figures computed from it."""
    return replace(record, figures=measured_figures(record, task))


def measured_figures(record: Record, task: Task | None = None) -> Figures:
    """Contents of result.json for the record of a run of ``task``, by default the task
    of its plan.

    Figures are in SI units and radians, and None if they do not apply.
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
    """Run ``task`` and return its result.

    With ``out`` all files of the run are written there; record and plans are updated at
    the end of each stage. Raises InfeasibleTaskError before anything moves if the task
    is infeasible. On Ctrl-C while the engine runs, it writes the record and the result
    so far, then raises Interrupted.
    """
    interrupt = Interrupt()
    monitor = replace(monitor or Monitor(), interrupt=interrupt)
    loop = RunOptions(execution=execution)
    options = StageOptions(engine, seed, force, models, monitor, loop=loop)
    with remedies_named(task):
        runner = hopeful_runner(task, options)
    if out is not None:
        clear(out.folder)
    for _ in runner.run():
        if out is not None and not runner.is_over:
            with interrupt.defer():
                _save(out, runner.so_far())
    with interrupt.defer():
        done = runner.done()
        if out is not None:
            _save(out, done)
    if interrupt():
        raise interrupted(out)
    if out is not None:
        write_pages(out, done, models=models)
    return done.result


PAGES = ("result.json", "replay.html", "report.html", "run.mp4", "run.webp")
PICTURES = ("plan*.png", "legs*.png", "plots/*.png", "pictures/*.webp")


def clear(folder: Path) -> None:
    """Make a folder, or remove an older run's result, pages and pictures from it."""
    folder.mkdir(parents=True, exist_ok=True)
    for pattern in (*PAGES, *PICTURES):
        for path in folder.glob(pattern):
            path.unlink()
    shutil.rmtree(folder / OLDER_STAGES, ignore_errors=True)


def _save(out: Output, done: Done) -> None:
    if done.result:
        done.result["command"] = out.command
    save_run(out.folder, done.task, done.stages, done.record, done.result)


def write_pages(out: Output, done: Done, *, models: str = "generated") -> None:
    """Write the pictures, replay and report of a run whose data are in ``out``.

    Each file is either complete or absent. Raises Interrupted on Ctrl-C.
    """
    from pushpressslide.report.page import write_report
    from pushpressslide.report.plan_files import write_plan_pictures

    folder = out.folder
    engine = engine_named(done.record.engine)
    goals = [(shape, pose) for _, shape, pose in goal_places(done.task)]
    try:
        write_plan_pictures(done.stages, folder)
        begun = [stage for stage in done.stages if isinstance(stage, StageRun)]
        arms = ArmOptions(models, video=out.video, goals=goals)
        if done.record.plan.segments:  # empty for a run without motion
            engine.write_replay(begun, done.record, folder, arms)
        write_report([folder])
    except KeyboardInterrupt:
        raise Interrupted(
            f"interrupted; record and result are in {folder}, its pages not all"
        ) from None
