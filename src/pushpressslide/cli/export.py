"""The command export: converts a run's record for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from pushpressslide.cli.app import command


@dataclass(frozen=True)
class ExportOptions:
    """Argument and options of ``pps export``, in the order of its help."""

    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Folder of a finished run.")
    ]
    mcap: Annotated[
        bool,
        typer.Option(
            "--mcap", help="ROS 2 messages, run.mcap, and a layout for Foxglove."
        ),
    ] = False
    csv: Annotated[bool, typer.Option("--csv", help="Columns with names, run.csv.")] = (
        False
    )
    rerun: Annotated[
        bool, typer.Option("--rerun", help="A recording for Rerun, run.rrd.")
    ] = False
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Folder of the files [that of the run]."
        ),
    ] = None


@command
def export(options: ExportOptions) -> None:
    """Write a run as MCAP, CSV or for Rerun."""
    from pushpressslide.cli.folders import hold
    from pushpressslide.report.csv_export import write_csv
    from pushpressslide.report.files import load_run
    from pushpressslide.report.mcap_export import write_layout, write_mcap
    from pushpressslide.report.rerun_export import write_rerun

    if not (options.mcap or options.csv or options.rerun):
        raise typer.BadParameter("give --mcap, --csv or --rerun")
    run = load_run(options.run)
    folder = hold(options.run if options.out is None else options.out)
    if options.csv:
        typer.echo(write_csv(run.record, folder / "run.csv"))
    if options.mcap:
        typer.echo(write_mcap(run, folder / "run.mcap"))
        typer.echo(write_layout(folder / "foxglove.json"))
    if options.rerun:
        typer.echo(write_rerun(run, folder / "run.rrd"))
