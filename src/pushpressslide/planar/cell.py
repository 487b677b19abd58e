"""The planar world as a cell: quasi-static, on the exact limit surface."""

from __future__ import annotations

from pushpressslide.control.cell import Applied, Arm, ArmState, Cell, TipAlone
from pushpressslide.core.control import ArmCommand, TipCommand
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.scene import Robot
from pushpressslide.core.state import WorldState
from pushpressslide.planar.physics import PlanarPhysics
from pushpressslide.planar.servo_tip import ServoTip


def planar_cell(plan: Plan, start: WorldState | None = None) -> Cell:
    """Cell with the object of ``plan`` at its true start, and the tips before their
    contacts or at the positions in the start state of the run.
    """
    for i, knock in enumerate(plan.task.disturbances):
        if knock.ball is not None:
            source = plan.task.source or plan.task.name
            allowed = "allowed on engine planar: push"
            raise TaskError(source, f"disturbances[{i}].ball", knock.ball.side, allowed)
    physics = PlanarPhysics(plan, start)
    tips = [_tip(physics, i, robot) for i, robot in enumerate(plan.task.robots)]
    return Cell("planar", physics, tips, physics, physics, physics)


def _tip(physics: PlanarPhysics, index: int, robot: Robot) -> Arm:
    """Tip with the interface of its robot."""
    if robot.interface == "torque":
        return PlanarTip(physics, index)
    return ServoTip(physics, index, robot)


class PlanarTip(TipAlone):
    """One tip of the planar world."""

    def __init__(self, physics: PlanarPhysics, index: int) -> None:
        """Attach to the tip number ``index`` of the planar world."""
        self._physics = physics
        self._index = index

    def read(self) -> ArmState:
        """Position and velocity of the tip, and the force of the previous tick."""
        return ArmState(self._physics.time, self._physics.now.tips[self._index])

    def send(self, command: ArmCommand) -> Applied:
        """Execute a tip command. Only commands move the tip."""
        tip = command if isinstance(command, TipCommand) else None
        self._physics.commands[self._index] = tip
        return Applied()
