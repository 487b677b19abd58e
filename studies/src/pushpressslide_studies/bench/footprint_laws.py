"""Friction of a flat base by the integral of its uniform pressure, and by the planar
engine.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point
from pushpressslide.geometry.shapes import Shape
from pushpressslide.planar.support import Support

FINE = 40
"""Resolution of the rule of integration."""
STANDING = 1e-12
"""Speed [m/s] below which a point counts as standing still."""

Law = Callable[[Vector3], Vector3]
"""Wrench (fx, fy [N], tau [N m]) of friction against a twist (m/s, rad/s), both about
the centroid of the base, per newton of friction mu N.
"""


def exact_law(shape: Shape) -> Law:
    """Friction by the integral of the uniform pressure."""
    points, areas = shape.base_rule(FINE)
    shares = areas / areas.sum()
    x, y = (points - shares @ points).T

    def law(twist: Vector3) -> Vector3:
        """Wrench by the integral."""
        vx, vy, w = twist
        ux = vx - w * y
        uy = vy + w * x
        speed = np.maximum(np.hypot(ux, uy), STANDING)
        fx = float(shares @ (ux / speed))
        fy = float(shares @ (uy / speed))
        return fx, fy, float(shares @ ((x * uy - y * ux) / speed))

    return law


def planar_law(shape: Shape) -> Law:
    """Friction in the planar engine."""
    center = base_center(shape)
    _, friction, _ = Support(shape, center).under((0.0, 0.0))

    def law(twist: Vector3) -> Vector3:
        """Wrench as in the planar engine."""
        return friction.wrench(twist, 1.0)

    return law


def base_center(shape: Shape) -> Point:
    """Centroid [m] of the base in the shape's frame."""
    x, y = _mean(*shape.base_rule(FINE))
    return x, y


def _mean(points: Array, areas: Array) -> list[float]:
    out: list[float] = (areas @ points / areas.sum()).tolist()
    return out


def gyration(shape: Shape) -> float:
    """Radius of gyration [m] of the base about its centroid."""
    points, areas = shape.base_rule(FINE)
    apart = points - _mean(points, areas)
    return math.sqrt(float(areas @ (apart**2).sum(axis=1) / areas.sum()))


def pushed_twist(law: Law, point: Point, velocity: Point, radius: float) -> Vector3:
    """Twist about the centroid of a base that a force leads at ``point`` [m] with
    ``velocity`` [m/s]. ``radius`` [m] is that of gyration.
    """
    x, y = point
    vx, vy = velocity

    def twist(w: float) -> Vector3:
        """Twist with a turn rate ``w`` [rad/s]."""
        return vx + w * y, vy - w * x, w

    def moment(w: float) -> float:
        """Moment [m] of the friction about the point."""
        fx, fy, tau = law(twist(w))
        return tau - (x * fy - y * fx)

    most = 10.0 * math.hypot(vx, vy) / radius
    return twist(float(brentq(moment, -most, most, xtol=1e-12)))
