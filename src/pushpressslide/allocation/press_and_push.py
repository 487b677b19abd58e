"""Allocation to a press from above and a push from the side: the push turns the object
about the pressed point, the press gives the rest (docs/mechanics.md, section 7).

The moment about the pressed point fixes the push across the line of contacts; along it
the force can be shared in any way that keeps the push inside its cone and the press
inside its disc. Closed form, in plain floats.
"""

from __future__ import annotations

from collections.abc import Callable
from math import hypot, inf, sqrt

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.core.allocation import Allocation, AllocationStatus, nothing
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, cross
from pushpressslide.mechanics.checks import check_normal, check_point, check_press

LEAST_LEVER = 1e-6  # [m]


def press_and_push_allocator(
    press: Point,
    load: float,
    push: Point,
    normal: Point,
    friction: float,
    cop: Point = (0.0, 0.0),
) -> Callable[[float, float, float], Allocation]:
    """Return ``allocate(fx, fy, tau)`` for a top contact at ``press`` [m], pressed with
    ``load`` [N], and a side contact at ``push`` [m] with the unit inward ``normal``;
    all in B, the wrench about ``cop`` [m].

    Of all forces inside cone and disc that realise it, the push is along its normal, or
    as near to that as can be. A wrench that the press cannot hold is scaled; where the
    push would have to pull, its moment is left out: status "projected" in both cases,
    "infeasible" if nothing is left, and for a wrench that is not finite. Raises
    InputError unless the places are finite, ``load`` is > 0, ``friction`` >= 0, and the
    push has a lever about the pressed point.
    """
    check_point(cop, "cop")
    line = ContactLine(press, push)
    lever = line.length * cross(line.e, normal)
    check_press(load, friction)
    check_normal(normal)
    if not abs(lever) > LEAST_LEVER:
        raise InputError(f"lever {lever} m of the push; must not be 0")
    about_press = (press[0] - cop[0], press[1] - cop[1])
    return _allocator(line.e, about_press, lever, load, normal, friction)


def _allocator(
    e: Point,
    about_press: Point,
    lever: float,
    load: float,
    normal: Point,
    friction: float,
) -> Callable[[float, float, float], Allocation]:
    """Return the allocator; ``e`` is the unit vector from the press to the push,
    ``about_press`` [m] leads from the centre of pressure to the press, and ``lever``
    [m] is the push's about the press.
    """
    ex, ey = e
    px, py = about_press
    nx, ny = normal
    most = friction * load
    # the sides of a cone without friction do not tell a pull from a push
    least = 0.0 if friction == 0.0 else -inf
    # a push a n + s e has the slacks friction a + slope s at the sides of its cone
    along = ex * nx + ey * ny
    left = nx * ey - ny * ex
    slopes = (friction * along - left, friction * along + left)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench [N, N m]."""
        if not abs(fx) + abs(fy) + abs(tau) < inf:
            return nothing((load, 0.0), (fx, fy, tau))
        a = (tau - px * fy + py * fx) / lever
        low, high = _interval(friction * a, slopes)
        gx = fx - a * nx
        gy = fy - a * ny  # what the press gives, at first to a push along its normal
        status: AllocationStatus = "ok"
        scale = 1.0
        s = 0.0
        if low > high or a < least:
            a = 0.0
            gx = fx
            gy = fy
            status = "projected"
        else:
            middle = gx * ex + gy * ey
            square = middle * middle - gx * gx - gy * gy + most * most
            room = sqrt(square) if square > 0.0 else 0.0
            s = _least_along(low, high, middle, room)
        gx = gx - s * ex
        gy = gy - s * ey
        size = hypot(gx, gy)
        if size > most * (1.0 + 1e-12):
            scale = most / size
            status = "projected"
        pushed = (scale * (a * nx + s * ex), scale * (a * ny + s * ey))
        pressed = (scale * gx, scale * gy)
        f_n = pushed[0] * nx + pushed[1] * ny
        f_t = nx * pushed[1] - ny * pushed[0]
        margin = min(most - scale * size, friction * f_n - abs(f_t))
        residual = (0.0, 0.0, 0.0)
        if status == "projected":
            x = pressed[0] + pushed[0]
            y = pressed[1] + pushed[1]
            moment = px * y - py * x + scale * a * lever
            residual = (fx - x, fy - y, tau - moment)
            if x == y == moment == 0.0:
                status = "infeasible"
        return Allocation((pressed, pushed), (load, f_n), margin, status, residual)

    return allocate


def _least_along(low: float, high: float, middle: float, room: float) -> float:
    """Return the least part of the push along the line, in [low, high], that is within
    ``room`` of ``middle``; the nearest to that where none is.
    """
    least = max(low, middle - room)
    most = min(high, middle + room)
    if least <= most:
        return min(max(0.0, least), most)
    return min(max(middle, low), high)


def _interval(slack: float, slopes: tuple[float, float]) -> tuple[float, float]:
    """Return the interval of s in which slack + slope s >= 0; reversed if none."""
    low = -inf
    high = inf
    for slope in slopes:
        if slope > 0.0:
            low = max(low, -slack / slope)
        elif slope < 0.0:
            high = min(high, -slack / slope)
        elif slack < 0.0:
            low = inf
    return low, high
