"""Friction between a body and its support, summed over samples of the load: the exact
limit surface of any pressure (docs/mechanics.md, section 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from pushpressslide.kernels.kernel import kernel_apart
from pushpressslide.kernels.support_friction import CREEP, Friction

Samples = Sequence[Sequence[float]]
"""Rows x, y [m] from the centre of pressure, mean square distance [m^2] of the sample's
load to it, and share of the load.
"""


@kernel_apart
def sampled_friction(vx: float, vy: float, w: float, samples: Samples) -> Friction:
    """Return wrench, over mu_s N, and slope of a twist of the centre of pressure."""
    fx = 0.0
    fy = 0.0
    tau = 0.0
    xx = 0.0
    xy = 0.0
    xw = 0.0
    yy = 0.0
    yw = 0.0
    ww = 0.0
    for sample in samples:
        x = sample[0]
        y = sample[1]
        square = sample[2]
        px = vx - w * y
        py = vy + w * x
        turn = vy * x - vx * y + w * square
        still = w * w * (square - x * x - y * y) + CREEP * CREEP
        squared = px * px + py * py + still
        k = sample[3] / sqrt(squared)
        per = k / squared
        fx = fx + k * px
        fy = fy + k * py
        tau = tau + k * turn
        xx = xx + k - per * px * px
        xy = xy - per * px * py
        xw = xw - k * y - per * px * turn
        yy = yy + k - per * py * py
        yw = yw + k * x - per * py * turn
        ww = ww + k * square - per * turn * turn
    return fx, fy, tau, xx, xy, xw, yy, yw, ww
