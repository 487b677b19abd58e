"""The area of a level face, however its triangles were made."""

import numpy as np
import pytest
import shapely
from shapely import affinity

from pushpressslide.taskfile.mesh_face import covered

GRID = 1e-7


def star(seed: int) -> shapely.Polygon:
    """A concave polygon about the origin."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 12))
    angles = 2.0 * np.pi * (np.arange(count) + rng.uniform(0.0, 0.8, count)) / count
    radii = rng.uniform(0.02, 0.1, count)
    return shapely.Polygon(
        np.stack((radii * np.cos(angles), radii * np.sin(angles)), axis=1)
    )


def fan(polygon: shapely.Polygon, first: int) -> np.ndarray:
    """Triangles from one corner to all others, inside or not."""
    corners = np.roll(shapely.get_coordinates(polygon)[:-1], -first, axis=0)
    return np.array(
        [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    )


@pytest.mark.parametrize("seed", range(20))
def test_a_fan_from_any_corner_covers_its_polygon(seed: int) -> None:
    polygon = star(seed)
    for first in range(len(polygon.exterior.coords) - 1):
        area = covered(fan(polygon, first), GRID)
        assert shapely.area(area ^ polygon) < 1e-6


@pytest.mark.parametrize("seed", range(20))
def test_faces_that_overlap_cover_their_union(seed: int) -> None:
    """The oracle is shapely's union of the polygons."""
    one = star(seed)
    other = affinity.translate(star(seed + 100), 0.03, 0.01)
    triangles = np.concatenate((fan(one, 1), fan(other, 2)))
    assert shapely.area(covered(triangles, GRID) ^ (one | other)) < 1e-6


def test_nothing_covers_nothing() -> None:
    assert covered(np.empty((0, 3, 2)), GRID).is_empty


def test_a_clockwise_face_covers_nothing() -> None:
    assert covered(fan(star(0), 0)[:, ::-1], GRID).is_empty


def test_a_border_of_too_many_edges_is_refused() -> None:
    corners = np.random.default_rng(0).uniform(0.0, 1.0, (7000, 3, 2))
    with pytest.raises(ValueError, match="allowed up to 20000"):
        covered(corners, GRID)
