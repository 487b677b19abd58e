"""Friction of each surface of a task, from that of its pairs.

A task names the friction of PAIRS of surfaces. Two surfaces of friction a and b have
2 a b / (a + b) between them, so that pairs which no task names follow from the others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.task import Task

OBJECT_FRICTION = 1.0
"""Friction of the object's own surface, from which those of its partners follow."""
ROUGHEST = 1.99
"""Largest friction of a pair over that of the smoother surface; 2 is the limit."""


def pair_friction(a: float, b: float) -> float:
    """Friction of a pair of surfaces of friction ``a`` and ``b``."""
    return 2.0 * a * b / (a + b)


def partner_friction(pair: float, own: float = OBJECT_FRICTION) -> float:
    """Surface friction b that results in the friction ``pair`` = 2 a b / (a + b)
    against a surface with a = ``own``.

    Raises ValueError if no surface can (pair >= 2 own).
    """
    if not 0.0 < pair < 2.0 * own:
        raise ValueError(f"pair friction {pair} is not in (0, {2.0 * own})")
    return pair * own / (2.0 * own - pair)


@dataclass(frozen=True)
class SurfaceFrictions:
    """Surface frictions, from which Drake computes those of pairs."""

    object: float
    support: float
    tip: float

    @classmethod
    def of_task(cls, task: Task) -> SurfaceFrictions:
        """Surface frictions that reproduce the pair frictions of a task."""
        own = object_friction(task)
        support = partner_friction(task.support.friction, own)
        return cls(own, support, partner_friction(task.contact_friction, own))

    def obstacle(self, pair: float) -> float:
        """Surface friction of an obstacle with friction ``pair`` against the support.

        If no value is high enough, because the pair frictions of tip, object, support
        and obstacle are incompatible, the result is a very rough surface.
        """
        if pair < ROUGHEST * self.support:
            return partner_friction(pair, self.support)
        return 200.0 * self.support


def object_friction(task: Task) -> float:
    """Friction of the object's own surface, from which the frictions of its partners
    follow.

    It is OBJECT_FRICTION, unless a movable obstacle needs more friction on the support
    than the support's surface could then provide. In that case it lies between the
    smallest value that allows the tip/object friction and the largest value that leaves
    the support rough enough.
    """
    pairs = [o.friction for o in task.obstacles if o.movable]
    support = task.support.friction
    if not pairs or max(pairs) <= max(support, ROUGHEST * partner_friction(support)):
        return OBJECT_FRICTION
    least = 0.51 * max(task.contact_friction, support)
    rough = 0.5 * max(pairs)
    return math.sqrt(least * max(least, support * rough / (2.0 * rough - support)))
