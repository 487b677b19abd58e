"""Paths of the free pusher around the T."""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from functools import cache, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.tee import CORNERS, PUSHER_RADIUS, WORLD

if TYPE_CHECKING:
    from shapely import Polygon

MARGIN = 6.0  # [px] between pusher and T on a way
INSIDE = 0.01  # [px] by which a way may enter the grown T: rounding


@cache
def _grown() -> Polygon:
    """The T in B, enlarged by the pusher's radius and the margin, with two chords per
    corner.
    """
    from shapely import Polygon

    return Polygon(CORNERS).buffer(PUSHER_RADIUS + MARGIN, quad_segs=2)


@cache
def _blocked() -> Polygon:
    """Region that a path must avoid, in B."""
    from shapely import prepare

    area = _grown().buffer(-INSIDE, join_style="mitre")
    prepare(area)
    return area


@cache
def _nodes() -> tuple[Point, ...]:
    """Positions [px] in B at which a path may turn."""
    return tuple((x, y) for x, y in _grown().exterior.coords[:-1])


def nearest_free(point: Point) -> Point:
    """Nearest free position [px] in B outside the enlarged T."""
    from shapely import Point as Place
    from shapely.ops import nearest_points

    place = Place(point)
    if not _blocked().contains(place):
        return point
    free, _ = nearest_points(_grown().exterior, place)
    return (free.x, free.y)


def free_space(X_WB: Pose2, start: Point, goal: Point) -> tuple[Point, ...]:
    """Shortest path [px] in W around the T at a pose, without ``start`` itself. Empty
    if there is no path.

    If the start is too near to the T, the path begins at the nearest free position; the
    goal is treated likewise. The path turns only at positions to which the pusher can
    be sent.
    """
    first = X_WB.unapply(start)
    end = X_WB.unapply(goal)
    turns = [node for node in _nodes() if reachable(X_WB.apply(node))]
    places = [nearest_free(first), nearest_free(end), *turns]
    path = _shortest(places)
    if not path:
        return ()
    if math.dist(places[0], first) == 0.0:
        path = path[1:]
    if math.dist(places[1], end) > 0.0:
        path = [*path, end]
    return tuple(X_WB.apply(place) for place in path)


def reachable(point: Point) -> bool:
    """Whether the pusher can be sent to a position [px] in W."""
    return 0.0 <= point[0] <= WORLD and 0.0 <= point[1] <= WORLD


@lru_cache(maxsize=4096)
def _sees(a: Point, b: Point) -> bool:
    """Whether the straight path between two positions in B is free."""
    from shapely import LineString

    return not _blocked().intersects(LineString([a, b]))


def _shortest(places: Sequence[Point]) -> list[Point]:
    """Shortest path from the first position to the second (Dijkstra)."""
    best = {0: 0.0}
    before: dict[int, int] = {}
    queue = [(0.0, 0)]
    while queue:
        length, here = heapq.heappop(queue)
        if here == 1:
            break
        if length > best[here]:
            continue
        for there in range(1, len(places)):
            further = length + math.dist(places[here], places[there])
            if there == here or further >= best.get(there, math.inf):
                continue
            if _sees(places[here], places[there]):
                best[there] = further
                before[there] = here
                heapq.heappush(queue, (further, there))
    if 1 not in before:
        return []
    path = [1]
    while path[-1] in before:
        path.append(before[path[-1]])
    return [places[index] for index in reversed(path)]


def way_length(X_WB: Pose2, start: Point, goal: Point) -> float:
    """Length [px] of the path from ``free_space``. Infinite without a path."""
    path = free_space(X_WB, start, goal)
    if not path:
        return math.inf
    ends = (start, *path)
    return sum(math.dist(a, b) for a, b in pairwise(ends))
