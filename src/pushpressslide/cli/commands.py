"""The commands on one task: list, select, plan, run, report."""

from __future__ import annotations

import json
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pushpressslide.cli.app import answer, app, command, print_json, task_of
from pushpressslide.cli.folders import hold, results_folder
from pushpressslide.cli.options import (
    Engine,
    Force,
    Joints,
    Json,
    Models,
    ModeName,
    Out,
    Quiet,
    Seed,
    Sets,
    TaskName,
    Verbose,
)
from pushpressslide.cli.shell import (
    MISSED,
    REACHED,
    WRONG_INPUT,
    Interruption,
    complain,
    progress_bar,
    show_page,
)
from pushpressslide.cli.text import print_text
from pushpressslide.core.errors import InfeasibleTaskError, PushPressSlideError
from pushpressslide.jobs.engines import DEFAULT, ENGINES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pushpressslide.core.task import Task
    from pushpressslide.report.stages import StagePlan
    from pushpressslide.selection.placement_planner import PlacementPlanner
    from pushpressslide.selection.stages import PlannedStage


@app.command()
def modes(as_json: Json = False) -> None:
    """Show the library of contact modes."""
    from pushpressslide.cli import tables
    from pushpressslide.modes import MODES

    rows = tables.mode_rows(MODES.values())
    print_json(rows) if as_json else tables.print_modes(rows)


@app.command()
def tasks(as_json: Json = False) -> None:
    """Show the tasks that ship with the package."""
    from pushpressslide.taskfile.load import descriptions_of_shipped_tasks

    descriptions = descriptions_of_shipped_tasks()
    if as_json:
        typer.echo(json.dumps(descriptions, indent=2))
        return
    width = max(map(len, descriptions), default=0)
    for name, description in descriptions.items():
        print_text(f"{name:<{width}}  {description}", width + 2)


@app.command()
def select(
    task: TaskName,
    mode: ModeName = None,
    sets: Sets = None,
    out: Out = None,
    as_json: Json = False,
    force: Force = False,
    joints: Joints = False,
) -> int:
    """Rank the contact modes for a task, with reasons; --out also writes select.json.

    With --joints also by the arms' joint paths, as a run does. A tier's world is that of
    seed 0.
    """
    from pushpressslide.cli import tables
    from pushpressslide.cli.goals import select_stages
    from pushpressslide.cli.joints import ranked
    from pushpressslide.jobs.tiers import drawn_world

    loaded = drawn_world(task_of(task, sets, mode))
    if joints and (loaded.goals or loaded.legs):
        reason = "--joints: allowed for a task of one motion, without goals or legs"
        raise PushPressSlideError(f"{loaded.source or loaded.name}: {reason}")
    folder = None
    if out is not None:
        results = ("select.json", "result.json")
        folder = results_folder(out, f"select-{loaded.name}", force, results)
    if loaded.goals:
        select_stages(loaded, folder, as_json)
        return REACHED
    choices = ranked(loaded, joints)
    rows = tables.choice_rows(choices)
    fields = {"joint_paths": joints or None, "choices": rows}  # None: not checked
    tables.write_selection(loaded, fields, folder)
    if as_json:
        print_json(rows)
    else:
        tables.print_choices(choices, joints)
        if folder is not None:
            typer.echo(folder / "select.json")
    if any(choice.feasible for choice in choices):
        return REACHED
    return _legs_instead(loaded, as_json)


def _legs_instead(task: Task, as_json: bool) -> int:
    """Print the sequence of motions for a task that no single motion can do."""
    from pushpressslide.cli import tables
    from pushpressslide.jobs.remedy import remedies_named
    from pushpressslide.selection.solve import plan as make_plan

    try:
        with remedies_named(task):
            found = make_plan(task)
    except InfeasibleTaskError as error:
        complain(error.brief)
        return WRONG_INPUT
    if not as_json:
        tables.print_legs(found)
    return REACHED


@dataclass(frozen=True)
class PlanOptions:
    """Argument and options of ``pps plan``, in the order of its help."""

    task: TaskName
    mode: ModeName = None
    sets: Sets = None
    out: Out = None
    as_json: Json = False
    verbose: Verbose = False
    trajectory: Annotated[
        Path | None,
        typer.Option(
            "--trajectory",
            metavar="FILE",
            help="Also the arms' joint trajectory, as .csv or as a ROS 2 "
            "JointTrajectory in .yaml; takes seconds.",
        ),
    ] = None
    odds: Annotated[
        bool,
        typer.Option(
            "--odds",
            help="Also the chance to arrive without a recovery, over 500 truths within "
            "the errors that the belief states, and what fails first.",
        ),
    ] = False
    force: Force = False


@command
def plan(options: PlanOptions) -> None:
    """Plan only; writes plan.json and plan.png.

    Joint paths are planned for --trajectory alone. A tier's world is that of seed 0.
    """
    from pushpressslide.cli.odds import (
        OTHER_BELIEF,
        TRUTHS_ALIKE,
        odds_text,
        plan_odds,
    )
    from pushpressslide.cli.tables import JOINT_PATHS
    from pushpressslide.jobs.hopes import of_first_hope
    from pushpressslide.jobs.remedy import remedies_named
    from pushpressslide.jobs.stages import planned_part
    from pushpressslide.jobs.tiers import drawn_world
    from pushpressslide.report.plan_files import stages_to_dict, write_plans
    from pushpressslide.selection.stages import plan_stages

    task = drawn_world(task_of(options.task, options.sets, options.mode))
    file = options.trajectory
    results = ("plan.json", "result.json")
    folder = results_folder(options.out, f"plan-{task.name}", options.force, results)

    def plan_of(hope: Task) -> tuple[Task, list[PlannedStage]]:
        planner = None if file is None else _joint_planner(file)
        return hope, plan_stages(hope, planner)

    with remedies_named(task):
        hope, planned = of_first_hope(task, plan_of)
    stages = [planned_part(one) for one in planned]
    (folder / "plan.json").unlink(missing_ok=True)  # an existing file is complete
    data, *pictures = write_plans(task, stages, folder)
    lines = [JOINT_PATHS] if file is None else _write_trajectory(task, planned, file)
    figures = []
    if options.odds:
        figures = [plan_odds(stage.plan) for stage in stages]
        if not task.belief.states_errors:
            complain(TRUTHS_ALIKE)
        if hope.full_belief != task.full_belief:
            complain(OTHER_BELIEF)
    if options.as_json:
        made = stages_to_dict(task, stages)
        for part, one in zip(made["stages"], figures, strict=False):
            part["odds"] = one
        print_json(made)
        return
    _print_stages(task, stages)
    for one in figures:
        print_text(odds_text(one), 4)
    for line in (*lines, *pictures, data):
        typer.echo(line)


def _print_stages(task: Task, stages: Sequence[StagePlan]) -> None:
    """Print the plan of each stage, with a title if the task has several goals."""
    from pushpressslide.cli.goals import stage_text

    for number, stage in enumerate(stages, start=1):
        if task.goals:
            typer.echo(stage_text(number, stage.stage))
        _print_plan(stage)


def _joint_planner(trajectory: Path) -> PlacementPlanner:
    """Planner of joint paths. The file of the trajectory is checked for writing first."""
    from pushpressslide.jobs.engines import engine_named
    from pushpressslide.jobs.trajectory import check_trajectory_file

    check_trajectory_file(trajectory)
    return engine_named(DEFAULT).placement_planner(False)


def _write_trajectory(
    task: Task, planned: Sequence[PlannedStage], path: Path
) -> list[str]:
    """Write the joint trajectory of planned stages. Return lines that describe it."""
    from pushpressslide.jobs.trajectory import trajectory, write_trajectory

    made = trajectory(planned, task.robots)
    write_trajectory(made, task.robots, path)
    return [
        f"joint trajectory of {made.times[-1]:.1f} s, at most {made.deviation:.3f} rad "
        "off the planned joint path",
        str(path),
    ]


def _print_plan(stage: StagePlan) -> None:
    """Print the plan of a stage."""
    from pushpressslide.cli.tables import print_legs

    made = stage.plan
    for choice in made.chosen(stage.choices):
        print_text(f"{choice.mode}: {choice.reason}", 4)
    if made.from_search or made.may_push:
        print_legs(made)
    length = sum(segment.path.distance for segment in made.segments)
    typer.echo(f"path {length:.3f} m in {made.duration:.1f} s")


@dataclass(frozen=True)
class RunOptions:
    """Argument and options of ``pps run``, in the order of its help."""

    task: TaskName
    engine: Engine = DEFAULT
    mode: ModeName = None
    seed: Seed = 0
    out: Out = None
    sets: Sets = None
    as_json: Json = False
    quiet: Quiet = False
    verbose: Verbose = False
    live: Annotated[
        bool,
        typer.Option(
            "--live",
            help="Watch in Meshcat while it runs, in real time; opens a browser.",
        ),
    ] = False
    video: Annotated[
        bool,
        typer.Option(
            "--video", help="Also write a film, run.mp4; without av run.webp."
        ),
    ] = False
    models: Annotated[
        Models, typer.Option("--models", help="Robot models on Drake.")
    ] = Models.generated
    anyway: Annotated[
        bool,
        typer.Option(
            "--anyway",
            help="Run the best choice that has a path, even if it is infeasible, beyond "
            "limits.normal_force and limits.workspace too.",
        ),
    ] = False
    force: Force = False


@command
def run(options: RunOptions) -> int:
    """Run a task in a physics engine.

    Selects a mode, plans, tracks and executes; writes result, record, plots, replay and
    report.
    """
    task = task_of(options.task, options.sets, options.mode)
    folder = results_folder(options.out, task.name, options.force)
    engine = options.engine
    if options.live and not ENGINES[engine].shows_live:
        allowed = [name for name, other in ENGINES.items() if other.shows_live]
        raise PushPressSlideError(
            f"--live is not allowed with --engine {engine}; allowed: --engine "
            f"{', '.join(allowed)}"
        )
    if options.video:
        _note_encoder()
    result = _run(task, options, folder)

    def show() -> None:
        """Print why the mode was chosen, the figures of the run, and where its pages
        are.
        """
        from pushpressslide.cli import tables
        from pushpressslide.cli.contest_table import print_contests

        print_contests(folder)
        tables.print_result(result, folder)

    answer(result, options, show)
    reached = result["success"] is not False
    return REACHED if reached and result["verified"] else MISSED


def _note_encoder() -> None:
    """Say on stderr if a film cannot be an mp4."""
    from pushpressslide.view.mp4 import MISSING, has_encoder

    if not has_encoder():
        complain(f"--video: run.webp in place of run.mp4, since {MISSING}")


def _run(task: Task, options: RunOptions, folder: Path) -> dict[str, Any]:
    """Run a task with a progress bar; return its result."""
    from pushpressslide.jobs.interrupt import Interrupted
    from pushpressslide.jobs.run import Monitor, Output, run_task

    engine = options.engine
    live = show_page if options.live else None
    try:
        with progress_bar(
            f"{task.name} on {engine.value}", not options.quiet
        ) as progress:
            return run_task(
                task,
                engine=engine.value,
                seed=options.seed,
                force=options.anyway,
                models=options.models.value,
                out=Output(folder, options.video, command_line()),
                monitor=Monitor(progress, live),
            )
    except Interrupted as stopped:
        raise Interruption(str(stopped)) from None


def command_line() -> str:
    """Command line of this process, ready to be typed again."""
    return shlex.join(["pps", *sys.argv[1:]])


@app.command()
def report(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR", help="Folders of finished runs.")
    ],
    out: Out = None,
) -> None:
    """Write the page of finished runs again, from their records."""
    from pushpressslide.report.page import write_report

    for folder in folders:
        if folder.is_dir():
            hold(folder)
    if out is not None:
        hold(out)
    page = None if out is None else out / "report.html"
    typer.echo(write_report(folders, page))
