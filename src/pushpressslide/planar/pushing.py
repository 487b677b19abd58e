"""One quasi-static step of an object pushed by one point: stick, slip, separation (docs/mechanics.md,
sections 2 and 3).

Two ways of pushing: a prescribed contact velocity, and a compliant tip whose force falls with its speed, f =
f_0 - B v_tip, which is what a force plus a velocity servo does. Everything in one planar frame, the body
frame B; r is the contact relative to the CoP. Plain floats.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Twist

ContactStatus = Literal["free", "rest", "stick", "slip_left", "slip_right"]


@dataclass(frozen=True, slots=True)
class PushOutcome:
    """What happens to object and tip in this instant."""

    status: ContactStatus
    force: Point  # [N] on the object
    twist: Twist  # of the object's point at the CoP
    tip_velocity: Point  # [m/s]


def _mobility(r: Point, rho: float) -> tuple[float, float, float]:
    """G = I + (J r)(J r)^T / rho^2 as (xx, xy, yy): contact velocity = alpha G f."""
    k = 1.0 / (rho * rho)
    return 1.0 + r[1] * r[1] * k, -r[0] * r[1] * k, 1.0 + r[0] * r[0] * k


def _twist(alpha: float, force: Point, r: Point, rho: float) -> Twist:
    return Twist(alpha * force[0], alpha * force[1], alpha * cross(r, force) / (rho * rho))


def _level(force: Point, r: Point, rho: float, limit: float) -> float:
    """Size of a force relative to the limit surface: 1 on it, below 1 at rest."""
    torque = cross(r, force) / rho
    return math.sqrt(force[0] ** 2 + force[1] ** 2 + torque * torque) / limit


def push_with_velocity(
    velocity: Point, r: Point, normal: Point, friction: float, rho: float, limit: float
) -> PushOutcome:
    """Return what a tip that moves at the given ``velocity`` [m/s] does to the object.

    ``limit`` [N] is mu_s N. Sticks where the force that this motion needs, ~ G^-1 v, is inside the cone; else
    slides with the force on the cone's edge and the size that keeps the normal velocities equal.
    """
    approach = velocity[0] * normal[0] + velocity[1] * normal[1]
    if approach <= 0.0:
        return PushOutcome("free", (0.0, 0.0), Twist(0.0, 0.0, 0.0), velocity)
    gxx, gxy, gyy = _mobility(r, rho)
    determinant = gxx * gyy - gxy * gxy
    f = (
        (gyy * velocity[0] - gxy * velocity[1]) / determinant,
        (gxx * velocity[1] - gxy * velocity[0]) / determinant,
    )
    tangent = (-normal[1], normal[0])
    fn, ft = f[0] * normal[0] + f[1] * normal[1], f[0] * tangent[0] + f[1] * tangent[1]
    status: ContactStatus = "stick"
    if abs(ft) > friction * fn:
        sign = (
            math.copysign(1.0, ft)
            if fn > 0.0
            else math.copysign(1.0, velocity[0] * tangent[0] + velocity[1] * tangent[1])
        )
        edge = (normal[0] + sign * friction * tangent[0], normal[1] + sign * friction * tangent[1])
        moved = (gxx * edge[0] + gxy * edge[1], gxy * edge[0] + gyy * edge[1])
        along = moved[0] * normal[0] + moved[1] * normal[1]
        f = (edge[0] * approach / along, edge[1] * approach / along)
        status = "slip_left" if sign > 0.0 else "slip_right"
    size = _level(f, r, rho, limit)
    return PushOutcome(status, (f[0] / size, f[1] / size), _twist(1.0, f, r, rho), velocity)


def push_with_compliance(
    force: Point,
    damping: tuple[float, float],
    r: Point,
    normal: Point,
    friction: float,
    rho: float,
    limit: float,
    tip_radius: float = 0.0,
) -> PushOutcome:
    """Return what a massless tip in contact does whose force on the object is ``force`` - diag(damping)
    v_tip.

    ``damping`` [N s/m] along the normal and the tangent, both > 0. v_tip is that of the tip's centre,
    ``tip_radius`` [m] outside the contact; the tip turns with the object, so that it does not roll along the
    face.
    """
    tangent = (-normal[1], normal[0])
    an, at = force[0] * normal[0] + force[1] * normal[1], force[0] * tangent[0] + force[1] * tangent[1]
    bn, bt = damping
    rest = Twist(0.0, 0.0, 0.0)
    if an <= 0.0:
        return PushOutcome("free", (0.0, 0.0), rest, _in_plane(an / bn, at / bt, normal, tangent))
    rn, rt = r[0] * normal[0] + r[1] * normal[1], r[0] * tangent[0] + r[1] * tangent[1]
    # v_tip = alpha G f, G = I + (J r_c)(J r)^T / rho^2 with r_c the tip's centre
    k = 1.0 / (rho * rho)
    cn = rn - tip_radius
    gnn, gnt, gtn, gtt = 1.0 + rt * rt * k, -rt * rn * k, -cn * rt * k, 1.0 + cn * rn * k

    def sticking(alpha: float) -> tuple[float, float]:
        # (I + alpha B G) f = f_0
        m11, m12 = 1.0 + alpha * bn * gnn, alpha * bn * gnt
        m21, m22 = alpha * bt * gtn, 1.0 + alpha * bt * gtt
        determinant = m11 * m22 - m12 * m21
        return (m22 * an - m12 * at) / determinant, (m11 * at - m21 * an) / determinant

    def size(fn: float, ft: float) -> float:
        return math.sqrt(fn * fn + ft * ft + ((rn * ft - rt * fn) / rho) ** 2) / limit

    alpha, fn, ft = 0.0, an, at
    if size(an, at) > 1.0:
        low, high = 0.0, 1e-3
        while size(*sticking(high)) > 1.0:
            low, high = high, 4.0 * high
        for _ in range(60):
            alpha = 0.5 * (low + high)
            if size(*sticking(alpha)) > 1.0:
                low = alpha
            else:
                high = alpha
        fn, ft = sticking(alpha)
    if fn > 0.0 and abs(ft) <= friction * fn:
        f = _in_plane(fn, ft, normal, tangent)
        twist = _twist(alpha, f, r, rho)
        v_tip = _in_plane((an - fn) / bn, (at - ft) / bt, normal, tangent)
        return PushOutcome("stick" if alpha > 0.0 else "rest", f, twist, v_tip)
    # slipping: the force is on the edge of the cone, its size m either what the tip presses with or what
    # slides the object
    sign = math.copysign(1.0, ft if fn > 0.0 else at)
    edge_t = sign * friction
    m_slide = 1.0 / size(1.0, edge_t)
    m, alpha = min(an, m_slide), 0.0
    if an > m_slide:
        alpha = (an / m_slide - 1.0) / (bn * (gnn + gnt * edge_t))
    f = _in_plane(m, m * edge_t, normal, tangent)
    v_tip = _in_plane((an - m) / bn, (at - m * edge_t) / bt, normal, tangent)
    return PushOutcome("slip_left" if sign > 0.0 else "slip_right", f, _twist(alpha, f, r, rho), v_tip)


def _in_plane(along_n: float, along_t: float, normal: Point, tangent: Point) -> Point:
    return (along_n * normal[0] + along_t * tangent[0], along_n * normal[1] + along_t * tangent[1])
