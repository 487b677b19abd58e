"""The exact limit surface on arrays: sums over the samples of one pressure.

Source: docs/mechanics.md, section 1; ``mechanics.limit_surface`` for one. Wrenches are
about the centre of pressure, twists are of it, as there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import check_all, check_last, check_positive
from pushpressslide.batch.elementwise import Table, figures, table
from pushpressslide.batch.sums import sums
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Columns, where
from pushpressslide.mechanics.limit_surface import PIN_SOFTENINGS
from pushpressslide.mechanics.pressure import PressureSamples
from pushpressslide.mechanics.virtual_axle import STRAIGHT_ANGLE

STEPS = 200  # at most, trials of a shorter step included
FLAT = 1e-13  # gradient of the power at its least
SHORT = 1e-14  # step of a twist that is none
DOWN = 1e-4  # share of the fall that the slope promises which a step must give
ROUNDING = 1e-15  # of the power
SHORTEST = 1e-8  # share of a Newton step below which it is taken as it is


class SampleColumns(NamedTuple):
    """Samples of a pressure from its centre."""

    x: Array  # (m,)
    y: Array  # (m,)
    square: Array  # (m,) of the radius of the cell
    load: Array  # (m,)


class ExactSurface:
    """The surface of one pressure, for friction of any leading shape."""

    def __init__(self, samples: PressureSamples, friction: ArrayLike) -> None:
        """Prepare the surface; ``friction`` (...) > 0 of the pair object/support."""
        (self._friction,) = figures(friction)
        check_positive(self._friction, "friction", "")
        arms = samples.points - np.array(samples.cop)
        x, y = np.ascontiguousarray(arms.T)
        square = samples.radii**2
        self._load = samples.total_load
        self._samples = SampleColumns(x, y, square, samples.loads)
        share = samples.loads / self._load
        self._rho = float(share @ np.sqrt(x * x + y * y + square))
        self._extended = bool((samples.radii[samples.loads > 0.0] > 0.0).all())

    def wrenches(self, twists: ArrayLike) -> Array:
        """Return the wrenches (..., 3) that drive ``twists`` (..., 3).

        A sample at the centre of rotation gives no force.
        """
        (rows,) = figures(twists)
        check_last(rows, (3,), "twists")
        shape = np.broadcast_shapes(rows.shape[:-1], self._friction.shape)
        driven = sums(friction_of_sample, _table(rows), self._samples, 3)
        unit = driven.reshape(rows.shape)
        out: Array = np.broadcast_to(unit, (*shape, 3)) * self._friction[..., None]
        return out

    def slides(self, wrenches: ArrayLike) -> tuple[Array, Array]:
        """Return the twists (..., 3) that ``wrenches`` (..., 3) drive, with |(v, rho
        w)| = 1, and the factors (...) by which they exceed the surface.

        rho is the mean distance of the load to its centre. As
        ``mechanics.limit_surface.exact_slide``: the twist of least friction power among
        those with unit power of the wrench. Raises ValueError for a wrench that is zero
        or not finite, and for a pressure without extent.
        """
        (rows,) = figures(wrenches)
        check_last(rows, (3,), "wrenches")
        if self._rho == 0.0:
            raise ValueError("extent of the pressure 0.0 m; must be > 0")
        flat = rows.reshape(-1, 3) / (1.0, 1.0, self._rho)
        sizes = np.linalg.norm(flat, axis=1)
        moves = np.isfinite(sizes) & (sizes > 0.0)
        check_all(moves, sizes, "size of a wrench", "finite and > 0", "N")
        twists, powers = self._least_power(flat / sizes[:, None])
        norms = np.linalg.norm(twists, axis=1)
        directions = twists / norms[:, None] / (1.0, 1.0, self._rho)
        levels = (sizes / (powers * self._load)).reshape(rows.shape[:-1])
        shape = np.broadcast_shapes(levels.shape, self._friction.shape)
        spread = np.broadcast_to(directions.reshape(rows.shape), (*shape, 3))
        return spread.copy(), levels / self._friction

    def _least_power(self, targets: Array) -> tuple[Array, Array]:
        """Return twists (n, 3) with |(v, rho w)|, and their powers over mu N (n,), for
        unit wrenches (n, 3).
        """
        bases = across(targets)
        z = np.zeros((len(targets), 2))
        for softening in (0.0,) if self._extended else PIN_SOFTENINGS:
            z = _descended(self._scaled(softening), targets, bases, z)
        twists = targets + np.einsum("nij,nj->ni", bases, z)
        powers = sums(power_of_sample, _table(twists), self._scaled(0.0), 10)[:, 0]
        return twists, powers

    def _scaled(self, softening: float) -> SampleColumns:
        """Return the samples over rho and load, their edges rounded by ``softening``."""
        s = self._samples
        rho = self._rho
        square = s.square / rho**2 + softening**2
        return SampleColumns(s.x / rho, s.y / rho, square, s.load / self._load)


def _table(twists: Array) -> Table:
    return table(TwistColumns, twists, twists.shape[:-1])


def across(targets: Array) -> Array:
    """Return two unit vectors (n, 3, 2) at right angles to unit vectors (n, 3) and to
    each other.
    """
    x, y, z = targets.T
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    first = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=1)
    second = np.stack([b, sign + y * y * a, -y], axis=1)
    return np.stack([first, second], axis=2)


def friction_of_sample(twist: TwistColumns, s: SampleColumns) -> Columns:
    """Return the wrench over mu that a sample takes to slide."""
    px = twist.vx - twist.w * s.y
    py = twist.vy + twist.w * s.x
    speed = np.sqrt(px * px + py * py + s.square * twist.w * twist.w)
    k = where(speed == 0.0, 0.0, s.load / speed)  # a sample at rest gives no force
    return k * px, k * py, k * (s.x * py - s.y * px + s.square * twist.w)


def power_of_sample(nu: TwistColumns, s: SampleColumns) -> Columns:
    """Return a sample's friction power, its gradient and its Hessian in (vx, vy, w).

    The speed is |A nu|; with u = A nu / |A nu| the gradient is A^T u, and the Hessian
    (A^T A - A^T u u^T A) / |A nu|.
    """
    px = nu.vx - s.y * nu.w
    py = nu.vy + s.x * nu.w
    speed = np.sqrt(px * px + py * py + s.square * nu.w * nu.w)
    inverse = where(speed == 0.0, 0.0, 1.0 / speed)
    ux = px * inverse
    uy = py * inverse
    ut = (s.x * py - s.y * px + s.square * nu.w) * inverse
    k = s.load * inverse
    return (
        s.load * speed,
        s.load * ux,
        s.load * uy,
        s.load * ut,
        k * (1.0 - ux * ux),
        -k * ux * uy,
        k * (-s.y - ux * ut),
        k * (1.0 - uy * uy),
        k * (s.x - uy * ut),
        k * (s.x * s.x + s.y * s.y + s.square - ut * ut),
    )


def _descended(samples: SampleColumns, targets: Array, bases: Array, z: Array) -> Array:
    """Return z (n, 2) of the least power, by Newton steps from ``z`` that are halved
    until the power falls.
    """
    out = z.copy()
    rows = np.arange(len(z))
    power, gradient, hessian = _derivatives(samples, targets, bases, z)
    share = np.ones(len(z))
    step = _newton_steps(gradient, hessian)
    for _ in range(STEPS):
        done = np.abs(gradient).max(axis=1, initial=0.0) < FLAT
        done |= share * np.abs(step).max(axis=1, initial=0.0) < SHORT
        if done.any():
            out[rows[done]] = z[done]
            left = ~done
            rows, z, share, step = rows[left], z[left], share[left], step[left]
            power, gradient, hessian = power[left], gradient[left], hessian[left]
        if not len(rows):
            return out
        trial = z + share[:, None] * step
        new = _derivatives(samples, targets[rows], bases[rows], trial)
        fall = DOWN * share * np.einsum("ni,ni->n", gradient, step)
        taken = (new[0] <= power + fall + ROUNDING) | (share <= SHORTEST)
        z = np.where(taken[:, None], trial, z)
        power = np.where(taken, new[0], power)
        gradient = np.where(taken[:, None], new[1], gradient)
        hessian = np.where(taken[:, None], new[2], hessian)
        share = np.where(taken, 1.0, 0.5 * share)
        step = np.where(taken[:, None], _newton_steps(gradient, hessian), step)
    out[rows] = z
    return out


def _derivatives(
    samples: SampleColumns, targets: Array, bases: Array, z: Array
) -> tuple[Array, Array, Array]:
    """Return power (n,), gradient (n, 2) and Hessian (n, 3), its entries 00, 01, 11."""
    nu = targets + np.einsum("nij,nj->ni", bases, z)
    parts = sums(power_of_sample, _table(nu), samples, 10)
    gradient = np.einsum("nij,ni->nj", bases, parts[:, 1:4])
    a, b, c, d, e, f = parts[:, 4:].T
    full = np.stack([a, b, c, b, d, e, c, e, f], axis=1).reshape(-1, 3, 3)
    small = np.einsum("nki,nkl,nlj->nij", bases, full, bases)
    entries = np.stack([small[:, 0, 0], small[:, 0, 1], small[:, 1, 1]], axis=1)
    return parts[:, 0], gradient, entries


def _newton_steps(gradient: Array, hessian: Array) -> Array:
    """Return the steps (n, 2) to where the gradient is zero, a little damped."""
    a, b, d = hessian.T
    damping = FLAT * (1.0 + a + d)
    a = a + damping
    d = d + damping
    determinant = a * d - b * b
    gx, gy = gradient.T
    steps = np.stack([b * gy - d * gx, b * gx - a * gy], axis=1)
    out: Array = steps / determinant[:, None]
    return out


def straight_variances(samples: PressureSamples, axes: Array) -> Array:
    """Return the variance (n,) [m^2] of the load along unit vectors (n, 2)."""
    arms = samples.points - np.array(samples.cop)
    along = arms @ axes.T
    out: Array = samples.loads @ along**2 / samples.total_load
    return out


def exact_axle_distances(
    samples: PressureSamples, levers: ArrayLike, angles: ArrayLike
) -> Array:
    """Return the distances (...) [m] from the centre of pressure to the virtual axle:
    ``mechanics.virtual_axle.exact_axle_distance`` of ``levers`` (..., 2) [m] and force
    ``angles`` (...) [rad].

    Raises ValueError for a lever that is zero.
    """
    arms, turns = figures(levers, angles)
    check_last(arms, (2,), "levers")
    shape = np.broadcast_shapes(arms.shape[:-1], turns.shape)
    arms = np.broadcast_to(arms, (*shape, 2)).reshape(-1, 2)
    turns = np.broadcast_to(turns, shape).reshape(-1)
    d = np.hypot(arms[:, 0], arms[:, 1])
    check_positive(d, "lever", "m")
    ex, ey = (arms / d[:, None]).T
    straight = np.abs(np.sin(turns)) < STRAIGHT_ANGLE
    # a straight force has no turn to divide by: its axle is the limit
    turns = np.where(straight, 0.5 * math.pi, turns)
    fx = np.cos(turns) * ex - np.sin(turns) * ey
    fy = np.sin(turns) * ex + np.cos(turns) * ey
    wrenches = np.stack([fx, fy, arms[:, 0] * fy - arms[:, 1] * fx], axis=1)
    twists, _ = ExactSurface(samples, 1.0).slides(wrenches)
    vx, vy, w = twists.T
    limit = straight_variances(samples, np.stack([ex, ey], axis=1)) / d
    return np.where(straight, limit, (vy * ex - vx * ey) / w).reshape(shape)
