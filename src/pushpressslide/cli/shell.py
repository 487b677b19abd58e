"""Common part of all commands: exit statuses, one-line errors, progress."""

from __future__ import annotations

import errno
import json
import os
import signal
import sys
import threading
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from io import TextIOWrapper
from pathlib import Path
from types import FrameType
from typing import Any

import typer
from typer.core import TyperGroup

from pushpressslide.cli import installed
from pushpressslide.cli.folders import kept_files, leave_folders
from pushpressslide.cli.text import print_text
from pushpressslide.core.errors import (
    InfeasibleTaskError,
    PushPressSlideError,
    SimulationError,
    WriteError,
)

REACHED = 0
MISSED = 1
WRONG_INPUT = 2
INTERNAL_ERROR = 3
INTERRUPTED = 130
"""Exit status of an interrupted command."""

NO_ROOM = (
    errno.ENOSPC,
    errno.EDQUOT,
    errno.EROFS,
    errno.EACCES,
    errno.EPERM,
    errno.EIO,
)
"""Errors of the file system that are never the program's fault."""

SHIPPED = Path(__file__).parents[1] / "tasks"
"""Folder of the shipped tasks."""


class Interruption(Exception):
    """Ctrl-C with a message. Typer would swallow the message of a KeyboardInterrupt."""


class Commands(TyperGroup):
    """The commands, with their promised exit statuses and one-line errors.

    Commands of other packages are loaded only when one of them, or the whole list, is
    requested.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands."""
        self._add_installed()
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """A command, or None if the name is unknown."""
        if cmd_name not in self.commands:
            self._add_installed()
        return super().get_command(ctx, cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Name, command and arguments.

        Raises MissingPackageError for a command whose package is not installed.
        """
        if args[0] not in self.commands and not ctx.resilient_parsing:
            installed.check_installed(args[0])
        return super().resolve_command(ctx, args)

    def _add_installed(self) -> None:
        """Add the commands of other packages after the existing ones."""
        for name, made in installed.commands().items():
            self.commands.setdefault(name, made)

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the command of ``args`` (default: sys.argv) and exit with its status."""
        words = list(sys.argv[1:] if args is None else args)
        call = partial(
            super().main,
            words or ["--help"],
            prog_name or "pps",
            complete_var,
            False,
            windows_expand_args,
            **extra,
        )
        presses: list[int] = []
        _replace_what_no_console_shows()
        restore = _note_interrupts(presses)
        status = _status_of(call, presses, "--json" in words, "--verbose" in words)
        leave_folders()
        restore()
        if not standalone_mode:
            return status
        sys.exit(status)


def _status_of(
    command: Callable[[], Any], presses: list[int], as_json: bool, verbose: bool
) -> int:
    """Call a command and return its exit status. A failure is printed in one line."""
    try:
        answer = command()
    except Interruption as stopped:
        complain(str(stopped))
        return INTERRUPTED
    except (KeyboardInterrupt, typer.Abort):
        complain("interrupted")
        return INTERRUPTED
    except Exception as error:
        # compiled code, such as an import, may turn Ctrl-C into an error of its own
        if presses:
            complain("interrupted")
            return INTERRUPTED
        if isinstance(error, InfeasibleTaskError):
            return refuse(error, verbose)
        return explain(error, as_json)
    if answer == INTERRUPTED:
        complain("interrupted")
    return answer if isinstance(answer, int) else REACHED


def _note_interrupts(presses: list[int]) -> Callable[[], object]:
    """Install a handler that records Ctrl-C and termination in ``presses``, then
    interrupts.

    Returns the function that removes the handler.
    """
    if threading.current_thread() is not threading.main_thread():
        return lambda: None

    def handler(number: int, frame: FrameType | None) -> None:
        """Record the signal, and raise the interrupt."""
        presses.append(number)
        raise KeyboardInterrupt

    endings = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(ending, handler) for ending in endings]
    return lambda: [*map(signal.signal, endings, before)]


def _replace_what_no_console_shows() -> None:
    """Replace characters that the console cannot show, instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def complain(line: str) -> None:
    """Print one line on stderr. Shipped tasks are named by their files."""
    short = line.replace(f"{SHIPPED}{os.sep}", "")
    print_text(f"pps: {' '.join(short.split())}", indent=4, error=True)


def show_page(address: str) -> None:
    """Print the location of a page, and open it in a browser if there is a screen."""
    complain(f"watch at {address}")
    screens = ("DISPLAY", "WAYLAND_DISPLAY")
    headless = sys.platform == "linux" and not any(map(os.environ.get, screens))
    if not headless:
        webbrowser.open(address)


def refuse(error: InfeasibleTaskError, verbose: bool) -> int:
    """Print the reason why a task is infeasible on stderr, in one line, and return the
    exit status. A table of all evaluated choices precedes it if requested.
    """
    if not error.choices:
        complain(str(error))
        return WRONG_INPUT
    if not verbose:
        complain(f"{error.brief} (--verbose shows all)")
        return WRONG_INPUT
    from rich.console import Console

    from pushpressslide.cli.tables import choice_lines

    Console(stderr=True, markup=False, highlight=False).print(
        *choice_lines(error.choices), sep="\n"
    )
    complain(error.brief)
    return WRONG_INPUT


def explain(error: Exception, as_json: bool) -> int:
    """Print the error on stderr in one line, and return the exit status."""
    usage = getattr(error, "format_message", None)
    if usage is not None:
        complain(usage().replace("Value error, ", ""))  # the parser's own words
        return WRONG_INPUT
    if isinstance(error, PushPressSlideError) and not isinstance(
        error, SimulationError
    ):
        kept = kept_files() if isinstance(error, WriteError) else ""
        complain(f"{error}{kept}")
        return WRONG_INPUT
    if isinstance(error, OSError) and error.errno in NO_ROOM:
        place = error.filename or "a file"
        complain(f"{WriteError(place, error)}{kept_files()}")
        return WRONG_INPUT
    text = " ".join(f"{type(error).__name__}: {error}".split())
    if os.environ.get("PPS_TRACEBACK"):
        import traceback

        traceback.print_exception(error)
    complain(f"internal error: {text[:400]} (PPS_TRACEBACK=1 shows where)")
    if as_json:
        failure = {
            "schema": 1,
            "success": False,
            "verified": False,
            "reason": {"code": "internal_error", "text": text},
        }
        typer.echo(json.dumps(failure))
    return INTERNAL_ERROR


@contextmanager
def progress_bar(label: str, shown: bool) -> Iterator[Callable[[float, float], None]]:
    """Show a bar with the remaining time, and yield the function that moves it.

    The bar is on stderr, and only if that is a terminal.
    """
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
    )
    visible = shown and sys.stderr.isatty()
    with Progress(
        *columns, console=Console(stderr=True), transient=True, disable=not visible
    ) as bar:
        item = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(
            item, completed=min(done, total), total=total
        )
