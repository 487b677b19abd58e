"""What every command shares: exit statuses, one-line errors, folders, progress."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime
from functools import partial
from itertools import count
from pathlib import Path
from types import FrameType
from typing import Any

import typer
from typer.core import TyperGroup

from pushpressslide.cli.text import print_text
from pushpressslide.core.errors import (
    InfeasibleTaskError,
    PushPressSlideError,
    SimulationError,
)

REACHED = 0
MISSED = 1
WRONG_INPUT = 2
INTERNAL_ERROR = 3
INTERRUPTED = 130
"""Exit statuses."""

SHIPPED = Path(__file__).parents[1] / "tasks"
"""Folder of the shipped tasks."""

_made: list[Path] = []  # folders of this command, which are removed if left empty


class Interruption(Exception):
    """Ctrl-C with something to say; typer swallows the message of a KeyboardInterrupt."""


class Commands(TyperGroup):
    """The commands, with the exit statuses and the one-line errors that they promise."""

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
        restore = _note_interrupts(presses)
        status = _status_of(call, presses, "--json" in words, "--verbose" in words)
        _remove_empty_folders()
        restore()
        if not standalone_mode:
            return status
        sys.exit(status)


def _status_of(
    call: Callable[[], Any], presses: list[int], as_json: bool, verbose: bool
) -> int:
    """Call a command and return its exit status; a failure is told in one line."""
    try:
        answer = call()
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
    """Let Ctrl-C also append to ``presses``; return the function that undoes this."""
    if threading.current_thread() is not threading.main_thread():
        return lambda: None

    def handler(number: int, frame: FrameType | None) -> None:
        """Note Ctrl-C and raise it."""
        presses.append(number)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, handler)
    return lambda: signal.signal(signal.SIGINT, before)


def complain(line: str) -> None:
    """Write one line on stderr; shipped tasks go by the name of their file."""
    short = line.replace(f"{SHIPPED}{os.sep}", "")
    print_text(f"pps: {' '.join(short.split())}", indent=4, error=True)


def show_page(address: str) -> None:
    """Say where a page is, and open it in a browser where there is a screen."""
    complain(f"watch at {address}")
    screens = ("DISPLAY", "WAYLAND_DISPLAY")
    headless = sys.platform == "linux" and not any(map(os.environ.get, screens))
    if not headless:
        webbrowser.open(address)


def refuse(error: InfeasibleTaskError, verbose: bool) -> int:
    """Say in one line on stderr why a task cannot be done, below a table of all that was
    judged if that is wanted; return the exit status.
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
    """Say in one line on stderr what went wrong; return the exit status."""
    usage = getattr(error, "format_message", None)
    if usage is not None:
        complain(usage().replace("Value error, ", ""))  # the parser's own words
        return WRONG_INPUT
    if isinstance(error, PushPressSlideError) and not isinstance(
        error, SimulationError
    ):
        complain(str(error))
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
            "reason": {"code": "internal_error", "text": text},
        }
        typer.echo(json.dumps(failure))
    return INTERNAL_ERROR


def results_folder(
    out: Path | None,
    name: str,
    force: bool,
    results: tuple[str, ...] = ("result.json",),
) -> Path:
    """Return the folder for results.

    Without ``out`` it is a new one below runs/, made here so that no other command
    takes it, and removed after the command if it is still empty. Raises
    PushPressSlideError if it cannot be made, or holds one of ``results`` without
    ``force``.
    """
    if out is None:
        return _new_folder(name)
    present = [result for result in results if (out / result).exists()]
    if present and not force:
        raise PushPressSlideError(
            f"--out: {str(out)!r} is not allowed; it holds {present[0]} already; give "
            "another folder, or --force"
        )
    above = next(path for path in (out, *out.absolute().parents) if path.exists())
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise _not_writable(out)
    return out


def _new_folder(name: str) -> Path:
    """Make a folder below runs/ that was not there, and return it."""
    runs = Path("runs")
    stamp = f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    for n in count(1):
        folder = runs / (stamp if n == 1 else f"{stamp}-{n}")
        try:
            folder.mkdir(parents=True)
            break
        except FileExistsError:
            if not runs.is_dir():
                raise _not_writable(folder) from None
        except OSError:
            raise _not_writable(folder) from None
    _made.append(folder)
    return folder


def _remove_empty_folders() -> None:
    """Remove the folders that a command made and left empty."""
    while _made:
        with suppress(OSError):
            _made.pop().rmdir()


def _not_writable(folder: Path) -> PushPressSlideError:
    return PushPressSlideError(
        f"--out: {str(folder)!r} is not allowed; allowed: a folder that can be written"
    )


@contextmanager
def progress_bar(label: str, shown: bool) -> Iterator[Callable[[float, float], None]]:
    """Show a bar with the time left, and yield the function that moves it.

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
