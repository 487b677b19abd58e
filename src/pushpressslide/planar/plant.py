"""The planar cell under its name in earlier versions."""

from __future__ import annotations

import warnings

from pushpressslide.control.cell import Cell
from pushpressslide.core.plan import Plan
from pushpressslide.planar.cell import planar_cell


def PlanarPlant(plan: Plan) -> Cell:
    """Like ``planar.cell.planar_cell``, with a DeprecationWarning. To be removed in
    0.5.
    """
    warnings.warn(
        "PlanarPlant goes with version 0.6: use pushpressslide.planar.cell.planar_cell",
        DeprecationWarning,
        stacklevel=2,
    )
    return planar_cell(plan)
