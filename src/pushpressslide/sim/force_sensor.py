"""Force sensor in the mount of a tip."""

from __future__ import annotations

from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import MultibodyPlant

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.sim.robot_models import RobotInstance


class ForceSensor:
    """Measures a tip's force on the body it touches, from the reaction in the tip's
    mount.
    """

    def __init__(self, plant: MultibodyPlant, robot: RobotInstance) -> None:
        """Find mount and tip in the finalized ``plant``."""
        joint = plant.GetJointByName(robot.tip_joint_name, robot.model_instance)
        # reaction forces are listed by ordinal: the joint's place among all joints
        self.joint = plant.GetJointIndices().index(joint.index())
        self._mass = robot.tip_body.default_mass()
        self._gravity = plant.gravity_field().gravity_vector()

    def force(
        self, reaction: SpatialForce, R_WT: Array, acceleration: Array
    ) -> Vector3:
        """Force [N] of the tip ON the touched body, in world axes.

        It is the ``reaction`` in the mount, in T's axes, minus the force that carries
        and accelerates the tip's own mass. The mass is assumed to be at T's origin,
        whose ``acceleration`` (3,) [m/s^2] is given. ``R_WT`` (3, 3) is the rotation of
        the tip frame.
        """
        own = self._mass * (self._gravity - acceleration)
        fx, fy, fz = (R_WT @ reaction.translational() + own).tolist()
        return (fx, fy, fz)
