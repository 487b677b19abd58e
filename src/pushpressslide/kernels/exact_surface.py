"""The exact limit surface of a sampled pressure: the wrench that drives a twist, and by
Newton's method the twist that a wrench drives (docs/mechanics.md, section 1).

Twists, wrenches and positions refer to the centre of pressure. Functions of one sample
also accept arrays of samples. Sums over samples are computed by NumPy in Python, and by
a loop in compiled code.
"""

from __future__ import annotations

from math import copysign, cos, inf, nan, sin, sqrt
from typing import Any

import numpy as np

from pushpressslide.kernels.allocation import Vector, Wrench
from pushpressslide.kernels.kernel import compiled_as, kernel
from pushpressslide.kernels.support_friction import CREEP, Friction

# roundings of the surface's edges, from coarse to fine, for pressures with pins
PIN_SOFTENINGS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
STEPS = 60  # of Newton's method
FLAT = 1e-13  # gradient of the power at its least
SHORT = 1e-14  # step of a twist that counts as zero
# smallest decrease in a step, as a share of the decrease predicted by the slope
DOWN = 1e-4
ROUNDING = 1e-15  # of the power
SHORTEST = 1e-8  # share of a Newton step below which it is accepted
# force angle [rad] below which the limit of straight motion is used, which differs from
# the exact one in second order
STRAIGHT_ANGLE = 1e-4

Column = Any
"""A number, or an array with one number per sample."""
Twist = tuple[float, float, float]
Sample = tuple[Column, Column, Column, Column]
"""A sample: position x, y, square of the cell's radius, load."""
Samples = Any
"""An array (4, m) with a ``Sample`` in each column."""
Blur = Vector
"""Terms added to the square of a sample's radius, and to the square of its speed."""
Power = tuple[
    Column, Column, Column, Column, Column, Column, Column, Column, Column, Column
]
"""Friction power divided by mu, its gradient (which is the wrench), and its symmetric
Hessian in (vx, vy, w): xx, xy, xw, yy, yw, ww.
"""
Extent = tuple[float, float]
"""Mean distance rho [m] of the load from its centre, and 1 for a pressure with pins,
otherwise 0.
"""
Along = tuple[float, float, float, float, float, float]
"""Power, its gradient, and its Hessian 00, 01, 11, along two unit vectors."""


@kernel
def velocity_of_sample(
    twist: Twist, x: Column, y: Column, turning: Column
) -> tuple[Column, Column, Column]:
    """Components of a sample's velocity, and its speed.

    The speed includes the sample's rotation about its own centre, whose squared
    contribution is ``turning``.
    """
    vx, vy, w = twist
    px = vx - w * y
    py = vy + w * x
    return px, py, np.sqrt(px * px + py * py + turning)


@kernel
def friction_of_sample(
    twist: Twist, x: Column, y: Column, radius: Column, load: Column
) -> tuple[Column, Column, Column]:
    """Wrench divided by mu that makes a sample slide. Zero at rest."""
    w = twist[2]
    turn = radius * w
    px, py, speed = velocity_of_sample(twist, x, y, turn * turn)
    k = load / (speed + (speed == 0.0))
    fx = k * px
    fy = k * py
    return fx, fy, x * fy - y * fx + k * (radius * radius) * w


@kernel
def power_of_sample(twist: Twist, sample: Sample, blur: Blur) -> Power:
    """Contribution of a sample to the power, with derivatives.

    The speed is |A nu|; with u = A nu / |A nu| the gradient is A^T u, and the Hessian
    (A^T A - A^T u u^T A) / |A nu|.
    """
    x, y, square, load = sample
    square = square + blur[0]
    w = twist[2]
    px, py, speed = velocity_of_sample(twist, x, y, square * w * w + blur[1])
    inverse = 1.0 / (speed + (speed == 0.0))
    ux = px * inverse
    uy = py * inverse
    ut = (x * py - y * px + square * w) * inverse
    k = load * inverse
    return (
        load * speed,
        load * ux,
        load * uy,
        load * ut,
        k * (1.0 - ux * ux),
        -k * ux * uy,
        k * (-y - ux * ut),
        k * (1.0 - uy * uy),
        k * (x - uy * ut),
        k * (x * x + y * y + square - ut * ut),
    )


def _wrench_loop(vx: float, vy: float, w: float, samples: Samples) -> Wrench:
    x = samples[0]
    y = samples[1]
    radius = samples[2]
    load = samples[3]
    fx = 0.0
    fy = 0.0
    tau = 0.0
    for i in range(len(x)):
        px, py, turn = friction_of_sample((vx, vy, w), x[i], y[i], radius[i], load[i])
        fx += px
        fy += py
        tau += turn
    return fx, fy, tau


@compiled_as(_wrench_loop, sums=True)
def wrench_of_samples(vx: float, vy: float, w: float, samples: Samples) -> Wrench:
    """Wrench divided by mu that drives a twist. The ``samples`` contain the radius in
    place of its square.
    """
    x, y, radius, load = np.asarray(samples)
    fx, fy, tau = friction_of_sample((vx, vy, w), x, y, radius, load)
    return float(fx.sum()), float(fy.sum()), float(tau.sum())


def _power_loop(twist: Twist, samples: Samples, blur: Blur) -> Power:
    x = samples[0]
    y = samples[1]
    square = samples[2]
    load = samples[3]
    power = 0.0
    fx = 0.0
    fy = 0.0
    tau = 0.0
    xx = 0.0
    xy = 0.0
    xw = 0.0
    yy = 0.0
    yw = 0.0
    ww = 0.0
    for i in range(len(x)):
        part = power_of_sample(twist, (x[i], y[i], square[i], load[i]), blur)
        power += part[0]
        fx += part[1]
        fy += part[2]
        tau += part[3]
        xx += part[4]
        xy += part[5]
        xw += part[6]
        yy += part[7]
        yw += part[8]
        ww += part[9]
    return power, fx, fy, tau, xx, xy, xw, yy, yw, ww


@compiled_as(_power_loop, sums=True)
def power_of_samples(twist: Twist, samples: Samples, blur: Blur) -> Power:
    """Power of a twist: the sum over all samples."""
    x, y, square, load = np.asarray(samples)
    a, b, c, d, e, f, g, h, i, j = power_of_sample(twist, (x, y, square, load), blur)
    sums = np.stack((a, b, c, d, e, f, g, h, i, j)).sum(axis=1).tolist()
    power, fx, fy, tau, xx, xy, xw, yy, yw, ww = sums
    return power, fx, fy, tau, xx, xy, xw, yy, yw, ww


@kernel
def sampled_friction(vx: float, vy: float, w: float, samples: Samples) -> Friction:
    """Friction of samples whose loads are fractions of the total.

    It is the gradient of a power in which each sample's speed is softened by ``CREEP``.
    """
    parts = power_of_samples((vx, vy, w), samples, (0.0, CREEP * CREEP))
    _, fx, fy, tau, xx, xy, xw, yy, yw, ww = parts
    return fx, fy, tau, xx, xy, xw, yy, yw, ww


@kernel
def exact_slide(
    fx: float, fy: float, tau: float, extent: Extent, samples: Samples
) -> tuple[Twist, float]:
    """Twist that a wrench drives, with |(v, rho w)| = 1, and the factor by which the
    wrench exceeds the surface of mu N = 1.

    NaN for a wrench that drives no twist. ``samples`` have positions in units of rho,
    and loads as fractions of the total. The twist has the smallest friction power among
    all twists at which the wrench has unit power (maximum dissipation); it is the
    normal of the surface. At an edge or a vertex of the surface (pins), it is one of
    the normals.
    """
    rho, pinned = extent
    turn = tau / rho
    size = sqrt(fx * fx + fy * fy + turn * turn)
    if not 0.0 < size < inf:
        return (nan, nan, nan), nan
    target = (fx / size, fy / size, turn / size)
    a, b = across(target)
    z = (0.0, 0.0)
    if pinned > 0.0:
        for softening in PIN_SOFTENINGS:
            z = least_power(z, target, a, b, samples, softening)
    else:
        z = least_power(z, target, a, b, samples, 0.0)
    nu = twist_at(z, target, a, b)
    power = power_of_samples(nu, samples, (0.0, 0.0))[0]
    vx, vy, w = nu
    norm = sqrt(vx * vx + vy * vy + w * w)
    return (vx / norm, vy / norm, w / norm / rho), size / power


@kernel
def across(unit: Twist) -> tuple[Twist, Twist]:
    """Two unit vectors perpendicular to a ``unit`` vector and to each other."""
    x, y, z = unit
    sign = copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return (1.0 + sign * x * x * a, sign * b, -sign * x), (b, sign + y * y * a, -y)


@kernel
def twist_at(z: Vector, target: Twist, a: Twist, b: Twist) -> Twist:
    """Twist ``target`` + p a + q b for z = (p, q).

    At each of these twists the unit wrench ``target`` has unit power.
    """
    p, q = z
    return (
        target[0] + p * a[0] + q * b[0],
        target[1] + p * a[1] + q * b[1],
        target[2] + p * a[2] + q * b[2],
    )


@kernel
def power_along(
    z: Vector, target: Twist, a: Twist, b: Twist, samples: Samples, softening: float
) -> Along:
    """Power of the twist at z, with derivatives with respect to z. ``softening`` rounds
    the edges of the surface of pins.
    """
    blur = (softening * softening, 0.0)
    parts = power_of_samples(twist_at(z, target, a, b), samples, blur)
    power, fx, fy, tau, xx, xy, xw, yy, yw, ww = parts
    ax, ay, az = a
    bx, by, bz = b
    # of the Hessian times a and b
    ha = (
        xx * ax + xy * ay + xw * az,
        xy * ax + yy * ay + yw * az,
        xw * ax + yw * ay + ww * az,
    )
    hb = (
        xx * bx + xy * by + xw * bz,
        xy * bx + yy * by + yw * bz,
        xw * bx + yw * by + ww * bz,
    )
    return (
        power,
        fx * ax + fy * ay + tau * az,
        fx * bx + fy * by + tau * bz,
        ha[0] * ax + ha[1] * ay + ha[2] * az,
        ha[0] * bx + ha[1] * by + ha[2] * bz,
        hb[0] * bx + hb[1] * by + hb[2] * bz,
    )


@kernel
def least_power(
    z: Vector, target: Twist, a: Twist, b: Twist, samples: Samples, softening: float
) -> Vector:
    """The z with the smallest power.

    Newton steps are halved until the power decreases.
    """
    at = power_along(z, target, a, b, samples, softening)
    for _ in range(STEPS):
        gradient = (at[1], at[2])
        if max(abs(at[1]), abs(at[2])) < FLAT:
            break
        p, q = newton_step(gradient, (at[3], at[4], at[5]))
        slope = at[1] * p + at[2] * q
        share = 1.0
        ahead = (z[0] + p, z[1] + q)
        trial = power_along(ahead, target, a, b, samples, softening)
        while (
            share > SHORTEST and not trial[0] <= at[0] + DOWN * share * slope + ROUNDING
        ):
            share *= 0.5
            ahead = (z[0] + share * p, z[1] + share * q)
            trial = power_along(ahead, target, a, b, samples, softening)
        z = ahead
        at = trial
        if share * max(abs(p), abs(q)) < SHORT:
            break
    return z


@kernel
def newton_step(gradient: Vector, hessian: Twist) -> Vector:
    """Step to the zero of the gradient, slightly damped."""
    gx, gy = gradient
    a, b, d = hessian
    damping = FLAT * (1.0 + a + d)
    a = a + damping
    d = d + damping
    determinant = a * d - b * b
    if determinant == 0.0:
        return 0.0, 0.0
    return (b * gy - d * gx) / determinant, (b * gx - a * gy) / determinant


@kernel
def exact_axle(
    x: float,
    y: float,
    angle: float,
    spread: Twist,
    extent: Extent,
    samples: Samples,
) -> tuple[float]:
    """Distance [m] from the centre of pressure to the virtual axle, away from the
    contact at x, y [m]. NaN for a contact at the centre.

    The contact's force is at the ``angle`` [rad] to the heading axis. ``spread``
    contains the mean xx, xy and yy [m^2] of the load.
    """
    d = sqrt(x * x + y * y)
    if not 0.0 < d < inf:
        return (nan,)
    ex = x / d
    ey = y / d
    c = cos(angle)
    s = sin(angle)
    if abs(s) < STRAIGHT_ANGLE:
        xx, xy, yy = spread
        return ((xx * ex * ex + 2.0 * xy * ex * ey + yy * ey * ey) / d,)
    fx = c * ex - s * ey
    fy = s * ex + c * ey
    (vx, vy, w), _ = exact_slide(fx, fy, x * fy - y * fx, extent, samples)
    return ((vy * ex - vx * ey) / w,)
