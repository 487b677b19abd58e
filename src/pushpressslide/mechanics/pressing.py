"""One tip pressed on top of an object: its load and the centre of pressure.

Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core import margins
from pushpressslide.core.motion import FORCE_ALLOWED
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.pressure import center_of_pressure


def friction_use(
    load: float,
    weight: float,
    mu_support: float,
    mu_contact: float,
    pushed: float = 0.0,
) -> float:
    """Friction utilisation of a press in straight sliding. If it is below 1, the press
    sticks.

    It is (mu_s (N_o + N_a) + pushed) / (mu_a N_a), where ``pushed`` [N] is the drag of
    a body that the object pushes.
    """
    if load <= 0.0 or mu_contact <= 0.0:
        return math.inf
    return (mu_support * (weight + load) + pushed) / (mu_contact * load)


def least_load(
    weight: float,
    mu_support: float,
    mu_contact: float,
    share: float = 1.0,
    pushed: float = 0.0,
) -> float:
    """Smallest load N_a [N] that drags the object in every direction with the friction
    utilisation ``share``.

    It is (mu_s N_o + pushed) / (share mu_a - mu_s). Infinite if no load is large
    enough.
    """
    slack = share * mu_contact - mu_support
    if slack <= 0.0:
        return math.inf
    return (mu_support * weight + pushed) / slack


def press_loads(
    weight: float,
    mu_support: float,
    mu_contact: float,
    max_force: float,
    wanted: float | None = None,
    pushed: float = 0.0,
    uses: Sequence[float] = margins.FRICTION_USES,
    min_load: float = margins.ARM.least_press,
) -> list[float]:
    """Loads [N] to try, from ``min_load`` to ``max_force`` [N], the safest first.

    If ``wanted`` [N] is given, it is the only load. ``pushed`` [N] is the drag of a
    body that the object pushes. ``uses`` are the friction utilisations to try, the best
    first. Raises RefusedError if no press is feasible.
    """
    if wanted is not None:
        used = friction_use(wanted, weight, mu_support, mu_contact, pushed)
        _check_press(wanted, max_force, used, uses[-1], mu_contact)
        return [wanted]
    loads = [
        max(
            min_load,
            least_load(weight, mu_support, mu_contact, use, pushed),
        )
        for use in uses
    ]
    if loads[-1] <= max_force:
        return sorted({load for load in loads if load <= max_force}, reverse=True)
    if mu_contact <= mu_support:
        raise RefusedError(no_drag(mu_contact, mu_support))
    text = f"needs a press of {{figure:N.1f}}, {FORCE_ALLOWED}"
    raise RefusedError(Refusal("normal_force", text, loads[-1], max_force, "N"))


def no_drag(mu_contact: float, mu_support: float) -> Refusal:
    """Refusal of every press, because the object sticks to the support more than to the
    tip and no load drags it.
    """
    text = (
        "contact friction {figure:g} must exceed the support's, {allowed:g}: no press "
        "drags"
    )
    return Refusal("smooth_tip", text, mu_contact, mu_support)


def _check_press(
    wanted: float, max_force: float, used: float, allowed: float, mu_contact: float
) -> None:
    """Raise RefusedError if a press of ``wanted`` [N] exceeds ``max_force`` [N], or its
    utilisation ``used`` exceeds ``allowed``.
    """
    if wanted > max_force:
        text = f"motion.press_force of {{figure:Ng}}, {FORCE_ALLOWED}"
        raise RefusedError(Refusal("normal_force", text, wanted, max_force, "N"))
    if used > allowed:
        needed = mu_contact * used / allowed
        text = (
            f"pressed with {wanted:g} N the tip slips before the object: straight "
            "sliding takes {figure:.2f} of its friction, allowed {allowed:g}; "
            f"contact friction {mu_contact:g}, needed {needed:.3f}"
        )
        raise RefusedError(Refusal("friction", text, used, allowed))


def pressed_cop(contact: Point, load: float, weight: float) -> Point:
    """CoP [m] in B under a press at ``contact`` without a force along the support."""
    n = load / (weight + load)
    return (n * contact[0], n * contact[1])


def least_lever(scene: Scene, load: float) -> float:
    """Smallest lever d [m] of a press of ``load`` [N] about the centre of pressure with
    which the drag turns the object against the friction under the tip.

    mu_s N d = mu_a N_a a, with the lever arm a of the tip's patch.
    """
    holding = scene.contact_friction * load * margins.PATCH * scene.tip_radius
    return holding / scene.max_friction(load)


def press_lever(scene: Scene, press: Contact) -> float:
    """Distance [m] of a press from the centre of pressure."""
    return math.dist(press.point, pressed_cop(press.point, press.load, scene.weight_on))


def lever_refusal(scene: Scene, press: Contact) -> Refusal | None:
    """Refusal of steering by a press whose lever is too short to turn the object, or
    None.
    """
    lever = press_lever(scene, press)
    lower = least_lever(scene, press.load)
    if lever >= lower:
        return None
    text = (
        f"pressed with {press.load:.1f} N an object of {scene.weight_on:.2f} N turns "
        "with the tool: the drag has a lever of {figure:mm.2f}, allowed from "
        "{allowed:mm.2f}, where it outweighs the friction under the tip"
    )
    return Refusal("held", text, lever, lower, "m")


def resting_cop(scene: Scene, presses: Sequence[Contact]) -> Point:
    """Centre of pressure [m] in B under presses, without drag."""
    loads = [contact.load for contact in presses]
    points = [contact.point for contact in presses]
    return center_of_pressure(scene.weight_on, (0.0, 0.0), loads, points)


def press_utilisation(scene: Scene, load: float, pushed: float = 0.0) -> float:
    """Believed friction utilisation of a press of ``load`` [N] that slides the object
    straight.

    ``pushed`` [N] is as in ``friction_use``.
    """
    mu_s = scene.support.friction
    return friction_use(load, scene.weight_on, mu_s, scene.contact_friction, pushed)
