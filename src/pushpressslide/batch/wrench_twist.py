"""Wrenches and twists as columns, in one planar frame."""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core.formulas import Column


class WrenchColumns(NamedTuple):
    """Wrenches, a column each."""

    fx: Column  # [N]
    fy: Column  # [N]
    tau: Column  # [N m]


class TwistColumns(NamedTuple):
    """Twists, a column each."""

    vx: Column  # [m/s]
    vy: Column  # [m/s]
    w: Column  # [rad/s]
