"""Waiting posture of an arm without a contact while another arm moves the object.

The arm stays where it is if it is out of the way. Otherwise it is parked at its home
posture or elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np

from pushpressslide.arms.paths.arm_problem import ArmProblem
from pushpressslide.arms.paths.postures import Miss, Move, Posture
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.robots.tool import UPRIGHT

PARKED = 8  # largest number of parking postures that are offered


def waiting_moves(problem: ArmProblem, *, force: bool = False) -> Iterator[Move | Miss]:
    """Yield the postures in which an arm may wait, the preferred first, and the misses
    in between.

    Postures with ample clearance come before those that are only just clear. With
    ``force`` the last posture is the present one, however bad it is.
    """
    start = problem.approach.start_posture
    home = problem.kin.facts.home
    offered = 0
    tight: list[Move] = []
    near = (start,) if np.array_equal(start, home) else (start, home)
    for q in chain(near, problem.approach.high_postures()):
        gap = problem.waiting_clearance(q)
        move = _still(problem, q)
        if not gap.clear:
            yield Miss(10.0 * gap.lack, f"waiting, {gap.text}", move.posture)
        elif gap.distance < margins.ARM.waiting:
            tight.append(move)
        else:
            yield move
            offered += 1
        if offered == PARKED:
            break
    yield from tight
    if force:
        yield _still(problem, start)


def _still(problem: ArmProblem, q: Array) -> Move:
    """Move that keeps a posture (n,) while the object moves."""
    still = np.repeat(q[None], len(problem.object_path.shapes), axis=0)
    return Move.from_posture(problem.kin, Posture(UPRIGHT, 0.0, still))
