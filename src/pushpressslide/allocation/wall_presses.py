"""Loads of two presses that hold an object on a wall and slide it there (docs/mechanics.md, section 7)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from pushpressslide.allocation.press_loads import TwoPresses, wall_hold, wall_press
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist

Step = tuple[Twist, Point]
"""How the object slides at one place of a motion, and its weight in the plane [N], in B."""


def wall_loads(
    presses: Callable[[float], TwoPresses], steps: Sequence[Step], uses: Sequence[float], least: float
) -> Point | None:
    """Return equal loads [N] of the left and right contact that drive every one of ``steps``, each at least
    ``least`` [N], at the first of the shares ``uses`` of the contact friction that the cap allows; None if it
    allows none.

    ``presses(use)`` are those with that share of the friction, on an object that its weight does not press.
    """
    for use in uses:
        pair = presses(use)
        found = [pair.for_share(0.5, twist, weight) for twist, weight in steps]
        each = max(least, *(max(loads.normals) for loads in found))
        if each <= pair.cap and all(loads.status == "ok" for loads in found):
            return (each, each)
    return None


def wall_problem(presses: TwoPresses, steps: Sequence[Step]) -> str:
    """Return in one line, with the number that decides, why no two presses within their cap do it."""
    mu_a, mu_w, cap = presses.contact_friction, presses.support_friction, presses.cap
    weight = max(math.hypot(*gravity) for _, gravity in steps)
    hold = 0.5 * wall_hold(weight, mu_a, mu_w)
    if hold > cap:
        return (
            f"to hold {weight:.1f} N with {mu_a:.2f} of friction at the tips and {mu_w:.2f} at the wall takes "
            f"{hold:.1f} N of each arm, limits.normal_force is {cap:g} N"
        )
    slide = 0.5 * max(wall_press(weight, mu_a, mu_w, up) for up in (_up(*step) for step in steps))
    if slide == math.inf:
        return (
            f"no press carries {weight:.1f} N and drags the object on: the {mu_a:.2f} of friction that the "
            f"tips may take must exceed the wall's, {mu_w:.2f}"
        )
    return (
        f"to carry {weight:.1f} N and drag the object on takes {slide:.1f} N or more of each arm, "
        f"limits.normal_force is {cap:g} N"
    )


def _up(twist: Twist, gravity: Point) -> float:
    """The part of the CoM's motion that points up, against gravity; 0 for a turn on the spot."""
    vx, vy, _, _ = twist.moved_to((0.0, 0.0))
    size = math.hypot(vx, vy) * math.hypot(*gravity)
    return -(vx * gravity[0] + vy * gravity[1]) / size if size > 0.0 else 0.0
