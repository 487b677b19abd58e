"""One side contact: two force components for three wrench components
(docs/mechanics.md, sections 2, 3 and 8).
"""

from __future__ import annotations

from math import inf

from pushpressslide.kernels.allocation import (
    EXACT,
    GIVEN,
    INFEASIBLE,
    OK,
    PROJECTED,
    One,
    Vector,
)
from pushpressslide.kernels.kernel import kernel

SideContact = tuple[float, float, float, float, float]
"""One side contact in B: point x, y [m], unit inward normal x, y, friction."""

Nearness = tuple[float, float, float]
"""Terms of the norm diag(1, 1, 1/rho^2): rho [m], 1 / rho^2 [1/m^2], and the factor by
which the norm shrinks the moment component of a force.
"""


@kernel
def one_contact_figures(
    point: Vector, normal: Vector, friction: float, rho: float
) -> tuple[SideContact, Nearness]:
    """Parameters of ``one_contact``, with ``point`` and ``rho`` in [m]."""
    px, py = point
    per_square = 1.0 / (rho * rho)
    # Normal equations of min |f - F|^2 + (p x f - tau)^2 / rho^2: (I + a a^T / rho^2) f
    # = F + a tau / rho^2, a = (-py, px)
    shrink = 1.0 / (1.0 + (py * py + px * px) * per_square)
    contact = (px, py, normal[0], normal[1], friction)
    return contact, (rho, per_square, shrink)


@kernel
def one_contact(
    fx: float, fy: float, tau: float, contact: SideContact, norm: Nearness
) -> One:
    """Allocation of a wrench [N, N m] about B's origin to one side contact."""
    px, py, nx, ny, friction = contact
    fn = fx * nx + fy * ny
    ft = fy * nx - fx * ny
    margin = friction * fn - (ft if ft > 0.0 else -ft)
    if margin >= 0.0 and -1e-12 * fn <= tau - px * fy + py * fx <= 1e-12 * fn:
        return ((fx, fy),), (fn,), margin, OK, EXACT
    return nearest_push(fx, fy, tau, contact, norm)


@kernel
def nearest_push(
    fx: float, fy: float, tau: float, contact: SideContact, norm: Nearness
) -> One:
    """Allocation of the nearest wrench that the contact can give."""
    if not abs(fx) + abs(fy) + abs(tau) < inf:
        return ((0.0, 0.0),), (0.0,), 0.0, INFEASIBLE, (fx, fy, tau)
    px, py, nx, ny, friction = contact
    rho, per_square, shrink = norm
    bx = fx - py * tau * per_square
    by = fy + px * tau * per_square
    shared = (px * by - py * bx) * per_square * shrink
    gx = bx + py * shared
    gy = by - px * shared
    fn = gx * nx + gy * ny
    ft = gy * nx - gx * ny
    if abs(ft) > friction * fn:
        gx, gy = nearest_on_edges(fx, fy, tau, contact, per_square)
        fn = gx * nx + gy * ny
        ft = gy * nx - gx * ny
    rx = fx - gx
    ry = fy - gy
    rt = tau - (px * gy - py * gx)
    scale = abs(fx) + abs(fy) + abs(tau) / rho
    error = abs(rx) + abs(ry) + abs(rt) / rho
    margin = friction * fn - abs(ft)
    status = OK if error <= GIVEN * scale else PROJECTED
    if fn <= 0.0:
        status = OK if scale == 0.0 else INFEASIBLE
        gx = 0.0
        gy = 0.0
        fn = 0.0
        margin = 0.0
    return ((gx, gy),), (fn,), margin, status, (rx, ry, rt)


@kernel
def nearest_on_edges(
    fx: float, fy: float, tau: float, contact: SideContact, per_square: float
) -> Vector:
    """Force [N] on an edge of the friction cone whose wrench is nearest. Zero if no
    force is nearer than zero.

    The nearest force on each edge is computed, and the better one is taken.
    """
    none = fx * fx + fy * fy + tau * tau * per_square
    friction = contact[4]
    left, left_cost = along_edge(fx, fy, tau, contact, friction, per_square)
    right, right_cost = along_edge(fx, fy, tau, contact, -friction, per_square)
    fx = 0.0
    fy = 0.0
    cost = none
    if left_cost < cost:
        fx, fy = left
        cost = left_cost
    if right_cost < cost:
        fx, fy = right
    return fx, fy


@kernel
def along_edge(
    fx: float,
    fy: float,
    tau: float,
    contact: SideContact,
    friction: float,
    per_square: float,
) -> tuple[Vector, float]:
    """Nearest force [N] along the left edge of a cone, and its squared error. Zero if
    the contact would have to pull.

    For the right edge, pass the negative friction.
    """
    px, py, nx, ny, _ = contact
    ex = nx - friction * ny
    ey = ny + friction * nx
    lever = px * ey - py * ex
    norm = ex * ex + ey * ey + lever * lever * per_square
    size = (ex * fx + ey * fy + lever * tau * per_square) / norm
    if not size > 0.0:
        size = 0.0
    rx = fx - size * ex
    ry = fy - size * ey
    rt = tau - size * lever
    return (size * ex, size * ey), rx * rx + ry * ry + rt * rt * per_square
