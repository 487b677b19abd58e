"""One tip pressed on top of an object: how hard to press, and the centre of pressure.

Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math

from pushpressslide.core.pose import Point

# shares of the press's friction that a motion may take, the best first
USES = (0.7, 0.8, 0.9, 0.96)
MOST_USE = USES[-1]
LEAST_PRESS = 2.0  # [N] below which contact is not felt for sure


def friction_use(
    load: float,
    weight: float,
    mu_support: float,
    mu_contact: float,
    pushed: float = 0.0,
) -> float:
    """Return what straight sliding takes of the press's friction: (mu_s (N_o + N_a) +
    pushed) / (mu_a N_a); below 1 it sticks. ``pushed`` [N]: the drag of a body that the
    object pushes.
    """
    return (
        (mu_support * (weight + load) + pushed) / (mu_contact * load)
        if load > 0.0
        else math.inf
    )


def least_load(
    weight: float,
    mu_support: float,
    mu_contact: float,
    use: float = 1.0,
    pushed: float = 0.0,
) -> float:
    """Return the least press N_a [N] that drags in every direction with ``use`` of its
    friction.

    (mu_s N_o + pushed) / (use mu_a - mu_s); infinite where no press is hard enough.
    """
    room = use * mu_contact - mu_support
    return (mu_support * weight + pushed) / room if room > 0.0 else math.inf


def press_loads(
    weight: float,
    mu_support: float,
    mu_contact: float,
    most: float,
    wanted: float | None = None,
    pushed: float = 0.0,
) -> tuple[str | None, list[float]]:
    """Return what stands against any press, and the loads [N] to try, safest first.

    Up to ``most`` [N]. ``wanted`` [N] is the only load where it is given; ``pushed``
    [N]: that of a body that the object pushes.
    """
    if wanted is not None:
        use = friction_use(wanted, weight, mu_support, mu_contact, pushed)
        problem = _press_problem(wanted, most, use, mu_contact)
        return problem, [] if problem else [wanted]
    loads = [
        max(LEAST_PRESS, least_load(weight, mu_support, mu_contact, use, pushed))
        for use in USES
    ]
    if loads[-1] <= most:
        return None, sorted({load for load in loads if load <= most}, reverse=True)
    if mu_contact <= mu_support:
        return (
            f"contact friction {mu_contact:g} must exceed the support's, "
            f"{mu_support:g}: no press drags"
        ), []
    return (
        f"needs a press of {loads[-1]:.1f} N, limits.normal_force is {most:g} N",
        [],
    )


def _press_problem(
    load: float, most: float, use: float, mu_contact: float
) -> str | None:
    """Return what stands against a given press [N], of whose friction ``use`` is taken."""
    if load > most:
        return f"motion.press_force of {load:g} N, limits.normal_force is {most:g} N"
    if use > MOST_USE:
        needed = use * mu_contact / MOST_USE
        return (
            f"pressed with {load:g} N the tip slips before the object: straight "
            f"sliding takes {use:.2f} of "
            f"its friction, allowed {MOST_USE:g}; contact friction {mu_contact:g}, "
            f"needed {needed:.3f}"
        )
    return None


def pressed_cop(contact: Point, load: float, weight: float) -> Point:
    """Return the CoP [m] in B under a press at ``contact``, no force along the support."""
    n = load / (weight + load)
    return (n * contact[0], n * contact[1])
