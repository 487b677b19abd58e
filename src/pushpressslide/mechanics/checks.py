"""Checks of friction, limit surface and force parameters, shared by all constructors.

Each raises InputError, in one line, with the name and the value.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point

# allowed error of a unit vector's length: vectors may be typed to three digits
UNIT = 1e-3


def check_friction(friction: float, name: str = "friction") -> None:
    """Raise InputError unless a coefficient of friction is finite and >= 0."""
    if not (friction >= 0.0 and math.isfinite(friction)):
        raise InputError(f"{name} {friction}; must be finite and >= 0")


def check_rho(rho: float) -> None:
    """Raise InputError unless ``rho`` [m] is finite and > 0."""
    if not (rho > 0.0 and math.isfinite(rho)):
        raise InputError(f"rho {rho} m; must be finite and > 0")


def check_force(force: float, name: str) -> None:
    """Raise InputError unless a ``force`` [N] is finite and > 0."""
    if not (force > 0.0 and math.isfinite(force)):
        raise InputError(f"{name} {force} N; must be finite and > 0")


def check_press(load: float, friction: float) -> None:
    """Raise InputError unless a press has a ``load`` [N] > 0 and friction >= 0."""
    check_force(load, "load")
    check_friction(friction)


def check_caps(caps: Sequence[float]) -> None:
    """Raise InputError unless there are two ``caps`` [N], each > 0. Inf means no cap."""
    if len(caps) != 2:
        raise InputError(f"caps {tuple(caps)} N; must be two, one for each contact")
    for cap in caps:
        if not cap > 0.0:
            raise InputError(f"cap {cap} N; must be > 0")


def check_point(point: Point, name: str) -> None:
    """Raise InputError unless both coordinates of a ``point`` [m] are finite."""
    if not all(map(math.isfinite, point)):
        raise InputError(f"{name} {point} m; must be finite")


def check_normal(normal: Point) -> None:
    """Raise InputError unless ``normal`` has unit length, to 1e-3."""
    if not abs(math.hypot(*normal) - 1.0) <= UNIT:
        raise InputError(f"normal {normal}; must have unit length")
