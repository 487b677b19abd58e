"""Friction under a polygon with a linear pressure: the exact limit surface in closed
form, edge by edge.

Source: docs/mechanics.md, section 1.3. Twists and wrenches are those of the centre of
pressure, and so are places; friction is over mu_s N. One text serves NumPy's columns,
compiled loops and plain floats (``formulas.plain``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pushpressslide.core.formulas import Column, Columns, where
from pushpressslide.mechanics.balance import CREEP

# length of an edge over the way from end to end by the centre of rotation: no more, as
# the centre is on the edge there
ON_EDGE = 1.0 - 2.0**-53
SHORT = 0.1  # of that way: an edge as short is a series of seven terms
# distance of the centres of rotation and pressure below which its square is lost
TOGETHER = 1e-100
LEAST = 1e-300  # added to what may be zero, and is divided by
FASTEST = 1e200  # of the square of a twist, beyond which it is no number

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
    turn = w * w
    if not square + turn <= FASTEST:
        return unknown()
    if turn > plane[3] * plane[3] * square:
        return near(edges, plane, vx, vy, w, sloped)
    if square > 0.0:
        return far(series, vx, vy, w)
    return at_rest(plane)


def at_rest(plane: Plane) -> Columns:
    """Return no wrench, and the slope of a body that does not move."""
    stiff = 1.0 / CREEP
    return 0.0, 0.0, 0.0, stiff, 0.0, 0.0, stiff, 0.0, stiff * plane[4]


def unknown() -> Columns:
    """Return what a twist that is no number has."""
    nan = np.nan
    return nan, nan, nan, nan, nan, nan, nan, nan, nan


def near(
    edges: Edges, plane: Plane, vx: Column, vy: Column, w: Column, sloped: bool
) -> Columns:
    """Return wrench and slope of a twist by integrals over the edges, ``w`` not zero;
    the slope is wrong without ``sloped``.

    Places R are from the centre of rotation c; u is J R / |R| for w > 0. The unit vector
    e leads from the centre of pressure to c, and f = |R| + e . R, whose gradient is
    R / |R| + e, is small where c is far away. With the outward normal n of an edge, its
    distance k and p = p_0 + q . r, the divergence theorem gives the integrals over the
    area

    - of f: a third of the sum of k int f ds,
    - of p f: a fourth of the sum of k int p f ds and of p(c) times the first,
    - of p grad f: the sum of n int p f ds, less q times the first,
    - of p R R^T / |R|^3: the sum of p(c) k int ds / |R| along t t^T and the like.
    """
    cx = -vy / w
    cy = vx / w
    distance = np.sqrt(cx * cx + cy * cy)
    apart = distance > TOGETHER
    unit = where(apart, 1.0 / where(apart, distance, 1.0), 0.0)
    ex = cx * unit
    ey = cy * unit
    level = plane[0] + plane[1] * cx + plane[2] * cy  # p(c)
    reach = 0.0  # sums over the edges: of k int f ds
    work = 0.0  # of k int p f ds
    gx = 0.0  # of n int p f ds
    gy = 0.0
    hx = 0.0  # of n int |R| ds
    hy = 0.0
    xx = 0.0  # of what p R R^T / |R|^3 has
    xy = 0.0
    yy = 0.0
    x = edges[0][0]
    y = edges[1][0]
    ra = np.sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy))
    fa = beyond(ex * (x - cx) + ey * (y - cy), ex * y - ey * x, ra)
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
        # e . R and e x r at the second end
        ahead = ex * tx + ey * ty
        aside = ex * y0 - ey * x0 + length * (ex * ty - ey * tx)
        fb = beyond(ex * x + ey * y + length * ahead, aside, rb)
        ends = ra + rb
        ra = rb
        z = length / ends
        z = where(z < ON_EDGE, z, ON_EDGE)
        half_log = np.arctanh(z)  # of int ds / |R|
        u = z * z
        # 1 - (1 / z - z) artanh z is 2 z^2 (1 / 3 + tail)
        tail = where(
            z < SHORT,
            u
            * (
                1 / 15
                + u * (1 / 35 + u * (1 / 63 + u * (1 / 99 + u * (1 / 143 + u / 195))))
            ),
            (1.0 - (1.0 / z - z) * half_log) / (2.0 * u) - 1 / 3,
        )
        climb = fb - fa
        slant = climb / length - ahead  # of |R|, from end to end
        steep = 1.0 - slant * slant
        sag = length * z * steep * (1 / 3 + tail)
        line = 0.5 * length * (fa + fb - sag)
        fa = fb
        # int (s - s_m) f ds
        first = length * length * (climb + 3.0 * tail * steep * slant * length)
        load = middle * line + along * first / 12.0
        reach = reach + k * line
        work = work + k * load
        gx = gx + ty * load
        gy = gy - tx * load
        if not sloped:
            continue
        radial = 0.5 * length * (ends - sag)  # int |R| ds
        rise = slant * length
        hx = hx + ty * radial
        hy = hy - tx * radial
        turn = 2.0 * k * half_log
        nn = -across * k * turn
        nt = -(0.5 * level + across * k) * rise
        tt = level * turn - across * radial - nn
        more = (tt - nn) * tx * tx + 2.0 * nt * tx * ty
        xx = xx + nn + more
        yy = yy + tt - more
        xy = xy + (tt - nn) * tx * ty + nt * (ty * ty - tx * tx)
    qx = plane[1]
    qy = plane[2]
    reach = reach / 3.0
    gx = gx - reach * qx
    gy = gy - reach * qy
    over = 0.25 * (work + level * reach)  # int p f
    sign = np.copysign(1.0, w)
    fx = -sign * (gy - ey)
    fy = sign * (gx - ex)
    tau = sign * (over + cx * gx + cy * gy)
    power = np.abs(w) * (over + ex * cx + ey * cy)
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


def beyond(ahead: Column, aside: Column, distance: Column) -> Column:
    """Return |R| + e . R of a place R from its |R|, e . R and e x R, without cancellation
    where the two are opposite.
    """
    small = aside * aside / (distance + np.abs(ahead) + LEAST)
    return where(ahead < 0.0, small, distance + ahead)


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
