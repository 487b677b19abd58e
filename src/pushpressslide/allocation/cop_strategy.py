"""Loads of two presses that place the centre of pressure (docs/mechanics.md, section
7).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.press_loads import TwoPresses
from pushpressslide.core import margins
from pushpressslide.core.motion import Cop
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist

FRACTIONS = [0.01 * i for i in range(1, 100)]
OPPOSITE = 1e-6  # [m] within which two contacts are opposite each other about the CoM


def safe_loads(
    presses: Callable[[float], TwoPresses],
    cop: Cop,
    twist: Twist,
    uses: Sequence[float],
    lightest: float,
) -> Point | None:
    """Loads [N] of the left and right contact, each at least ``lightest`` [N]. None if
    no loads within the cap suffice.

    The friction utilisations ``uses`` are tried in order until the loads are within the
    cap. If the contacts are opposite each other and balanced, the loads suffice for
    every twist; otherwise they are the smallest for ``twist``. If a load is below
    ``lightest``, both are raised: in their own ratio, or, if ``cop`` is a fraction, so
    that the centre of pressure stays at this fraction. ``presses(use)`` are the presses
    at the utilisation ``use``.
    """
    left = presses(1.0).left
    right = presses(1.0).right
    if cop == "balanced" and math.dist(left, (-right[0], -right[1])) < OPPOSITE:
        for use in uses:
            each = max(0.5 * presses(use).press_for_every_twist(), lightest)
            if each <= presses(use).cap:
                return (each, each)
    for use in uses:
        loads = least_loads(presses(use), cop, twist)
        if loads is None or not min(loads) > 0.0:
            continue
        shares = loads if isinstance(cop, str) else (1.0 - cop, cop)
        more = max(
            0.0,
            *(
                (lightest - load) / share
                for load, share in zip(loads, shares, strict=True)
            ),
        )
        raised = (loads[0] + more * shares[0], loads[1] + more * shares[1])
        if max(raised) <= presses(use).cap:
            return raised
    return None


def least_loads(presses: TwoPresses, cop: Cop, twist: Twist) -> Point | None:
    """Smallest loads [N] of the left and right contact for ``twist``.

    None if no loads up to the cap suffice with the given centre of pressure.
    """
    if isinstance(cop, str):
        loads = presses.in_ratio(cop, twist)
    else:
        loads = presses.for_cop(cop, twist)
    if loads.status != "ok":
        return None
    return loads.normals


def loads_with(presses: TwoPresses, cop: Cop, heavier: float) -> Point:
    """Loads [N] of the left and right contact, the larger one equal to ``heavier``. The
    smaller one is negative if its contact would have to pull to place the centre of
    pressure at ``cop``.
    """
    weight = presses.weight
    if isinstance(cop, str):
        lower = presses.least_fraction + margins.SPARE_LOAD
        lighter = heavier
        if cop != "balanced" and lower < 0.5:
            lighter = min(heavier, lower * (weight + heavier) / (1.0 - lower))
        if cop == "right":
            return (lighter, heavier)
        return (heavier, lighter)
    line = ContactLine(presses.left, presses.right)
    own = line.in_axes((-presses.left[0], -presses.left[1]))[0] / line.length * weight
    parts = ((heavier + own, cop), (heavier + weight - own, 1.0 - cop))
    load = min(load / part for load, part in parts if part > 0.0)
    return ((1.0 - cop) * load - (weight - own), cop * load - own)


def possible_fractions(
    presses: Callable[[float], TwoPresses],
    twist: Twist,
    uses: Sequence[float],
    lightest: float,
) -> Point | None:
    """Smallest and largest fraction, in steps of 0.01, for which ``safe_loads`` finds
    loads. None if there is no such fraction.
    """
    good = [
        f
        for f in FRACTIONS
        if safe_loads(presses, f, twist, uses, lightest) is not None
    ]
    if not good:
        return None
    return (good[0], good[-1])
