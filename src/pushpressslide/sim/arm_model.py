"""Kinematics and dynamics of one arm for its controller, in a plant of its own."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.execution.arm import ArmState
from pushpressslide.sim.robot_models import add_robot


class ArmModel:
    """Computes an ArmState from joint positions and velocities."""

    def __init__(self, robot: Robot, *, models: str = "generated") -> None:
        """Build the arm's own plant."""
        plant = MultibodyPlant(0.0)
        self.instance = add_robot(plant, robot, 0, models=models)
        plant.Finalize()
        self._plant = plant
        self._context = plant.CreateDefaultContext()
        self._tip = self.instance.tip_frame
        world = plant.world_frame()
        self._at_tip = (
            JacobianWrtVariable.kV,
            self._tip,
            np.zeros(3),
            world,
            world,
        )
        self.size = plant.num_positions(self.instance.model_instance)

    def state(self, q: Array, v: Array) -> ArmState:
        """Return what a torque controller needs at joint positions ``q`` (n,) and
        velocities ``v`` (n,).
        """
        plant = self._plant
        context = self._context
        plant.SetPositionsAndVelocities(context, np.concatenate([q, v]))
        J = plant.CalcJacobianSpatialVelocity(context, *self._at_tip)
        drift = plant.CalcBiasSpatialAcceleration(context, *self._at_tip)
        X = self._tip.CalcPoseInWorld(context)
        M = plant.CalcMassMatrix(context)
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        x, y, z = X.translation().tolist()
        wx, wy, wz, vx, vy, vz = (J @ v).tolist()
        return ArmState(
            q,
            v,
            (x, y, z),
            X.rotation().matrix(),
            (vx, vy, vz),
            (wx, wy, wz),
            J,
            M,
            bias,
            drift.get_coeffs(),
        )
