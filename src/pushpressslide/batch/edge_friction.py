"""Friction under a polygon with a linear pressure: the exact limit surface in closed
form, edge by edge.

Source: docs/mechanics.md, section 1.3. Twists and wrenches are those of the centre of
pressure, and so are places; friction is over mu_s N. One text serves NumPy's columns,
compiled loops and plain floats (``formulas.plain``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pushpressslide.batch.formulas import Column, Columns
from pushpressslide.mechanics.balance import CREEP

ON_EDGE = 1e-15  # of an edge's length: as near as a centre of rotation comes to it

Edges = Any
"""Eight rows, one number for each edge, in their order round the polygon: x, y of its
first corner; its unit vector (tx, ty), with (ty, -tx) outwards; its length; the pressure
at its middle; the pressure's slope outwards and along it.
"""
Plane = Any
"""The pressure p + q . r of unit load as p, q_x, q_y; the turn rate per speed below
which the series holds; the square of rho.
"""
Series = Any
"""Ten complex coefficients, ``mechanics.face_pressure.series``."""


def friction_of_row(
    edges: Edges,
    plane: Plane,
    series: Series,
    vx: float,
    vy: float,
    w: float,
    sloped: bool,
) -> Columns:
    """Return wrench and slope of one twist, as ``softened`` does.

    Without ``sloped`` the slope may be left out.
    """
    square = vx * vx + vy * vy
    if w * w > plane[3] * plane[3] * square:
        return near(edges, plane, vx, vy, w, sloped)
    if square > 0.0:
        return far(series, vx, vy, w)
    return at_rest(plane)


def at_rest(plane: Plane) -> Columns:
    """Return no wrench, and the slope of a body that does not move."""
    stiff = 1.0 / CREEP
    return 0.0, 0.0, 0.0, stiff, 0.0, 0.0, stiff, 0.0, stiff * plane[4]


def near(
    edges: Edges, plane: Plane, vx: Column, vy: Column, w: Column, sloped: bool
) -> Columns:
    """Return wrench and slope of a twist by integrals over the edges, ``w`` not zero;
    the slope is wrong without ``sloped``.

    Places R are from the centre of rotation c; u is J R / |R| for w > 0. With the
    outward normal n of an edge, its distance k and p = p_0 + q . r, the divergence
    theorem gives the integrals over the area

    - of |R|: a third of the sum of k int |R| ds,
    - of p |R|: a fourth of the sum of k int p |R| ds and of p(c) times the first,
    - of p R / |R|: the sum of n int p |R| ds, less q times the first,
    - of p R R^T / |R|^3: the sum of p(c) k int ds / |R| along t t^T and the like.
    """
    cx = -vy / w
    cy = vx / w
    level = plane[0] + plane[1] * cx + plane[2] * cy  # p(c)
    reach = 0.0  # sums over the edges: of k int |R| ds
    work = 0.0  # of k int p |R| ds
    gx = 0.0  # of n int p |R| ds
    gy = 0.0
    hx = 0.0  # of n int |R| ds
    hy = 0.0
    xx = 0.0  # of what p R R^T / |R|^3 has
    xy = 0.0
    yy = 0.0
    x = edges[0][0] - cx
    y = edges[1][0] - cy
    ra = np.sqrt(x * x + y * y)
    for x0, y0, tx, ty, length, middle, across, along in zip(  # noqa: B905
        edges[0],
        edges[1],
        edges[2],
        edges[3],
        edges[4],
        edges[5],
        edges[6],
        edges[7],
    ):
        x = x0 - cx
        y = y0 - cy
        k = ty * x - tx * y
        s = tx * x + ty * y + length
        rb = np.sqrt(k * k + s * s)
        ends = ra + rb
        rise = rb - ra
        ra = rb
        z = length / (ends + ON_EDGE * length)
        half_log = np.arctanh(z)  # of int ds / |R|
        # |R| is (ends + rise (s - s_m) / length) / 2 and a little, by which it sags
        slant = rise / length
        sag = (1.0 - slant * slant) * (1.0 - (1.0 / z - z) * half_log)
        line = 0.25 * length * ends * (2.0 - sag)
        # int (s - s_m) |R| ds
        first = rise * (rise * rise + 1.5 * sag * ends * ends)
        load = middle * line + along * first / 12.0
        reach = reach + k * line
        work = work + k * load
        gx = gx + ty * load
        gy = gy - tx * load
        if not sloped:
            continue
        hx = hx + ty * line
        hy = hy - tx * line
        turn = 2.0 * k * half_log
        nn = -across * k * turn
        nt = -(0.5 * level + across * k) * rise
        tt = level * turn - across * line - nn
        more = (tt - nn) * tx * tx + 2.0 * nt * tx * ty
        xx = xx + nn + more
        yy = yy + tt - more
        xy = xy + (tt - nn) * tx * ty + nt * (ty * ty - tx * tx)
    qx = plane[1]
    qy = plane[2]
    reach = reach / 3.0
    gx = gx - reach * qx
    gy = gy - reach * qy
    sign = np.copysign(1.0, w)
    fx = -sign * gy
    fy = sign * gx
    spin = 0.25 * sign * (work + level * reach)  # moment about the centre
    tau = spin + cx * fy - cy * fx
    power = w * spin
    if not sloped:
        return softened(power, fx, fy, tau, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    xx = (xx + 2.0 * qx * hx) / np.abs(w)
    xy = (xy + qx * hy + qy * hx) / np.abs(w)
    yy = (yy + 2.0 * qy * hy) / np.abs(w)
    # the centre stands still: a slope has no more than what moves it
    xw = xy * cx - xx * cy
    yw = yy * cx - xy * cy
    ww = yw * cx - xw * cy
    return softened(power, fx, fy, tau, xx, xy, xw, yy, yw, ww)


def far(series: Series, vx: Column, vy: Column, w: Column) -> Columns:
    """Return wrench and slope of a twist that turns little, v not zero.

    With v = V e and z = x + i y a point moves at V |1 + i (w / V) z / e|: the power is
    V (1 + sum of (w / V)^n b_n), where b_n depends on e alone.
    """
    speed = np.sqrt(vx * vx + vy * vy)
    ex = vx / speed
    ey = vy / speed
    q = w / speed
    g = ey + 1j * ex
    g2 = g * g
    g3 = g2 * g
    t20 = series[1] * g2
    t31 = series[2] * g
    t30 = series[3] * g3
    t42 = series[5] * g2
    t44 = series[6] * g2 * g2
    t51 = series[7] * g
    t53 = series[8] * g3
    t55 = series[9] * g3 * g2
    b2 = series[0].real + t20.real
    b3 = t31.real + t30.real
    b4 = series[4].real + t42.real + t44.real
    b5 = t51.real + t53.real + t55.real
    # derivatives by the angle of e, which g goes against
    c2 = 2.0 * t20.imag
    c3 = t31.imag + 3.0 * t30.imag
    c4 = 2.0 * t42.imag + 4.0 * t44.imag
    c5 = t51.imag + 3.0 * t53.imag + 5.0 * t55.imag
    d2 = -4.0 * t20.real
    d3 = -t31.real - 9.0 * t30.real
    qq = q * q
    ahead = 1.0 - qq * (b2 + q * (2.0 * b3 + q * (3.0 * b4 + q * 4.0 * b5)))
    aside = qq * (c2 + q * (c3 + q * (c4 + q * c5)))
    tau = q * (2.0 * b2 + q * (3.0 * b3 + q * (4.0 * b4 + q * 5.0 * b5)))
    fx = ex * ahead - ey * aside
    fy = ey * ahead + ex * aside
    ww = (2.0 * b2 + q * (6.0 * b3 + q * (12.0 * b4 + q * 20.0 * b5))) / speed
    nw = q * (2.0 * c2 + q * (3.0 * c3 + q * (4.0 * c4 + q * 5.0 * c5))) / speed
    nn = (ahead + qq * (d2 + q * d3)) / speed
    # along e by what the twist itself does not change
    ew = -q * ww
    en = -q * nw
    ee = -q * ew
    xx = ee * ex * ex - 2.0 * en * ex * ey + nn * ey * ey
    xy = (ee - nn) * ex * ey + en * (ex * ex - ey * ey)
    yy = ee * ey * ey + 2.0 * en * ex * ey + nn * ex * ex
    xw = ew * ex - nw * ey
    yw = ew * ey + nw * ex
    power = speed * ahead + w * tau
    return softened(power, fx, fy, tau, xx, xy, xw, yy, yw, ww)


def softened(
    power: Column,
    fx: Column,
    fy: Column,
    tau: Column,
    xx: Column,
    xy: Column,
    xw: Column,
    yy: Column,
    yw: Column,
    ww: Column,
) -> Columns:
    """Return wrench and slope of the power sqrt(P^2 + CREEP^2), whose friction falls to
    zero with the speed; the slope's entries are xx, xy, xw, yy, yw, ww.
    """
    soft = 1.0 / np.sqrt(power * power + CREEP * CREEP)
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
