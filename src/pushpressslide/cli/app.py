"""The application, and the registration of its commands."""

from __future__ import annotations

import functools
import inspect
import json
import sys
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, Protocol, TypeVar

import typer

from pushpressslide.cli.shell import Commands, complain
from pushpressslide.core.errors import TaskWarning

if TYPE_CHECKING:
    from pushpressslide.core.task import Task

Options = TypeVar("Options")
Status = TypeVar("Status")

app = typer.Typer(
    cls=Commands,
    help="Push, press and slide objects with robot arms. TASK: a shipped task's name, or a YAML file.",
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        import pushpressslide

        typer.echo(pushpressslide.__version__)
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Show the version."
        ),
    ] = False,
) -> None: ...


def unpacked(function: Callable[[Options], Status]) -> Callable[..., Status]:
    """A function with the fields of a dataclass as its parameters.

    The dataclass is the annotation of the only parameter of ``function``.
    """
    (parameter,) = inspect.signature(function, eval_str=True).parameters.values()
    options = parameter.annotation

    @functools.wraps(function)
    def called(**values: Any) -> Status:
        """Call the function with its dataclass made from the command line's values."""
        return function(options(**values))

    vars(called)["__signature__"] = inspect.signature(options, eval_str=True)
    return called


def command(function: Callable[[Options], Status]) -> Callable[[Options], Status]:
    """Register a command whose arguments and options are the fields of a dataclass.

    The dataclass is the annotation of the only parameter of ``function``.
    """
    app.command()(unpacked(function))
    return function


def task_of(name: str, sets: list[str] | None, mode: str | None = None) -> Task:
    """Checked task of the command line.

    ``name`` is a shipped task or a file, ``sets`` are overrides a.b=c, ``mode`` is the
    only mode allowed.
    """
    from pushpressslide.taskfile.load import load_task

    only = [] if mode is None else [f"modes={json.dumps([mode])}"]
    with warnings.catch_warnings(record=True) as slips:
        warnings.simplefilter("always", TaskWarning)
        task = load_task(name, [*(sets or ()), *only])
    for slip in slips:
        complain(f"warning: {slip.message}")
    _note_files(task)
    return task


def _note_files(task: Task) -> None:
    """Report on stderr what is fixed, ignored or assumed in files of robots and meshes."""
    from pushpressslide.robots.arm_files import robot_facts

    shapes = {"object": task.object.shape}
    shapes |= {f"obstacles[{i}]": body.shape for i, body in enumerate(task.obstacles)}
    for field, shape in shapes.items():
        if shape.note:
            typer.echo(f"{field}: {shape.note}", err=True)
    for i, robot in enumerate(task.robots):
        for note in robot_facts(robot).notes:
            typer.echo(f"robots[{i}]: {note}", err=True)


def print_json(value: Any) -> None:
    """Print plain data as JSON on stdout."""
    from pushpressslide.report.json_text import to_json

    text = to_json(value)
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError:
        text = json.dumps(json.loads(text), indent=2) + "\n"  # as escapes alone
    typer.echo(text, nl=False)


class Answered(Protocol):
    """Options for a command's output."""

    @property
    def as_json(self) -> bool:
        """Output as JSON only."""

    @property
    def quiet(self) -> bool:
        """No output."""


def answer(data: Any, options: Answered, show: Callable[[], None]) -> None:
    """Print plain data as JSON, print them by ``show``, or print nothing."""
    if options.as_json:
        print_json(data)
    elif not options.quiet:
        show()
