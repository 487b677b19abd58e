"""What is left over of the forces on a body, and the step of Newton's method towards
their balance, on arrays.

Source: docs/mechanics.md, sections 1 to 3; ``planar.sliding`` and ``planar.support``
for one. Frame B, twists (v_x, v_y, rho w) and wrenches (f_x, f_y, tau / rho) of the
centre of pressure.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.batch.side_contact import (
    SideTip,
    Slope,
    tip_force,
    tip_slope,
    tip_wrench,
)
from pushpressslide.batch.wrench_twist import TwistColumns, WrenchColumns
from pushpressslide.core.formulas import Column, Columns
from pushpressslide.mechanics.balance import CREEP, SOFTENING


class Friction(NamedTuple):
    """What ``Support.frictions`` gives: the wrench that slides a body, over mu_s N, and
    its slope, which is symmetric.
    """

    fx: Column
    fy: Column
    tau: Column
    xx: Column
    xy: Column
    xw: Column
    yy: Column
    yw: Column
    ww: Column


class Held(NamedTuple):
    """What holds a body back: its support, and a drag to a twist."""

    max_force: Column  # [N] mu_s N
    drag: Column  # [N s/m]
    vx: Column  # [m/s] where the drag is zero
    vy: Column
    w: Column


def balancing(
    twist: TwistColumns, friction: Friction, held: Held, first: SideTip, second: SideTip
) -> Columns:
    """Return the force [N] that nothing balances, and the step of Newton [m/s] to where
    there is none.
    """
    one = tip_force(twist, first)
    two = tip_force(twist, second)
    limit = held.max_force
    g = tip_wrench(first, one.fn, one.ft)
    h = tip_wrench(second, two.fn, two.ft)
    fx = limit * friction.fx - g.fx - h.fx + held.drag * (twist.vx - held.vx)
    fy = limit * friction.fy - g.fy - h.fy + held.drag * (twist.vy - held.vy)
    tau = limit * friction.tau - g.tau - h.tau + held.drag * (twist.w - held.w)
    p = tip_slope(first, one)
    q = tip_slope(second, two)
    square = twist.vx * twist.vx + twist.vy * twist.vy + twist.w * twist.w
    soft = held.drag + SOFTENING * limit / (np.sqrt(square) + CREEP)
    slope = Slope(
        limit * friction.xx + p.fx_vx + q.fx_vx + soft,
        limit * friction.xy + p.fx_vy + q.fx_vy,
        limit * friction.xw + p.fx_w + q.fx_w,
        limit * friction.xy + p.fy_vx + q.fy_vx,
        limit * friction.yy + p.fy_vy + q.fy_vy + soft,
        limit * friction.yw + p.fy_w + q.fy_w,
        limit * friction.xw + p.tau_vx + q.tau_vx,
        limit * friction.yw + p.tau_vy + q.tau_vy,
        limit * friction.ww + p.tau_w + q.tau_w + soft,
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
