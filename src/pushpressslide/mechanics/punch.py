"""Pressure under a rigid flat face on an elastic support, highest at the rim.

This is the contact problem of a rigid punch on an elastic half-space (Boussinesq;
Johnson, "Contact Mechanics", 1985, sections 3.4 and 5.9). Each point load makes the
support sink in proportion to 1/distance. The load is distributed so that the support
under the whole face remains plane; the elastic constants do not matter. A face harder
than its support has nearly this pressure, and measured pushes of such a face agree with
it (docs/uncertainty.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pushpressslide.core.pose import Point
from pushpressslide.geometry import quadrature
from pushpressslide.mechanics.pressure import CELL_RADIUS, PressureSamples


def punch_pressure(
    polygon: Sequence[Point],
    load: float = 1.0,
    cop: Point | None = None,
    resolution: int = 4,
) -> PressureSamples:
    """Pressure of a rigid, frictionless face on an elastic half-space.

    ``polygon`` is simple and counter-clockwise [m]; ``load`` [N] is the total; ``cop``
    [m] is the centroid by default. There are about 24 ``resolution``^2 samples, whose
    rho is about 1 % too low. Raises ValueError for a CoP so far out that an edge would
    lift.
    """
    outline = tuple((float(x), float(y)) for x, y in polygon)
    points, areas = quadrature.base_rule(outline, resolution)
    area, first, _ = quadrature.moments(quadrature.base(outline))
    center = first / area if cop is None else np.array(cop, dtype=np.float64)
    n = len(areas)
    system = np.zeros((n + 3, n + 3))
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    # A cell sinks under its own load like a disc of its area.
    np.fill_diagonal(distance, 0.5 * np.sqrt(areas / math.pi))
    system[:n, :n] = 1.0 / distance
    system[:n, n] = system[n, :n] = 1.0
    system[:n, n + 1 :] = points - center
    system[n + 1 :, :n] = (points - center).T
    loads = np.linalg.solve(system, np.append(np.zeros(n), (1.0, 0.0, 0.0)))[:n]
    if loads.min() < 0.0:
        raise ValueError(
            f"centre of pressure ({center[0]:.4g}, {center[1]:.4g}) m lifts an edge of "
            "the rigid face"
        )
    return PressureSamples(points, load * loads, CELL_RADIUS * np.sqrt(areas))
