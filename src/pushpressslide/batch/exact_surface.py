"""The exact limit surface on arrays: sums over the samples of one pressure.

Source: docs/mechanics.md, section 1; ``mechanics.limit_surface`` and
``mechanics.virtual_axle`` do the same for one object. As there, wrenches are about the
centre of pressure, and twists are those of the centre of pressure.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import check_all, check_last, check_positive
from pushpressslide.batch.rows import answers, figures, figures_of, spread
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.exact_surface import (
    exact_axle,
    exact_slide,
    wrench_of_samples,
)
from pushpressslide.mechanics.limit_surface import load_spread, slide_samples
from pushpressslide.mechanics.pressure import PressureSamples


class ExactSurface:
    """Limit surface of one pressure, for friction of any leading shape."""

    def __init__(self, samples: PressureSamples, friction: ArrayLike) -> None:
        """Prepare the surface. ``friction`` (...) > 0 is that of the pair
        object/support.
        """
        (self._friction,) = figures(friction)
        check_positive(self._friction, "friction", "")
        x, y = (samples.points - np.array(samples.cop)).T
        self._load = samples.total_load
        self._samples = np.stack([x, y, samples.radii, samples.loads])
        self._extent, self._over_rho = slide_samples(samples)

    def wrenches(self, twists: ArrayLike) -> Array:
        """Wrenches (..., 3) that drive ``twists`` (..., 3).

        A sample at the centre of rotation contributes no force.
        """
        (rows,) = figures(twists)
        check_last(rows, (3,), "twists")
        arrays = (self._samples,)
        unit = answers(wrench_of_samples, spread(rows), arrays=arrays, columns=3)
        return unit * self._friction[..., None]

    def slides(self, wrenches: ArrayLike) -> tuple[Array, Array]:
        """Twists (..., 3) that ``wrenches`` (..., 3) drive, with |(v, rho w)| = 1, and
        the factors (...) by which they exceed the surface.

        rho is the mean distance of the load from its centre. As in
        ``mechanics.limit_surface.exact_slide``, the twist has the smallest friction
        power among all twists at which the wrench has unit power. Raises ValueError for
        a wrench that is zero or not finite, and for a pressure without extent.
        """
        (rows,) = figures(wrenches)
        check_last(rows, (3,), "wrenches")
        if self._extent[0] == 0.0:
            raise ValueError("extent of the pressure 0.0 m; must be > 0")
        sizes = np.linalg.norm(rows / (1.0, 1.0, self._extent[0]), axis=-1)
        moves = np.isfinite(sizes) & (sizes > 0.0)
        check_all(moves, sizes, "size of a wrench", "finite and > 0", "N")
        extent = figures_of(self._extent)
        arrays = (self._over_rho,)
        out = answers(exact_slide, spread(rows), extent, arrays, columns=4)
        levels = out[..., 3] / (self._load * self._friction)
        return np.broadcast_to(out[..., :3], (*levels.shape, 3)).copy(), levels


def exact_axle_distances(
    samples: PressureSamples, levers: ArrayLike, angles: ArrayLike
) -> Array:
    """Distances (...) [m] from the centre of pressure to the virtual axle.

    They are those of ``mechanics.virtual_axle.exact_axle_distance`` for ``levers``
    (..., 2) [m] and force ``angles`` (...) [rad]. Raises ValueError for a lever that is
    zero.
    """
    arms, turns = figures(levers, angles)
    check_last(arms, (2,), "levers")
    check_positive(np.hypot(arms[..., 0], arms[..., 1]), "lever", "m")
    turns = np.where(np.isfinite(turns), turns, math.nan)
    row = figures_of(arms[..., 0], arms[..., 1], turns)
    extent, over_rho = slide_samples(samples)
    law = figures_of(load_spread(samples), extent)
    return answers(exact_axle, row, law, (over_rho,), columns=1)[..., 0]
