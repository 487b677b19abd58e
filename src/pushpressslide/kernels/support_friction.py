"""Friction between a body and its support as a smooth function of the twist: the common
part of all limit surfaces, and the ellipsoid (docs/mechanics.md, section 1).

Twists (v_x, v_y, w) and wrenches are those of the centre of pressure. Friction is
divided by mu_s N.
"""

from __future__ import annotations

from math import sqrt

from pushpressslide.kernels.allocation import Wrench
from pushpressslide.kernels.kernel import kernel

CREEP = 1e-8  # [m/s] speed up to which the friction grows; represents rest
STILL = 1.0 / CREEP  # slope of the friction of a body that does not move

Slope = tuple[float, float, float, float, float, float]
"""Symmetric derivative of a wrench with respect to the twist: xx, xy, xw, yy, yw, ww.
"""
Friction = tuple[float, float, float, float, float, float, float, float, float]
"""Wrench x, y and moment that slides a body with a twist, and its slope."""


@kernel
def softened(power: float, wrench: Wrench, slope: Slope) -> Friction:
    """Wrench and slope of the softened power sqrt(P^2 + CREEP^2) from those of the
    power P.

    The friction falls to zero with the speed.
    """
    fx, fy, tau = wrench
    xx, xy, xw, yy, yw, ww = slope
    soft = 1.0 / sqrt(power * power + CREEP * CREEP)
    part = power * soft
    rest = CREEP * CREEP * soft * soft * soft
    rx = rest * fx
    ry = rest * fy
    return (
        part * fx,
        part * fy,
        part * tau,
        part * xx + rx * fx,
        part * xy + rx * fy,
        part * xw + rx * tau,
        part * yy + ry * fy,
        part * yw + ry * tau,
        part * ww + rest * tau * tau,
    )


@kernel
def ellipsoid_friction(vx: float, vy: float, w: float) -> Friction:
    """Wrench and slope for a twist (v_x, v_y, rho w), with the moment divided by rho."""
    inverse = 1.0 / sqrt(vx * vx + vy * vy + w * w + CREEP * CREEP)
    fx = vx * inverse
    fy = vy * inverse
    tau = w * inverse
    return (
        fx,
        fy,
        tau,
        inverse * (1.0 - fx * fx),
        -inverse * fx * fy,
        -inverse * fx * tau,
        inverse * (1.0 - fy * fy),
        -inverse * fy * tau,
        inverse * (1.0 - tau * tau),
    )
