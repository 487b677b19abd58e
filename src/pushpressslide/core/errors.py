"""Errors. One root; every message is one line that says what is wrong, the value, and what is allowed."""

from __future__ import annotations


class PushPressSlideError(Exception):
    """Root of every error that this package raises on purpose."""


class TaskError(PushPressSlideError):
    """A task file that cannot be used: names the file, the field, the value and what is allowed."""

    def __init__(self, source: str, field: str, value: object, allowed: str) -> None:
        shown = repr(value)
        shown = shown if len(shown) <= 80 else shown[:77] + "..."
        where = f"{source}: {field}: " if field else f"{source}: "
        super().__init__(f"{where}{shown} is not allowed; {allowed}" if field else f"{where}{allowed}")
        self.source, self.field, self.value, self.allowed = source, field, value, allowed


class InfeasibleTaskError(PushPressSlideError):
    """No mode, path or joint path can do the task; the message holds the number that decides."""


class SimulationError(PushPressSlideError):
    """The physics engine could not go on."""
