"""Pressure under a base that is not flat."""

from __future__ import annotations

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.geometry.shapes import Shape
from pushpressslide.mechanics.pressure import PressureSamples

FOOT = 0.12
"""Radius of a foot, as a share of the base's breadth."""


def bow_factors(shape: Shape, points: Array, bow: float) -> Array:
    """Factors (n,) of the pressure at ``points`` (n, 2) [m] in G: 1 + ``bow`` at the
    rim, 1 - ``bow`` in the middle, quadratic between them.

    The gauge g of a convex base has a mean square of 1/2 over its area, so that an even
    pressure keeps its load.
    """
    x, y = shape.middle
    gauge = shape.gauge()
    places = (points - (x, y)).tolist()
    radii = np.array([min(1.0, gauge(px, py)) for px, py in places])
    factors: Array = 1.0 + bow * (2.0 * radii**2 - 1.0)
    return factors


def feet_factors(shape: Shape, points: Array, share: float) -> Array:
    """Factors (n,) of the pressure at ``points`` (n, 2) [m] in G under four feet, each
    at a ``share`` of the way from the middle of the base to its rim.

    They fall off as a normal distribution does. A share of 0 is a whole base.
    """
    if share == 0.0:
        return np.ones(len(points))
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    gauge = shape.gauge()
    factors = np.zeros(len(points))
    for x in (0.5 * (x_max - x_min), 0.5 * (x_min - x_max)):
        for y in (0.5 * (y_max - y_min), 0.5 * (y_min - y_max)):
            foot = np.array(shape.middle) + share / gauge(x, y) * np.array((x, y))
            away = np.hypot(*(points - foot).T) / (FOOT * shape.breadth)
            factors += np.exp(-(away**2))
    return factors


def base_factors(shape: Shape, points: Array, bow: float, feet: float) -> Array:
    """Factors (n,) of the pressure at ``points`` (n, 2) [m] in G under a base with a
    ``bow`` and on ``feet``.
    """
    return bow_factors(shape, points, bow) * feet_factors(shape, points, feet)


def bowed(
    samples: PressureSamples,
    shape: Shape,
    center_of_mass: Point,
    bow: float,
    feet: float = 0.0,
) -> PressureSamples:
    """Samples in B of the pressure under a base as of ``base_factors``, with the same
    load and CoP.

    A factor linear in the position restores the CoP, as a small tilt of the base does.
    """
    factors = base_factors(shape, samples.points + center_of_mass, bow, feet)
    loads = samples.loads * factors
    places = np.column_stack([np.ones(len(loads)), samples.points - samples.cop])
    moments = (loads * places.T) @ places
    tilt = np.linalg.solve(moments, (samples.total_load, 0.0, 0.0))
    carried = np.maximum(loads * (places @ tilt), 0.0)
    bent = PressureSamples(samples.points, carried, samples.radii)
    return bent.scaled_to(samples.total_load)
