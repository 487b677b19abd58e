"""Checks of a batch's parameters.

Each raises InputError with a message of one line: the parameter's name and the first
value that is not allowed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import InputError
from pushpressslide.mechanics.checks import UNIT

Flags = NDArray[np.bool_]


def check_last(array: Array, sizes: tuple[int, ...], name: str) -> None:
    """Raise InputError unless the last axes of ``array`` have the given ``sizes``."""
    if array.shape[-len(sizes) :] != sizes:
        allowed = ", ".join(str(size) for size in sizes)
        raise InputError(f"{name} {array.shape}; must be (..., {allowed})")


def check_all(
    holds: Flags, values: Array, name: str, allowed: str, unit: str = ""
) -> None:
    """Raise InputError with the first of ``values`` for which ``holds`` is False."""
    if not np.all(holds):
        first = np.asarray(values)[np.logical_not(holds)].flat[0]
        raise InputError(
            f"{' '.join([name, str(first), unit]).rstrip()}; must be {allowed}"
        )


def check_frictions(friction: Array) -> None:
    """Raise InputError unless all coefficients of friction are finite and >= 0."""
    holds = np.isfinite(friction) & (friction >= 0.0)
    check_all(holds, friction, "friction", "finite and >= 0")


def check_positive(values: Array, name: str, unit: str) -> None:
    """Raise InputError unless all ``values`` are finite and > 0."""
    holds = np.isfinite(values) & (values > 0.0)
    check_all(holds, values, name, "finite and > 0", unit)


def check_finite(values: Array, name: str) -> None:
    """Raise InputError unless all ``values`` are finite."""
    check_all(np.isfinite(values), values, name, "finite")


def check_units(normals: Array) -> None:
    """Raise InputError unless vectors (..., 2) have unit length, to 1e-3."""
    sizes = np.hypot(normals[..., 0], normals[..., 1])
    check_all(np.abs(sizes - 1.0) <= UNIT, sizes, "length of a normal", "1")


def check_caps(caps: Array) -> None:
    """Raise InputError unless all normal forces [N] are > 0. An infinite value means no
    limit.
    """
    check_all(caps > 0.0, caps, "cap", "> 0", "N")
