"""Joint paths of one placement after the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pushpressslide.arms.paths.all_arms import drawn_back, joint_paths
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Plan, arms_kept
from pushpressslide.planning.free_space import Bounds

ROOM = 0.05  # [m] about the object, for errors


class PlacementPaths:
    """Joint paths of placements, each from where the arms let go in the one before."""

    def __init__(
        self,
        library: ArmLibrary,
        force: bool = False,
        postures: tuple[Array, ...] | None = None,
        within: Bounds | None = None,
    ) -> None:
        """Begin without a placement; ``force`` takes the best paths there are.

        ``postures`` (n,) [rad] are where the arms begin, None for their ready postures;
        ``within`` [m] bounds where the object may be led: x_min, x_max, y_min, y_max.
        """
        self.library = library
        self.force = force
        self.postures = postures
        self.within = within
        self.plans: list[Plan] = []
        self.paths: list[tuple[ArmPath, ...]] = []

    def add(self, placement: Plan) -> None:
        """Add the plan of one more placement.

        One that goes on with all contacts of the placement before it lengthens that.
        Raises InfeasibleTaskError as ``joint_paths``.
        """
        if self.within is not None:
            _check_bounds(placement, self.within)
        plans = list(self.plans)
        if plans and plans[-1].segments[-1].same_placement(placement.segments[0]):
            begun = plans.pop()
            segments = (*begun.segments, *placement.segments)
            placement = replace(begun, segments=segments)
        paths = self.paths[: len(plans)]
        postures = self.postures
        holding = frozenset[int]()
        if plans:
            last = plans[-1]
            holding = arms_kept(last.segments, placement.segments)
            postures = drawn_back(paths[-1], holding)
        added = joint_paths(
            self.library,
            placement,
            force=self.force,
            postures=postures,
            holding=holding,
        )
        self.plans = [*plans, placement]
        self.paths = [*paths, added]

    def keep(self, count: int) -> None:
        """Forget all placements but the first ``count``."""
        self.plans = self.plans[:count]
        self.paths = self.paths[:count]

    def after(self) -> PlacementPaths:
        """Return an empty preparation from where the arms are after all placements."""
        postures = self.postures
        if self.plans:
            postures = drawn_back(self.paths[-1])
        return PlacementPaths(self.library, self.force, postures, self.within)


def _check_bounds(placement: Plan, within: Bounds) -> None:
    """Raise InfeasibleTaskError where a plan leads the object beyond ``within``."""
    low_x, high_x, low_y, high_y = within
    x_min, x_max, y_min, y_max = reached_bounds(placement, ROOM)
    beyond = max(low_x - x_min, x_max - high_x, low_y - y_min, y_max - high_y)
    if beyond > 0.0:
        raise InfeasibleTaskError(
            f"{placement.query.source}: the object would be led {beyond:.2f} m beyond "
            "the support that is modelled"
        )


def reached_bounds(plan: Plan, margin: float) -> Bounds:
    """Return x_min, x_max, y_min, y_max [m] of what the object covers on its planned
    way, and ``margin`` [m] about it.
    """
    poses = [plan.true_start]
    for segment in plan.segments:
        grid = np.linspace(0.0, segment.path.length, 60)
        poses += [plan.object_pose(segment, s) for s in grid]
    x = [p.x for p in poses]
    y = [p.y for p in poses]
    reach = plan.task.object.shape.farthest((0.0, 0.0)) + margin
    return min(x) - reach, max(x) + reach, min(y) - reach, max(y) + reach
