"""The command on many runs: sweep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from pushpressslide.cli.app import answer, command, task_of
from pushpressslide.cli.folders import results_folder
from pushpressslide.cli.options import (
    Drawing,
    Engine,
    Force,
    Json,
    ModeName,
    Out,
    Quiet,
    Seed,
    Sets,
    TaskName,
    Variation,
    World,
)
from pushpressslide.cli.shell import progress_bar
from pushpressslide.jobs.engines import DEFAULT


@dataclass(frozen=True)
class SweepOptions:
    """Argument and options of ``pps sweep``, in the order of its help."""

    task: TaskName
    samples: Annotated[
        int,
        typer.Option("--samples", min=0, max=1_000_000, help="Number of variations."),
    ] = 0
    attempts: Annotated[
        int,
        typer.Option(
            "--attempts",
            min=0,
            max=1_000_000,
            help="Draw until so many samples are not refused, in place of --samples.",
        ),
    ] = 0
    engine: Engine = DEFAULT
    vary: Annotated[
        Variation,
        typer.Option(
            "--vary",
            help="truth: what is true of the task; tasks: new tasks for its robots; "
            "start: other starts; knocks: another body pushes the object 3 cm and about "
            "15 degrees aside in mid-contact (with arms).",
        ),
    ] = Variation.truth
    draw: Annotated[
        Drawing,
        typer.Option(
            "--draw",
            help="Of new tasks. ahead: goals about ahead of the push, objects of medium "
            "size; any: goals in all directions, objects of all sizes, mass off centre; "
            "cluttered: start and goal anywhere in reach, among obstacles, any mode.",
        ),
    ] = Drawing.ahead
    world: Annotated[
        World,
        typer.Option(
            "--world",
            help="known: new tasks are as believed; uncertain: they have other frictions, "
            "mass and centre of mass, noisy and late sensors; tier1 to tier3: each sample "
            "has its own world of this tier, the same tasks in each tier.",
        ),
    ] = World.known
    check_refusals: Annotated[
        int,
        typer.Option(
            "--check-refusals",
            min=0,
            help="Run the three best choices of so many refused samples all the same.",
        ),
    ] = 0
    sample_time: Annotated[
        float,
        typer.Option(
            "--sample-time", min=0.0, help="Seconds that a sample may take; 0: any."
        ),
    ] = 0.0
    batched: Annotated[
        bool,
        typer.Option(
            "--batched",
            help="Of --vary truth: plan once and run all samples on arrays, without "
            "engine, arms, touch and new plans; for plans of one rear_push.",
        ),
    ] = False
    mode: ModeName = None
    jobs: Annotated[
        int, typer.Option("--jobs", min=0, help="Processes; 0: one for each core.")
    ] = 0
    cluster: Annotated[
        str,
        typer.Option(
            "--cluster",
            metavar="ADDRESS",
            help="Dask scheduler whose workers run the samples, as tcp://10.0.0.1:8786.",
        ),
    ] = ""
    seed: Seed = 0
    out: Out = None
    sets: Sets = None
    as_json: Json = False
    quiet: Quiet = False
    force: Force = False


@command
def sweep(options: SweepOptions) -> None:
    """Run a task under random variations.

    Samples run in parallel. If a sweep was interrupted, the same --out continues it.
    """
    from pushpressslide.batch import fast
    from pushpressslide.jobs import sweep as sweep_job

    if (options.samples > 0) == (options.attempts > 0):
        raise typer.BadParameter("give --samples or --attempts, one of them")
    task = task_of(options.task, options.sets, options.mode)
    folder = results_folder(options.out, f"sweep-{task.name}", options.force)
    job = sweep_job.SweepOptions(
        samples=options.samples,
        attempts=options.attempts,
        vary=options.vary.value,
        draw=options.draw.value,
        world=options.world.value,
        seed=options.seed,
        engine=options.engine,
        check_refusals=options.check_refusals,
        sample_time=options.sample_time,
        jobs=options.jobs,
        cluster=options.cluster,
        force=options.force,
        batched=options.batched,
    )
    label = f"{options.samples} samples on {job.engine_name}"
    if options.attempts:
        label = f"{options.attempts} attempts on {options.engine}"
    with progress_bar(label, not options.quiet) as progress:
        result = sweep_job.sweep(task, job, folder, progress)

    def show() -> None:
        """Print the figures, and the location of the results."""
        from pushpressslide.cli.tables import print_figures

        print_figures(result)
        compiling = fast.compiling()
        if compiling:
            typer.echo(compiling)
        typer.echo(folder)

    answer(result, options, show)
