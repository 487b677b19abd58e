"""Refusals as data, and their conversion to English text."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Unit = Literal["", "m", "rad", "N", "s"]

SKIPPED = "skipped"
"""Code of a choice that was not evaluated. The refusal's text states the reason."""

# units that are shown, the longer names first
SHOWN = ("deg", "mm", "m", "N", "s", "")


class Quantity(float):
    """A number whose format names its unit: ``{:mm.1f}`` of 0.0412 is "41.2 mm"."""

    __slots__ = ()

    def __format__(self, form: str) -> str:
        """The number followed by its unit.

        ``form`` starts with the unit; its rest formats the number.
        """
        unit = next(name for name in SHOWN if form.startswith(name))
        value = float(self)
        if unit == "deg":
            value = math.degrees(value)
        elif unit == "mm":
            value *= 1e3
        return f"{format(value, form[len(unit) :])} {unit}".rstrip()


@dataclass(frozen=True, slots=True)
class Refusal:
    """One reason against a choice, a plan or a task.

    ``text`` has placeholders ``{figure}`` and ``{allowed}`` for the two numbers,
    formatted as ``Quantity`` does it.
    """

    code: str  # the reason, one word for machines
    text: str
    figure: float | None = None  # SI, the number that decides
    allowed: float | None = None  # SI, its bound
    unit: Unit = ""  # of both

    def __str__(self) -> str:
        """One line of English. A missing number is "unknown"."""
        return self.text.format(
            figure=_shown(self.figure), allowed=_shown(self.allowed)
        )


class _Unknown:
    """Placeholder for a number that a refusal's text uses but its data lack."""

    def __format__(self, form: str) -> str:
        """The word "unknown", for any unit."""
        return "unknown"


def _shown(number: float | None) -> Quantity | _Unknown:
    if number is None or math.isnan(number):
        return _Unknown()
    return Quantity(number)


def enough_feasible(count: int) -> Refusal:
    """Refusal of a choice that was not evaluated because ``count`` better choices of
    its mode are feasible.
    """
    text = (
        "not evaluated: enough choices of this mode that rank before it are feasible "
        "({figure:.0f})"
    )
    return Refusal(SKIPPED, text, count)


class RefusedError(ValueError):
    """A model cannot be made. The error carries the refusal."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(str(refusal))
        self.refusal = refusal


def literal(text: str) -> str:
    """``text`` escaped for a refusal, so that no part of it is read as a placeholder."""
    return text.replace("{", "{{").replace("}", "}}")


def refusal_of(error: ValueError, code: str) -> Refusal:
    """Refusal that ``error`` carries. If it carries none, a new refusal with the
    error's message, under ``code``.
    """
    if isinstance(error, RefusedError):
        return error.refusal
    return Refusal(code, literal(str(error)))
