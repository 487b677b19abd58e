"""An arm with position commands: it pushes, stiffly, one tick late."""

from __future__ import annotations

import math

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.cell import Applied, ArmState, Cell, Interface, TipAlone
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.control.state import SERVO_CAP
from pushpressslide.core.control import ArmCommand, TipCommand, Vector3
from pushpressslide.planar.physics import PlanarPhysics

STIFFNESS = 2e4  # [N/m] of the arm's own servo
DAMPING = 200.0  # [N s/m]
ZERO = (0.0, 0.0, 0.0)


class PositionArm(TipAlone):
    """A tip that its own servo leads to a place, a tick after it was told so.

    Where a command holds the tip by a spring the place is the spring's; along an axis
    without one it is led on from there at the command's velocity.
    """

    interface: Interface = "position"

    def __init__(self, physics: PlanarPhysics, period: float) -> None:
        self.physics = physics
        self.period = period
        self.place = np.array(physics.now.tips[0].position)  # that is wanted next
        self.sent: list[Vector3] = []

    def read(self) -> ArmState:
        return ArmState(self.physics.time, self.physics.now.tips[0])

    def send(self, command: ArmCommand) -> Applied:
        before = self.place.copy()
        if isinstance(command, TipCommand):
            self.place = self.led(command)
        velocity = (self.place - before) / self.period
        self.physics.commands[0] = self.servo(before, velocity)
        x, y, z = self.place.tolist()
        self.sent.append((x, y, z))
        return Applied()

    def led(self, command: TipCommand) -> np.ndarray:
        """The next place [m]."""
        on = self.place + self.period * np.array(command.velocity)
        c, s = math.cos(command.normal_yaw), math.sin(command.normal_yaw)
        axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        held = np.array(command.stiffness) > 0.0
        along = np.where(held, axes @ np.array(command.position), axes @ on)
        return axes.T @ along

    @staticmethod
    def servo(place: np.ndarray, velocity: np.ndarray) -> TipCommand:
        """What the arm's own servo does, as the planar world takes it."""
        x, y, z = place.tolist()
        vx, vy, vz = velocity.tolist()
        stiff = (STIFFNESS,) * 3
        slow = (DAMPING,) * 3
        return TipCommand(
            ZERO, (x, y, z), (vx, vy, vz), stiff, slow, 0.0, 0.0, 0.0, SERVO_CAP, 0.0
        )


@pytest.mark.parametrize("name", ["rear-push-rear", "rear-push-left"])
def test_a_shipped_push_is_done_by_positions(name: str) -> None:
    plan = pps.plan(pps.load_task(name))
    physics = PlanarPhysics(plan)
    arm = PositionArm(physics, plan.task.motion.control_period)
    cell = Cell("positions", physics, [arm], physics, witness=physics)
    record = run_loop(cell, plan, RunOptions())
    figures = pps.result(record)
    assert figures["success"], record.reason_text
    assert figures["final_position_error"] < 2e-3
    # its places are led without a jump
    steps = np.linalg.norm(np.diff(arm.sent, axis=0), axis=1)
    assert steps.max() < 2e-3
