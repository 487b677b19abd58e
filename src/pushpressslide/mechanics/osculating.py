"""The ellipsoid that touches the exact limit surface at one twist, with the same wrench
and the same normal.

No single ellipsoid fits everywhere (docs/mechanics.md, section 1.1). Along a path with
a constant twist, the surface is only needed near this twist. Let (F, tau) be the wrench
of the twist (v, w), both at one point, P = F.v + tau w its power and f = mu N the
limit. Normality then leaves a single ellipsoid with the force axis f:

    k = f^2 / P,   v + w J c = F / k,   rho^2 = (f^2 - |F|^2) / (k w)^2
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure

# smallest turn of a motion at the pressure's radius, as a share of its speed
LEAST_TURN = 0.01
RESOLUTION = 5  # of the pressure samples
ROUNDS = 12  # rounds of centre of pressure and wrench
FIRST = 0.5  # share of the drag's displacement in the first round
CLOSE = 1e-5  # tolerance of the centre of pressure, as a share of rho


def pressures(scene: Scene) -> Callable[[Point], PressureSamples]:
    """Function from a CoP [m] in B to the believed pressure of unit load under a
    scene's body.

    If rho is believed, all of the load is placed at this distance from the CoP, which
    makes the exact surface an ellipsoid. The function raises ValueError for a CoP
    outside the base, where the object tips.
    """
    body = scene.body
    rho = scene.rho

    def pressure_at(cop: Point) -> PressureSamples:
        """Pressure with its centre at ``cop`` [m] in B."""
        if rho is None:
            return support_pressure(
                body.shape, 1.0, body.center_of_mass, cop, RESOLUTION
            )
        return PressureSamples(np.array([cop]), np.ones(1), np.array([rho]))

    return pressure_at


def touching_ellipsoid(
    samples: PressureSamples, mu: float, twist: Twist
) -> DraggedSurface:
    """Ellipsoid that touches the exact surface of ``samples`` at ``twist`` (any body
    point).

    ``mu`` is the friction of the pair object/support. Raises ValueError for a zero
    twist, or a pressure without extent.
    """
    at = twist.moved_to(samples.cop)
    arms = samples.points - samples.cop
    radius = math.sqrt(
        float(samples.loads @ ((arms**2).sum(1) + samples.radii**2))
        / samples.total_load
    )
    speed = math.hypot(at.vx, at.vy)
    turn = max(abs(at.w), LEAST_TURN * math.hypot(at.vx, at.vy) / radius)
    if not max(speed, turn) > 0.0:
        raise ValueError("a zero twist; some direction of sliding is needed")
    w = math.copysign(turn, at.w)
    fx, fy, tau, cop = exact_wrench(samples, mu, Twist(at.vx, at.vy, w, samples.cop))
    limit = mu * samples.total_load
    k = limit * limit / (fx * at.vx + fy * at.vy + tau * w)
    center = (cop[0] + (fy / k - at.vy) / w, cop[1] - (fx / k - at.vx) / w)
    rho = math.sqrt(limit * limit - fx * fx - fy * fy) / (k * turn)
    return DraggedSurface(limit, rho, 0.0, center)


def dragged_ellipsoid(
    pressure_at: Callable[[Point], PressureSamples],
    mu: float,
    load: float,
    cop: Point,
    twist: Twist,
    shift: Callable[[Wrench], Point],
) -> tuple[DraggedSurface, Point]:
    """Ellipsoid of ``touching_ellipsoid`` for the centre of pressure shifted by the
    drag, and the shifted centre [m].

    ``pressure_at(p)`` gives the distribution, for any total load, with its CoP at p.
    ``load`` [N] is the true total load, ``cop`` [m] the CoP without drag, and
    ``shift(wrench)`` [m] the displacement of the CoP by the forces of a wrench. Raises
    ValueError if the CoP leaves the base, so that the object tips.
    """
    # By the secant method in complex numbers: the twist's turn makes of an offset of
    # the centre of pressure a shift that is turned and scaled, which is what a complex
    # factor does.
    at = complex(*cop)
    step = 0j
    before = 0j
    for _ in range(ROUNDS):
        surface = touching_ellipsoid(
            pressure_at((at.real, at.imag)).scaled_to(load), mu, twist
        )
        off = complex(*cop) + complex(*shift(surface.wrench(twist))) - at
        if abs(off) < CLOSE * surface.rho:
            break
        if step and before != off:
            step = off * step / (before - off)
        else:
            step = FIRST * off
        at = at + step
        before = off
    return surface, (at.real, at.imag)
