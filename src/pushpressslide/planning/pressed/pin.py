"""Place and load of the press about which an object turns."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from pushpressslide.core import margins
from pushpressslide.core.motion import FORCE_ALLOWED
from pushpressslide.core.pose import Point
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.twist_path import screw
from pushpressslide.mechanics.top import inside_top
from pushpressslide.planning.held_twist import tipping_refusal
from pushpressslide.planning.hollow import hollow_refusal
from pushpressslide.planning.pressed.drag import PinnedDrag

HALVINGS = 8  # of the interval of presses
LEAST_TURN = math.radians(3.0)  # of a goal


def least_pin_load(
    dragged: Callable[[float], PinnedDrag],
    cap: float,
    uses: Sequence[float],
    min_load: float = margins.ARM.least_press,
) -> float:
    """Smallest press load [N] from ``min_load`` that meets the first achievable friction
    utilisation of ``uses``, or ``cap`` [N] if none is achievable.

    ``dragged`` returns the drag for a load [N]. Raises ValueError if the object tips.
    """
    hardest = dragged(cap).friction_utilisation
    allowed = next((share for share in uses if hardest <= share), None)
    if allowed is None:
        return cap
    low = min_load
    high = cap
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if dragged(middle).friction_utilisation <= allowed:
            high = middle
        else:
            low = middle
    return high


def pin_refusal(
    cap: float, load: float, drag: PinnedDrag, allowed: float
) -> Refusal | None:
    """Refusal of a press of ``load`` [N], or None. ``cap`` [N] is the largest load,
    ``allowed`` the largest friction utilisation.
    """
    utilisation = drag.friction_utilisation
    push = drag.forces.normals[1]
    if load > cap:
        text = f"motion.press_force of {{figure:Ng}}, {FORCE_ALLOWED}"
        return Refusal("normal_force", text, load, cap, "N")
    if drag.forces.status != "ok" or utilisation > allowed:
        text = (
            f"pressed with {load:.1f} N the tip slips: holding the pivot takes "
            "{figure:.2f} of its friction, allowed {allowed:g}; allowed a press of "
            f"{cap:g} N by limits.normal_force"
        )
        return Refusal("friction", text, utilisation, allowed)
    if push > cap:
        text = f"needs a push of {{figure:N.1f}}, {FORCE_ALLOWED}"
        return Refusal("normal_force", text, push, cap, "N")
    return tipping_refusal("drag tips the object", drag.tipping_margin)


def pin_of(query: MotionQuery) -> Point:
    """Point to press [m] in B. Raises RefusedError if the goal is not a turn about a
    point that can be pressed.
    """
    body = query.body
    start, goal = query.body_ends
    vx, vy, w = screw(start, goal)
    if abs(w) < LEAST_TURN:
        text = "the goal is turned by {figure:deg.1f}, allowed from {allowed:degg}"
        raise RefusedError(Refusal("turn", text, w, LEAST_TURN, "rad"))
    pin = (-vy / w, vx / w)
    places = query.motion.contacts
    if places is not None:
        com = body.center_of_mass
        pin = (places[0][0] - com[0], places[0][1] - com[1])
        distances = math.dist(start.apply(pin), goal.apply(pin))
        allowed = query.tolerance.position
        if distances > allowed:
            text = (
                "the pressed point has to stay in its place, start and goal have it "
                "{figure:mm.1f} apart, allowed {allowed:mmg}"
            )
            raise RefusedError(Refusal("pin_moves", text, distances, allowed, "m"))
    deep = hollow_refusal(query.scene)
    if deep is not None:
        raise RefusedError(deep)
    inset = query.scene.inset
    if not inside_top(body, pin, inset):
        text = (
            f"the goal is turned about ({pin[0]:.3f}, {pin[1]:.3f}), which would have "
            "to be pressed: it is {figure:mm.0f} inside the top, allowed from "
            "{allowed:mm.0f}"
        )
        depth = body.shape.depth(body.X_GB.apply(pin))
        raise RefusedError(Refusal("off_top", text, depth, inset, "m"))
    return pin
