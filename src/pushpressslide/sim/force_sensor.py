"""The force sensor in the mount of a tip."""

from __future__ import annotations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from pushpressslide.core.control import Vector3
from pushpressslide.sim.robot_models import RobotInstance


class ForceSensor:
    """Measures the force of a tip on what it touches by the reaction in its mount."""

    def __init__(self, plant: MultibodyPlant, robot: RobotInstance) -> None:
        """Find mount and tip in the finalized ``plant``."""
        joint = plant.GetJointByName(robot.tip_joint_name, robot.model_instance)
        # reaction forces are listed by ordinal: the joint's place among all joints
        self._joint = plant.GetJointIndices().index(joint.index())
        self._reactions = plant.get_reaction_forces_output_port()
        self._accelerations = plant.get_body_spatial_accelerations_output_port()
        self._plant = plant
        self._tip = robot.tip_body
        self._mass = robot.tip_body.default_mass()
        self._gravity = plant.gravity_field().gravity_vector()
        self._R_TJ = (
            joint.frame_on_child().GetFixedPoseInBodyFrame().rotation().matrix()
        )

    def force(self, context: Context) -> Vector3:
        """Return the force [N] of the tip ON what it touches, world axes, in the plant's
        ``context``: the reaction less what bears and moves the tip's own mass, which is
        taken to be at its centre.
        """
        reaction = self._reactions.Eval(context)[self._joint].translational()
        tip = self._tip
        moved = self._accelerations.Eval(context)[tip.index()].translational()
        R_WT = self._plant.EvalBodyPoseInWorld(context, tip).rotation().matrix()
        own = self._mass * (self._gravity - moved)
        fx, fy, fz = (R_WT @ (self._R_TJ @ reaction) + own).tolist()
        return (fx, fy, fz)
