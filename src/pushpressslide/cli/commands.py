"""The commands on one task: list, select, plan, run, report."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from pushpressslide.cli.app import app, print_json, task_of
from pushpressslide.cli.options import (
    Engine,
    Force,
    Json,
    Models,
    ModeName,
    Out,
    Quiet,
    Seed,
    Sets,
    TaskName,
)
from pushpressslide.cli.shell import (
    MISSED,
    REACHED,
    WRONG_INPUT,
    Interruption,
    complain,
    progress_bar,
    results_folder,
)
from pushpressslide.core.errors import InfeasibleTaskError, PushPressSlideError
from pushpressslide.jobs.engines import DEFAULT, ENGINES


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
    from pushpressslide.taskfile.load import load_task, shipped_tasks

    found = {name: load_task(name).description for name in shipped_tasks()}
    if as_json:
        typer.echo(json.dumps(found, indent=2))
        return
    width = max(map(len, found), default=0)
    for name, description in found.items():
        typer.echo(f"{name:<{width}}  {description}")


@app.command()
def select(
    task: TaskName,
    sets: Sets = None,
    out: Out = None,
    as_json: Json = False,
    force: Force = False,
) -> int:
    """Rank the contact modes for a task, with reasons."""
    from pushpressslide.cli import tables
    from pushpressslide.report.files import to_json, write_whole
    from pushpressslide.selection.planner import refusal
    from pushpressslide.selection.select import select as rank

    loaded = task_of(task, sets)
    folder = results_folder(
        out, f"select-{loaded.name}", force, ("select.json", "result.json")
    )
    choices = rank(loaded)
    rows = tables.choice_rows(choices)
    write_whole(
        folder / "select.json",
        to_json({"schema": 1, "task": loaded.name, "choices": rows}),
    )
    print_json(rows) if as_json else tables.print_choices(choices)
    if any(choice.feasible for choice in choices):
        return REACHED
    complain(refusal(loaded, choices))
    return WRONG_INPUT


@app.command()
def plan(
    task: TaskName,
    mode: ModeName = None,
    sets: Sets = None,
    out: Out = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Plan only; writes plan.json and plan.png."""
    from pushpressslide.report.plan_files import plan_to_dict, write_plan
    from pushpressslide.selection.planner import plan as make_plan
    from pushpressslide.selection.planner import refusal
    from pushpressslide.selection.select import select as rank

    loaded = task_of(task, sets, mode)
    folder = results_folder(
        out, f"plan-{loaded.name}", force, ("plan.json", "result.json")
    )
    choices = rank(loaded)
    if not choices[0].feasible:
        raise InfeasibleTaskError(refusal(loaded, choices))
    made = make_plan(loaded, choices[0])
    write_plan(made, folder, choices)
    if as_json:
        print_json(plan_to_dict(made, choices))
        return
    for choice in made.chosen(choices):
        typer.echo(f"{choice.mode}: {choice.reason}")
    length = sum(segment.path.length for segment in made.segments)
    typer.echo(f"path {length:.3f} m in {made.duration:.1f} s")
    typer.echo(folder / "plan.png")


@app.command()
def run(
    task: TaskName,
    engine: Engine = DEFAULT,
    mode: ModeName = None,
    seed: Seed = 0,
    out: Out = None,
    sets: Sets = None,
    as_json: Json = False,
    quiet: Quiet = False,
    live: Annotated[
        bool,
        typer.Option("--live", help="Watch in Meshcat while it runs, in real time."),
    ] = False,
    video: Annotated[
        bool, typer.Option("--video", help="Also write an animation.")
    ] = False,
    models: Annotated[
        Models, typer.Option("--models", help="Robot models on Drake.")
    ] = Models.generated,
    anyway: Annotated[
        bool,
        typer.Option("--anyway", help="Run the best choice even if judged infeasible."),
    ] = False,
    force: Force = False,
) -> int:
    """Run a task in a physics engine.

    Selects a mode, plans, tracks and executes; writes result, record, plots, replay and
    report.
    """
    loaded = task_of(task, sets, mode)
    folder = results_folder(out, loaded.name, force)
    if (live or video) and not ENGINES[engine].has_arms:
        option = "--live" if live else "--video"
        allowed = [name for name, other in ENGINES.items() if other.has_arms]
        raise PushPressSlideError(
            f"{option} is not allowed with --engine {engine}; allowed: --engine "
            f"{', '.join(allowed)}"
        )
    from pushpressslide.jobs.interrupt import Interrupted
    from pushpressslide.jobs.run import Monitor, Output, run_task

    try:
        with progress_bar(f"{loaded.name} on {engine}", not quiet) as progress:
            result = run_task(
                loaded,
                engine=engine.value,
                seed=seed,
                force=anyway,
                models=models.value,
                out=Output(folder, video),
                monitor=Monitor(progress, _show_address if live else None),
            )
    except Interrupted as stopped:
        raise Interruption(str(stopped)) from None
    if as_json:
        print_json(result)
    elif not quiet:
        from pushpressslide.cli import tables

        tables.print_result(result, folder)
    return REACHED if result["success"] else MISSED


def _show_address(address: str) -> None:
    complain(f"watch at {address}")


@app.command()
def report(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR...", help="Folders of finished runs.")
    ],
    out: Out = None,
) -> None:
    """Write the page of finished runs again, from their records."""
    from pushpressslide.report.page import write_report

    typer.echo(write_report(folders, None if out is None else out / "report.html"))
