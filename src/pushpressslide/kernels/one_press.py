"""One top contact: a tangential force within the friction disc of its press
(docs/mechanics.md, sections 4 and 8).
"""

from __future__ import annotations

from math import inf, sqrt

from pushpressslide.kernels.allocation import INFEASIBLE, OK, PROJECTED, One, Vector
from pushpressslide.kernels.kernel import kernel

Press = tuple[float, float, float, float]
"""One press: lever arm x, y [m] in B from the centre of pressure, normal force [N],
radius [N] of the friction disc.
"""

Nearness = tuple[float, float]
"""Terms of the norm diag(1, 1, 1/rho^2): 1 / rho^2 [1/m^2], and the factor by which the
norm shrinks the moment component of a force.
"""


@kernel
def one_press_figures(
    point: Vector, load: float, friction: float, rho: float, cop: Vector
) -> tuple[Press, Nearness]:
    """Parameters of ``one_press``, with ``point``, ``rho`` and ``cop`` in [m], ``load``
    in [N].
    """
    rx = point[0] - cop[0]
    ry = point[1] - cop[1]
    per_square = 1.0 / (rho * rho)
    shrink = 1.0 / (1.0 + (rx * rx + ry * ry) * per_square)
    return (rx, ry, load, friction * load), (per_square, shrink)


@kernel
def one_press(fx: float, fy: float, tau: float, press: Press, norm: Nearness) -> One:
    """Allocation of a wrench [N, N m] about the centre of pressure to one press.

    The wrench is projected to the nearest direction, then onto the disc.
    """
    rx, ry, load, upper = press
    off = tau - rx * fy + ry * fx
    size = sqrt(fx * fx + fy * fy)
    if size <= upper and abs(off) <= 1e-12 * upper:
        return ((fx, fy),), (load,), upper - size, OK, (0.0, 0.0, off)
    if not size + abs(tau) < inf:
        return ((0.0, 0.0),), (load,), 0.0, INFEASIBLE, (fx, fy, tau)
    per_square, shrink = norm
    # least squares of (f - F, (r x f - tau) / rho) over f
    k = off * per_square * shrink
    gx = fx - k * ry
    gy = fy + k * rx
    size = sqrt(gx * gx + gy * gy)
    if size > upper:
        gx = gx * upper / size
        gy = gy * upper / size
        size = upper
    residual = (fx - gx, fy - gy, tau - rx * gy + ry * gx)
    return ((gx, gy),), (load,), upper - size, PROJECTED, residual
