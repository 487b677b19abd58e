"""Kinematics and dynamics of one arm for its controller, in a model of its own."""

from __future__ import annotations

import mujoco
import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.mujoco_sim.arm_bodies import add_arm
from pushpressslide.robots.facts import RobotFacts


class MujocoArmModel:
    """MuJoCo's model of an arm, as ``arms.model.ArmModel``."""

    def __init__(self, robot: Robot, truth: Truth = EXACT) -> None:
        """Build the arm's own model. The arm differs from ``robot`` by ``truth``."""
        spec = mujoco.MjSpec()
        spec.compiler.degree = False
        spec.option.gravity = list(truth.gravity)
        names = add_arm(spec, robot, 0, truth)
        self.facts: RobotFacts = names.facts
        self.compiled = model = spec.compile()
        self._at = mujoco.MjData(model)
        self._tip = model.body(names.tip).id
        self.size: int = model.nv
        self._unit = np.eye(self.size)

    def state_at(self, x: Array) -> ArmDynamics:
        """State that a torque controller needs at ``x`` (2 n,), positions and
        velocities.
        """
        model = self.compiled
        at = self._at
        n = self.size
        q, v = x[:n], x[n:]
        at.qpos[:] = q
        at.qvel[:] = v
        mujoco.mj_fwdPosition(model, at)
        mujoco.mj_fwdVelocity(model, at)
        J = np.zeros((6, n))
        rate = np.zeros((6, n))
        place = at.xpos[self._tip]
        mujoco.mj_jac(model, at, J[3:], J[:3], place, self._tip)
        mujoco.mj_jacDot(model, at, rate[3:], rate[:3], place, self._tip)
        M = np.zeros((n, n))
        for column, unit in zip(M, self._unit, strict=True):
            mujoco.mj_mulM(model, at, column, unit)
        px, py, pz = place.tolist()
        wx, wy, wz, vx, vy, vz = (J @ v).tolist()
        return ArmDynamics(
            q,
            v,
            (px, py, pz),
            at.xmat[self._tip].reshape(3, 3).copy(),
            (vx, vy, vz),
            (wx, wy, wz),
            J,
            M,
            at.qfrc_bias - at.qfrc_passive,
            rate @ v,
        )
