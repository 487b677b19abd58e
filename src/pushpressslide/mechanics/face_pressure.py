"""Continuous pressure under a base with straight edges: linear on the polygon that
carries the load (docs/mechanics.md, sections 1.2 and 1.3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.geometry import quadrature
from pushpressslide.geometry.shapes import Shape
from pushpressslide.kernels.edge_friction import Plane

# Gauss points and weights of an edge from 0 to 1, exact to degree 7
NODES = 0.5 + 0.5 * np.array(
    [-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526]
)
_OUTER = 0.17392742256872693
_INNER = 0.32607257743127307
WEIGHTS = np.array([_OUTER, _INNER, _INNER, _OUTER])
# of sqrt(1 + z)
ROOT = (1.0, 1.0 / 2.0, -1.0 / 8.0, 1.0 / 16.0, -5.0 / 128.0, 7.0 / 256.0)
# turn rate times the reach over the speed, up to which the series is right to 1e-10
FAR = 0.02
# powers of z and of its conjugate in the terms of ``FacePressure.series``
TERMS = (
    (1, 1),
    (2, 0),
    (2, 1),
    (3, 0),
    (2, 2),
    (3, 1),
    (4, 0),
    (3, 2),
    (4, 1),
    (5, 0),
)


@dataclass(frozen=True, eq=False)
class FacePressure:
    """Linear pressure p + q . r on a polygon, with a total load of 1, about its centre
    of pressure.
    """

    corners: Array  # (n, 2) [m] counter-clockwise
    level: float  # [1/m^2] p, at the centre
    slope: Point  # [1/m^3] q

    @property
    def reach(self) -> float:
        """Distance [m] from the centre to the farthest corner."""
        return float(np.hypot(*self.corners.T).max())

    @property
    def rho(self) -> float:
        """Root mean square distance [m] of the load from its centre."""
        return math.sqrt(self._square)

    def variance(self, direction: Point) -> float:
        """Variance [m^2] of the load along a unit vector."""
        x, y = direction
        along = self._moment(2, 0) * complex(x, -y) ** 2
        return 0.5 * (self._square + along.real)

    def edges(self) -> Array:
        """The ``kernels.edge_friction.Edges`` (8, n) of the polygon."""
        steps = np.concatenate((self.corners[1:], self.corners[:1])) - self.corners
        lengths = np.hypot(*steps.T)
        real = lengths > 0.0
        x, y = self.corners[real].T
        tx, ty = steps[real].T / lengths[real]
        qx, qy = self.slope
        across = ty * qx - tx * qy
        along = tx * qx + ty * qy
        mx, my = (self.corners[real] + 0.5 * steps[real]).T
        middle = self.level + qx * mx + qy * my
        return np.stack([x, y, tx, ty, lengths[real], middle, across, along])

    def series(self) -> tuple[complex, ...]:
        """Coefficients of ``TERMS`` in the load-weighted mean of |1 + k z|, for a small
        complex k and z = x + i y.

        Each coefficient covers a term and its conjugate.
        """
        return tuple(
            (1.0 if i == j else 2.0) * ROOT[i] * ROOT[j] * self._moment(i, j)
            for i, j in TERMS
        )

    def plane(self) -> Plane:
        """The ``kernels.edge_friction.Plane`` of the pressure."""
        return (self.level, *self.slope, FAR / self.reach, self._square)

    def scaled(self, length: float) -> FacePressure:
        """The same pressure with ``length`` [m] as the unit of length."""
        qx, qy = self.slope
        cube = length**3
        return FacePressure(
            self.corners / length, self.level * length**2, (qx * cube, qy * cube)
        )

    @cached_property
    def _square(self) -> float:
        """Mean square distance [m^2] of the load from its centre."""
        return self._moment(1, 1).real

    def _moment(self, i: int, j: int) -> complex:
        """Load-weighted mean of z^i times its conjugate^j.

        The integral of a homogeneous function of degree n over a triangle with a corner
        at the origin follows from the integral along the opposite side.
        """
        z, areas, slopes = self._nodes
        degree = i + j + 2
        loads = areas * (self.level / degree + slopes / (degree + 1))
        return complex((loads * z**i * z.conj() ** j).sum())

    @cached_property
    def _nodes(self) -> tuple[NDArray[np.complex128], Array, Array]:
        """Gauss points along the edges as complex numbers, twice the areas of their
        triangles, and q . r at the points.
        """
        x, y = self.corners.T[:, :, None]
        to_x, to_y = np.concatenate((self.corners[1:], self.corners[:1])).T[:, :, None]
        turns = x * to_y - y * to_x
        x = x + NODES * (to_x - x)
        y = y + NODES * (to_y - y)
        qx, qy = self.slope
        return x + 1j * y, turns * WEIGHTS, qx * x + qy * y


def face_pressure(shape: Shape, center_of_mass: Point, cop: Point) -> FacePressure:
    """Pressure under a shape, with its centre at ``cop`` [m] in the body frame B.

    ``center_of_mass`` [m] is in the shape's frame G.
    ``mechanics.pressure.support_pressure`` gives samples of the same pressure. A round
    base is replaced by a polygon with 64 corners. Raises ValueError for a CoP outside
    the base's hull.
    """
    place = (cop[0] + center_of_mass[0], cop[1] + center_of_mass[1])
    polygon, a, b = quadrature.loaded_polygon(shape.base_corners, place)
    return of_polygon(polygon - np.array(place), a + float(b @ place), b.tolist())


def of_polygon(corners: Array, level: float, slope: Sequence[float]) -> FacePressure:
    """Pressure with a total load of 1, from its value and slope at the origin, the
    centre of pressure.
    """
    face = FacePressure(corners, level, (float(slope[0]), float(slope[1])))
    load = face._moment(0, 0).real
    return FacePressure(corners, level / load, (slope[0] / load, slope[1] / load))
