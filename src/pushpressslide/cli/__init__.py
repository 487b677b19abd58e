"""The command ``pps``. What is heavy is imported in the command that uses it: help
answers at once.
"""

from pushpressslide.cli import commands, studies
from pushpressslide.cli.app import app

__all__ = ["app", "commands", "main", "studies"]


def main() -> None:
    """Entry point of the command ``pps``."""
    app()
