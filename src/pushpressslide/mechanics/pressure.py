"""Pressure between object and support: total load, centre of pressure (CoP),
distributions as samples.

Source: docs/mechanics.md, section 1.2. All points are in one planar frame: the body
frame B, unless stated otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.geometry import quadrature
from pushpressslide.geometry.shapes import Shape

# Torsional radius of a square cell over the root of its area: keeps the cell's second
# moment, 1 / sqrt(12).
CELL_RADIUS = 1.0 / math.sqrt(12.0)


@dataclass(frozen=True, eq=False)
class PressureSamples:
    """A pressure distribution as n point loads.

    Three pins are ``PressureSamples(points, loads)`` directly. Raises ValueError for
    wrong shapes, negative or non-finite loads, or no load at all.
    """

    points: Array  # (n, 2) [m]
    loads: Array  # (n,) [N], >= 0
    radii: Array = field(
        default_factory=lambda: np.zeros(0)
    )  # (n,) [m] of the cell a sample stands for; 0: a pin

    def __post_init__(self) -> None:
        points = np.array(self.points, dtype=np.float64)
        loads = np.array(self.loads, dtype=np.float64)
        radii = np.array(self.radii, dtype=np.float64)
        if radii.size == 0:
            radii = np.zeros(len(loads))
        if (
            points.ndim != 2
            or points.shape[1] != 2
            or loads.shape != points.shape[:1]
            or radii.shape != loads.shape
        ):
            raise ValueError(
                f"points {points.shape}, loads {loads.shape}, radii {radii.shape}: "
                "need (n, 2), (n,) and (n,)"
            )
        finite = (
            np.isfinite(points).all()
            and np.isfinite(loads).all()
            and np.isfinite(radii).all()
        )
        if not finite or (loads < 0.0).any() or not loads.sum() > 0.0:
            raise ValueError(
                "points and loads must be finite, loads >= 0, and their sum > 0"
            )
        for name, value in (("points", points), ("loads", loads), ("radii", radii)):
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    @property
    def total_load(self) -> float:
        """Total normal load N [N]."""
        return float(self.loads.sum())

    @property
    def cop(self) -> Point:
        """Centre of pressure [m], in the frame of the points."""
        x, y = self.loads @ self.points / self.loads.sum()
        return (float(x), float(y))

    def scaled_to(self, load: float) -> PressureSamples:
        """The same distribution with another total ``load`` [N]."""
        return PressureSamples(
            self.points, self.loads * (load / self.total_load), self.radii
        )

    def translated(self, shift: Point) -> PressureSamples:
        """The distribution translated by ``shift`` [m]."""
        return PressureSamples(self.points + np.array(shift), self.loads, self.radii)


def total_load(own_load: float, normals: Sequence[float]) -> float:
    """Total load N = N_o + sum N_i [N]: the object's own load on the support plus the
    presses from above.
    """
    return own_load + sum(normals)


def center_of_pressure(
    own_load: float,
    own_point: Point,
    normals: Sequence[float] = (),
    points: Sequence[Point] = (),
    forces: Sequence[Point] = (),
    heights: Sequence[float] = (),
) -> Point:
    """Centre of pressure p_cop = (N_o p_o + sum N_i p_i + sum h_i F_i) / N [m]
    (docs/mechanics.md, 1.2).

    ``own_load`` [N] is the weight, which acts at ``own_point`` [m], the centre of mass;
    on a wall it is 0. Contacts press with ``normals`` [N] at ``points`` [m]. ``forces``
    [N] along the support act on the object at ``heights`` [m] above the support: those
    of pushes and presses, and on a wall also the weight, at the height of the centre of
    mass. Raises ValueError for unequal lengths or a load <= 0.
    """
    if len(normals) != len(points) or len(forces) != len(heights):
        raise ValueError(
            f"{len(normals)} normals, {len(points)} points, {len(forces)} forces, "
            f"{len(heights)} heights: "
            "one point per normal and one height per force"
        )
    load = total_load(own_load, normals)
    if not load > 0.0:
        raise ValueError(f"total load {load} N; must be > 0")
    x = own_load * own_point[0]
    y = own_load * own_point[1]
    for n, p in zip(normals, points, strict=True):
        x += n * p[0]
        y += n * p[1]
    for f, h in zip(forces, heights, strict=True):
        x += h * f[0]
        y += h * f[1]
    return (x / load, y / load)


def _cells(
    points: Array, areas: Array, pressures: Array, load: float
) -> PressureSamples:
    loads = areas * np.maximum(pressures, 0.0)
    return PressureSamples(
        points, loads * (load / loads.sum()), CELL_RADIUS * np.sqrt(areas)
    )


def polygon_pressure(
    polygon: Sequence[Point],
    load: float = 1.0,
    cop: Point | None = None,
    resolution: int = 12,
) -> PressureSamples:
    """Unilateral linear (Winkler) pressure on a simple ``polygon`` with a given CoP and
    total ``load`` [N].

    Corners [m] are counter-clockwise. The pressure is max(0, a + b . r). It is uniform
    if ``cop`` is None or the centroid, and linear over the whole face for a CoP near
    the centroid. For a CoP farther out, the opposite side lifts (docs/mechanics.md,
    1.2). There are about 24 ``resolution``^2 samples, which are exact for moments up to
    the third. Raises ValueError for a CoP outside the polygon's hull.
    """
    outline = tuple((float(x), float(y)) for x, y in polygon)
    if cop is None:
        points, areas = quadrature.base_rule(outline, resolution)
        return _cells(points, areas, np.ones(len(areas)), load)
    return _cells(*quadrature.polygon_pressure(outline, cop, resolution), load)


def rectangle_pressure(
    length: float,
    width: float,
    load: float = 1.0,
    cop: Point = (0.0, 0.0),
    resolution: int = 12,
) -> PressureSamples:
    """Winkler pressure of a rectangle of ``length`` x ``width`` [m] about the origin.

    The CoP is at ``cop`` [m]. For a CoP (x_c, 0) the far side lifts when |x_c| >
    length/6 (docs/mechanics.md, 1.2).
    """
    a = 0.5 * length
    b = 0.5 * width
    return polygon_pressure(((-a, -b), (a, -b), (a, b), (-a, b)), load, cop, resolution)


def disc_pressure(
    radius: float, load: float = 1.0, cop: Point = (0.0, 0.0), resolution: int = 12
) -> PressureSamples:
    """Winkler pressure of a disc of ``radius`` [m] about the origin, with its CoP at
    ``cop`` [m].

    The whole face is in contact for |cop| <= radius/4. For a CoP farther out, the disc
    is integrated as a 64-sided polygon with the same second moment. Raises ValueError
    for a CoP outside the disc.
    """
    if not radius > 0.0:
        raise ValueError(f"radius {radius} m; must be > 0")
    return _cells(*quadrature.disc_pressure(radius, cop, resolution), load)


def pin_pressure(
    points: Sequence[Point], cop: Point, load: float = 1.0
) -> PressureSamples:
    """Loads on three pins at ``points`` [m] whose centre of pressure is ``cop`` [m].

    Raises ValueError unless there are three pins that are not collinear, with the CoP
    inside their triangle.
    """
    if len(points) != 3:
        raise ValueError(f"{len(points)} pins; the loads are determined for exactly 3")
    system = np.vstack([np.array(points, dtype=np.float64).T, np.ones(3)])
    if abs(np.linalg.det(system)) < 1e-15:
        raise ValueError("the three pins are in one line; they must span a triangle")
    shares = np.linalg.solve(system, np.array([cop[0], cop[1], 1.0]))
    if shares.min() < -1e-12:
        raise ValueError(
            f"centre of pressure {cop} is outside the triangle of the pins"
        )
    return PressureSamples(
        np.array(points, dtype=np.float64), load * np.maximum(shares, 0.0)
    )


def support_pressure(
    shape: Shape,
    load: float = 1.0,
    center_of_mass: Point = (0.0, 0.0),
    cop: Point = (0.0, 0.0),
    resolution: int = 12,
) -> PressureSamples:
    """Pressure under a shape, as samples in the body frame B (origin: the projected
    CoM).

    ``center_of_mass`` [m] is in the shape's frame G (``ObjectModel.center_of_mass``).
    ``cop`` [m] is in B: (0, 0) for an object at rest, and shifted by presses and by
    pushes at a height. The distribution is unilateral and linear, with the total
    ``load`` [N]. It is uniform if the CoP is the centroid of the base. Raises
    ValueError for a CoP outside the base's hull.
    """
    cop_G = (cop[0] + center_of_mass[0], cop[1] + center_of_mass[1])
    samples_G = _cells(*shape.pressure(cop_G, resolution), load)
    return samples_G.translated((-center_of_mass[0], -center_of_mass[1]))
