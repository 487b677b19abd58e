"""The ellipsoid on arrays: which wrench drives a twist, and which twist a wrench drives.

Source: docs/mechanics.md, sections 1 and 1.2; ``mechanics.limit_surface`` and
``mechanics.height_term`` for one. Wrenches are about B's origin, twists those of B's
origin, in B.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import check_all, check_last, check_positive
from pushpressslide.batch.elementwise import (
    columns_of,
    figures,
    leading_shape,
    table,
    values,
)
from pushpressslide.batch.wrench_twist import TwistColumns, WrenchColumns
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, greater, where


class Ellipsoid(NamedTuple):
    """A limit surface as columns."""

    max_force: Column  # [N] mu_s N
    rho: Column  # [m]
    lift: Column  # [m] how far max_force moves the centre of pressure
    x: Column  # [m] the centre of pressure without drag, in B
    y: Column


class EllipsoidSurface:
    """An ellipsoid; figures of any leading shape."""

    def __init__(
        self,
        max_force: ArrayLike,
        rho: ArrayLike,
        center: ArrayLike = (0.0, 0.0),
        lift: ArrayLike = 0.0,
    ) -> None:
        """Prepare the surface.

        ``max_force`` (...) [N] and ``rho`` (...) [m] > 0, ``center`` (..., 2) [m] in B,
        ``lift`` (...) [m] >= 0 of forces at a height: h mu_s. Raises ValueError
        otherwise.
        """
        force, length, point, height = figures(max_force, rho, center, lift)
        check_last(point, (2,), "center")
        check_positive(force, "max_force", "N")
        check_positive(length, "rho", "m")
        rises = np.isfinite(height) & (height >= 0.0)
        check_all(rises, height, "lift", "finite and >= 0", "m")
        self.surface = Ellipsoid(force, length, height, point[..., 0], point[..., 1])
        self.shape = leading_shape(self.surface)
        """The leading shape of the surface."""

    def wrenches(self, twists: ArrayLike) -> Array:
        """Return the wrenches (..., 3) on the surface that drive ``twists`` (..., 3)."""
        (rows,) = figures(twists)
        check_last(rows, (3,), "twists")
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        surface = columns_of(self.surface, shape)
        (out,) = values(
            driving_wrench, (table(TwistColumns, rows, shape), surface), shape, (3,)
        )
        return out

    def twist_directions(self, wrenches: ArrayLike) -> Array:
        """Return the twists (..., 3) that ``wrenches`` (..., 3) drive, with |(v, rho
        w)| = 1 m/s at the moved centre of pressure; zero for no wrench.
        """
        return self._twists(wrenches)[0]

    def levels(self, wrenches: ArrayLike) -> Array:
        """Return H(W) (...): 1 on the surface, below 1 at rest."""
        return self._twists(wrenches)[1]

    def _twists(self, wrenches: ArrayLike) -> list[Array]:
        """Return twists (..., 3) and levels (...)."""
        (rows,) = figures(wrenches)
        check_last(rows, (3,), "wrenches")
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        surface = columns_of(self.surface, shape)
        return values(
            driven_twist, (table(WrenchColumns, rows, shape), surface), shape, (3, 0)
        )


def driving_wrench(twist: TwistColumns, s: Ellipsoid) -> Columns:
    """Return the wrench on the surface that drives a twist; zero for none."""
    vx = twist.vx - twist.w * s.y
    vy = twist.vy + twist.w * s.x
    turn = (s.rho * twist.w) * (s.rho * twist.w)
    shift = (s.lift * twist.w) * (s.lift * twist.w)
    # |v_center|^2 = v^2 (1 + shift / (v^2 + turn)) for the speed v of the moved centre
    square = vx * vx + vy * vy
    half = 0.5 * (square - turn - shift)
    root = np.sqrt(half * half + square * turn)
    norm = np.sqrt(greater(half + root, 0.0) + turn)
    norm = where(s.lift == 0.0, np.sqrt(square + turn), norm)
    k = s.lift * twist.w / norm
    scale = s.max_force / (norm * (1.0 + k * k))
    fx = where(norm == 0.0, 0.0, scale * (vx - k * vy))
    fy = where(norm == 0.0, 0.0, scale * (vy + k * vx))
    spin = s.max_force * s.rho * s.rho * twist.w / norm
    tau = where(norm == 0.0, 0.0, spin) + s.x * fy - s.y * fx
    return fx, fy, tau


def driven_twist(wrench: WrenchColumns, s: Ellipsoid) -> Columns:
    """Return the direction of sliding under a wrench, and the level H."""
    spin = (wrench.tau - s.x * wrench.fy + s.y * wrench.fx) / s.rho
    square = wrench.fx * wrench.fx + wrench.fy * wrench.fy + spin * spin
    norm = np.sqrt(square)
    inverse = where(norm == 0.0, 0.0, 1.0 / norm)
    vx = wrench.fx * inverse
    vy = wrench.fy * inverse
    w = spin * inverse / s.rho
    k = s.lift * w
    level = square / (s.max_force * s.max_force)
    return vx + k * vy + w * s.y, vy - k * vx - w * s.x, w, level
