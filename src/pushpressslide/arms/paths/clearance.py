"""Clearances of an arm to its surroundings, and the interface that measures them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2

# [m] least distance of the arm's capsules, which contain the real outline with 1 cm to
# spare
CLEARANCE = 0.005
LOOK = 0.08  # [m] larger distances are not computed


@dataclass(frozen=True, slots=True)
class Gap:
    """Distance between two shapes, and their required clearance."""

    distance: float  # [m]
    pair: str  # their names
    allowed: float = CLEARANCE  # [m]
    # [m] between the object and the links, those aside that keep theirs as planned
    to_object: float = LOOK

    @property
    def clear(self) -> bool:
        """Whether the two shapes keep their clearance."""
        return self.distance >= self.allowed

    @property
    def lack(self) -> float:
        """Shortfall [m] of the clearance. Negative if the clearance is kept."""
        return self.allowed - self.distance

    @property
    def text(self) -> str:
        """Shortfall of the clearance, in words."""
        digits = 0 if self.allowed == CLEARANCE else 1
        return (
            f"{self.pair} come as near as {self.distance * 1e3:.1f} mm, allowed from "
            f"{self.allowed * 1e3:.{digits}f} mm"
        )


NOTHING = Gap(LOOK, "nothing within reach")


class Clearance(Protocol):
    """Distances of one arm to the object, the support, the obstacles, and arms that
    stand still.
    """

    def min_distance(
        self,
        postures: Array,
        object_poses: Sequence[Pose2],
        *,
        touching: bool,
        bodies: Mapping[str, Sequence[Pose2]] | None = None,
    ) -> Gap:
        """Tightest gap, searched up to ``LOOK``, over postures (k, n) and object poses
        X_WG (k).

        With ``touching``, the tip's sphere touches the object on purpose, so this pair
        is excluded. ``bodies`` are poses (k each) of movable obstacles by name, by
        default those of the task.
        """
