"""The command ``pps``.

A command does its heavy imports when it runs, so that help answers at once.
"""

from pushpressslide.cli import commands, files, learning, many_runs, objects, robot
from pushpressslide.cli.app import app

__all__ = [
    "app",
    "commands",
    "files",
    "learning",
    "main",
    "many_runs",
    "objects",
    "robot",
]


def main() -> None:
    """Entry point of the command ``pps``."""
    app()
