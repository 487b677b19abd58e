"""Supports of many bodies: the exact limit surface of a pressure, or ellipsoids.

Source: docs/mechanics.md, section 1. ``planar.support`` does the same for one body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import check_positive
from pushpressslide.batch.rows import AnyArray, Kernel, figures
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.planar_steps import (
    slide_on_ellipsoid,
    slide_on_polygon,
    slide_on_samples,
    step_on_ellipsoid,
    step_on_polygon,
    step_on_samples,
)
from pushpressslide.mechanics.face_pressure import FacePressure
from pushpressslide.mechanics.pressure import PressureSamples


@dataclass(frozen=True, eq=False)
class Support:
    """Supports of one kind under the bodies."""

    step: Kernel  # a tick of a body with its tips
    slide: Kernel  # the twist at which a body is balanced
    arrays: tuple[AnyArray, ...]  # of the pressure, the same for all
    rho: Array  # (...) [m] root mean square distance of the load
    max_force: Array  # (...) [N] mu_s N


def ellipsoid_support(max_force: ArrayLike, rho: ArrayLike) -> Support:
    """Supports with an ellipsoidal limit surface of ``rho`` (...) [m].

    ``max_force`` (...) [N] is mu_s N. Raises ValueError unless both are finite and > 0.
    """
    force, length = figures(max_force, rho)
    check_positive(force, "max_force", "N")
    check_positive(length, "rho", "m")
    return Support(step_on_ellipsoid, slide_on_ellipsoid, (), length, force)


def polygon_support(face: FacePressure, max_force: ArrayLike) -> Support:
    """Supports with the exact limit surface of one pressure.

    ``max_force`` (...) [N] is mu_s N. Raises ValueError unless it is finite and > 0.
    """
    (force,) = figures(max_force)
    check_positive(force, "max_force", "N")
    arrays = (np.array(face.plane()), face.edges(), np.array(face.series()))
    return Support(step_on_polygon, slide_on_polygon, arrays, np.array(face.rho), force)


def exact_support(samples: PressureSamples, friction: ArrayLike) -> Support:
    """Supports with the exact limit surface of one pressure, for ``friction`` (...) of
    the pair object/support.

    Raises ValueError for friction <= 0, and for a pressure concentrated in points: a
    turn about such a point leaves its drag undetermined.
    """
    (mu,) = figures(friction)
    check_positive(mu, "friction", "")
    check_positive(samples.radii[samples.loads > 0.0], "radius of a sample", "m")
    x, y = (samples.points - np.array(samples.cop)).T
    shares = samples.loads / samples.total_load
    own = samples.radii**2
    rho = np.sqrt(shares @ (x * x + y * y + own))
    table = np.stack([x, y, own, shares])
    force = mu * samples.total_load
    return Support(step_on_samples, slide_on_samples, (table,), rho, force)
