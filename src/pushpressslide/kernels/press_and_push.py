"""A press from above and a push from the side. The push turns the object about the
pressed point, and the press provides the remaining force (docs/mechanics.md, section
7).

The moment about the pressed point determines the push across the line of contacts.
Along this line the force can be shared in any way that keeps the push inside its cone
and the press inside its disc.
"""

from __future__ import annotations

from math import inf, sqrt

from pushpressslide.kernels.allocation import (
    EXACT,
    INFEASIBLE,
    OK,
    PROJECTED,
    Two,
    Vector,
)
from pushpressslide.kernels.contact_line import contact_line
from pushpressslide.kernels.elementary import hypotenuse
from pushpressslide.kernels.kernel import kernel, kernel_wide

Push = tuple[float, float, float, float, float, float, float]
"""The push in B: unit vector x, y from the press to the push; unit inward normal x, y;
lever [m] about the press; and for each side of the push's friction cone, the change of
its slack per force along the line.
"""
Press = tuple[float, float, float, float, float]
"""The press: lever arm x, y [m] in B from the centre of pressure, normal force [N],
radius [N] of the friction disc, friction.
"""


@kernel
def press_and_push_figures(
    press: Vector,
    load: float,
    push: Vector,
    normal: Vector,
    friction: float,
    cop: Vector,
) -> tuple[Push, Press]:
    """Parameters of ``press_and_push``, with positions in [m] and ``load`` in [N]."""
    ex, ey, length, _, _ = contact_line(press, push)
    nx, ny = normal
    lever = length * (ex * ny - ey * nx)
    # a push a n + s e has the slacks friction a + slope s at the sides of its cone
    along = ex * nx + ey * ny
    left = nx * ey - ny * ex
    slopes = (friction * along - left, friction * along + left)
    px = press[0] - cop[0]
    py = press[1] - cop[1]
    pushed = (ex, ey, nx, ny, lever, slopes[0], slopes[1])
    return pushed, (px, py, load, friction * load, friction)


@kernel_wide
def press_and_push(fx: float, fy: float, tau: float, push: Push, press: Press) -> Two:
    """Allocation of a wrench [N, N m] about the centre of pressure to a press and a
    push.
    """
    px, py, load, upper, friction = press
    if not abs(fx) + abs(fy) + abs(tau) < inf:
        return ((0.0, 0.0), (0.0, 0.0)), (load, 0.0), 0.0, INFEASIBLE, (fx, fy, tau)
    ex, ey, nx, ny, lever, _, _ = push
    a, s, gx, gy, status = shared(fx, fy, tau, push, press)
    gx = gx - s * ex
    gy = gy - s * ey
    size = hypotenuse(gx, gy)
    scale = 1.0
    if size > upper * (1.0 + 1e-12):
        scale = upper / size
        status = PROJECTED
    pushed_x = scale * (a * nx + s * ex)
    pushed_y = scale * (a * ny + s * ey)
    pressed_x = scale * gx
    pressed_y = scale * gy
    f_n = pushed_x * nx + pushed_y * ny
    f_t = nx * pushed_y - ny * pushed_x
    margin = min(upper - scale * size, friction * f_n - abs(f_t))
    residual = EXACT
    if status == PROJECTED:
        x = pressed_x + pushed_x
        y = pressed_y + pushed_y
        moment = px * y - py * x + scale * a * lever
        residual = (fx - x, fy - y, tau - moment)
        if x == 0.0 and y == 0.0 and moment == 0.0:
            status = INFEASIBLE
    forces = ((pressed_x, pressed_y), (pushed_x, pushed_y))
    return forces, (load, f_n), margin, status, residual


@kernel
def shared(
    fx: float, fy: float, tau: float, push: Push, press: Press
) -> tuple[float, float, float, float, int]:
    """Components [N] of the push along its normal and along the line, the press [N] for
    the normal component alone, and a status.

    The push is zero if it would have to pull.
    """
    ex, ey, nx, ny, lever, slope_1, slope_2 = push
    px, py, _, upper, friction = press
    a = (tau - px * fy + py * fx) / lever
    low, high = with_side(-inf, inf, friction * a, slope_1)
    low, high = with_side(low, high, friction * a, slope_2)
    # the sides of a cone without friction do not tell a pull from a push
    if low > high or (friction == 0.0 and a < 0.0):
        return 0.0, 0.0, fx, fy, PROJECTED
    gx = fx - a * nx
    gy = fy - a * ny
    middle = gx * ex + gy * ey
    square = middle * middle - gx * gx - gy * gy + upper * upper
    slack = sqrt(square) if square > 0.0 else 0.0
    return a, least_along(low, high, middle, slack), gx, gy, OK


@kernel
def with_side(low: float, high: float, slack: float, slope: float) -> Vector:
    """Part of an interval of s in which slack + slope s >= 0. If there is none, the
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
def least_along(low: float, high: float, middle: float, tolerance: float) -> float:
    """Smallest component of the push along the line, in [low, high], that is within
    ``tolerance`` of ``middle``.

    If no component in the interval is that close, it is the one nearest to ``middle``.
    """
    lower = max(low, middle - tolerance)
    upper = min(high, middle + tolerance)
    if lower <= upper:
        return min(max(0.0, lower), upper)
    return min(max(middle, low), high)
