"""Two side contacts anywhere on the object: four force components for the three
components of a wrench (docs/mechanics.md, sections 5 and 6).

The forces are linear in the wrench until one reaches the edge of its cone. The squeeze
along the line of contacts is free. Each edge of a friction cone bounds it from above or
from below, and a wrench is feasible if and only if the bounds leave an interval.
"""

from __future__ import annotations

from math import copysign, inf, isfinite, nan

from pushpressslide.kernels.allocation import (
    EXACT,
    GIVEN,
    INFEASIBLE,
    OK,
    PROJECTED,
    Two,
    Vector,
    Wrench,
)
from pushpressslide.kernels.contact_line import Line, contact_line, line_parts
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.wrench_cone import Cone, Points, nearest_parts, wrench_cone

ELSEWHERE = 3  # status of a wrench outside of the cone that the caller moves itself
ALONG = 1e-9  # sine below which the side of a cone counts as along the line of contacts

Four = tuple[float, float, float, float]
Linear = tuple[
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
]
"""Coefficients of the linear split.

The members are the x component of contact 1's force per fx, fy and tau; its y component
likewise; the normals x, y of contacts 1 and 2; the friction; and the caps [N]. Without
friction the caps are minus infinity, which leaves every wrench to ``nearest_forces``.
"""
Sides = tuple[Vector, Vector, Four, Four]
"""Sides of the friction cones.

The members are the unit vector from contact 1 to 2; its component along either normal;
the change, per force along this vector, of the slacks mu f_n - f_t and mu f_n + f_t of
contact 1, then of contact 2, none of them zero; and minus the inverse of each.
"""
Place = tuple[Points, float, Vector, float]
"""Points [m], rho [m], caps [N], and a number that is > 0 if wrenches outside the cone
are left to the caller.
"""
Rest = tuple[Sides, Place, tuple[Line, Wrench], Cone]
"""Sides, points and cone of two contacts, and their line with the shares of F.e, g_1
and g_2 in contact 1's force.
"""


@kernel
def two_contact_figures(
    points: Points,
    normals: Points,
    frictions: Vector,
    caps: Vector,
    choices: Vector,
) -> tuple[Linear, Rest]:
    """Parameters of ``two_contacts``. ``frictions`` are friction and rho [m].

    If ``choices`` are > 0, the first selects the split with the smallest friction, and
    the second leaves wrenches outside the cone to the caller.
    """
    friction, rho = frictions
    line = contact_line(points[0], points[1])
    split = (line, split_shares(line, normals, choices[0]))
    x_fx, y_fx = first_force(1.0, 0.0, 0.0, split)
    x_fy, y_fy = first_force(0.0, 1.0, 0.0, split)
    x_tau, y_tau = first_force(0.0, 0.0, 1.0, split)
    (n1x, n1y), (n2x, n2y) = normals
    low, high = caps if friction > 0.0 else (-inf, -inf)
    linear = (
        x_fx,
        x_fy,
        x_tau,
        y_fx,
        y_fy,
        y_tau,
        n1x,
        n1y,
        n2x,
        n2y,
        friction,
        low,
        high,
    )
    place = (points, rho, caps, choices[1])
    cone = wrench_cone(points, normals, friction, rho)
    return linear, (cone_sides(line, normals, friction), place, split, cone)


@kernel
def in_axes(line: Line, v: Vector) -> Vector:
    """Components of a vector along the line of contacts and to its left."""
    ex, ey, _, _, _ = line
    return ex * v[0] + ey * v[1], ex * v[1] - ey * v[0]


@kernel
def split_shares(line: Line, normals: Points, least_friction: float) -> Wrench:
    """Shares of F.e, g_1 and g_2 in contact 1's force along the line."""
    n1e, n1m = in_axes(line, normals[0])
    n2e, n2m = in_axes(line, normals[1])
    squares = n1m * n1m + n2m * n2m
    if least_friction > 0.0 and squares > 0.0:
        return n2m * n2m / squares, n1m * n1e / squares, -n2m * n2e / squares
    return 0.5, 0.0, 0.0


@kernel
def cone_sides(line: Line, normals: Points, friction: float) -> Sides:
    """Bounds that the sides of both cones set on a force along the line."""
    n1e, n1m = in_axes(line, normals[0])
    n2e, n2m = in_axes(line, normals[1])
    a1, a2 = nonzero_slopes(friction * n1e + n1m, friction * n1e - n1m)
    a3, a4 = nonzero_slopes(-friction * n2e - n2m, -friction * n2e + n2m)
    inverse = (against(a1), against(a2), against(a3), against(a4))
    return (line[0], line[1]), (n1e, n2e), (a1, a2, a3, a4), inverse


@kernel
def nonzero_slopes(a: float, b: float) -> Vector:
    """Slopes of a cone's sides, none of them zero.

    A side parallel to the line of contacts bounds nothing if its slack is >= 0, and
    otherwise excludes every force. It is represented by a distant bound, in the
    direction opposite to that of the other side.
    """
    if abs(a) < ALONG:
        return copysign(ALONG, -b), b
    return a, b if abs(b) > ALONG else copysign(ALONG, -a)


@kernel
def against(slope: float) -> float:
    """Negative inverse of a slope. Zero for a zero slope, which occurs only in a cone
    of zero width.
    """
    return -1.0 / slope if slope != 0.0 else 0.0


@kernel
def first_force(fx: float, fy: float, tau: float, split: tuple[Line, Wrench]) -> Vector:
    """Force [N] of contact 1, in B, by the chosen split."""
    line, (a, b, c) = split
    ex, ey, _, _, _ = line
    along, g1, g2 = line_parts(fx, fy, tau, line, (0.0, 0.0))
    s = a * along + b * g1 + c * g2
    return ex * s - ey * g1, ey * s + ex * g1


@kernel
def two_contacts(fx: float, fy: float, tau: float, linear: Linear, rest: Rest) -> Two:
    """Allocation of a wrench [N, N m] about B's origin to two side contacts."""
    x_fx, x_fy, x_tau, y_fx, y_fy, y_tau, n1x, n1y, n2x, n2y, mu, cap1, cap2 = linear
    f1x = x_fx * fx + x_fy * fy + x_tau * tau
    f1y = y_fx * fx + y_fy * fy + y_tau * tau
    f2x = fx - f1x
    f2y = fy - f1y
    f1n = n1x * f1x + n1y * f1y
    f2n = n2x * f2x + n2y * f2y
    f1t = n1x * f1y - n1y * f1x
    f2t = n2x * f2y - n2y * f2x
    margin = mu * f1n - (f1t if f1t > 0.0 else -f1t)
    margin2 = mu * f2n - (f2t if f2t > 0.0 else -f2t)
    if margin2 < margin:
        margin = margin2
    if margin >= 0.0 and f1n <= cap1 and f2n <= cap2:
        return ((f1x, f1y), (f2x, f2y)), (f1n, f2n), margin, OK, EXACT
    if mu == 0.0:
        # a cone without width: every wrench is one that has to be moved onto it
        return outside((fx, fy, tau), linear, rest)
    forces = ((f1x, f1y), (f2x, f2y))
    pushes = (mu * f1n, mu * f2n, f1n, f2n)
    return projected((fx, fy, tau), forces, pushes, (f1t, f2t), linear, rest)


@kernel
def projected(
    wrench: Wrench,
    forces: Points,
    pushes: Four,
    slides: Vector,
    linear: Linear,
    rest: Rest,
) -> Two:
    """Allocation of a wrench whose wanted ``forces`` [N] exceed a cone or a cap.

    The forces are shifted along the line of contacts as little as the cones require.
    ``pushes`` [N] are mu f_n of both contacts, then f_n of both; ``slides`` [N] are
    their f_t.
    """
    most1, most2, f1n, f2n = pushes
    if not isfinite(most1 + most2):
        return outside(wrench, linear, rest)
    (ex, ey), (n1e, n2e), _, (k1, k2, k3, k4) = rest[0]
    f1t, f2t = slides
    # q + a d >= 0 bounds d by -q / a: from below where a > 0, and so -1 / a < 0
    low, high = within(-inf, inf, k1 * (most1 - f1t), k1)
    low, high = within(low, high, k2 * (most1 + f1t), k2)
    low, high = within(low, high, k3 * (most2 - f2t), k3)
    low, high = within(low, high, k4 * (most2 + f2t), k4)
    if not low <= high:
        return outside(wrench, linear, rest)
    d = low
    if low <= 0.0:
        d = high if high < 0.0 else 0.0
    f1n = f1n + d * n1e
    f2n = f2n - d * n2e
    if not (f1n <= linear[11] and f2n <= linear[12]):
        return capped(wrench, linear, rest)
    (f1x, f1y), (f2x, f2y) = forces
    dx = d * ex
    dy = d * ey
    return ((f1x + dx, f1y + dy), (f2x - dx, f2y - dy)), (f1n, f2n), 0.0, OK, EXACT


@kernel
def within(low: float, high: float, d: float, k: float) -> Vector:
    """Part of an interval on one side of ``d``: above it for k < 0, otherwise below."""
    if k < 0.0:
        return (d if d > low else low), high
    return low, (d if d < high else high)


@kernel
def capped(wrench: Wrench, linear: Linear, rest: Rest) -> Two:
    """Allocation of a wrench in the cone whose usual split exceeds a cap on a normal
    force.

    The force along the line of contacts is split differently. If no split inside both
    cones respects the caps, the wrench is scaled down.
    """
    fx, fy, tau = wrench
    sides, (_, _, caps, _), split, _ = rest
    (ex, ey), (n1e, n2e), (a1, a2, a3, a4), _ = sides
    f1x, f1y = first_force(fx, fy, tau, split)
    f2x = fx - f1x
    f2y = fy - f1y
    _, _, _, _, _, _, n1x, n1y, n2x, n2y, mu, cap1, cap2 = linear
    f1n = f1x * n1x + f1y * n1y
    f2n = f2x * n2x + f2y * n2y
    f1t = n1x * f1y - n1y * f1x
    f2t = n2x * f2y - n2y * f2x
    low, high = bounded(-inf, inf, mu * f1n - f1t, a1)
    low, high = bounded(low, high, mu * f1n + f1t, a2)
    low, high = bounded(low, high, mu * f2n - f2t, a3)
    low, high = bounded(low, high, mu * f2n + f2t, a4)
    lower, upper = bounded(-inf, inf, cap1 - f1n, -n1e)
    lower, upper = bounded(lower, upper, cap2 - f2n, n2e)
    lower = max(lower, low)
    upper = min(upper, high)
    d = min(max(0.0, lower), upper)
    scale = 1.0
    if not lower <= upper:
        d, scale = best_scaled((low, high), (f1n, f2n), (n1e, n2e), caps)
    forces = ((f1x + d * ex, f1y + d * ey), (f2x - d * ex, f2y - d * ey))
    return allocation_of(wrench, forces, scale, linear, rest)


@kernel
def bounded(low: float, high: float, slack: float, slope: float) -> Vector:
    """Part of an interval of d in which slack + slope d >= 0. If there is none, the
    lower end of the result is above its upper end.
    """
    if slope > 0.0:
        return max(low, -slack / slope), high
    if slope < 0.0:
        return low, min(high, -slack / slope)
    if slack < 0.0:
        return inf, -inf
    return low, high


@kernel
def best_scaled(
    interval: Vector, pushes: Vector, alongs: Vector, caps: Vector
) -> Vector:
    """Force d [N] along the line of contacts, in ``interval``, with which the largest
    fraction of the wrench respects the caps, and this fraction.

    ``pushes`` are the normal forces [N] at d = 0, ``alongs`` the components of the
    line's direction along the normals.
    """
    low, high = interval
    f1n, f2n = pushes
    n1e, n2e = alongs
    rate = caps[0] * n2e + caps[1] * n1e
    both = (caps[0] * f2n - caps[1] * f1n) / rate if rate != 0.0 else nan
    best = 0.0
    largest = -inf
    for d in (low, high, min(max(both, low), high)):
        part = kept_part(f1n + d * n1e, f2n - d * n2e, caps)
        if isfinite(d) and part > largest:
            best = d
            largest = part
    return best, kept_part(f1n + best * n1e, f2n - best * n2e, caps)


@kernel
def kept_part(f1n: float, f2n: float, caps: Vector) -> float:
    """Largest factor, at most 1, by which two normal forces [N] can be scaled to keep
    the caps.
    """
    part = caps[0] / f1n if f1n > caps[0] else 1.0
    return min(part, caps[1] / f2n) if f2n > caps[1] else part


@kernel
def outside(wrench: Wrench, linear: Linear, rest: Rest) -> Two:
    """Allocation of the cone's nearest wrench, unless the caller projects the wrench
    itself.
    """
    if rest[1][3] > 0.0:
        none = ((0.0, 0.0), (0.0, 0.0))
        return none, (0.0, 0.0), 0.0, ELSEWHERE, wrench
    return nearest_forces(wrench, wrench, linear, rest)


@kernel
def nearest_forces(wanted: Wrench, aim: Wrench, linear: Linear, rest: Rest) -> Two:
    """Allocation of the cone's wrench nearest to ``aim``."""
    fx, fy, tau = wanted
    if not abs(fx) + abs(fy) + abs(tau) < inf:
        return ((0.0, 0.0), (0.0, 0.0)), (0.0, 0.0), 0.0, INFEASIBLE, wanted
    _, (_, rho, caps, _), _, cone = rest
    k1, k2, k3, k4 = nearest_parts(aim[0], aim[1], aim[2] / rho, cone)
    a, b, c, d = cone[0]
    first = (k1 * a[0] + k2 * b[0], k1 * a[1] + k2 * b[1])
    second = (k3 * c[0] + k4 * d[0], k3 * c[1] + k4 * d[1])
    scale = kept_part(k1 + k2, k3 + k4, caps)
    return allocation_of(wanted, (first, second), scale, linear, rest)


@kernel
def allocation_of(
    wanted: Wrench, forces: Points, scale: float, linear: Linear, rest: Rest
) -> Two:
    """Allocation of ``scale`` times two forces, compared with the wanted wrench."""
    (f1x, f1y), (f2x, f2y) = forces
    f1x = scale * f1x
    f1y = scale * f1y
    f2x = scale * f2x
    f2y = scale * f2y
    fx, fy, tau = wanted
    ((p1x, p1y), (p2x, p2y)), rho, _, _ = rest[1]
    rx = fx - f1x - f2x
    ry = fy - f1y - f2y
    rt = tau - (p1x * f1y - p1y * f1x) - (p2x * f2y - p2y * f2x)
    size = abs(fx) + abs(fy) + abs(tau) / rho
    error = abs(rx) + abs(ry) + abs(rt) / rho
    _, _, _, _, _, _, n1x, n1y, n2x, n2y, mu, _, _ = linear
    f1n = n1x * f1x + n1y * f1y
    f2n = n2x * f2x + n2y * f2y
    margin = min(
        mu * (f1x * n1x + f1y * n1y) - abs(n1x * f1y - n1y * f1x),
        mu * (f2x * n2x + f2y * n2y) - abs(n2x * f2y - n2y * f2x),
    )
    status = OK if error <= GIVEN * size < inf else PROJECTED
    if status == PROJECTED and f1x == 0.0 and f1y == 0.0 and f2x == 0.0 and f2y == 0.0:
        status = INFEASIBLE
    return ((f1x, f1y), (f2x, f2y)), (f1n, f2n), margin, status, (rx, ry, rt)
