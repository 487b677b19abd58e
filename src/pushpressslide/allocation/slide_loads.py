"""Loads with which two presses move an object along one twist, or the refusal if no
loads do (docs/mechanics.md, section 7).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.cop_strategy import (
    loads_with,
    possible_fractions,
    safe_loads,
)
from pushpressslide.allocation.press_loads import TwoPresses
from pushpressslide.allocation.wall_presses import wall_loads
from pushpressslide.core import margins
from pushpressslide.core.motion import FORCE_ALLOWED, Cop, Motion
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.osculating import pressures, touching_ellipsoid
from pushpressslide.mechanics.pressing import no_drag, resting_cop
from pushpressslide.mechanics.wall import lean_press, weights

COP: Cop = "balanced"
ORIGIN = (0.0, 0.0)

Presses = Callable[..., TwoPresses]


def slide_loads(
    scene: Scene,
    motion: Motion,
    cap: float,
    points: tuple[Point, Point],
    path: TwistPath,
    min_load: float = margins.ARM.least_press,
) -> tuple[Refusal | None, list[Point]]:
    """Loads [N] at ``points`` to try for a body's ``path``, with their refusal or None.
    Each is at least ``min_load`` [N].

    If no loads suffice, the result is a refusal and loads at ``cap`` [N]. Raises
    RefusedError if two tips cannot press the object in this way.
    """
    cop: Cop = COP if motion.cop is None else motion.cop
    twist = path.initial_twist(ORIGIN)
    mu_s = scene.support.friction
    mu_a = scene.contact_friction
    rho = touching_ellipsoid(pressures(scene)(ORIGIN), mu_s, twist).rho

    def presses(share: float = 1.0) -> TwoPresses:
        """The presses with a fraction of the contact friction."""
        return TwoPresses(*points, scene.weight_on, mu_s, share * mu_a, rho, cap)

    press = motion.press_force
    if press is not None:
        return None, [_given_loads(presses(), cop, press, cap)]
    if any(scene.weight_along):
        steps = [(twist, along) for along in weights(scene, path)]
        lower = max(min_load, lean_press(scene))
        return None, [wall_loads(presses, steps, scene.friction_uses, lower)]
    loads = safe_loads(presses, cop, twist, scene.friction_uses, min_load)
    if loads is not None:
        harder = loads_with(presses(), cop, min(cap, margins.HARDER * max(loads)))
        return None, [loads, harder]
    return _loads_at_limit(presses, cop, twist, scene.friction_uses[-1])


def _loads_at_limit(
    presses: Presses, cop: Cop, twist: Twist, allowed: float
) -> tuple[Refusal, list[Point]]:
    """Loads [N] at the cap, with their refusal or None.

    Raises RefusedError if two tips cannot press the object in this way.
    """
    pair = presses()
    mu_a = pair.contact_friction
    mu_s = pair.support_friction
    if mu_a <= mu_s:
        raise RefusedError(no_drag(mu_a, mu_s))
    if not isinstance(cop, str):
        raise RefusedError(_cop_refusal(presses, cop, twist, allowed))
    normals = loads_with(pair, cop, pair.cap)
    utilisation = pair.loads_for(normals, twist).needed / sum(normals)
    limit = f"; allowed {pair.cap:g} N by limits.normal_force"
    return slip_refusal(normals, utilisation, allowed, limit), [normals]


def slip_refusal(
    normals: Point, utilisation: float, allowed: float, note: str = ""
) -> Refusal:
    """Refusal of two presses that slip under the loads ``normals`` [N]: their friction
    ``utilisation`` is above the largest ``allowed``.
    """
    left, right = normals
    text = (
        f"pressed with {left:.1f} and {right:.1f} N the tips slip before the object: "
        f"the motion takes {{figure:.2f}} of their friction, allowed {{allowed:g}}{note}"
    )
    return Refusal("friction", text, utilisation, allowed)


def cop_fraction(scene: Scene, contacts: Sequence[Contact]) -> float:
    """Fraction of the line from the left to the right contact at which the centre of
    pressure lies without drag.
    """
    left, right = (contact.point for contact in contacts)
    x, y = resting_cop(scene, contacts)
    line = ContactLine(left, right)
    return line.in_axes((x - left[0], y - left[1]))[0] / line.length


def _given_loads(presses: TwoPresses, cop: Cop, given: float, cap: float) -> Point:
    """Loads [N] that share a press given by the task. Raises RefusedError if it is too
    hard or too light.
    """
    normals = loads_with(presses, cop, given)
    if given > cap:
        text = f"motion.press_force of {{figure:Ng}}, {FORCE_ALLOWED}"
        raise RefusedError(Refusal("normal_force", text, given, cap, "N"))
    if min(normals) < margins.ARM.least_press:
        text = (
            "the lighter press is {figure:N.1f}, allowed from {allowed:Ng}: a contact "
            "that does not press holds nothing"
        )
        raise RefusedError(
            Refusal("press", text, min(normals), margins.ARM.least_press, "N")
        )
    return normals


def _cop_refusal(presses: Presses, cop: float, twist: Twist, allowed: float) -> Refusal:
    """Refusal of a wanted centre of pressure."""
    cap = presses().cap
    can = possible_fractions(presses, twist, (allowed,), margins.ARM.least_press)
    span = "and so does any other"
    if can:
        span = f"allowed from {can[0]:.2f} to {can[1]:.2f}"
    text = (
        "a centre of pressure {figure:g} of the way from left to right needs a contact "
        f"that does not press, or more than the {cap:g} N allowed by limits.normal_force, {span}"
    )
    return Refusal("cop", text, cop)
