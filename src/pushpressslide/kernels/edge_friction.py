"""Friction under a polygon with a linear pressure: the exact limit surface in closed
form, edge by edge (docs/mechanics.md, section 1.3).

Twists, wrenches and positions refer to the centre of pressure. Friction is divided by
mu_s N.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atanh, copysign, nan, sqrt

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.support_friction import (
    STILL,
    Friction,
    Slope,
    softened,
)

# length of an edge over the way from end to end by the centre of rotation: no more, as
# the centre is on the edge there
ON_EDGE = 1.0 - 2.0**-53
# share of that path below which an edge is evaluated by a series of seven terms
SHORT = 0.1
# distance of the centres of rotation and pressure below which its square is lost
TOGETHER = 1e-100
LEAST = 1e-300  # added to what may be zero, and is divided by
FASTEST = 1e200  # largest square of a twist that is a number
UNKNOWN = (nan, nan, nan, nan, nan, nan, nan, nan, nan)
NO_SLOPE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

Edges = Sequence[Sequence[float]]
"""Eight rows with one number per edge, in order round the polygon.

The rows are x and y of the edge's first corner; its unit vector (tx, ty), with (ty,
-tx) outwards; its length; the pressure at its middle; and the pressure's slope outwards
and along the edge.
"""
Edge = tuple[float, float, float, float, float, float, float, float]
"""One column of ``Edges``."""
Plane = tuple[float, float, float, float, float]
"""Coefficients p, q_x, q_y of the pressure p + q . r for unit load; the ratio of turn
rate to speed below which the series is valid; and the square of rho.
"""
Series = Sequence[complex]
"""Ten complex coefficients, from ``mechanics.face_pressure.series``."""
Center = tuple[float, float, float, float, float]
"""The centre of rotation c: position x, y, unit vector e towards c, and pressure p(c).
"""
Forces = tuple[float, float, float, float]
"""Sums over the edges, in the notation of ``near``: k int f ds, k int p f ds, and n int
p f ds.
"""
Stretches = tuple[float, float, float, float, float]
"""Sums over the edges, in the notation of ``near``: n int |R| ds, and the components
xx, xy, yy of the integral of p R R^T / |R|^3.
"""
Side = tuple[float, float, float, float, float]
"""Terms of one edge, in the notation of ``near``: k; half the logarithm in int ds /
|R|; the increase of |R| along the edge; int |R| ds; and p(c).
"""


@kernel
def polygon_friction(
    vx: float,
    vy: float,
    w: float,
    plane: Plane,
    edges: Edges,
    series: Series,
    sloped: bool = True,
) -> Friction:
    """Wrench and slope of a twist. The slope is valid only with ``sloped``."""
    square = vx * vx + vy * vy
    turn = w * w
    if not square + turn <= FASTEST:
        return UNKNOWN
    if turn > plane[3] * plane[3] * square:
        return near(vx, vy, w, plane, edges, sloped)
    if square > 0.0:
        return far_center_friction(vx, vy, w, series)
    return 0.0, 0.0, 0.0, STILL, 0.0, 0.0, STILL, 0.0, STILL * plane[4]


@kernel
def near(
    vx: float, vy: float, w: float, plane: Plane, edges: Edges, sloped: bool = True
) -> Friction:
    """Wrench and slope of a twist by integrals over the edges, for ``w`` not zero. The
    slope is valid only with ``sloped``.

    Positions R are relative to the centre of rotation c; the direction of motion is u =
    J R / |R| for w > 0. The unit vector e leads from the centre of pressure to c, and f
    = |R| + e . R, whose gradient is R / |R| + e, is small where c is far away. With the
    outward normal n of an edge, its distance k and p = p_0 + q . r, the divergence
    theorem gives the integrals over the area

    - of f: a third of the sum of k int f ds,
    - of p f: a fourth of the sum of k int p f ds and of p(c) times the first,
    - of p grad f: the sum of n int p f ds, less q times the first,
    - of p R R^T / |R|^3: the sum of p(c) k int ds / |R| along t t^T and the like.
    """
    center = center_of_rotation(vx, vy, w, plane)
    cx, cy, ex, ey, level = center
    (reach, work, gx, gy), stretches = over_edges(edges, center, sloped)
    reach = reach / 3.0
    gx = gx - reach * plane[1]
    gy = gy - reach * plane[2]
    over = 0.25 * (work + level * reach)  # int p f
    sign = copysign(1.0, w)
    wrench = (-sign * (gy - ey), sign * (gx - ex), sign * (over + cx * gx + cy * gy))
    power = abs(w) * (over + ex * cx + ey * cy)
    slope = turning_slope(abs(w), center, plane, stretches) if sloped else NO_SLOPE
    return softened(power, wrench, slope)


@kernel
def center_of_rotation(vx: float, vy: float, w: float, plane: Plane) -> Center:
    """Instantaneous centre of rotation of a turning body."""
    cx = -vy / w
    cy = vx / w
    distance = sqrt(cx * cx + cy * cy)
    unit = 1.0 / distance if distance > TOGETHER else 0.0
    level = plane[0] + plane[1] * cx + plane[2] * cy
    return cx, cy, cx * unit, cy * unit, level


@kernel
def over_edges(edges: Edges, center: Center, sloped: bool) -> tuple[Forces, Stretches]:
    """Sums over the edges. Unless ``sloped``, the sums for the slope are zero."""
    reach = 0.0
    work = 0.0
    gx = 0.0
    gy = 0.0
    stretches = (0.0, 0.0, 0.0, 0.0, 0.0)
    ra, fa = first_end(edges[0][0], edges[1][0], center)
    for edge in zip(  # noqa: B905
        edges[0], edges[1], edges[2], edges[3], edges[4], edges[5], edges[6], edges[7]
    ):
        _, _, tx, ty, length, middle, _, along = edge
        k, ahead, rb, fb = second_end(edge, center)
        ends = ra + rb
        ra = rb
        z = length / ends
        z = z if z < ON_EDGE else ON_EDGE
        half_log = atanh(z)  # of int ds / |R|
        tail = bulge(z, half_log)
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
        if sloped:
            radial = 0.5 * length * (ends - sag)
            side = (k, half_log, slant * length, radial, center[4])
            stretches = stretched(stretches, edge, side)
    return (reach, work, gx, gy), stretches


@kernel
def first_end(x: float, y: float, center: Center) -> Vector:
    """|R| and f at a corner, in the notation of ``near``."""
    cx, cy, ex, ey, _ = center
    ra = sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy))
    return ra, beyond(ex * (x - cx) + ey * (y - cy), ex * y - ey * x, ra)


@kernel
def second_end(edge: Edge, center: Center) -> tuple[float, float, float, float]:
    """Distance k of an edge, component of e along it, and |R| and f at its second end,
    in the notation of ``near``.
    """
    x0, y0, tx, ty, length, _, _, _ = edge
    cx, cy, ex, ey, _ = center
    x = x0 - cx
    y = y0 - cy
    k = ty * x - tx * y
    s = tx * x + ty * y + length
    rb = sqrt(k * k + s * s)
    # e . R and e x r at the second end
    ahead = ex * tx + ey * ty
    aside = ex * y0 - ey * x0 + length * (ex * ty - ey * tx)
    return k, ahead, rb, beyond(ex * x + ey * y + length * ahead, aside, rb)


@kernel
def beyond(ahead: float, aside: float, distance: float) -> float:
    """The sum |R| + e . R, from ``distance`` |R|, ``ahead`` e . R and ``aside`` e x R.

    The terms do not cancel if R is opposite to e.
    """
    if ahead < 0.0:
        return aside * aside / (distance + abs(ahead) + LEAST)
    return distance + ahead


@kernel
def bulge(z: float, half_log: float) -> float:
    """Value ``tail`` in 1 - (1 / z - z) artanh z = 2 z^2 (1 / 3 + tail)."""
    u = z * z
    if z < SHORT:
        rest = 1 / 63 + u * (1 / 99 + u * (1 / 143 + u / 195))
        return u * (1 / 15 + u * (1 / 35 + u * rest))
    return (1.0 - (1.0 / z - z) * half_log) / (2.0 * u) - 1 / 3


@kernel
def stretched(sums: Stretches, edge: Edge, side: Side) -> Stretches:
    """The sums with the terms of one edge added."""
    hx, hy, xx, xy, yy = sums
    _, _, tx, ty, _, _, across, _ = edge
    k, half_log, rise, radial, level = side
    turn = 2.0 * k * half_log
    nn = -across * k * turn
    nt = -(0.5 * level + across * k) * rise
    tt = level * turn - across * radial - nn
    more = (tt - nn) * tx * tx + 2.0 * nt * tx * ty
    xx = xx + nn + more
    yy = yy + tt - more
    xy = xy + (tt - nn) * tx * ty + nt * (ty * ty - tx * tx)
    return hx + ty * radial, hy - tx * radial, xx, xy, yy


@kernel
def turning_slope(
    rate: float, center: Center, plane: Plane, stretches: Stretches
) -> Slope:
    """Slope for a turn with ``rate`` > 0. Only the displacement of the centre of
    rotation contributes, because its velocity is zero.
    """
    cx = center[0]
    cy = center[1]
    hx, hy, xx, xy, yy = stretches
    qx = plane[1]
    qy = plane[2]
    xx = (xx + 2.0 * qx * hx) / rate
    xy = (xy + qx * hy + qy * hx) / rate
    yy = (yy + 2.0 * qy * hy) / rate
    xw = xy * cx - xx * cy
    yw = yy * cx - xy * cy
    return xx, xy, xw, yy, yw, yw * cx - xw * cy


@kernel
def far_center_friction(vx: float, vy: float, w: float, series: Series) -> Friction:
    """Wrench and slope of a twist with little rotation, v not zero.

    With v = V e and z = x + i y a point moves at V |1 + i (w / V) z / e|: the power is
    V (1 + sum of (w / V)^n b_n), where b_n depends on e alone.
    """
    speed = sqrt(vx * vx + vy * vy)
    ex = vx / speed
    ey = vy / speed
    q = w / speed
    (b2, b3, b4, b5), (c2, c3, c4, c5), (d2, d3) = waves(ex, ey, series)
    qq = q * q
    ahead = 1.0 - qq * (b2 + q * (2.0 * b3 + q * (3.0 * b4 + q * 4.0 * b5)))
    aside = qq * (c2 + q * (c3 + q * (c4 + q * c5)))
    tau = q * (2.0 * b2 + q * (3.0 * b3 + q * (4.0 * b4 + q * 5.0 * b5)))
    wrench = (ex * ahead - ey * aside, ey * ahead + ex * aside, tau)
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
    return softened(speed * ahead + w * tau, wrench, (xx, xy, xw, yy, yw, ww))


@kernel
def waves(
    ex: float, ey: float, series: Series
) -> tuple[
    tuple[float, float, float, float], tuple[float, float, float, float], Vector
]:
    """The coefficients b_2 to b_5 of ``far_center_friction`` for a direction e, with
    derivatives.

    The derivatives are with respect to the angle of e: the first of all four
    coefficients, and the second of b_2 and b_3. The phase of g decreases with the
    angle.
    """
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
    values = (
        series[0].real + t20.real,
        t31.real + t30.real,
        series[4].real + t42.real + t44.real,
        t51.real + t53.real + t55.real,
    )
    slopes = (
        2.0 * t20.imag,
        t31.imag + 3.0 * t30.imag,
        2.0 * t42.imag + 4.0 * t44.imag,
        t51.imag + 3.0 * t53.imag + 5.0 * t55.imag,
    )
    return values, slopes, (-4.0 * t20.real, -t31.real - 9.0 * t30.real)
