"""Parameters identified during a run, for its replans."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.identification.online import AxleEstimate


class ParameterEstimates(NamedTuple):
    """Measured values that replace believed ones."""

    axle: AxleEstimate | None = None  # None while the plan is not contradicted
    rho: float | None = None  # [m]; None: as believed
    drag: float | None = None  # [N] that slides the object; None: as believed
    center: Point = (0.0, 0.0)  # p_BCom [m]; B is at the believed centre
    doubt: float = 0.0  # [rad] standard deviation of the line from contact to centre
    # [m] from the only contact to the virtual axle; None: as planned
    reach: float | None = None
    # whether the plan that is followed has the centre or the axle elsewhere
    elsewhere: bool = False


NOTHING = ParameterEstimates()
"""No estimates: nothing contradicts the belief."""


MOST_FRICTION = 1.9
"""Largest support friction that forces are believed to tell."""


def withstood_friction(
    scene: Scene, forces: Sequence[Vector3], unsure: float, acceleration: float
) -> float:
    """Least friction of a level support under an object that the tips' ``forces`` [N],
    in the support's frame, accelerate by no more than ``acceleration`` [m/s^2].

    ``unsure`` [N] is the standard deviation of each component of the forces. Zero on a
    slope, and for an object that nothing presses onto its support.
    """
    fx, fy, fz = (math.fsum(force[i] for force in forces) for i in range(3))
    press = scene.weight_on - fz
    if any(scene.weight_along) or press <= 0.0:
        return 0.0
    force = math.hypot(fx, fy) - scene.body.mass * acceleration
    force -= margins.DOUBT * math.sqrt(len(forces)) * unsure
    return min(max(0.0, force) / press, MOST_FRICTION)


def dragged_friction(scene: Scene, load: float, drag: float | None) -> float:
    """Support friction according to the ``drag`` [N] under a ``load`` [N]. It is the
    believed friction unless the measurement contradicts the belief.
    """
    friction = scene.support.friction
    if drag is None:
        return friction
    ratio = margins.drag_ratio(drag, scene.max_friction(load))
    if abs(ratio - 1.0) < margins.SURE_DRAG:
        return friction
    return ratio * friction
