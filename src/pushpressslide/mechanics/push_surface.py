"""The limit surface near one twist, for an object pushed from its sides at one height."""

from __future__ import annotations

from functools import lru_cache

from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.osculating import dragged_ellipsoid, pressures

KEPT = 4096  # surfaces; a search comes back to the same twists with other contacts


@lru_cache(maxsize=KEPT)
def push_surface(scene: Scene, height: float, twist: Twist) -> DraggedSurface:
    """Ellipsoid that touches the believed exact surface at ``twist`` (any body point).

    Its centre of pressure shifts with the force of pushes at ``height`` [m]
    (docs/mechanics.md, section 1.2). Raises ValueError for a zero twist, and if the
    object tips.
    """
    load = scene.weight_on

    def shift(wrench: Wrench) -> Point:
        """Displacement [m] of the centre of pressure by a push."""
        return (height * wrench.fx / load, height * wrench.fy / load)

    mu = scene.support.friction
    surface, _ = dragged_ellipsoid(pressures(scene), mu, load, (0.0, 0.0), twist, shift)
    dx, dy = shift(surface.wrench(twist))
    (x, y) = surface.center
    return DraggedSurface(surface.max_force, surface.rho, height * mu, (x - dx, y - dy))
