"""Motion of many bodies on their supports under compliant tips.

Each body takes the twist at which all forces balance. The kernel is that of
``planar.sliding``, which handles one body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pushpressslide.batch.rows import answers, figures_of, grouped
from pushpressslide.batch.support import Support
from pushpressslide.core.arrays import Array

NO_TIP = np.array([1.0, 0.0, -1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
"""A tip that touches nothing."""


def slide(support: Support, tips: Sequence[Array], guesses: Array) -> Array:
    """Twists (n, 3) at which supports and tips balance, to 1e-9 of mu_s N.

    ``tips`` are one or two arrays (n, 10). Let n be the unit inward normal of the face,
    t the direction to its left, p the contact and c the tip's centre, which is behind p
    along n. The columns are n; the components along n and t of f_0 [N], the force of a
    tip at rest minus damping times the speed at which the gap closes; the damping [N
    s/m] along n and t; the friction; and the lever arms p x n, p x t and c x t, each
    divided by rho. ``guesses`` (n, 3) are the twists of the previous tick. Twists are
    (v_x, v_y, rho w) of the centre of pressure. The parameters of the support are
    single numbers or (n,).
    """
    rho = np.broadcast_to(support.rho, len(guesses))
    scale = np.stack([np.ones_like(rho), np.ones_like(rho), rho], axis=1)
    one, two = (*tips, NO_TIP)[:2]
    sides = figures_of((_side(one, rho), _side(two, rho)))
    row = (grouped(guesses / scale), sides)
    body = figures_of(np.asarray(support.max_force), np.asarray(support.rho))
    out = answers(support.slide, row, body, support.arrays, columns=3)
    return out * scale


def _side(tips: Array, rho: Array) -> tuple[object, ...]:
    """Tips as ``kernels.compliant_tip.Side``, with their gaps closed."""
    nx, ny, fn, ft, bn, bt, friction, across, along, centre = np.moveaxis(tips, -1, 0)

    def place(ahead: Array) -> tuple[Array, Array]:
        """Position of a point with components ``ahead`` along n and t, divided by rho."""
        return rho * (ahead * nx + across * ny), rho * (ahead * ny - across * nx)

    law = ((nx, ny), (fn, ft), (bn, bt))
    return place(along), place(centre), law, friction, np.zeros_like(fn)
