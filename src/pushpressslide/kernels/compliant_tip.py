"""Contact of a massless, compliant tip: its force on the body as a function of the
body's twist.

The tip's own law is f = f_0 - B v, B > 0 along two axes of the plane. It combines a
force, a spring evaluated at the end of the tick, and a damper. Each contact's force is
thus an explicit function of the velocity of the tip's centre as carried by the body. No
iteration between stick, slip and separation is needed (docs/mechanics.md, section 3).
Everything is in frame B, with positions relative to the centre of pressure.
"""

from __future__ import annotations

from math import copysign, hypot

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.kernel import kernel

STICK = 0
SLIP_LEFT = 1
SLIP_RIGHT = 2
FREE = 3
SLIP = 4
PULL = 5

ENTERING = 1e-9  # [m/s] into a wall, that is rounding
PARALLEL = 1e-3  # sine of the angle between two walls below which they are parallel
# excess over the limit at which a contact slips, as a share of the limit
ON_RIM = 1e-12
SLIP_STEPS = 30  # one for equal dampings

Law = tuple[Vector, Vector, Vector]
"""Law f = f_0 - B v of a tip: a unit axis, then the components of f_0 [N] and B [N s/m]
along this axis and to its left.
"""
Side = tuple[Vector, Vector, Law, float, float]
"""A tip at a side face.

Its members are the point of the face [m]; the centre of the tip [m], which turns with
the body, so that the tip does not roll along the face; the tip's law, with the inward
normal as its axis; the friction of the pair tip/body; and the gap divided by the tick:
the speed [m/s] at which the tip may approach the face.
"""
Slope = tuple[float, float, float, float]
"""Decrease of a force per velocity of the tip's centre [N s/m]: xx, xy, yx, yy."""
Touch = tuple[Vector, Slope, int, Vector, Vector]
"""Force on the body [N], its slope, the contact's status, the point of action [m], and
the centre of the tip [m].
"""
NONE = (0.0, 0.0)
LEVEL = (0.0, 0.0, 0.0, 0.0)


@kernel
def side_contact(
    tip: Vector, radius: float, gap: float, law: Law, friction: float, dt: float
) -> Side:
    """Contact of a tip with its centre at ``tip`` [m], a distance ``gap`` [m] before a
    side, in a tick of ``dt`` [s].

    The axis of the law is the side's inward normal.
    """
    nx, ny = law[0]
    out = gap + radius
    point = (tip[0] + out * nx, tip[1] + out * ny)
    center = (tip[0] + gap * nx, tip[1] + gap * ny)
    return point, center, law, friction, gap / dt


@kernel
def tip_velocity(force: Vector, law: Law) -> Vector:
    """Velocity [m/s] of a tip that exerts ``force`` [N], both in B."""
    (ax, ay), (f1, f2), (d1, d2) = law
    v1 = (f1 - (ax * force[0] + ay * force[1])) / d1
    v2 = (f2 - (ax * force[1] - ay * force[0])) / d2
    return ax * v1 - ay * v2, ay * v1 + ax * v2


@kernel
def side_touch(vx: float, vy: float, w: float, contact: Side) -> Touch:
    """Force, slope and status of a tip at a side under a body's twist.

    The normal force prevents penetration, or is zero (complementarity). Friction holds
    the tip on the face, up to the edge of the cone.
    """
    point, center, law, friction, approach = contact
    axis, (fn, ft), (bn, bt) = law
    nx, ny = axis
    vx = vx - w * center[1]
    vy = vy + w * center[0]
    fn = fn - bn * (nx * vx + ny * vy + approach)
    if not fn > 0.0:
        return NONE, LEVEL, FREE, point, center
    ft = ft - bt * (nx * vy - ny * vx)
    edge = friction * fn
    if -edge <= ft <= edge:
        force = (nx * fn - ny * ft, ny * fn + nx * ft)
        return force, turned(axis, bn, 0.0, bt), STICK, point, center
    mu = copysign(friction, ft)
    ex = nx - mu * ny
    ey = ny + mu * nx
    slope = (bn * ex * nx, bn * ex * ny, bn * ey * nx, bn * ey * ny)
    status = SLIP_LEFT if ft > 0.0 else SLIP_RIGHT
    return (fn * ex, fn * ey), slope, status, point, center


@kernel
def wedged_touch(vx: float, vy: float, w: float, own: Side, wall: Side) -> Touch:
    """Force, slope and status of a tip in a notch, between its ``own`` side and the
    other ``wall``.

    The tip touches only one of the two if this contact also keeps it out of the other.
    Otherwise the tip sticks between them, and its force is assumed to act at its
    centre.
    """
    center = own[1]
    force, slope, status, _, _ = side_touch(vx, vy, w, own)
    if not enters(vx, vy, w, own, wall, force):
        return force, slope, status, center, center
    force, slope, status, _, _ = side_touch(vx, vy, w, wall)
    if not enters(vx, vy, w, wall, own, force):
        return force, slope, status, center, center
    force, slope, status = stuck_between(vx, vy, w, own, wall)
    return force, slope, status, center, center


@kernel
def stuck_between(
    vx: float, vy: float, w: float, own: Side, wall: Side
) -> tuple[Vector, Slope, int]:
    """Force, slope and status of a tip that closes both gaps and moves with the body."""
    _, center, law, _, a = own
    axis, (fn, ft), (bn, bt) = law
    ax, ay = axis
    bx, by = wall[2][0]
    b = wall[4]
    size = ax * by - ay * bx
    if abs(size) < PARALLEL:
        force, slope, status, _, _ = side_touch(vx, vy, w, own)
        return force, slope, status
    vx = vx - w * center[1] + (a * by - b * ay) / size
    vy = vy + w * center[0] + (b * ax - a * bx) / size
    fn = fn - bn * (ax * vx + ay * vy)
    ft = ft - bt * (ax * vy - ay * vx)
    force = (ax * fn - ay * ft, ay * fn + ax * ft)
    return force, turned(axis, bn, 0.0, bt), STICK


@kernel
def enters(
    vx: float, vy: float, w: float, touched: Side, other: Side, force: Vector
) -> bool:
    """Whether a tip that touches one side would penetrate the ``other`` one."""
    ux, uy = tip_velocity(force, touched[2])
    cx, cy = touched[1]
    nx, ny = other[2][0]
    into = nx * (ux - vx + w * cy) + ny * (uy - vy - w * cx)
    return into > other[4] + ENTERING


@kernel
def press_touch(
    vx: float, vy: float, w: float, point: Vector, law: Law, limit: float
) -> Touch:
    """Force, slope and status of a tip pressed on the top face at ``point`` [m].

    The tip sticks, or slips with a friction force of ``limit`` [N].
    """
    axis, (f1, f2), (d1, d2) = law
    ax, ay = axis
    vx = vx - w * point[1]
    vy = vy + w * point[0]
    f1 = f1 - d1 * (ax * vx + ay * vy)
    f2 = f2 - d2 * (ax * vy - ay * vx)
    if hypot(f1, f2) <= limit:
        force = (ax * f1 - ay * f2, ay * f1 + ax * f2)
        return force, turned(axis, d1, 0.0, d2), STICK, point, point
    f1, f2, per_force = sliding_force((f1, f2), (d1, d2), limit)
    t1 = -f2 / limit
    t2 = f1 / limit  # the force can only turn
    k = 1.0 / (per_force + t1 * t1 / d1 + t2 * t2 / d2)
    force = (ax * f1 - ay * f2, ay * f1 + ax * f2)
    slope = turned(axis, k * t1 * t1, k * t1 * t2, k * t2 * t2)
    return force, slope, SLIP, point, point


@kernel
def turned(axis: Vector, s11: float, s12: float, s22: float) -> Slope:
    """Components xx, xy, yx, yy in B of a symmetric matrix given along ``axis`` and to
    its left.
    """
    if s11 == s22 and s12 == 0.0:
        return s11, 0.0, 0.0, s11
    x, y = axis
    xy = x * y * (s11 - s22) + (x * x - y * y) * s12
    return (
        x * x * s11 - 2.0 * x * y * s12 + y * y * s22,
        xy,
        xy,
        y * y * s11 + 2.0 * x * y * s12 + x * x * s22,
    )


@kernel
def sliding_force(
    holding: Vector, damping: Vector, limit: float
) -> tuple[float, float, float]:
    """Friction force f of size ``limit`` along the slip that it leaves, and slip per
    force m [m/(N s)].

    ``holding`` is the force that would prevent the slip s. From D s = holding - f and s
    = m f follows f_i = holding_i / (1 + d_i m). Since 1/|f| is concave in m, Newton
    steps from m = 0 do not overshoot.
    """
    m = 0.0
    f1, f2 = holding
    for _ in range(SLIP_STEPS):
        f1 = holding[0] / (1.0 + damping[0] * m)
        f2 = holding[1] / (1.0 + damping[1] * m)
        size = hypot(f1, f2)
        if size <= limit * (1.0 + ON_RIM):
            break
        fall = f1 * f1 * damping[0] / (1.0 + damping[0] * m) + f2 * f2 * damping[1] / (
            1.0 + damping[1] * m
        )
        m += (size / limit - 1.0) * size * size / fall
    return f1, f2, m
