"""Joint paths of one placement after the other."""

from __future__ import annotations

from pushpressslide.core.plan import Plan, lasting_arms
from pushpressslide.sim.joints.arms import drawn_back, joint_paths
from pushpressslide.sim.joints.joint_path import ArmPath


class PlacementPaths:
    """Joint paths of placements, each from where the arms let go in the one before."""

    def __init__(self, force: bool = False) -> None:
        """Begin without a placement; ``force`` takes the best paths there are."""
        self.force = force
        self.plans: list[Plan] = []
        self.paths: list[tuple[ArmPath, ...]] = []

    def add(self, placement: Plan) -> None:
        """Add the plan of one more placement.

        One that goes on with all contacts of the placement before it lengthens that.
        Raises InfeasibleTaskError as ``joint_paths``.
        """
        plans = list(self.plans)
        if plans and plans[-1].segments[-1].same_placement(placement.segments[0]):
            begun = plans.pop()
            segments = (*begun.segments, *placement.segments)
            placement = Plan(begun.task, segments)
        paths = self.paths[: len(plans)]
        postures = None
        holding = frozenset[int]()
        if plans:
            last = plans[-1]
            holding = lasting_arms(last.segments, placement.segments)
            postures = drawn_back(last, paths[-1], holding)
        added = joint_paths(
            placement, force=self.force, postures=postures, holding=holding
        )
        self.plans = [*plans, placement]
        self.paths = [*paths, added]


def all_joint_paths(plan: Plan) -> list[tuple[ArmPath, ...]]:
    """Return the joint paths of every placement of a plan.

    Raises InfeasibleTaskError as ``joint_paths``.
    """
    out = PlacementPaths()
    for placement in plan.by_placement:
        out.add(placement)
    return out.paths
