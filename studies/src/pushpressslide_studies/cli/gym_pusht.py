"""The command gym-pusht, which plays the benchmark push-T."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import typer

from pushpressslide.cli.app import answer, unpacked
from pushpressslide.cli.folders import results_folder
from pushpressslide.cli.options import Force, Json, Out, Quiet
from pushpressslide.cli.shell import progress_bar

FILMED = 20  # episodes


@dataclass(frozen=True)
class PushTOptions:
    """Options of ``pps gym-pusht``, in the order of its help."""

    episodes: Annotated[
        int, typer.Option("--episodes", min=1, max=100_000, help="Number of episodes.")
    ] = 500
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Of the first reset; the next follow.")
    ] = 3000
    noise: Annotated[
        float,
        typer.Option(
            "--noise",
            min=0.0,
            help="Standard deviation in px of the T's pose as the policy sees it.",
        ),
    ] = 0.0
    jobs: Annotated[int, typer.Option("--jobs", min=1, help="Processes.")] = 1
    video: Annotated[
        Path | None,
        typer.Option(
            "--video",
            metavar="FILE",
            help="Also film the first twenty episodes; FILE ends in .webp or .gif.",
        ),
    ] = None
    out: Out = None
    as_json: Json = False
    quiet: Quiet = False
    force: Force = False


@unpacked
def gym_pusht(options: PushTOptions) -> None:
    """Play the benchmark push-T in the package gym-pusht.

    Beside published figures; needs the extra pusht.
    """
    from pushpressslide_studies.pusht.benchmark import ROWS, benchmark
    from pushpressslide_studies.pusht.film import check_kind, film

    if options.video is not None:
        check_kind(options.video)
    files = ("result.json", ROWS)
    folder = results_folder(options.out, "gym-pusht", options.force, files)
    seeds = range(options.seed, options.seed + options.episodes)
    label = f"{options.episodes} episodes of push-T"
    with progress_bar(label, not options.quiet) as progress:
        figures = benchmark(seeds, folder, options.noise, options.jobs, progress)
    if options.video is not None:
        film(seeds[:FILMED], options.video)

    def show() -> None:
        """Print the table, and the location of the rows."""
        from pushpressslide_studies.cli.pusht_table import print_figures

        print_figures(figures)
        typer.echo(folder / ROWS)

    answer(asdict(figures), options, show)
