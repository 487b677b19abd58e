"""What a massless, compliant tip does at a side of a body, on arrays: its force as a
function of the body's twist.

Source: docs/mechanics.md, section 3; ``planar.contact`` for one. Frame B, twists
(v_x, v_y, rho w) and wrenches (f_x, f_y, tau / rho) of the centre of pressure.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.batch.wrench_twist import TwistColumns, WrenchColumns
from pushpressslide.core.formulas import Column, where


class SideTip(NamedTuple):
    """Tips at side faces: f = f_0 - B v along the inward normal n and to its left t.

    Arms are over rho: (p x n, p x t) of the contact p, and of the tip's centre, which
    is behind it along n.
    """

    nx: Column  # unit inward normal
    ny: Column
    fn: Column  # [N] f_0, less damping times the speed at which the gap closes
    ft: Column  # [N]
    bn: Column  # [N s/m] B, > 0
    bt: Column
    friction: Column  # of the pair tip/body
    arm_n: Column  # of contact and centre
    arm_t: Column  # of the contact
    centre_t: Column  # of the centre


NO_TIP = SideTip(*map(np.float64, (1.0, 0.0, -1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0)))
"""A tip that touches nothing."""


class TipForce(NamedTuple):
    """Force of a tip on its body."""

    fn: Column  # [N], 0: it does not touch
    ft: Column
    touches: Column  # truth value
    sticks: Column  # truth value
    left: Column  # truth value: a slip is to the left


class Slope(NamedTuple):
    """A derivative of a wrench by a twist [N s/m]; rows fx, fy, tau."""

    fx_vx: Column
    fx_vy: Column
    fx_w: Column
    fy_vx: Column
    fy_vy: Column
    fy_w: Column
    tau_vx: Column
    tau_vy: Column
    tau_w: Column


def tip_force(twist: TwistColumns, tip: SideTip) -> TipForce:
    """Return the force of a tip under a twist: it sticks, slips, or does not touch."""
    into = tip.nx * twist.vx + tip.ny * twist.vy + tip.arm_n * twist.w
    along = tip.nx * twist.vy - tip.ny * twist.vx + tip.centre_t * twist.w
    fn = tip.fn - tip.bn * into
    ft = tip.ft - tip.bt * along
    touches = fn > 0.0
    sticks = np.abs(ft) <= tip.friction * fn
    left = ft > 0.0
    slips = where(left, tip.friction, -tip.friction) * fn
    return TipForce(
        where(touches, fn, 0.0),
        where(touches, where(sticks, ft, slips), 0.0),
        touches,
        sticks & touches,
        left,
    )


def tip_wrench(tip: SideTip, fn: Column, ft: Column) -> WrenchColumns:
    """Return the wrench of a tip's force."""
    return WrenchColumns(
        tip.nx * fn - tip.ny * ft,
        tip.ny * fn + tip.nx * ft,
        tip.arm_n * fn + tip.arm_t * ft,
    )


def tip_slope(tip: SideTip, force: TipForce) -> Slope:
    """Return what a tip's wrench loses per twist."""
    bn = where(force.touches, tip.bn, 0.0)
    nx = bn * tip.nx
    ny = bn * tip.ny
    nw = bn * tip.arm_n
    side = where(force.left, tip.friction, -tip.friction)
    tx = where(force.sticks, -tip.bt * tip.ny, side * nx)
    ty = where(force.sticks, tip.bt * tip.nx, side * ny)
    tw = where(force.sticks, tip.bt * tip.centre_t, side * nw)
    x = tip_wrench(tip, nx, tx)
    y = tip_wrench(tip, ny, ty)
    w = tip_wrench(tip, nw, tw)
    return Slope(x.fx, y.fx, w.fx, x.fy, y.fy, w.fy, x.tau, y.tau, w.tau)
