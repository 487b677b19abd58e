"""Command for the friction of flat bases: footprints."""

from __future__ import annotations

import typer

from pushpressslide.cli.folders import results_folder
from pushpressslide.cli.options import Force, Out, Quiet
from pushpressslide.cli.shell import progress_bar


def footprints(out: Out = None, quiet: Quiet = False, force: Force = False) -> None:
    """Measure the friction of flat bases in every simulator, beside the integral."""
    from pushpressslide.jobs.engines import EngineName, engine_named
    from pushpressslide_studies.bench.footprints import footprints as measure

    engine_named(EngineName.mujoco)  # brings Drake too
    folder = results_folder(out, "footprints", force)
    with progress_bar("footprints", not quiet) as progress:
        measure(folder, progress)
    typer.echo(folder / "page.md")
