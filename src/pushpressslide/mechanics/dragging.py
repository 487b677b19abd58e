"""How an object slides that is dragged by one force at a height: exact, many forces at a time.

Under the pressure that the drag itself moves (docs/mechanics.md, sections 1 and 1.2): unilateral and linear
over the base, with its centre at cop + h F / N. All in the body frame B.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.task import Cylinder, ObjectModel
from pushpressslide.mechanics import quadrature
from pushpressslide.mechanics.pressure import CELL_RADIUS

Array = NDArray[np.float64]

RESOLUTION = 3  # of the base: twists are right to about a percent
STEPS = 15  # of the iteration for pressure and twist together
DAMPED = (1.0, 0.5, 0.5, 0.5, 0.7)  # shares of the first Newton steps for the pressure
BALANCED = 0.01  # of the load and of its moment: pressures farther off are not used
REST = 1e-9  # [m/s] below which a cell counts as resting, of twists of about 1 m/s


@dataclass(frozen=True, slots=True)
class Dragged:
    """What m forces do, each of the size that slides the object."""

    twists: Array  # (m, 3) of B's origin, about 1 m/s in size: only their direction counts
    shares: Array  # (m,) the force's size over mu N


class DraggedBase:
    """The base of one object."""

    def __init__(self, body: ObjectModel, shift: float) -> None:
        """Prepare the base; ``shift`` h mu_s [m]: how far a drag of mu_s N moves the centre of pressure."""
        if isinstance(body.shape, Cylinder):
            points, areas = quadrature.disc_rule(body.shape.radius, RESOLUTION)
        else:
            points, areas = quadrature.polygon_rule(quadrature.as_polygon(body.shape.footprint), RESOLUTION)
        x, y = (points - np.array(body.center_of_mass)).T
        self._shift, self._size = shift, math.sqrt(float((x * x + y * y).max()))
        self._shares = areas / areas.sum()
        self._linear = np.column_stack([np.ones_like(x), x / self._size, y / self._size])
        self._moments = (self._linear[:, :, None] * self._linear[:, None, :]).reshape(-1, 9)
        # |v_k|^2 is linear in these four: v^2 + 2 w (v_y x - v_x y) + w^2 (x^2 + y^2 + radius^2)
        self._basis = np.column_stack([np.ones_like(x), x, y, x * x + y * y + CELL_RADIUS**2 * areas])

    def slide(self, cops: Array, contacts: Array, directions: Array) -> Dragged:
        """Return the motion under forces along ``directions`` (m, 2), unit vectors, at ``contacts`` (m, 2).

        ``cops`` (m, 2) [m] without drag; the moved ones must be inside the base. Newton steps for the
        pressure, and for the twist the ellipsoid that has the friction of the last one: the friction's power
        falls with every step.
        """
        m = len(directions)
        moments = contacts[:, 0] * directions[:, 1] - contacts[:, 1] * directions[:, 0]
        wrenches = np.column_stack([directions, moments])
        shares, twists = np.ones(m), np.column_stack([directions, np.full(m, 1e-6)])
        planes, slope = np.tile([1.0, 0.0, 0.0], (m, 1)), np.zeros((m, 3, 3))
        for step in range(STEPS):
            moved = cops + self._shift * shares[:, None] * directions
            target = np.column_stack([np.ones(m), moved / self._size])[:, :, None]
            for part in (1.0,) if step else DAMPED:
                touching = np.where(planes @ self._linear.T > 0.0, self._shares, 0.0)
                hessian = (touching @ self._moments).reshape(m, 3, 3) + 1e-9 * np.eye(3)
                planes = planes + part * (np.linalg.solve(hessian, target)[:, :, 0] - planes)
            loads = np.maximum(planes @ self._linear.T, 0.0) * self._shares
            k0, kx, ky, ks = ((loads / np.maximum(self._speeds(twists), REST)) @ self._basis).T
            slope[:, 0, 0] = slope[:, 1, 1] = k0
            slope[:, 0, 2] = slope[:, 2, 0] = -ky
            slope[:, 1, 2] = slope[:, 2, 1] = kx
            slope[:, 2, 2] = ks
            twists = np.asarray(np.linalg.solve(slope, wrenches[:, :, None])[:, :, 0], dtype=np.float64)
            twists /= np.sqrt((twists * twists) @ np.array([1.0, 1.0, self._size**2]))[:, None]
            shares = np.clip((loads * self._speeds(twists)).sum(1) / (wrenches * twists).sum(1), 0.0, 1.0)
        off = np.abs(loads @ self._linear - target[:, :, 0]).max(1)
        twists[off > BALANCED] = np.nan
        return Dragged(twists, shares)

    def _speeds(self, twists: Array) -> Array:
        """Return the cells' speeds (m, n)."""
        vx, vy, w = twists.T
        squares = np.column_stack([vx * vx + vy * vy, 2.0 * w * vy, -2.0 * w * vx, w * w]) @ self._basis.T
        root: Array = np.sqrt(np.maximum(squares, 0.0))
        return root
