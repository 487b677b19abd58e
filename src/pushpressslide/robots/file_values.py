"""Values in a robot's file, each checked when it is read."""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.core.errors import Shown

Triple = tuple[float, float, float]

FARTHEST = 100.0  # [m] of an origin; millimetres are beyond it
HEAVIEST = 1e6  # [kg] of a link


class UnfitValue(Exception):
    """A value in a robot's file that cannot be used, with its place and the allowed
    values.
    """

    def __init__(self, place: str, value: object, allowed: str) -> None:
        super().__init__(f"{place}: {value!r} is not allowed; allowed: {allowed}")
        self.place = place
        self.value = value
        self.allowed = allowed


def triple(
    text: str | None,
    place: str,
    default: Triple = (0.0, 0.0, 0.0),
    limit: float = math.inf,
) -> Triple:
    """Three finite numbers of at most ``limit`` in magnitude.

    Raises UnfitValue otherwise.
    """
    x, y, z = vector(text, 3, place, default, limit)
    return (x, y, z)


def vector(
    text: str | None,
    count: int,
    place: str,
    default: tuple[float, ...] | None = None,
    limit: float = math.inf,
) -> tuple[float, ...]:
    """``count`` finite numbers of at most ``limit`` in magnitude.

    Raises UnfitValue otherwise, and for a missing text without a default.
    """
    if text is None and default is not None:
        return default
    values = tuple(_float(part) for part in (text or "").split())
    bound = "" if math.isinf(limit) else f" in [-{limit:g}, {limit:g}]"
    if len(values) != count or not all(
        math.isfinite(v) and abs(v) <= limit for v in values
    ):
        given = Shown(f"'{(text or '').strip()}'")
        raise UnfitValue(place, given, f"{count} finite numbers{bound}")
    return values


def place_of(text: str | None, place: str) -> Triple:
    """Position [m] of an origin."""
    return triple(text, place, limit=FARTHEST)


def number(
    text: str,
    place: str,
    allowed: str,
    sound: Callable[[float], bool] = math.isfinite,
) -> float:
    """A number for which ``sound`` holds. NaN never passes.

    Raises UnfitValue otherwise.
    """
    value = _float(text)
    if math.isnan(value) or not sound(value):
        raise UnfitValue(place, Shown(text.strip()), allowed)
    return value


def mass(text: str, place: str) -> float:
    """Mass [kg] of a link. 0 for a link that only carries a frame."""
    allowed = f"a number [kg] in [0, {HEAVIEST:g}]"
    return number(text, place, allowed, lambda value: 0.0 <= value <= HEAVIEST)


def moment(text: str, place: str) -> float:
    """Moment of inertia [kg m^2]. It may be 0."""
    allowed = "a finite number [kg m^2], 0 or more"
    sound: Callable[[float], bool] = lambda value: 0.0 <= value < math.inf  # noqa: E731
    return number(text, place, allowed, sound)


def product(text: str, place: str) -> float:
    """Product of inertia [kg m^2]."""
    return number(text, place, "a finite number [kg m^2]")


def _float(text: str) -> float:
    """A text as a number. NaN if it is not one."""
    try:
        return float(text)
    except ValueError:
        return math.nan
