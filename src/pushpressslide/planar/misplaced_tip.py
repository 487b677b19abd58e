"""A tip that is not where its arm says, as the task's ``truth`` has it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pushpressslide.arms.command_line import CommandLine
from pushpressslide.control.cell import Applied, Arm, ArmState, TipAlone
from pushpressslide.core.control import ArmCommand, TipCommand, TipState, Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.truth import Truth


@dataclass(frozen=True, slots=True)
class Misplacement:
    """Motion that carries a tip from its believed place to the true one."""

    plane: Pose2  # along the support
    height: float = 0.0  # [m]

    @property
    def inverse(self) -> Misplacement:
        """Motion from the true place to the believed one."""
        return Misplacement(self.plane.inverse(), -self.height)

    def place(self, p: Vector3) -> Vector3:
        """Place [m] to which a tip at ``p`` [m] is carried."""
        x, y, z = p
        return (*self.plane.apply((x, y)), z + self.height)

    def turned(self, v: Vector3) -> Vector3:
        """A vector that turns with the tip."""
        x, y, z = v
        return (*self.plane.rotate((x, y)), z)

    def tip(self, tip: TipState) -> TipState:
        """State of a tip that is carried."""
        velocity = self.turned(tip.velocity)
        return TipState(self.place(tip.position), velocity, self.turned(tip.force))

    def command(self, command: TipCommand) -> TipCommand:
        """Command of a tip that is carried."""
        return replace(
            command,
            force=self.turned(command.force),
            position=self.place(command.position),
            velocity=self.turned(command.velocity),
            acceleration=self.turned(command.acceleration),
            normal_yaw=command.normal_yaw + self.plane.yaw,
            tool_yaw=command.tool_yaw + self.plane.yaw,
        )


def misplacement(truth: Truth, base: Vector3, frame: SupportFrame) -> Misplacement:
    """Misplacement of the tip of an arm whose ``base`` [m] is given in a support's
    ``frame``. Its tool is taken to point down, at tool yaw 0.
    """
    yaw = truth.arm_base_yaw * frame.spin_axis[2]
    dx, dy, dz = frame.components((*truth.arm_base, 0.0))
    turn = Pose2(0.0, 0.0, yaw)
    ox, oy, oz = truth.tip_offset
    # from the base, less its turn about the origin
    off_x, off_y = turn.rotate((ox, -frame.handedness * oy))
    x, y = base[:2]
    turned_x, turned_y = turn.rotate((x, y))
    plane = Pose2(x + dx + off_x - turned_x, y + dy + off_y - turned_y, yaw)
    return Misplacement(plane, dz - oz)


class MisplacedTip(TipAlone):
    """A tip with errors of its measured place, to which commands may come late."""

    def __init__(
        self, tip: Arm, off: Misplacement, line: CommandLine[ArmCommand]
    ) -> None:
        """Wrap a ``tip``, which is misplaced by ``off``. Commands come through ``line``."""
        self.interface = tip.interface
        self._tip = tip
        self._off = off
        self._believed = off.inverse
        self._line = line

    def read(self) -> ArmState:
        """The tip as the arm believes."""
        state = self._tip.read()
        return state._replace(tip=self._believed.tip(state.tip))

    def send(self, command: ArmCommand) -> Applied:
        """Execute a command as far as it arrives."""
        arrived = self._line.through(command)
        if isinstance(arrived, TipCommand):
            arrived = self._off.command(arrived)
        return self._tip.send(arrived)
