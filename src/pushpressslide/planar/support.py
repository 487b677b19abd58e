"""Support under one object, for its current load."""

from __future__ import annotations

from functools import lru_cache

from pushpressslide.core.pose import Point
from pushpressslide.geometry.shapes import Shape
from pushpressslide.mechanics.bowed import bowed
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.planar.polygon_friction import PolygonFriction
from pushpressslide.planar.support_friction import SupportFriction

Friction = PolygonFriction | SupportFriction

RESOLUTION = 6  # of a sampled pressure: torsion is right to 0.2 %
FEET_RESOLUTION = 12  # of one under feet, which are small
# largest number of corners of a base in closed form; with more, samples are faster
MOST_CORNERS = 16
# of the base's inner radius: spacing of the CoPs for which pressures are made
GRID = 0.005
KEPT = 1000  # pressures that are remembered
# share of the distance from the base's middle to its outline beyond which the object
# tips
TIPPING = 0.95


class Support:
    """Support under one object.

    The CoP follows from the load, but never leaves the base. The (Winkler) pressure is
    computed for the nearest CoP on a fine grid, once per grid point, and shifted to the
    true CoP.
    """

    def __init__(
        self,
        shape: Shape,
        center_of_mass: Point,
        bow: float = 0.0,
        feet: float = 0.0,
    ) -> None:
        """Prepare the support. ``center_of_mass`` [m] is in the shape's frame G.
        ``bow`` and ``feet`` are as in ``mechanics.bowed``.

        CoPs are given in B, the frame at the CoM.
        """
        middle = shape.middle
        self._middle = (middle[0] - center_of_mass[0], middle[1] - center_of_mass[1])
        self._gauge = shape.gauge()
        self._step = step = GRID * shape.inner_radius
        flat = bow == 0.0 == feet
        resolution = RESOLUTION if feet == 0.0 else FEET_RESOLUTION

        @lru_cache(maxsize=KEPT)
        def samples(i: int, j: int) -> PressureSamples:
            """Pressure for the CoP at a grid point."""
            cop = (i * step, j * step)
            even = support_pressure(shape, 1.0, center_of_mass, cop, resolution)
            return even if flat else bowed(even, shape, center_of_mass, bow, feet)

        @lru_cache(maxsize=KEPT)
        def friction(i: int, j: int) -> Friction:
            """Friction for the CoP at a grid point."""
            if shape.corners and flat:
                face = face_pressure(shape, center_of_mass, (i * step, j * step))
                if len(face.corners) <= MOST_CORNERS:
                    return PolygonFriction(face)
            return SupportFriction(samples(i, j))

        self._friction = friction
        self._samples = samples

    def outwards(self, cop: Point) -> float:
        """Relative position of ``cop`` [m]: 0 at the middle of the base, 1 on its
        outline.
        """
        return self._gauge(cop[0] - self._middle[0], cop[1] - self._middle[1])

    def under(self, cop: Point) -> tuple[Point, Friction, bool]:
        """CoP [m] in B, limited to the base; the friction about this CoP; and whether
        the object tips.
        """
        out = self.outwards(cop)
        tipping = out > TIPPING
        if tipping:
            mx, my = self._middle
            k = TIPPING / out
            cop = (mx + k * (cop[0] - mx), my + k * (cop[1] - my))
        return cop, self._friction(*self._nearest(cop)), tipping

    def samples(self, cop: Point) -> PressureSamples:
        """Pressure in B, with a total load of 1, for the grid point nearest to ``cop``
        [m].
        """
        return self._samples(*self._nearest(cop))

    def _nearest(self, cop: Point) -> tuple[int, int]:
        """Grid point nearest to a CoP [m]."""
        return round(cop[0] / self._step), round(cop[1] / self._step)
