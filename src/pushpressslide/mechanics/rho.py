"""The length rho of the ellipsoid with the semi-axes mu N and mu N rho, from a pressure
distribution.

Source: docs/mechanics.md, section 1.1. No single value fits every motion: rho depends
on the direction and on the curvature of the turn.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.pose import Point
from pushpressslide.mechanics.limit_surface import exact_wrenches
from pushpressslide.mechanics.pressure import PressureSamples


def rho_pole(samples: PressureSamples) -> float:
    """Ratio tau_max / (mu N) [m], which is the mean distance of the load from the CoP.
    Exact for pure rotation.
    """
    r = samples.points - np.array(samples.cop)
    distance = np.sqrt((r**2).sum(1) + samples.radii**2)
    return float(samples.loads @ distance) / samples.total_load


def rho_straight(samples: PressureSamples, direction: Point = (1.0, 0.0)) -> float:
    """Rho [m] for nearly straight motion along ``direction``: the root of the
    pressure's variance in this direction.

    It is exact to first order in the turn, for any pressure. Raises ValueError for a
    zero direction.
    """
    size = math.hypot(direction[0], direction[1])
    if size == 0.0:
        raise ValueError("direction (0, 0); must not be zero")
    along = (samples.points - np.array(samples.cop)) @ (np.array(direction) / size)
    return math.sqrt(float(samples.loads @ along**2) / samples.total_load)


def rho_fit(samples: PressureSamples) -> float:
    """Rho [m] of the ellipsoid nearest to the exact surface: least squares of H - 1.

    The force axis is fixed at mu N. The fit is over 256 twists spread evenly on the
    sphere (vx, vy, rho_pole w). It is the default for control, and 0.95 to 0.97 of
    ``rho_pole`` for uniform patches. Raises ValueError for a pressure without extent.
    """
    pole = rho_pole(samples)
    if pole == 0.0:
        raise ValueError("the pressure has no extent; rho is not defined")
    n = 256
    i = np.arange(n) + 0.5
    height = 1.0 - 2.0 * i / n
    angle = i * (math.pi * (1.0 + math.sqrt(5.0)))
    flat = np.sqrt(1.0 - height**2)
    twists = np.stack(
        [flat * np.cos(angle), flat * np.sin(angle), height / pole], axis=1
    )
    wrenches = exact_wrenches(samples, 1.0 / samples.total_load, twists)
    force_squared = (wrenches[:, :2] ** 2).sum(1)
    torque_squared = wrenches[:, 2] ** 2
    return math.sqrt(
        float(
            (torque_squared**2).sum() / (torque_squared * (1.0 - force_squared)).sum()
        )
    )
