"""The command identify: a support's parameters from recorded pushes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pushpressslide.cli import complete
from pushpressslide.cli.app import answer, command, task_of
from pushpressslide.cli.folders import results_folder
from pushpressslide.cli.options import Force, Json, Out, Quiet, Seed
from pushpressslide.cli.shell import progress_bar
from pushpressslide.cli.text import print_text

if TYPE_CHECKING:
    from pushpressslide.identification.identified_set import IdentifiedSet
    from pushpressslide.identification.log_options import LogOptions


class ForceFrame(StrEnum):
    """Axes in which forces are given."""

    world = "world"
    tip = "tip"


class ForceOn(StrEnum):
    """Body on which a measured force acts."""

    object = "object"
    tip = "tip"


@dataclass(frozen=True)
class IdentifyOptions:
    """Arguments and options of ``pps identify``, in the order of its help."""

    data: Annotated[
        list[Path],
        typer.Argument(
            metavar="DATA",
            help="Recorded pushes: CSV, Parquet, MCAP, rosbag2, MIT's HDF5, runs of pps, "
            "text logs; or folders with them.",
        ),
    ]
    task: Annotated[
        str,
        typer.Option(
            "--task",
            metavar="TASK",
            help="Task whose object was pushed: shape, mass, centre of mass, tip.",
            autocompletion=complete.tasks,
        ),
    ] = ""
    write: Annotated[
        Path | None,
        typer.Option(
            "--write", metavar="FILE", help="Write the result into this file's belief."
        ),
    ] = None
    column: Annotated[
        list[str] | None,
        typer.Option(
            "--column",
            metavar="QUANTITY=NAME",
            help="Column of a quantity, as object_x='Body 1 X'; repeatable.",
        ),
    ] = None
    unit: Annotated[
        list[str] | None,
        typer.Option(
            "--unit",
            metavar="QUANTITY=UNIT",
            help="Unit of object, tip, yaw, force, time or a column's quantity; "
            "repeatable.",
        ),
    ] = None
    topic: Annotated[
        list[str] | None,
        typer.Option(
            "--topic",
            metavar="STREAM=NAME",
            help="Topic of object, tip or force, as object=/mocap/box; repeatable "
            "[/object/pose, /tip0/pose, /tip0/wrench].",
        ),
    ] = None
    force_frame: Annotated[
        ForceFrame, typer.Option("--force-frame", help="Axes of the force.")
    ] = ForceFrame.world
    force_on: Annotated[
        ForceOn, typer.Option("--force-on", help="Body that the force acts on.")
    ] = ForceOn.object
    tip_height: Annotated[
        float | None,
        typer.Option(
            "--tip-height",
            min=0.0,
            max=2.0,
            help="Metres of the tip above the support.",
        ),
    ] = None
    tip_radius: Annotated[
        float | None,
        typer.Option(
            "--tip-radius",
            min=0.0,
            max=0.1,
            help="Metres [that of the task's first robot].",
        ),
    ] = None
    offset: Annotated[
        float | None,
        typer.Option(
            "--offset", help="Seconds added to the stamps of poses [estimated]."
        ),
    ] = None
    seed: Seed = 0
    splits: Annotated[
        int,
        typer.Option("--splits", min=1, max=10_000, help="Random splits to score on."),
    ] = 20
    fit_share: Annotated[
        float,
        typer.Option(
            "--fit-share",
            min=0.05,
            max=0.95,
            help="Share of the pushes that is fitted.",
        ),
    ] = 0.5
    out: Out = None
    as_json: Json = False
    quiet: Quiet = False
    force: Force = False


@command
def identify(options: IdentifyOptions) -> None:
    """Identify rho, friction and pressure from recorded pushes.

    The models are scored on pushes that were held out.
    """
    from pushpressslide.jobs import identify as job

    task = task_of(options.task, None) if options.task else None
    written = _text_of(options.write)
    log = _log_options(options)
    folder = results_folder(options.out, "identify", options.force)
    how = job.IdentifyOptions(
        options.seed, options.splits, options.fit_share, task, log
    )
    label = f"pushes of {options.data[0].name}"
    with progress_bar(label, not options.quiet) as progress:
        result, found = job.identify(options.data, folder, how, progress)
    if options.write is not None:
        _write(options.write, written, found)

    def show() -> None:
        """Print the tables, the identified parameters, and the location of the page."""
        from pushpressslide.cli.identification_table import lines
        from pushpressslide.report.identification import summary

        models = [each.models for each in found]
        said = [line for each in found for line in summary(each)]
        for line in [*lines(models, result), *said, *result["notes"]]:
            print_text(line)
        if options.write is not None:
            typer.echo(options.write)
        typer.echo(folder / "report.html")

    answer(result, options, show)


def _text_of(path: Path | None) -> str:
    """Text of the task file to be changed. Empty if there is none.

    Raises TaskError if the file is not a task.
    """
    from pushpressslide.core.errors import PushPressSlideError
    from pushpressslide.taskfile.load import load_task, shipped_tasks

    if path is None:
        return ""
    if str(path) in shipped_tasks() and not path.exists():
        raise PushPressSlideError(
            f"--write: {str(path)!r} is a shipped task; pps show {path} > {path}.yaml "
            "makes a file of it"
        )
    load_task(path)
    return path.read_text(encoding="utf-8-sig")


def _write(path: Path, text: str, results: list[IdentifiedSet]) -> None:
    """Write the belief of a single set into a task file."""
    from pushpressslide.core.errors import PushPressSlideError
    from pushpressslide.core.whole_file import write_whole
    from pushpressslide.taskfile.belief_text import with_belief

    if len(results) != 1:
        raise PushPressSlideError(
            f"--write: {len(results)} sets of pushes; allowed: one, as a file has one belief"
        )
    write_whole(path, with_belief(text, results[0].belief, str(path)))


def _log_options(options: IdentifyOptions) -> LogOptions:
    """Options of the command line that concern log files."""
    from pushpressslide.identification.log_options import LogOptions

    return LogOptions(
        _named(options.column, "--column", "object_x=NAME"),
        _named(options.unit, "--unit", "object=mm"),
        _named(options.topic, "--topic", "object=/mocap/box"),
        options.force_frame.value,
        options.force_on.value,
        options.tip_height,
        options.tip_radius,
        options.offset,
    )


def _named(texts: list[str] | None, option: str, example: str) -> dict[str, str]:
    """Names and values of a repeatable option NAME=VALUE."""
    from pushpressslide.core.errors import PushPressSlideError

    out = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise PushPressSlideError(f"{option} {text}: allowed: {example}")
        out[name] = value
    return out
