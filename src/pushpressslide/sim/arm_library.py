"""Drake as the library of the joint-path search."""

from __future__ import annotations

from collections.abc import Mapping

from pushpressslide.arms.paths.capsules import ArmCapsules
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.paths.placements import PlacementPaths
from pushpressslide.arms.paths.postures import Posture, TipPath
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.task import Robot
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.sim.arm_model import DrakeArmModel
from pushpressslide.sim.clearance import DrakeClearance
from pushpressslide.sim.outline import arm_capsules
from pushpressslide.sim.refine import refined_move


class DrakeLibrary:
    """Drake's implementation of ``arms.paths.library.ArmLibrary``."""

    def model(self, robot: Robot) -> DrakeArmModel:
        """The arm's dynamics."""
        return DrakeArmModel(robot)

    def clearance(
        self, plan: Plan, arm: int, others: Mapping[int, Array]
    ) -> DrakeClearance:
        """Clearance model of an arm."""
        return DrakeClearance(plan, arm, others)

    def capsules(self, robot: Robot, index: int) -> ArmCapsules:
        """Capsules that enclose an arm."""
        return arm_capsules(robot, index)

    def refined(
        self,
        kinematics: ArmKinematics,
        clearance: DrakeClearance,
        path: TipPath,
        guess: Posture,
        margin: float,
        min_distance: float,
    ) -> Posture | None:
        """A posture found by trajectory optimisation near a guess, or None."""
        return refined_move(kinematics, clearance, path, guess, margin, min_distance)


DRAKE = DrakeLibrary()


def joint_paths_of(plan: Plan) -> list[tuple[ArmPath, ...]]:
    """Joint paths of every placement of a plan.

    Raises InfeasibleTaskError if an arm has none.
    """
    out = PlacementPaths(DRAKE)
    for placement in plan.by_placement:
        out.add(placement)
    return out.paths
