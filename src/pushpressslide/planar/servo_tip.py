"""A tip that takes places or velocities, late, as an arm with a servo does."""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.arms.lag import RobotServo
from pushpressslide.control.cell import Applied, ArmState, Interface, TipAlone
from pushpressslide.core import margins
from pushpressslide.core.control import ArmCommand, TipCommand, Vector3
from pushpressslide.core.scene import Robot
from pushpressslide.execution.admittance import Admittance
from pushpressslide.planar.physics import PlanarPhysics

DAMPING = 200.0
"""Damping [N s/m] of the tip about the place that its servo has reached."""


class ServoTip(TipAlone):
    """A tip whose servo reaches a place, and which is as soft as rubber about it."""

    def __init__(self, physics: PlanarPhysics, index: int, robot: Robot) -> None:
        """Take the ``index``th tip, with the interface and the delays of ``robot``."""
        self.interface: Interface = robot.interface
        self._physics = physics
        self._index = index
        self._admittance = Admittance(robot.reaction)
        start = np.array(physics.now.tips[index].position)
        self._place = start.copy()  # (3,) [m] as commanded
        self._servo = RobotServo(robot, start, physics.period)

    def read(self) -> ArmState:
        """Position, velocity, and the force of the previous tick."""
        return ArmState(self._physics.time, self._physics.now.tips[self._index])

    def send(self, command: ArmCommand) -> Applied:
        """Execute a tip command. Without one the tip stays in place."""
        dt = self._physics.period
        velocity = np.zeros(3)
        if isinstance(command, TipCommand):
            tip = self._physics.now.tips[self._index]
            velocity = np.array(self._admittance.velocity(command, tip))
        self._place = self._place + dt * velocity
        speed = self._servo.step(self._place, velocity)
        held = _held_place(self._servo.reached, speed)
        self._physics.commands[self._index] = held
        return Applied()


def _held_place(place: np.ndarray, velocity: np.ndarray) -> TipCommand:
    """Command of a tip that is held at a place [m] that moves [m/s]."""
    x, y, z = place.tolist()
    vx, vy, vz = velocity.tolist()
    position: Vector3 = (x, y, z)
    stiffness = margins.ARM.contact_stiffness
    return TipCommand(
        force=(0.0, 0.0, 0.0),
        position=position,
        velocity=(vx, vy, vz),
        stiffness=(stiffness,) * 3,
        damping=(DAMPING,) * 3,
        normal_yaw=0.0,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=math.inf,
        progress=0.0,
    )
