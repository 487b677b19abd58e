"""Wrapped text on a terminal, and plain lines in a file."""

from __future__ import annotations

import sys
from shutil import get_terminal_size
from textwrap import wrap

import typer


def print_text(text: str, indent: int = 0, error: bool = False) -> None:
    """Print a text, on stderr if it is an error.

    A terminal gets lines broken between words, with all but the first indented.
    Anything else gets a single line.
    """
    stream = sys.stderr if error else sys.stdout
    if not stream.isatty():
        typer.echo(text, err=error)
        return
    lines = wrap(
        text,
        get_terminal_size().columns,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    typer.echo("\n".join(lines), err=error)
