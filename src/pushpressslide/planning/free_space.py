"""Shortest collision-free path of a footprint among polygons, with rotation, on a grid
over position and yaw.

At a given yaw a footprint touches a polygon if the origin of its frame lies in the
Minkowski sum of the polygon and the mirrored footprint. The result is not a path of a
reduced model, but it shows where such paths may lead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.footprint import gaps
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.geometry.shapes import Shape

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry

YAWS = 24
CELLS = 60  # along the longer side of the bounds, at most
FINEST = 0.01  # [m]
NEAR = 3.0  # clearances, within which a way costs more
NEAR_COST = 2.0  # factor on the cost near obstacles
ALIKE = 0.01  # [m]
TURNED_ALIKE = 0.05  # [rad]
REACH = 4.0  # cells from an end, within which its way meets the grid
STEP = 0.5  # spacing of the checked points of a straight path, in clearances
# to the neighbours of a cell: along x, y and yaw
MOVES = ((1, 0, 0), (0, 1, 0), (1, 1, 0), (1, -1, 0), (0, 0, 1))

Bounds = tuple[float, float, float, float]


@dataclass(frozen=True)
class FreeSpace:
    """Free poses of a footprint: at least ``clearance`` [m] away from all polygons,
    with its frame within ``bounds`` [m].

    The bounds are x_min, x_max, y_min, y_max. The point ``center`` [m] of the
    footprint, in G, stays in a region of W.
    """

    shape: Shape
    others: tuple[Polygon, ...]
    clearance: float
    bounds: Bounds
    region: BaseGeometry | None = None  # None: anywhere
    center: Point = (0.0, 0.0)

    @property
    def convex(self) -> bool:
        """Whether every straight path between free poses is free."""
        region = self.region
        if self.others or region is None:
            return not self.others
        return math.isclose(region.area, region.convex_hull.area, rel_tol=1e-9)

    def straight(self, start: Pose2, goal: Pose2) -> bool:
        """Whether the straight path with even rotation between two poses is free. The
        end poses are not checked.
        """
        turn = math.remainder(goal.yaw - start.yaw, 2.0 * math.pi)
        far = math.dist(start.position, goal.position)
        far += abs(turn) * self.shape.circumradius
        steps = max(2, math.ceil(far / (STEP * self.clearance)))
        poses = [between(start, goal, i / steps) for i in range(1, steps)]
        return bool(self.free(poses).all())

    def free(self, poses: Sequence[Pose2]) -> NDArray[np.bool_]:
        """Whether each of n poses X_WG is free, (n,)."""
        import shapely

        on = np.full(len(poses), True)
        if self.region is not None:
            centers = np.array([X.apply(self.center) for X in poses])
            on = shapely.contains_xy(self.region, centers)
        if not self.others:
            return on
        distances = gaps(self.shape, poses, self.others).min(1)
        return np.asarray(on & (distances >= self.clearance))

    def paths_to(self, goal: Pose2) -> PathsTo:
        """Paths to a pose X_WG. This pose may be nearer to a polygon than the
        clearance.
        """
        return PathsTo(self, goal)


class PathsTo:
    """Shortest free paths of a footprint to one pose, from any start."""

    def __init__(self, space: FreeSpace, goal: Pose2) -> None:
        """Search a grid from ``goal``, X_WG, unless every straight path is free."""
        self.space = space
        self.goal = goal
        self._grid = None if space.convex else _Grid(space, goal)

    def lengths(self, poses: Sequence[Pose2]) -> Array:
        """Lengths (n,) [m] of the paths from poses X_WG, including turns and a penalty
        for narrow passages. Infinite if there is no path.
        """
        if self._grid is None:
            return lengths_from(self.space.shape, self.goal, poses)
        return np.array([self._grid.length(X) for X in poses])

    def via_poses(self, start: Pose2) -> list[Pose2] | None:
        """Collision-free via poses X_WG from ``start`` to the goal, shortened greedily.
        None if the grid has no path.
        """
        if self._grid is None or self.space.straight(start, self.goal):
            return [start, self.goal]
        cells = self._grid.via_poses(start)
        if cells is None:
            return None
        return _shortened(self.space, [start, *cells, self.goal])


def displacement(shape: Shape, X: Pose2, Y: Pose2) -> float:
    """Displacement [m] of a footprint from one pose to another, including its rotation."""
    turn = abs(math.remainder(Y.yaw - X.yaw, 2.0 * math.pi))
    return math.dist(X.position, Y.position) + shape.circumradius * turn


def lengths_from(shape: Shape, X: Pose2, poses: Sequence[Pose2]) -> Array:
    """Displacements (n,) [m] of a footprint from one pose to others."""
    x, y, yaw = np.array([(Y.x, Y.y, Y.yaw) for Y in poses]).T
    turn = np.remainder(yaw - X.yaw + math.pi, 2.0 * math.pi) - math.pi
    out: Array = np.hypot(x - X.x, y - X.y) + shape.circumradius * np.abs(turn)
    return out


def same_pose(X: Pose2, Y: Pose2) -> bool:
    """Whether two poses count as the same pose of a path."""
    turn = math.remainder(Y.yaw - X.yaw, 2.0 * math.pi)
    return math.dist(X.position, Y.position) < ALIKE and abs(turn) < TURNED_ALIKE


def between(a: Pose2, b: Pose2, share: float) -> Pose2:
    """Pose at the fraction ``share`` of the straight path from ``a`` to ``b``. It turns
    the shorter way.
    """
    turn = math.remainder(b.yaw - a.yaw, 2.0 * math.pi)
    x = a.x + share * (b.x - a.x)
    y = a.y + share * (b.y - a.y)
    return Pose2(x, y, a.yaw + share * turn)


def _shortened(space: FreeSpace, poses: Sequence[Pose2]) -> list[Pose2]:
    """The poses without those that a straight path can skip."""
    out = [poses[0]]
    i = 0
    while i < len(poses) - 1:
        j = len(poses) - 1
        while j > i + 1 and not space.straight(poses[i], poses[j]):
            j -= max(1, (j - i) // 4)
        i = max(j, i + 1)
        out.append(poses[i])
    return out


class _Grid:
    """Cells (yaw, x, y) of a free space."""

    def __init__(self, space: FreeSpace, goal: Pose2) -> None:
        """Test every cell, and find the paths of all cells to ``goal``."""
        from scipy.sparse.csgraph import dijkstra

        x_min, x_max, y_min, y_max = space.bounds
        self.size = max(FINEST, max(x_max - x_min, y_max - y_min) / CELLS)
        self.xs = np.arange(x_min, x_max + 0.5 * self.size, self.size)
        self.ys = np.arange(y_min, y_max + 0.5 * self.size, self.size)
        self.radius = space.shape.circumradius
        self.free = _clear(space, self.xs, self.ys, space.clearance)
        self.ample = _clear(space, self.xs, self.ys, NEAR * space.clearance)
        near, far = self._near(goal)
        self._costs = np.full(self.free.size, math.inf)
        self._next = np.full(self.free.size, -1)
        if len(near) == 0:
            return
        self._last = int(near[np.argmin(far)])
        self._costs, self._next = dijkstra(
            self._graph(), directed=False, indices=self._last, return_predecessors=True
        )

    def length(self, start: Pose2) -> float:
        """Length [m] of the path from a pose. Infinite if there is none."""
        return self._first(start)[1]

    def via_poses(self, start: Pose2) -> list[Pose2] | None:
        """Poses of the free cells on the path from near ``start`` to near the goal.
        None without a path.
        """
        cell, length = self._first(start)
        if not math.isfinite(length):
            return None
        cells = [cell]
        while cells[-1] != self._last:
            cells.append(int(self._next[cells[-1]]))
        return [self._pose(cell) for cell in cells]

    def _first(self, start: Pose2) -> tuple[int, float]:
        """First cell of the path from a pose, and the path's length [m]."""
        near, far = self._near(start)
        if len(near) == 0:
            return -1, math.inf
        whole = self._costs[near] + NEAR_COST * far
        best = int(np.argmin(whole))
        return int(near[best]), float(whole[best])

    def _graph(self) -> object:
        """Sparse matrix of the costs [m] between neighbouring free cells."""
        from scipy.sparse import coo_array

        count = self.free.size
        numbers = np.arange(count).reshape(self.free.shape)
        rows: list[NDArray[np.intp]] = []
        columns: list[NDArray[np.intp]] = []
        costs: list[Array] = []
        for dx, dy, turn in MOVES:
            here, there = _pair(self.free.shape, dx, dy)
            after = np.roll(numbers, -turn, axis=0)[there]
            both = self.free[here] & np.roll(self.free, -turn, axis=0)[there]
            ample = self.ample[here] & np.roll(self.ample, -turn, axis=0)[there]
            length = math.hypot(dx, dy) * self.size
            length += turn * 2.0 * math.pi / YAWS * self.radius
            rows.append(numbers[here][both])
            columns.append(after[both])
            costs.append(np.where(ample, length, NEAR_COST * length)[both])
        where = (np.concatenate(rows), np.concatenate(columns))
        return coo_array((np.concatenate(costs), where), shape=(count, count)).tocsr()

    def _near(self, pose: Pose2) -> tuple[NDArray[np.intp], Array]:
        """Free cells near a pose, and their distances [m] from it."""
        reach = REACH * self.size
        i = np.flatnonzero(np.abs(self.xs - pose.x) <= reach)
        j = np.flatnonzero(np.abs(self.ys - pose.y) <= reach)
        middle = round(pose.yaw * YAWS / (2.0 * math.pi))
        k = np.arange(middle - 1, middle + 2) % YAWS
        yaw, x, y = (v.ravel() for v in np.meshgrid(k, i, j, indexing="ij"))
        free = self.free[yaw, x, y]
        yaw, x, y = yaw[free], x[free], y[free]
        turn = yaw * (2.0 * math.pi / YAWS) - pose.yaw
        turn = np.remainder(turn + math.pi, 2.0 * math.pi) - math.pi
        far = np.hypot(self.xs[x] - pose.x, self.ys[y] - pose.y)
        far += self.radius * np.abs(turn)
        return np.ravel_multi_index((yaw, x, y), self.free.shape), far

    def _pose(self, cell: int) -> Pose2:
        yaw, x, y = np.unravel_index(cell, self.free.shape)
        turn = float(yaw) * 2.0 * math.pi / YAWS
        return Pose2(float(self.xs[x]), float(self.ys[y]), turn)


def _pair(
    shape: tuple[int, ...], dx: int, dy: int
) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Slices of the cells that have a neighbour at offset (dx, dy), and of these
    neighbours.
    """
    _, nx, ny = shape
    low = max(-dy, 0)
    high = ny - max(dy, 0)
    here = (slice(None), slice(0, nx - dx), slice(low, high))
    there = (slice(None), slice(dx, nx), slice(low + dy, high + dy))
    return here, there


def _clear(
    space: FreeSpace, xs: Array, ys: Array, clearance: float
) -> NDArray[np.bool_]:
    """Mask (YAWS, len(xs), len(ys)) of the positions in the region, at each yaw, that
    are at least ``clearance`` [m] away from all polygons.
    """
    import shapely

    grid_x, grid_y = np.meshgrid(xs, ys, indexing="ij")
    out = np.full((YAWS, len(xs), len(ys)), True)
    if space.region is not None:
        shapely.prepare(space.region)
    parts = convex_parts(space.shape.placed(Pose2()))
    others = [part for other in space.others for part in convex_parts(other)]
    for k in range(YAWS):
        turn = np.exp(2j * math.pi * k / YAWS)
        if space.region is not None:
            center = turn * complex(*space.center)
            x = grid_x + center.real
            out[k] &= shapely.contains_xy(space.region, x, grid_y + center.imag)
        for part, other in product(parts, others):
            grown = _sum(other, -turn * part).buffer(clearance)
            shapely.prepare(grown)
            out[k] &= ~shapely.contains_xy(grown, grid_x, grid_y)
    return out


def _sum(one: NDArray[np.complex128], other: NDArray[np.complex128]) -> BaseGeometry:
    """Minkowski sum of two convex polygons, given by corners x + iy [m]."""
    import shapely

    sums = (one[:, None] + other[None]).ravel()
    points = np.stack([sums.real, sums.imag], axis=-1)
    out: BaseGeometry = shapely.MultiPoint(points).convex_hull
    return out


def convex_parts(polygon: Polygon) -> list[NDArray[np.complex128]]:
    """Convex polygons that make up a simple polygon, as corners x + iy [m]."""
    import shapely

    parts: list[BaseGeometry] = [polygon]
    if not math.isclose(polygon.area, polygon.convex_hull.area, rel_tol=1e-9):
        parts = list(shapely.constrained_delaunay_triangles(polygon).geoms)
    return [shapely.get_coordinates(part).view(np.complex128)[:-1, 0] for part in parts]
