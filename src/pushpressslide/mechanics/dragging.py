"""Exact sliding motion of an object dragged by one force at a height, for many forces
at a time.

The drag itself shifts the pressure (docs/mechanics.md, sections 1 and 1.2). The
pressure is unilateral and linear over the base, with its centre at cop + h F / N.
Everything is in the body frame B.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.pressure import CELL_RADIUS

RESOLUTION = 3  # of the base: twists are right to about a percent
COARSE = 1  # resolution of the coarse base that settles first
STEPS = 18  # at most, of the iteration for pressure and twist together
SETTLING = 4  # steps before the first Newton step for the twist
# change of a twist in a step after which it is near enough: Newton's last step squares
# it
CLOSE = 1e-3
# largest relative increase of the friction's power in a step, as the pressure moves
LOWER = 1e-5
FULL = (1.0,)  # shares of the Newton steps for the pressure
DAMPED = (1.0, 0.5, 0.5, 0.5, 0.7)  # the same of the first ones
BALANCED = 0.01  # largest error of load and moment of a usable pressure, as a share
REST = 1e-9  # [m/s] below which a cell counts as resting, of twists of about 1 m/s
# rows and columns of a symmetric matrix that are kept
THREE = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
FOUR = ([0, 0, 0, 0, 1, 1, 1, 2, 2, 3], [0, 1, 2, 3, 1, 2, 3, 2, 3, 3])


@dataclass(frozen=True, slots=True)
class Dragged:
    """Sliding motions under m forces, each just large enough to slide the object."""

    # (m, 3) of B's origin, about 1 m/s in size: only their direction counts
    twists: Array
    shares: Array  # (m,) the force's size over mu N


@dataclass(frozen=True, slots=True)
class DraggedEllipsoid:
    """A base whose limit surface is an ellipsoid with the same rho for every centre of
    pressure.
    """

    rho: float  # [m]
    shift: float  # [m] as of DraggedBase

    def slide(self, cops: Array, contacts: Array, directions: Array) -> Dragged:
        """Sliding motion under forces, as in ``DraggedBase``, but in closed form."""
        x, y = (contacts - cops).T
        fx, fy = directions.T
        # the drag moves the centre of pressure along the force, which has no moment
        moments = x * fy - y * fx
        shares = 1.0 / np.hypot(1.0, moments / self.rho)
        w = moments / self.rho**2
        cx, cy = (cops + self.shift * shares[:, None] * directions).T
        return Dragged(np.stack([fx + w * cy, fy - w * cx, w], axis=1), shares)


class DraggedBase:
    """The base of one object, with its exact limit surface."""

    def __init__(
        self, body: ObjectModel, shift: float, resolution: int = RESOLUTION
    ) -> None:
        """Precompute the base.

        ``shift`` h mu_s [m] is the displacement of the centre of pressure by a drag of
        mu_s N.
        """
        points, areas = body.shape.base_rule(resolution)
        x, y = (points - np.array(body.center_of_mass)).T
        self._shift = shift
        self._size = body.shape.farthest(body.center_of_mass)  # [m] of the base
        self._coarser: DraggedBase | None = None
        if resolution > COARSE:
            self._coarser = DraggedBase(body, shift, COARSE)
        self._shares = areas / areas.sum()
        self._linear = np.stack([np.ones_like(x), x / self._size, y / self._size])
        self._moments = (self._linear[THREE[0]] * self._linear[THREE[1]]).T
        # |v_k|^2 is linear in these four: v^2 + 2 w (v_y x - v_x y) + w^2 (x^2 + y^2 +
        # radius^2); so are the entries of its gradient
        self._sizes = np.array([[1.0], [1.0], [self._size]])
        self._basis = np.stack(
            [np.ones_like(x), x, y, x * x + y * y + CELL_RADIUS**2 * areas]
        )
        self._squares = (self._basis[FOUR[0]] * self._basis[FOUR[1]]).T

    def slide(self, cops: Array, contacts: Array, directions: Array) -> Dragged:
        """Sliding motion under forces along unit vectors ``directions`` (m, 2) at
        ``contacts`` (m, 2) [m].

        ``cops`` (m, 2) [m] are the centres of pressure without drag; the centres
        shifted by the drag must be inside the base. The pressure is found by Newton
        steps. The twist has the smallest friction power among all twists at which the
        force has unit power. Each of the first steps takes the twist of an ellipsoid
        with the friction of the previous twist, which always lowers the friction power.
        Later steps are Newton steps wherever these also lower the power. If a coarser
        base has already given a result, there are only later steps.
        """
        x, y = contacts.T
        direction = directions.T
        cop = cops.T
        force = np.stack([*direction, x * direction[1] - y * direction[0]])
        one = np.ones(len(directions))
        zero = np.zeros(len(directions))
        start = np.stack([*direction, zero, one, one, zero, zero])
        settled = np.zeros(len(directions), dtype=bool)
        if self._coarser is not None:
            coarse, settled = self._coarser._slid(force, direction, cop, start, 0)
            start = np.where(settled, coarse, start)
        slid = np.full_like(start, math.nan)
        for rows, first in ((settled, SETTLING), (~settled, 0)):
            if rows.any():
                found, balanced = self._slid(
                    force[:, rows],
                    direction[:, rows],
                    cop[:, rows],
                    start[:, rows],
                    first,
                )
                slid[:, rows] = np.where(balanced, found, math.nan)
        twists = slid[:3] / np.linalg.norm(slid[:3] * self._sizes, axis=0)
        return Dragged(twists.T, slid[3])

    def _slid(
        self, force: Array, direction: Array, cop: Array, start: Array, first: int
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Twist, share and pressure (7, m) from given initial values, and whether the
        pressure is in balance.
        """
        twist = start[:3]
        share = start[3]
        plane = start[4:]
        lower = np.full(len(share), math.inf)
        sure = twist
        rows = np.arange(len(share))
        out = np.empty_like(start)
        balanced = np.zeros(len(share), dtype=bool)
        for step in range(first, STEPS):
            moved = (cop + self._shift * share * direction) / self._size
            target = np.stack([np.ones(len(rows)), *moved])
            plane = self._settled(plane, target, FULL if step else DAMPED)
            loads = np.maximum(plane.T @ self._linear, 0.0) * self._shares
            late = step >= SETTLING
            power, ellipsoid, newton = self._steps(loads, twist, force, late)
            higher = power > lower * (1.0 + LOWER)
            share = np.where(higher, share, np.clip(power, 0.0, 1.0))
            last = twist
            twist = np.where(higher, sure, newton)
            sure = ellipsoid
            lower = np.where(higher, math.inf, power)
            change = self._change(last, twist)
            done = (change < CLOSE) & (step > SETTLING) | (step == STEPS - 1)
            if done.any():
                off = np.abs(loads[done] @ self._linear.T - target[:, done].T).max(1)
                state = np.concatenate([twist, share[None], plane])
                out[:, rows[done]] = state[:, done]
                balanced[rows[done]] = off <= BALANCED
                if done.all():
                    break
                rows = rows[~done]
                direction, cop, force, twist, share, lower, plane, sure = (
                    v[..., ~done]
                    for v in (direction, cop, force, twist, share, lower, plane, sure)
                )
        return out, balanced

    def _change(self, last: Array, twist: Array) -> Array:
        """Relative change (m,) of twists."""
        step = np.abs((twist - last) * self._sizes).max(0)
        change: Array = step / np.linalg.norm(last * self._sizes, axis=0)
        return change

    def _settled(self, plane: Array, target: Array, parts: Sequence[float]) -> Array:
        """Pressures (3, m) after Newton steps, each damped by its factor in ``parts``."""
        for part in parts:
            plane = plane + part * (self._plane(plane, target) - plane)
        return plane

    def _plane(self, plane: Array, target: Array) -> Array:
        """Pressures (3, m) with the load and moments ``target``, on the area loaded by
        ``plane``.
        """
        touching = np.where(plane.T @ self._linear > 0.0, self._shares, 0.0)
        hessian = (touching @ self._moments).T
        hessian[[0, 3, 5]] += 1e-9
        return _solved(hessian, target)

    def _steps(
        self, loads: Array, twist: Array, force: Array, newton: bool
    ) -> tuple[Array, Array, Array]:
        """Ratio (m,) of the friction's power to the force's power, and the next twists
        (3, m), at which the force has unit power.

        The next twists are those of the ellipsoid and, if requested, those of Newton's
        method.
        """
        vx, vy, w = twist
        squares = (
            np.stack([vx * vx + vy * vy, 2.0 * w * vy, -2.0 * w * vx, w * w]).T
            @ self._basis
        )
        squares = np.maximum(squares, REST * REST)
        k = loads / np.sqrt(squares)
        power = (k * squares).sum(1) / (force * twist).sum(0)
        n, nx, ny, ns = self._basis @ k.T
        friction = np.stack([n, np.zeros_like(n), -ny, n, nx, ns])
        ellipsoid = _solved(friction, force)
        ellipsoid /= (force * ellipsoid).sum(0)
        if not newton:
            return power, ellipsoid, ellipsoid
        hessian = friction - self._lessened(k / squares, twist)
        hessian += power * force[THREE[0]] * force[THREE[1]]
        gradient = np.stack(
            [n * vx - ny * w, n * vy + nx * w, nx * vy - ny * vx + ns * w]
        )
        out = 2.0 * twist - _solved(hessian, gradient)
        out /= (force * out).sum(0)
        return power, ellipsoid, np.where(np.isfinite(out).all(0), out, ellipsoid)

    def _lessened(self, k: Array, twist: Array) -> Array:
        """Difference (6, m) between the Hessians of the ellipsoid and the friction.

        It is the sum of ``k`` q q^T, with the gradient q = (v_x - w y, v_y + w x, r x v
        + w radius^2) of |v|^2 / 2.
        """
        vx, vy, w = twist
        n1, mx, my, ms, xx, xy, xs, yy, ys, ss = (k @ self._squares).T
        return np.stack(
            [
                vx * (vx * n1 - 2.0 * w * my) + w * w * yy,
                vx * (vy * n1 + w * mx) - w * (vy * my + w * xy),
                vx * (vy * mx - vx * my + w * ms) - w * (vy * xy - vx * yy + w * ys),
                vy * (vy * n1 + 2.0 * w * mx) + w * w * xx,
                vy * (vy * mx - vx * my + w * ms) + w * (vy * xx - vx * xy + w * xs),
                vy * vy * xx
                + vx * vx * yy
                + w * w * ss
                - 2.0 * (vx * vy * xy - w * (vy * xs - vx * ys)),
            ]
        )


def _solved(matrix: Array, right: Array) -> Array:
    """Solutions (3, m) for symmetric matrices (6, m), with entries in the order of
    THREE.
    """
    a, b, c, d, e, f = matrix
    p, q, r = right
    A = d * f - e * e
    B = c * e - b * f
    C = b * e - c * d
    D = a * f - c * c
    E = b * c - a * e
    F = a * d - b * b
    solved: Array = np.stack(
        [A * p + B * q + C * r, B * p + D * q + E * r, C * p + E * q + F * r]
    )
    with np.errstate(divide="ignore", invalid="ignore"):  # a base without load: NaN
        solved /= a * A + b * B + c * C
    return solved
