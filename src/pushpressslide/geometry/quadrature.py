"""Quadrature over polygons and discs, and the linear unilateral pressure with a given
centre.

A concave polygon is integrated over convex parts. The centre of pressure may be
anywhere inside the polygon's convex hull.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.geometry.pieces import convex_pieces
from pushpressslide.geometry.polygon import convex_hull, is_convex

ROUNDING = 1e-9  # of an area
DISC_CORNERS = 64  # corners of the polygon that represents a disc if a part of it lifts

# Symmetric six-point triangle rule, exact to degree 4 (Strang and Fix 1973):
# (barycentric coordinate, weight).
_RULE = ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))


def as_polygon(corners: Sequence[Point]) -> Array:
    """Corners as an array (n, 2).

    Raises ValueError unless they run counter-clockwise, once round each inner point.
    """
    polygon = np.array(corners, dtype=np.float64)
    if (
        polygon.ndim != 2
        or polygon.shape[1] != 2
        or len(polygon) < 3
        or not np.isfinite(polygon).all()
    ):
        raise ValueError(
            f"polygon of shape {polygon.shape}; need at least 3 finite corners (x, y)"
        )
    edges = _next_corners(polygon) - polygon
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    size = float(np.abs(edges).max())
    concave = size > 0.0 and turns.min() < -1e-12 * size**2
    if (
        size == 0.0
        or not moments(polygon)[0] > 1e-12 * size**2
        or (concave and not _covers_once(polygon))
    ):
        raise ValueError(
            "polygon must not cross itself, be counter-clockwise, and have an area"
        )
    return polygon


def _covers_once(polygon: Array) -> bool:
    """Whether a ring encloses each of its points once. It may touch itself, as at the
    bridges to an area's holes.
    """
    from shapely import Polygon, make_valid

    area = Polygon(polygon)
    if area.is_valid:
        return True
    covered = make_valid(area, method="structure").area
    return bool(abs(covered - moments(polygon)[0]) < ROUNDING * covered)


@lru_cache(maxsize=64)
def base(corners: tuple[Point, ...]) -> Array:
    """Cached ``as_polygon`` of an object's outline.

    Read-only.
    """
    polygon = as_polygon(corners)
    polygon.setflags(write=False)
    return polygon


@lru_cache(maxsize=64)
def base_rule(corners: tuple[Point, ...], resolution: int) -> tuple[Array, Array]:
    """Quadrature rule over an object's outline. Read-only."""
    points, areas = pieces_rule(convex_polygons(corners), resolution)
    points.setflags(write=False)
    areas.setflags(write=False)
    return points, areas


@lru_cache(maxsize=64)
def convex_polygons(corners: tuple[Point, ...]) -> tuple[Array, ...]:
    """Convex polygons that make up an object's outline.

    Raises ValueError as ``as_polygon`` does.
    """
    whole = base(corners)
    if is_convex(corners):
        return (whole,)
    return tuple(np.array(piece) for piece in convex_pieces(corners))


@lru_cache(maxsize=64)
def _hull(corners: tuple[Point, ...]) -> Array:
    """Convex hull of an object's outline, counter-clockwise."""
    if is_convex(corners):
        return base(corners)
    return np.array(convex_hull(corners))


@lru_cache(maxsize=64)
def _base_moments(corners: tuple[Point, ...]) -> tuple[float, Array, Array]:
    """Area, centroid (2,), and the inverse (2, 2) of the second moments about the
    centroid.
    """
    area, first, second = moments(base(corners))
    center = first / area
    inverse = np.linalg.inv(second - area * np.outer(center, center)).astype(np.float64)
    return area, center, inverse


def whole_pressure(
    corners: tuple[Point, ...], cop: Point
) -> tuple[float, Array] | None:
    """Coefficients (a, b) of ``linear_pressure`` if the pressure is positive on the
    whole outline, otherwise None.
    """
    area, center, inverse = _base_moments(corners)
    b: Array = inverse @ (np.array(cop) - center)
    a = 1.0 / area - float(b @ center)
    return (a, b) if a + (base(corners) @ b).min() >= 0.0 else None


def moments(polygon: Array) -> tuple[float, Array, Array]:
    """Exact area, first moments (2,) and second moments (2, 2) about the origin."""
    x, y = polygon.T
    to_x, to_y = _next_corners(polygon).T
    turn = x * to_y - to_x * y
    first = np.array([turn @ (x + to_x), turn @ (y + to_y)]) / 6.0
    xx = turn @ (x * x + x * to_x + to_x * to_x) / 12.0
    yy = turn @ (y * y + y * to_y + to_y * to_y) / 12.0
    xy = turn @ ((x + to_x) * (y + to_y) + x * y + to_x * to_y) / 24.0
    return float(turn.sum()) / 2.0, first, np.array([[xx, xy], [xy, yy]])


def _next_corners(polygon: Array) -> Array:
    """Successor of each corner, (n, 2)."""
    return np.concatenate((polygon[1:], polygon[:1]))


def clipped(polygon: Array, a: float, b: Array) -> Array:
    """Part of a polygon where a + b . r >= 0, as corners (m, 2).

    m is 0 if no part remains. Several parts of a concave polygon are joined by pairs of
    opposite edges along the line, so that ``moments`` stays correct.
    """
    heights = a + polygon @ b
    if heights.min() >= 0.0:
        return polygon
    values: list[float] = heights.tolist()
    points: list[Point] = polygon.tolist()
    corners: list[Point] = []
    for i, (x, y) in enumerate(points):
        j = (i + 1) % len(points)
        here, there = values[i], values[j]
        if here >= 0.0:
            corners.append((x, y))
        if (here >= 0.0) != (there >= 0.0):
            share = here / (here - there)
            to_x, to_y = points[j]
            corners.append((x + share * (to_x - x), y + share * (to_y - y)))
    return np.array(corners) if corners else np.zeros((0, 2))


def linear_pressure(
    polygon: Array, cop: Array, hull: Array | None = None
) -> tuple[float, Array]:
    """Coefficients (a, b) of the pressure max(0, a + b . r) with its centre at ``cop``
    (2,).

    The pressure's integral is one. ``hull`` is the convex hull of a concave polygon.
    Raises ValueError for a CoP on or outside the hull.
    """
    _check_inside(polygon if hull is None else hull, cop)
    area, first, _ = moments(polygon)
    center = first / area
    scale = math.sqrt(area)
    local = (polygon - center) / scale
    x = _least_energy(local, np.append(1.0, (cop - center) / scale))
    b = x[1:] / scale
    return float(x[0] - b @ center) / area, b / area


def _check_inside(polygon: Array, cop: Array) -> None:
    edges = _next_corners(polygon) - polygon
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    real = lengths > 0.0
    to_cop = cop - polygon
    turns = edges[:, 0] * to_cop[:, 1] - edges[:, 1] * to_cop[:, 0]
    inside = turns[real] / lengths[real]
    size = float(lengths.max())
    if not inside.min() > 1e-4 * size:
        raise ValueError(
            f"centre of pressure ({cop[0]:.4g}, {cop[1]:.4g}) m is {inside.min():.3g} "
            "m inside the outline "
            f"of the base; it must be at least {1e-4 * size:.2g} m inside"
        )


def _least_energy(polygon: Array, target: Array) -> Array:
    """Minimiser x = (a, b) (3,) of ``_energy``, by damped Newton steps."""
    x = np.array([1.0, 0.0, 0.0])
    value, gradient, hessian = _energy(polygon, target, x)
    for _ in range(100):
        if np.abs(gradient).max() < 1e-13:
            break
        step = np.linalg.solve(hessian + 1e-14 * np.eye(3), -gradient)
        t = 1.0
        slope = float(gradient @ step)
        while t > 1e-9:
            new_value, new_gradient, new_hessian = _energy(
                polygon, target, x + t * step
            )
            # Near the end the value is below its own round-off; there the gradient
            # decides.
            if (
                new_value <= value + 1e-4 * t * slope
                or np.abs(new_gradient).max() < 0.5 * np.abs(gradient).max()
            ):
                break
            t *= 0.5
        else:
            break
        x = x + t * step
        value = new_value
        gradient = new_gradient
        hessian = new_hessian
    return x


def _energy(polygon: Array, target: Array, x: Array) -> tuple[float, Array, Array]:
    """Convex function of x = (a, b), with its gradient (3,) and Hessian (3, 3).

    It is half the integral of max(0, a + b . r)^2, minus ``target`` . x. At its minimum
    the pressure has the load target[0] and the moments target[1:].
    """
    patch = clipped(polygon, float(x[0]), x[1:])
    hessian = np.zeros((3, 3))
    if len(patch) >= 3:
        hessian[0, 0], hessian[0, 1:], hessian[1:, 1:] = moments(patch)
        hessian[1:, 0] = hessian[0, 1:]
    integral = hessian @ x
    return float(0.5 * x @ integral - x @ target), integral - target, hessian


def polygon_rule(polygon: Array, resolution: float) -> tuple[Array, Array]:
    """Points (m, 2) and areas (m,) of a quadrature rule over a convex polygon, exact to
    degree 4.

    A fan of triangles about the centroid is cut into about 4 ``resolution``^2 equal
    parts, with six points in each.
    """
    area, first, _ = moments(polygon)
    center = first / area
    cuts = max(1, round(resolution * math.sqrt(4.0 / len(polygon))))
    local, share = _triangle_rule(cuts)
    to_p = polygon - center
    to_q = _next_corners(to_p)
    triangle = 0.5 * (to_p[:, 0] * to_q[:, 1] - to_p[:, 1] * to_q[:, 0])
    points = (
        center + local[None, :, :1] * to_p[:, None] + local[None, :, 1:] * to_q[:, None]
    )
    areas = triangle[:, None] * share[None, :]
    kept = areas.ravel() > 0.0
    return points.reshape(-1, 2)[kept], areas.ravel()[kept]


@lru_cache(maxsize=64)
def _triangle_rule(cuts: int) -> tuple[Array, Array]:
    """Points (m, 2) and area fractions (m,) of the rule over a triangle whose sides are
    divided into ``cuts`` equal parts.

    Points are given as fractions of the two sides that meet at the first corner.
    """
    rule = np.array(
        [(1 - 2 * g, g, g) for g, _ in _RULE] + [(g, 1 - 2 * g, g) for g, _ in _RULE]
    )
    rule = np.vstack([rule, [(g, g, 1 - 2 * g) for g, _ in _RULE]])
    weights = np.array([w for _, w in _RULE] * 3)
    parts = []
    for i in range(cuts):
        for j in range(cuts - i):
            parts.append(((i, j), (i + 1, j), (i, j + 1)))
            if i + j < cuts - 1:
                parts.append(((i + 1, j + 1), (i, j + 1), (i + 1, j)))
    local = (rule @ np.array(parts, dtype=np.float64) / cuts).reshape(-1, 2)
    return local, np.tile(weights / cuts**2, len(parts))


def pieces_rule(parts: Sequence[Array], resolution: int) -> tuple[Array, Array]:
    """Points (m, 2) and areas (m,) of a quadrature rule over several convex polygons.

    It is as fine as ``polygon_rule`` over one polygon of their total area.
    """
    if len(parts) == 1:
        return polygon_rule(parts[0], resolution)
    sizes = [moments(part)[0] for part in parts]
    whole = sum(sizes)
    rules = [
        polygon_rule(part, resolution * math.sqrt(size / whole))
        for part, size in zip(parts, sizes, strict=True)
        if size > 0.0
    ]
    points, areas = zip(*rules, strict=True)
    return np.concatenate(points), np.concatenate(areas)


def disc_rule(radius: float, resolution: int) -> tuple[Array, Array]:
    """Points (m, 2) and areas (m,) of a quadrature rule over a disc about the origin:
    Gauss points on rings.
    """
    rings = 2 * resolution
    spokes = 6 * resolution
    # Golub and Welsch (1969), without the import of NumPy's polynomials
    k = np.arange(1.0, rings)
    nodes, vectors = np.linalg.eigh(np.diag(k / np.sqrt(4.0 * k * k - 1.0), -1))
    weights = 2.0 * vectors[0] ** 2
    r = 0.5 * radius * (nodes + 1.0)
    angle = (np.arange(spokes)[None, :] + 0.5 * (np.arange(rings) % 2)[:, None]) * (
        2.0 * math.pi / spokes
    )
    points = np.stack([r[:, None] * np.cos(angle), r[:, None] * np.sin(angle)], axis=-1)
    areas = np.repeat(0.5 * radius * weights * r * (2.0 * math.pi / spokes), spokes)
    return points.reshape(-1, 2), areas


def polygon_pressure(
    corners: tuple[Point, ...], cop: Point, resolution: int
) -> tuple[Array, Array, Array]:
    """Points (m, 2), areas (m,) and linear unilateral pressures (m,), not normalised.

    Raises ValueError for a CoP outside the polygon's hull.
    """
    whole = whole_pressure(corners, cop)
    if whole is not None:
        points, areas = base_rule(corners, resolution)
        return points, areas, whole[0] + points @ whole[1]
    a, b = _lifting_pressure(corners, cop)
    loaded = [clipped(piece, a, b) for piece in convex_polygons(corners)]
    points, areas = pieces_rule([part for part in loaded if len(part) > 2], resolution)
    return points, areas, a + points @ b


def loaded_polygon(
    corners: tuple[Point, ...], cop: Point
) -> tuple[Array, float, Array]:
    """Loaded part of an outline, as corners (m, 2), and the coefficients (a, b) of its
    ``linear_pressure``.

    Several parts of a concave outline are joined as in ``clipped``. Raises ValueError
    for a CoP outside the outline's hull.
    """
    whole = whole_pressure(corners, cop)
    if whole is not None:
        return base(corners), *whole
    a, b = _lifting_pressure(corners, cop)
    return clipped(base(corners), a, b), a, b


def _lifting_pressure(corners: tuple[Point, ...], cop: Point) -> tuple[float, Array]:
    """Coefficients (a, b) of ``linear_pressure``, also if a part of the outline lifts."""
    place = np.array(cop, dtype=np.float64)
    return linear_pressure(base(corners), place, _hull(corners))


def disc_pressure(
    radius: float, cop: Point, resolution: int
) -> tuple[Array, Array, Array]:
    """Points (m, 2), areas (m,) and linear unilateral pressures (m,), not normalised.

    The disc is about the origin. For |cop| > radius / 4 a part of it lifts, and it is
    integrated as a polygon with the same second moment. Raises ValueError for a CoP
    outside the disc.
    """
    if math.hypot(cop[0], cop[1]) <= 0.25 * radius:
        points, areas = disc_rule(radius, resolution)
        return points, areas, 1.0 + points @ (4.0 / radius**2 * np.array(cop))
    return polygon_pressure(disc_corners(radius), cop, resolution)


@lru_cache(maxsize=64)
def disc_corners(radius: float) -> tuple[Point, ...]:
    """Corners [m] of a polygon about the origin with a disc's second moment."""
    step = 2.0 * math.pi / DISC_CORNERS
    # Second moment of a regular n-gon of circumradius R, over that of the disc: sin(s)
    # (2 + cos(s)) / (3 s).
    corner = radius * (math.sin(step) * (2.0 + math.cos(step)) / (3.0 * step)) ** -0.25
    return tuple(
        (corner * math.cos(i * step), corner * math.sin(i * step))
        for i in range(DISC_CORNERS)
    )
