"""Pressure under a base that is not flat."""

from __future__ import annotations

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.geometry.shapes import Shape
from pushpressslide.mechanics.pressure import PressureSamples


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


def bowed(
    samples: PressureSamples, shape: Shape, center_of_mass: Point, bow: float
) -> PressureSamples:
    """Samples in B of the pressure under a bowed base, with the same load and CoP.

    A factor linear in the position restores the CoP, as a small tilt of the base does.
    """
    factors = bow_factors(shape, samples.points + center_of_mass, bow)
    loads = samples.loads * factors
    places = np.column_stack([np.ones(len(loads)), samples.points - samples.cop])
    moments = (loads * places.T) @ places
    tilt = np.linalg.solve(moments, (samples.total_load, 0.0, 0.0))
    carried = np.maximum(loads * (places @ tilt), 0.0)
    bent = PressureSamples(samples.points, carried, samples.radii)
    return bent.scaled_to(samples.total_load)
