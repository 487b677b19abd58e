"""Kinematics and dynamics of one arm for its controller, in a separate plant."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable, MultibodyForces

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.robots.facts import RobotFacts
from pushpressslide.sim.robot_models import add_robot


class DrakeArmModel:
    """Drake's model of an arm, as ``arms.model.ArmModel``."""

    def __init__(
        self, robot: Robot, truth: Truth = EXACT, *, models: str = "generated"
    ) -> None:
        """Build the arm's own plant. The arm differs from ``robot`` by ``truth``."""
        plant = MultibodyPlant(0.0)
        plant.mutable_gravity_field().set_gravity_vector(list(truth.gravity))
        self.instance = add_robot(plant, robot, 0, models=models, truth=truth)
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
        self._rest = np.zeros(self.size)  # (n,) [rad/s^2]
        self._forces = MultibodyForces(plant)  # without contact, at the present state

    @property
    def facts(self) -> RobotFacts:
        """The manufacturer's limits of the arm's joints."""
        return self.instance.facts

    def state(self, q: Array, v: Array) -> ArmDynamics:
        """State at joint positions ``q`` (n,) and velocities ``v`` (n,)."""
        return self.state_at(np.concatenate([q, v]))

    def state_at(self, x: Array) -> ArmDynamics:
        """State that a torque controller needs at ``x`` (2 n,), positions and
        velocities.
        """
        plant = self._plant
        context = self._context
        v = x[self.size :]
        plant.SetPositionsAndVelocities(context, x)
        J = plant.CalcJacobianSpatialVelocity(context, *self._at_tip)
        drift = plant.CalcBiasSpatialAcceleration(context, *self._at_tip)
        X = self._tip.CalcPoseInWorld(context).GetAsMatrix34()
        M = plant.CalcMassMatrix(context)
        plant.CalcForceElementsContribution(context, self._forces)
        bias = plant.CalcInverseDynamics(context, self._rest, self._forces)
        px, py, pz = X[:, 3].tolist()
        wx, wy, wz, vx, vy, vz = (J @ v).tolist()
        return ArmDynamics(
            x[: self.size],
            v,
            (px, py, pz),
            X[:, :3],
            (vx, vy, vz),
            (wx, wy, wz),
            J,
            M,
            bias,
            drift.get_coeffs(),
        )
