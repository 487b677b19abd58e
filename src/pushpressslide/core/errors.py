"""The errors of the package, with a common base class.

Every message is one line with the cause, the value, and the allowed range.
"""

from __future__ import annotations

import os
import reprlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pushpressslide.core.plan import Choice


LONGEST_PATH = 4096  # characters, as of Linux


class PushPressSlideError(Exception):
    """Base class of all deliberate errors of this package."""


class TaskError(PushPressSlideError):
    """A task file that cannot be used.

    The message is one line: ``file: field: value is not allowed; what is allowed``, or
    ``file: fault`` if no single field is to blame.
    """

    def __init__(self, source: str, field: str, value: object, allowed: str) -> None:
        shown = value if isinstance(value, Shown) else _bounded(value)
        where = "".join(f"{place}: " for place in (source, field) if place)
        super().__init__(
            f"{where}{shown} is not allowed; {allowed}"
            if field
            else f"{where}{allowed}"
        )
        self.source = source
        self.field = field
        self.value = value
        self.allowed = allowed


class TaskWarning(UserWarning):
    """A value that is allowed but probably a mistake."""


class RobotFileError(TaskError):
    """A robot's file that does not define an arm.

    The message gives the file, the link or joint, the value and the allowed range.
    """

    def __init__(self, path: str, place: str, value: object, allowed: str) -> None:
        here = os.path.join(os.getcwd(), "")
        super().__init__(path.removeprefix(here), place, value, allowed)


class WriteError(PushPressSlideError, OSError):
    """A file or folder of results that cannot be written, for lack of space or
    permission.
    """

    def __init__(self, path: object, error: OSError) -> None:
        reason = error.strerror or str(error) or type(error).__name__
        super().__init__(f"{path}: it cannot be written ({reason})")


class InputError(PushPressSlideError, ValueError):
    """A number that a constructor cannot use.

    The message gives its name, its value and the allowed range.
    """


class MissingFrameError(PushPressSlideError):
    """A robot model without the frame that is named as its tip."""


class MissingPackageError(PushPressSlideError, ImportError):
    """A missing package of an extra.

    The message contains the command that installs it.
    """


def path_value(path: str) -> str:
    """A path as a value in a message.

    It is shortened only if it is longer than any file's path can be.
    """
    return Shown(repr(path)) if len(path) <= LONGEST_PATH else path


class Shown(str):
    """A value that appears in a message without quotes, such as a number with its unit."""

    __slots__ = ()


def _bounded(value: object) -> str:
    """Repr of at most about 80 characters, in bounded time for any value."""
    short = reprlib.Repr()
    short.maxstring = short.maxother = short.maxlong = 60
    text = " ".join(short.repr(value).split())
    return text if len(text) <= 80 else text[:77] + "..."


class InfeasibleTaskError(PushPressSlideError):
    """No mode, path or joint path can do the task.

    The message contains the deciding number.
    """

    def __init__(
        self, message: str, brief: str = "", choices: Sequence[Choice] = ()
    ) -> None:
        super().__init__(message)
        self.brief = brief or message  # reason of one choice alone
        self.choices = tuple(choices)  # evaluated choices; may be empty


class SimulationError(PushPressSlideError):
    """The physics engine failed."""
