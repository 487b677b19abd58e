"""Joint paths of consecutive placements."""

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
    """Joint paths of placements, each from the arms' postures after the previous
    release.
    """

    def __init__(
        self,
        library: ArmLibrary,
        force: bool = False,
        postures: tuple[Array, ...] | None = None,
        within: Bounds | None = None,
    ) -> None:
        """Start without a placement. ``force`` takes the best paths available.

        ``postures`` (n,) [rad] are the arms' initial postures, None for their ready
        postures. ``within`` [m] bounds the region of the object: x_min, x_max, y_min,
        y_max.
        """
        self.library = library
        self.force = force
        self.postures = postures
        self.within = within
        self.plans: list[Plan] = []
        self.paths: list[tuple[ArmPath, ...]] = []

    @property
    def margin_share(self) -> float:
        """Least share of the room that an unsure object asks for, of the last
        placement's arms.
        """
        return min(path.margin_share for path, _ in self.paths[-1])

    def add(self, placement: Plan) -> None:
        """Append the plan of a placement.

        A plan that keeps all contacts of the previous placement extends that placement.
        Raises InfeasibleTaskError as ``joint_paths`` does.
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
        """Planner without placements that starts from the arms' state after all
        placements.
        """
        postures = self.postures
        if self.plans:
            postures = drawn_back(self.paths[-1])
        return PlacementPaths(self.library, self.force, postures, self.within)


def _check_bounds(placement: Plan, within: Bounds) -> None:
    """Raise InfeasibleTaskError if a plan leads the object beyond ``within``."""
    low_x, high_x, low_y, high_y = within
    x_min, x_max, y_min, y_max = reached_bounds(placement, ROOM)
    beyond = max(low_x - x_min, x_max - high_x, low_y - y_min, y_max - high_y)
    if beyond > 0.0:
        raise InfeasibleTaskError(
            f"{placement.query.source}: the object would move {beyond:.2f} m beyond "
            "the support that is modelled"
        )


def reached_bounds(plan: Plan, margin: float) -> Bounds:
    """Bounds x_min, x_max, y_min, y_max [m] of the object's footprint along its planned
    path, enlarged by ``margin`` [m].
    """
    poses = [plan.true_start]
    for segment in plan.segments:
        grid = np.linspace(0.0, segment.path.length, 60)
        poses += [plan.object_pose(segment, s) for s in grid]
    x = [p.x for p in poses]
    y = [p.y for p in poses]
    reach = plan.task.object.shape.farthest((0.0, 0.0)) + margin
    return min(x) - reach, max(x) + reach, min(y) - reach, max(y) + reach
