"""What was identified on the way, for the plans made there."""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.identification.online import Identified


class ParameterEstimates(NamedTuple):
    """What measurements say instead of what was believed."""

    axle: Identified | None = None  # None while the plan is not contradicted
    rho: float | None = None  # [m]; None: as believed
    drag: float | None = None  # [N] that slides the object; None: as believed
    center: Point = (0.0, 0.0)  # p_BCom [m]; B is at the believed centre
    elsewhere: bool = (
        False  # whether the plan that is followed has the centre elsewhere
    )


NOTHING = ParameterEstimates()
"""Nothing contradicts what was believed."""


def dragged_friction(scene: Scene, load: float, drag: float | None) -> float:
    """Return the support's friction as the force says that slides the object, ``drag``
    [N] under a ``load`` [N]; as believed where that is not contradicted.
    """
    friction = scene.support.friction
    if drag is None:
        return friction
    ratio = margins.drag_ratio(drag, scene.max_friction(load))
    if abs(ratio - 1.0) < margins.SURE_DRAG:
        return friction
    return ratio * friction
