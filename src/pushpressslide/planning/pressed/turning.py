"""How much a force turns a pressed object, at each of its angles."""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.mechanics.dragging import RESOLUTION
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.mechanics.turning import Turning
from pushpressslide.planning.pressed.turns import slides


def turning_of(press: Press) -> Turning:
    """Return R of the exact surface: the force's moment about the CoM, per force, times
    the way of the centre of pressure along the force, per turn.
    """
    angles, (along, across, w) = slides([press], RESOLUTION)
    lever = math.hypot(*press.contact)
    sine = np.sin(angles)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = lever * sine * (along[0] * np.cos(angles) + across[0] * sine) / w[0]
    # a force along the axis does not turn the object
    known = np.isfinite(values) & (np.abs(sine) > 1e-6)
    return Turning(tuple(angles[known].tolist()), tuple(values[known].tolist()))
