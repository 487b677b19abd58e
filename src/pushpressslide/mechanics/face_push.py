"""An object pushed on one face by a force anywhere on it, on the exact limit surface: as a car."""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point, turned_left
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.faces import Face
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.mechanics.virtual_axle import pushed_twist

RESOLUTION = 6  # of the pressure samples


class Turning(NamedTuple):
    """How a force turns the object."""

    axle: float  # [m] ahead of the CoM along the face's normal, of the point without velocity across it
    curvature: float  # [1/m] of that point's path


def on_face(face: Face, left: float) -> Point:
    """Return the point [m] in B of a face that is ``left`` [m] of the CoM's line along the normal."""
    n = face.normal
    return (-face.depth * n[0] - left * n[1], -face.depth * n[1] + left * n[0])


def turning(body: ObjectModel, mu: float, face: Face, height: float, left: float, slope: float) -> Turning:
    """Return how a force turns the object that acts ``left`` [m] of the CoM's line, at ``height`` [m].

    ``slope`` is its part to the left, per part along the normal; ``mu`` of the pair object/support. The load
    that the push itself shifts is taken in. Raises ValueError where the object tips, and for a force through
    the CoM, which does not turn it.
    """
    if left == 0.0 and slope == 0.0:
        raise ValueError("a force through the CoM does not turn the object")

    def pressure_at(cop: Point) -> PressureSamples:
        return support_pressure(body.shape, 1.0, body.center_of_mass, cop, RESOLUTION)

    n, t = face.normal, turned_left(face.normal)
    angle = math.atan(slope) + math.atan2(left, face.depth)  # from the line of contact and CoM
    twist = pushed_twist(pressure_at, mu, on_face(face, left), height, angle)
    along, across = twist.vx * n[0] + twist.vy * n[1], twist.vx * t[0] + twist.vy * t[1]
    return Turning(-across / twist.w, twist.w / along)
