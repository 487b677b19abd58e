"""Loads of two presses that hold an object on a wall and slide it there
(docs/mechanics.md, section 7).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from pushpressslide.allocation.press_loads import TwoPresses, wall_hold, wall_press
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist

Step = tuple[Twist, Point]
"""Direction of sliding at one pose of a motion, and the weight [N] in the plane, both
in B.
"""


def wall_loads(
    presses: Callable[[float], TwoPresses],
    steps: Sequence[Step],
    uses: Sequence[float],
    min_use: float,
) -> Point:
    """Equal loads [N] of the left and right contact that drive every one of ``steps``,
    each at least ``min_use`` [N].

    The friction utilisations ``uses`` are tried in order until the loads are within the
    cap. ``presses(use)`` are the presses at the utilisation ``use``, on an object whose
    weight does not press it against the support. Raises ValueError, with the deciding
    number, if no loads within the cap suffice.
    """
    for use in uses:
        pair = presses(use)
        solved = [pair.for_share(0.5, twist, weight) for twist, weight in steps]
        each = max(min_use, *(max(loads.normals) for loads in solved))
        if each <= pair.cap and all(loads.status == "ok" for loads in solved):
            return (each, each)
    raise ValueError(_problem(presses(uses[-1]), steps, min_use))


def _problem(presses: TwoPresses, steps: Sequence[Step], min_use: float) -> str:
    """Reason in one line why no two presses within the cap suffice."""
    mu_a = presses.contact_friction
    mu_w = presses.support_friction
    cap = presses.cap
    weight = max(math.hypot(*gravity) for _, gravity in steps)
    allowed = f"allowed {cap:g} N by limits.normal_force"
    friction = f"{mu_a:.2f} of friction used at the tips"
    hold = 0.5 * wall_hold(weight, mu_a, mu_w)
    if hold > cap:
        return f"to hold {weight:.1f} N on the wall, {friction}, takes {hold:.1f} N of each arm; {allowed}"
    slide = 0.5 * max(
        wall_press(weight, mu_a, mu_w, up) for up in (_up(*step) for step in steps)
    )
    if slide == math.inf:
        return (
            f"no press carries {weight:.1f} N and drags the object over the wall: "
            f"{friction} must exceed "
            f"the wall's, {mu_w:.2f}"
        )
    if min_use > max(cap, slide):
        return (
            f"carried off its face the object leans over with less than {min_use:.1f} N "
            f"of each arm; {allowed}"
        )
    return f"to carry {weight:.1f} N over the wall takes {slide:.1f} N or more of each arm; {allowed}"


def _up(twist: Twist, gravity: Point) -> float:
    """Component of the unit vector of the CoM's motion that points up, against gravity.
    0 for a turn on the spot.
    """
    vx, vy, _, _ = twist.moved_to((0.0, 0.0))
    size = math.hypot(vx, vy) * math.hypot(*gravity)
    if size <= 0.0:
        return 0.0
    return -(vx * gravity[0] + vy * gravity[1]) / size
