"""The joint paths of one grasp after the other."""

from __future__ import annotations

from pushpressslide.core.plan import Plan, lasting_arms
from pushpressslide.sim.joints.arms import drawn_back, joint_paths
from pushpressslide.sim.joints.joint_path import ArmPath


class GraspPaths:
    """Joint paths, those of each grasp from where the arms let go in the one before."""

    def __init__(self, force: bool = False) -> None:
        """Begin; ``force`` takes the best there is."""
        self.force = force
        self.plans: list[Plan] = []
        self.paths: list[tuple[ArmPath, ...]] = []

    def add(self, grasp: Plan) -> None:
        """Add the plan of one more grasp; raises InfeasibleTaskError as
        ``joint_paths``.
        """
        if self.plans:
            last = self.plans[-1]
            kept = lasting_arms(last.segments, grasp.segments)
            postures = drawn_back(last, self.paths[-1], kept)
            found = joint_paths(
                grasp, force=self.force, postures=postures, holding=kept
            )
        else:
            found = joint_paths(grasp, force=self.force)
        self.paths.append(found)
        self.plans.append(grasp)


def all_joint_paths(plan: Plan) -> list[tuple[ArmPath, ...]]:
    """Return the joint paths of every grasp of a plan; raises InfeasibleTaskError as
    ``joint_paths``.
    """
    out = GraspPaths()
    for grasp in plan.by_placement:
        out.add(grasp)
    return out.paths
