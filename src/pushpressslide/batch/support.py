"""Friction between bodies and their supports as a smooth function of the twist, on
arrays: the exact limit surface of a pressure, or the ellipsoid.

Source: docs/mechanics.md, section 1; ``planar.support`` for one. Twists are
(v_x, v_y, rho w) and wrenches (f_x, f_y, tau / rho) of the centre of pressure, so that
all three are speeds, and forces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import check_positive
from pushpressslide.batch.elementwise import Table, figures, values
from pushpressslide.batch.rows import Figures, answers, spread
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns
from pushpressslide.kernels.edge_friction import polygon_friction
from pushpressslide.kernels.support_friction import CREEP, ellipsoid_friction
from pushpressslide.mechanics.face_pressure import FacePressure
from pushpressslide.mechanics.pressure import PressureSamples

BLOCK = 32_768  # speeds of samples that are worked out at a time, to stay in the cache


@dataclass(frozen=True, eq=False)
class EllipsoidSupport:
    """Bodies on ellipsoids."""

    rho: Array  # (...) [m]
    max_force: Array  # (...) [N] mu_s N

    def frictions(self, twists: Array) -> Array:
        """Return ``balance.Friction`` (9, n) of ``twists`` (n, 3) [m/s]."""
        return answers(ellipsoid_friction, spread(twists), columns=9).T


@dataclass(frozen=True, eq=False)
class PolygonSupport:
    """Bodies on the exact surface of one pressure on a polygon."""

    # of the pressure, over rho, as ``kernels.edge_friction`` has them
    edges: Array  # (8, m)
    plane: Array  # (5,)
    series: NDArray[np.complex128]  # (10,)
    rho: Array  # (...) [m] root mean square distance of the load
    max_force: Array  # (...) [N] mu_s N

    def frictions(self, twists: Array) -> Array:
        """Return ``balance.Friction`` (9, n) of ``twists`` (n, 3) [m/s]."""
        arrays = (self.edges, self.series)
        figures = Figures(self.plane, ((0.0,) * 5,))
        return answers(polygon_friction, spread(twists), figures, arrays, columns=9).T


@dataclass(frozen=True, eq=False)
class SampledSupport:
    """Samples of the load, the same under all bodies, and each body's size and limit."""

    places: Array  # (m, 2) over rho, from the centre of pressure
    radii: Array  # (m,) over rho, of the cells
    shares: Array  # (m,) of the load
    rho: Array  # (...) [m] root mean square distance of the load
    max_force: Array  # (...) [N] mu_s N

    def frictions(self, twists: Array) -> Array:
        """Return ``balance.Friction`` (9, n) of ``twists`` (n, 3) [m/s]."""
        sums = Table(Sums, self._sums(twists))
        return _columns(friction_of_sums, Table(TwistColumns, twists), sums)

    def _sums(self, twists: Array) -> Array:
        """Return 14 sums (n, 14) over the samples, of which friction and its slope are
        made, for ``twists`` (n, 3) [m/s].

        With b = (1, x, y, r^2) and the speed |v|: of b_i / |v|, and of b_i b_j / |v|^3
        for i <= j.
        """
        soft = CREEP * CREEP
        basis, pairs = self._basis
        out = np.empty((len(twists), 14))
        rows = max(1, BLOCK // len(basis))
        for start in range(0, len(twists), rows):
            block = slice(start, start + rows)
            vx, vy, w = twists[block].T
            still = vx * vx + vy * vy + soft
            terms = np.stack([still, 2.0 * w * vy, -2.0 * w * vx, w * w])
            squared = np.maximum(basis @ terms, soft)
            per_speed = self.shares[:, None] / np.sqrt(squared)
            out[block, :4] = (basis.T @ per_speed).T
            out[block, 4:] = (pairs @ (per_speed / squared)).T
        return out

    @cached_property
    def _basis(self) -> tuple[Array, Array]:
        """Return b_i (m, 4), and b_i b_j (10, m) for i <= j."""
        x, y = self.places.T
        square = x * x + y * y + self.radii**2
        basis = np.stack([np.ones_like(x), x, y, square], axis=1)
        i, j = np.triu_indices(4)
        return basis, np.ascontiguousarray((basis[:, i] * basis[:, j]).T)


Support = EllipsoidSupport | PolygonSupport | SampledSupport


class Sums(NamedTuple):
    """What ``SampledSupport`` sums up: k_i of b_i / |v|, s_ij of b_i b_j / |v|^3."""

    k0: Column
    kx: Column
    ky: Column
    ks: Column
    s00: Column
    s0x: Column
    s0y: Column
    s0s: Column
    sxx: Column
    sxy: Column
    sxs: Column
    syy: Column
    sys: Column
    sss: Column


def _columns(formula: Callable[..., Columns], *tables: Table) -> Array:
    """Return the nine columns (9, n) of a formula."""
    (out,) = values(formula, tables, (len(tables[0].rows),), (9,))
    return out.T


def friction_of_sums(twist: TwistColumns, s: Sums) -> Columns:
    """Return ``balance.Friction``; its slope is that of the forces at given speeds, less
    what the speeds change.
    """
    x, y, w = twist
    xx = x * x * s.s00 - 2.0 * x * w * s.s0y + w * w * s.syy
    xy = x * y * s.s00 + x * w * s.s0x - w * y * s.s0y - w * w * s.sxy
    yy = y * y * s.s00 + 2.0 * y * w * s.s0x + w * w * s.sxx
    xw = x * y * s.s0x - x * x * s.s0y + x * w * s.s0s
    xw = xw - w * y * s.sxy + w * x * s.syy - w * w * s.sys
    yw = y * y * s.s0x - x * y * s.s0y + y * w * s.s0s
    yw = yw + w * y * s.sxx - w * x * s.sxy + w * w * s.sxs
    ww = y * y * s.sxx + x * x * s.syy + w * w * s.sss
    ww = ww + 2.0 * (y * w * s.sxs - x * y * s.sxy - x * w * s.sys)
    return (
        s.k0 * x - s.ky * w,
        s.k0 * y + s.kx * w,
        s.kx * y - s.ky * x + s.ks * w,
        s.k0 - xx,
        -xy,
        -s.ky - xw,
        s.k0 - yy,
        s.kx - yw,
        s.ks - ww,
    )


def ellipsoid_support(max_force: ArrayLike, rho: ArrayLike) -> EllipsoidSupport:
    """Return bodies on the ellipsoid: ``max_force`` (...) [N] mu_s N, ``rho`` (...) [m].

    Raises ValueError unless both are finite and > 0.
    """
    force, length = figures(max_force, rho)
    check_positive(force, "max_force", "N")
    check_positive(length, "rho", "m")
    return EllipsoidSupport(length, force)


def polygon_support(face: FacePressure, max_force: ArrayLike) -> PolygonSupport:
    """Return bodies on the exact surface of one pressure: ``max_force`` (...) [N] mu_s N.

    Raises ValueError unless it is finite and > 0.
    """
    (force,) = figures(max_force)
    check_positive(force, "max_force", "N")
    unit = face.scaled(face.rho)
    plane = np.array(unit.plane())
    series = np.array(unit.series())
    return PolygonSupport(unit.edges(), plane, series, np.array(face.rho), force)


def exact_support(samples: PressureSamples, friction: ArrayLike) -> SampledSupport:
    """Return bodies on the exact surface of one pressure, for ``friction`` (...) of the
    pair object/support.

    Raises ValueError for friction <= 0, and for a pressure with pins: about one of
    them a body turns with no drag that could be found.
    """
    (mu,) = figures(friction)
    check_positive(mu, "friction", "")
    check_positive(samples.radii[samples.loads > 0.0], "radius of a sample", "m")
    arms = samples.points - np.array(samples.cop)
    shares = samples.loads / samples.total_load
    square = (arms**2).sum(axis=1) + samples.radii**2
    rho = np.sqrt(shares @ square)
    return SampledSupport(
        arms / rho, samples.radii / rho, shares, rho, mu * samples.total_load
    )
