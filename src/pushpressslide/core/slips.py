"""Warnings about values that are allowed but probably mistakes."""

from __future__ import annotations

import sys
import warnings
from types import FrameType

from pushpressslide.core.errors import TaskWarning

INSIDE = ("pushpressslide", "dataclasses")
"""Modules that only pass on values from a calling program."""


def warn_of_slip(text: str) -> None:
    """Issue a TaskWarning at the line of the program that called into this package."""
    level = 2
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and _name(frame).startswith(INSIDE):
        frame = frame.f_back
        level += 1
    warnings.warn(text, TaskWarning, stacklevel=level)


def called_from_inside(depth: int) -> bool:
    """Whether the caller ``depth`` calls above belongs to this package."""
    frame: FrameType | None = sys._getframe(depth + 1)
    while frame is not None and _name(frame) == "dataclasses":
        frame = frame.f_back
    return frame is not None and _name(frame).startswith("pushpressslide")


def _name(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", ""))
