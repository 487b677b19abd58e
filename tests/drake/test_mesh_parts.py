"""The convex shapes of a body, from which distances to arms are measured."""

from collections.abc import Callable

import numpy as np
import pytest

from pushpressslide.geometry import mesh_parts
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.mesh_parts import MOST_PARTS, STEP
from pushpressslide.sim.mesh_shapes import convex_parts
from pushpressslide.taskfile.mesh_file import surface_of


def outside(body: MeshBody, points: np.ndarray) -> float:
    """Return the largest distance [m] of points from the nearest convex part."""
    from scipy.spatial import ConvexHull

    depths = []
    for part in convex_parts(body):
        hull = part.GetConvexHull()
        corners = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
        planes = ConvexHull(corners).equations
        depths.append((points @ planes[:, :3].T + planes[:, 3]).max(axis=1))
    return float(np.min(depths, axis=0).max())


@pytest.mark.parametrize("most", [MOST_PARTS, 20])
@pytest.mark.parametrize("name", ["chamfered", "ring", "stool", "mug", "bowl"])
def test_few_convex_parts_cover_a_body(
    name: str,
    most: int,
    standing: Callable[[str], MeshBody],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(mesh_parts, "MOST_PARTS", most)
    convex_parts.cache_clear()
    mesh_parts.few_convex_corners.cache_clear()
    body = standing(name)
    points = np.asarray(surface_of(body).vertices, dtype=float)
    points[:, 2] -= points[:, 2].min() + 0.5 * body.height
    assert len(convex_parts(body)) <= most or body.pressed_inside
    assert outside(body, points) < (STEP if body.pressed_inside else 1e-3)
    convex_parts.cache_clear()
    mesh_parts.few_convex_corners.cache_clear()
