"""What is left over of the forces on a body, and the step of Newton's method towards
their balance, on arrays.

Source: docs/mechanics.md, sections 1 to 3; ``planar.sliding`` and ``planar.support``
for one. Frame B, twists (v_x, v_y, rho w) and wrenches (f_x, f_y, tau / rho) of the
centre of pressure.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.batch.formulas import Column, Columns
from pushpressslide.batch.side_contact import (
    SideTip,
    Slope,
    tip_force,
    tip_slope,
    tip_wrench,
)
from pushpressslide.batch.wrench_twist import TwistColumns, WrenchColumns
from pushpressslide.mechanics.balance import CREEP, SOFTENING


class Sums(NamedTuple):
    """What ``Support.sums`` gives: k_i of b_i / |v|, s_ij of b_i b_j / |v|^3."""

    k0: Column
    kx: Column
    ky: Column
    ks: Column
    s00: Column
    s0x: Column
    s0y: Column
    s0s: Column
    sxx: Column
    sxy: Column
    sxs: Column
    syy: Column
    sys: Column
    sss: Column


class Held(NamedTuple):
    """What holds a body back: its support, and a drag to a twist."""

    max_force: Column  # [N] mu_s N
    drag: Column  # [N s/m]
    vx: Column  # [m/s] where the drag is zero
    vy: Column
    w: Column


def friction_wrench(twist: TwistColumns, k: Sums, limit: Column) -> WrenchColumns:
    """Return the wrench that slides a body."""
    return WrenchColumns(
        limit * (k.k0 * twist.vx - k.ky * twist.w),
        limit * (k.k0 * twist.vy + k.kx * twist.w),
        limit * (k.kx * twist.vy - k.ky * twist.vx + k.ks * twist.w),
    )


def friction_slope(twist: TwistColumns, s: Sums, limit: Column) -> Slope:
    """Return its derivative by the twist: that of the forces at given speeds, less what
    the speeds change.
    """
    x, y, w = twist
    xx = x * x * s.s00 - 2.0 * x * w * s.s0y + w * w * s.syy
    xy = x * y * s.s00 + x * w * s.s0x - w * y * s.s0y - w * w * s.sxy
    yy = y * y * s.s00 + 2.0 * y * w * s.s0x + w * w * s.sxx
    xw = x * y * s.s0x - x * x * s.s0y + x * w * s.s0s
    xw = xw - w * y * s.sxy + w * x * s.syy - w * w * s.sys
    yw = y * y * s.s0x - x * y * s.s0y + y * w * s.s0s
    yw = yw + w * y * s.sxx - w * x * s.sxy + w * w * s.sxs
    ww = y * y * s.sxx + x * x * s.syy + w * w * s.sss
    ww = ww + 2.0 * (y * w * s.sxs - x * y * s.sxy - x * w * s.sys)
    a = limit * (s.k0 - xx)
    b = -limit * xy
    c = -limit * (s.ky + xw)
    d = limit * (s.k0 - yy)
    e = limit * (s.kx - yw)
    f = limit * (s.ks - ww)
    return Slope(a, b, c, b, d, e, c, e, f)


def balancing(
    twist: TwistColumns, sums: Sums, held: Held, first: SideTip, second: SideTip
) -> Columns:
    """Return the force [N] that nothing balances, and the step of Newton [m/s] to where
    there is none.
    """
    one = tip_force(twist, first)
    two = tip_force(twist, second)
    f = friction_wrench(twist, sums, held.max_force)
    g = tip_wrench(first, one.fn, one.ft)
    h = tip_wrench(second, two.fn, two.ft)
    fx = f.fx - g.fx - h.fx + held.drag * (twist.vx - held.vx)
    fy = f.fy - g.fy - h.fy + held.drag * (twist.vy - held.vy)
    tau = f.tau - g.tau - h.tau + held.drag * (twist.w - held.w)
    k = friction_slope(twist, sums, held.max_force)
    p = tip_slope(first, one)
    q = tip_slope(second, two)
    square = twist.vx * twist.vx + twist.vy * twist.vy + twist.w * twist.w
    soft = held.drag + SOFTENING * held.max_force / (np.sqrt(square) + CREEP)
    slope = Slope(
        k.fx_vx + p.fx_vx + q.fx_vx + soft,
        k.fx_vy + p.fx_vy + q.fx_vy,
        k.fx_w + p.fx_w + q.fx_w,
        k.fy_vx + p.fy_vx + q.fy_vx,
        k.fy_vy + p.fy_vy + q.fy_vy + soft,
        k.fy_w + p.fy_w + q.fy_w,
        k.tau_vx + p.tau_vx + q.tau_vx,
        k.tau_vy + p.tau_vy + q.tau_vy,
        k.tau_w + p.tau_w + q.tau_w + soft,
    )
    x, y, w = newton_step(slope, WrenchColumns(fx, fy, tau))
    return fx, fy, tau, x, y, w


def newton_step(slope: Slope, force: WrenchColumns) -> TwistColumns:
    """Return the step x with slope x = -force, by Cramer's rule; not finite where the
    slope is singular.
    """
    a, b, c, d, e, f, g, h, i = slope
    first = e * i - f * h
    second = f * g - d * i
    third = d * h - e * g
    determinant = a * first + b * second + c * third
    x = -force.fx / determinant
    y = -force.fy / determinant
    z = -force.tau / determinant
    return TwistColumns(
        first * x + (c * h - b * i) * y + (b * f - c * e) * z,
        second * x + (a * i - c * g) * y + (c * d - a * f) * z,
        third * x + (b * g - a * h) * y + (a * e - b * d) * z,
    )
