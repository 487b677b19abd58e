"""The command bench, which runs the benchmarks."""

from __future__ import annotations

from typing import Annotated

import typer

from pushpressslide.cli.app import print_json
from pushpressslide.cli.folders import results_folder
from pushpressslide.cli.options import Force, Json, Out, Quiet, Seed
from pushpressslide.cli.shell import progress_bar
from pushpressslide_studies.cli import complete


def bench(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME",
            help=f"Of {', '.join(complete.BENCHMARKS)}; default: all.",
            autocompletion=complete.benchmarks,
        ),
    ] = None,
    seed: Seed = 0,
    out: Out = None,
    as_json: Json = False,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Run the benchmarks beside the alternatives, as ratios."""
    from pushpressslide_studies.bench.bench import bench as run_benchmarks

    folder = results_folder(out, "bench", force)
    with progress_bar("benchmarks", not quiet) as progress:
        result = run_benchmarks(names or None, seed=seed, out=folder, progress=progress)
    if as_json:
        print_json(result)
    elif not quiet:
        from pushpressslide_studies.cli.bench_table import print_benchmarks

        print_benchmarks(result["benchmarks"])
        typer.echo(folder)
