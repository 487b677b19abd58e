"""Position actuators of an arm whose joints have position loops of their own."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import mujoco
import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.mujoco_sim.arm_bodies import ArmNames

RATE = 150.0
"""Natural frequency [rad/s] of a loop."""


def add_position_loops(spec: Any, joints: Iterable[str]) -> None:
    """Add an actuator to each joint of a specification, named like the joint.

    Its target moves with its control signal [rad/s] in every step of the simulation.
    """
    for joint in joints:
        added = spec.add_actuator(name=joint, target=joint)
        added.trntype = mujoco.mjtTrn.mjTRN_JOINT
        added.dyntype = mujoco.mjtDyn.mjDYN_INTEGRATOR
        added.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        added.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
        added.forcerange = [-1.0, 1.0]  # ``PositionLoops`` sets it


class PositionLoops:
    """Loops of one arm, critically damped by the inertia of each joint alone."""

    def __init__(self, model: Any, arm: ArmNames, mass: Array) -> None:
        """Set the gains in a compiled model by the mass matrix (n, n) in a typical
        posture.
        """
        self._model = model
        self._numbers = [model.actuator(name).id for name in arm.joints]
        self._targets = model.actuator_actadr[self._numbers]
        self._effort = arm.facts.effort_limit
        stiffness = RATE**2 * np.diag(mass)
        self._damping: Array = 2.0 * RATE * np.diag(mass)
        model.actuator_gainprm[self._numbers, 0] = stiffness
        model.actuator_biasprm[self._numbers, 1] = -stiffness
        model.actuator_biasprm[self._numbers, 2] = -self._damping

    def force(self, state: Any) -> Array:
        """Torques (n,) [N m] of the actuators in the last step."""
        out: Array = state.actuator_force[self._numbers]
        return out

    def lead(self, state: Any, bias: Array, start: Array, speed: Array) -> Array:
        """Move the targets from ``start`` (n,) [rad] at ``speed`` (n,) [rad/s].

        Returns the torques (n,) [N m] to apply besides the actuators' own: ``bias``,
        and what makes their dampers act on the speed relative to the target's.
        """
        state.act[self._targets] = start
        state.ctrl[self._numbers] = speed
        added = bias + self._damping * speed
        limits = np.column_stack([-self._effort - added, self._effort - added])
        self._model.actuator_forcerange[self._numbers] = limits
        return added
