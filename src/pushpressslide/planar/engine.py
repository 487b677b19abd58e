"""The fast engine: runs a plan quasi-statically on the exact limit surface, with the
same controller as Drake.
"""

from __future__ import annotations

from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.planar.cell import planar_cell


def run(plan: Plan, options: RunOptions | None = None) -> Record:
    """Run ``plan`` from the task's true start and return its record.

    If the run continues from a state, it takes over the tips of that state. The record
    is deterministic for a given seed. Movable obstacles are not modelled: the object
    passes through them.
    """
    return run_loop(planar_cell(plan, options), plan, options)
