"""Free paths of a footprint among polygons."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from pushpressslide.core.footprint import gaps
from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.shapes import Box, Cylinder, Prism
from pushpressslide.planning.free_space import (
    FreeSpace,
    between,
    convex_parts,
    displacement,
)

BAR = Box((0.2, 0.1, 0.05))
CLEARANCE = 0.01
REGION = (0.2, 0.9, -0.4, 0.4)
START = Pose2(0.35, 0.0, 0.0)
GOAL = Pose2(0.75, 0.0, math.pi)
POST = Box((0.1, 0.1, 0.1)).placed(Pose2(0.55, 0.0, 0.3))


def space(*others: object, shape: object = BAR) -> FreeSpace:
    return FreeSpace(shape, tuple(others), CLEARANCE, REGION)  # type: ignore[arg-type]


def test_a_straight_way_is_taken_where_it_is_free() -> None:
    assert space().paths_to(GOAL).via_poses(START) == [START, GOAL]


@pytest.mark.parametrize("shape", [BAR, Cylinder(0.06, 0.1)])
def test_every_pose_of_a_way_round_a_post_keeps_its_clearance(shape: object) -> None:
    way = space(POST, shape=shape).paths_to(GOAL).via_poses(START)
    assert way is not None
    assert len(way) > 2
    poses = [
        between(a, b, share)
        for a, b in pairwise(way)
        for share in np.linspace(0, 1, 60)
    ]
    least = gaps(shape, poses, [POST]).min()  # type: ignore[arg-type]
    assert least >= CLEARANCE - 1e-3  # half a step between the places that were asked


def test_a_way_leads_into_the_notch_of_a_concave_polygon() -> None:
    """The goal is inside the hull of a U that opens to the left."""
    walls = ((0.7, -0.2), (0.9, -0.2), (0.9, 0.2), (0.5, 0.2), (0.5, 0.15))
    walls = (*walls, (0.85, 0.15), (0.85, -0.15), (0.5, -0.15), (0.5, -0.2))
    fork = Prism(walls, 0.1).placed(Pose2())
    way = space(fork).paths_to(Pose2(0.72, 0.0, 0.0)).via_poses(Pose2(0.3, 0.1, 0.4))
    assert way is not None
    assert gaps(BAR, way, [fork]).min() >= CLEARANCE


def test_the_centre_of_a_footprint_stays_in_its_region_all_the_way() -> None:
    """The region is an L; the centre is off the frame's origin."""
    low = shapely.box(0.2, -0.4, 0.9, -0.2)
    region = low.union(shapely.box(0.2, -0.4, 0.4, 0.4))
    off = (0.03, 0.02)
    free = FreeSpace(BAR, (), CLEARANCE, REGION, region, off)
    way = free.paths_to(Pose2(0.8, -0.3, 1.0)).via_poses(Pose2(0.3, 0.3, 0.0))
    assert way is not None
    assert len(way) > 2
    for a, b in pairwise(way):
        steps = [between(a, b, share) for share in np.linspace(0, 1, 20)]
        centers = shapely.points([X.apply(off) for X in steps])
        # half a step between the places that were asked, at a corner
        assert shapely.distance(region, centers).max() < 0.5 * CLEARANCE


def test_in_a_convex_region_the_straight_way_is_taken() -> None:
    region = shapely.box(0.2, -0.4, 0.9, 0.4)
    free = FreeSpace(BAR, (), CLEARANCE, REGION, region)
    assert free.paths_to(GOAL).via_poses(START) == [START, GOAL]
    assert free.free([START, Pose2(0.91, 0.0)]).tolist() == [True, False]


def test_there_is_no_way_through_a_wall_that_reaches_from_edge_to_edge() -> None:
    wall = Box((0.05, 2.0, 0.1)).placed(Pose2(0.55, 0.0, 0.0))
    ways = space(wall).paths_to(GOAL)
    assert ways.via_poses(START) is None
    assert ways.lengths([START]).tolist() == [math.inf]


def test_a_gap_that_only_the_bars_short_side_fits_is_passed_with_that_side() -> None:
    gap = 0.1 + 2.0 * CLEARANCE + 0.03
    upper = Box((0.05, 1.0, 0.1)).placed(Pose2(0.55, 0.5 + 0.5 * gap, 0.0))
    lower = Box((0.05, 1.0, 0.1)).placed(Pose2(0.55, -0.5 - 0.5 * gap, 0.0))
    turned = Pose2(0.35, 0.0, 0.5 * math.pi)
    way = (
        space(upper, lower).paths_to(Pose2(0.75, 0.0, 0.5 * math.pi)).via_poses(turned)
    )
    assert way is not None
    inside = [X for X in way if abs(X.x - 0.55) < 0.1]
    sizes = [abs(math.remainder(X.yaw, math.pi)) for X in inside]
    assert max(sizes, default=0.0) < math.radians(20.0)


def test_ways_are_as_long_as_straight_ones_or_longer() -> None:
    ways = space(POST).paths_to(GOAL)
    far = [Pose2(0.35, 0.3, 1.0), Pose2(0.4, -0.3, -2.0), START]
    lengths = ways.lengths(far)
    direct = [displacement(BAR, X, GOAL) for X in far]
    cells = 2.0 * (
        0.7 / 60.0 + 0.11 * math.pi / 24.0
    )  # both ends meet the grid so near
    assert (lengths >= np.array(direct) - cells).all()


def test_convex_parts_of_a_tee_have_its_area() -> None:
    from shapely import Polygon

    tee = Polygon(
        [(-6, 0), (-1.5, 0), (-1.5, -9), (1.5, -9), (1.5, 0), (6, 0), (6, 3), (-6, 3)]
    )
    parts = [
        Polygon(np.stack([part.real, part.imag], axis=-1)) for part in convex_parts(tee)
    ]
    assert sum(part.area for part in parts) == pytest.approx(tee.area)
    assert all(part.convex_hull.area == pytest.approx(part.area) for part in parts)
