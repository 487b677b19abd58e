"""The command reproduce, which runs the paper's experiments."""

from __future__ import annotations

from typing import Annotated

import typer

from pushpressslide.cli.folders import results_folder
from pushpressslide.cli.options import Force, Out, Quiet, Seed
from pushpressslide.cli.shell import progress_bar
from pushpressslide_studies.cli import complete


def reproduce(
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only",
            metavar="NAME",
            help=f"This experiment; repeatable: {', '.join(complete.EXPERIMENTS)}.",
            autocompletion=complete.experiments,
        ),
    ] = None,
    jobs: Annotated[int, typer.Option("--jobs", min=1, help="Runs at a time.")] = 2,
    seed: Seed = 0,
    out: Out = None,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Run the paper's experiments, figure beside figure."""
    from pushpressslide_studies.paper.reproduce import reproduce as run_experiments

    folder = results_folder(out, "reproduce", force)
    with progress_bar("experiments of the paper", not quiet) as progress:
        page = run_experiments(
            only or None, seed=seed, out=folder, jobs=jobs, progress=progress
        )
    typer.echo(page)
