"""The command ``pps``.

A command imports heavy packages only when it runs, so that help answers at once.
"""

from pushpressslide.cli import (
    commands,
    export,
    files,
    identify,
    learning,
    objects,
    robot,
    sweep,
)
from pushpressslide.cli.app import app

__all__ = [
    "app",
    "commands",
    "export",
    "files",
    "identify",
    "learning",
    "main",
    "objects",
    "robot",
    "sweep",
]


def main() -> None:
    """Entry point of the command ``pps``."""
    app()
