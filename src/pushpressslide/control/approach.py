"""The approach: joint motion in free space to where the touch begins, as a source of
commands beside the controller.
"""

from __future__ import annotations

from dataclasses import replace

from pushpressslide.control.joint_reference import approach_reference
from pushpressslide.core.control import (
    Commands,
    ControlLog,
    JointCommand,
    TipCommand,
    TipCommands,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.core.pose import Pose2

SETTLE = 0.2  # [s] that an arm rests at the end of its approach
NO_ERROR = (0.0, 0.0, 0.0)


class JointApproach:
    """Leads all arms to a placement along their joint paths.

    An arm that holds a contact from the placement before keeps on obeying its last tip
    command; its joint path gives its posture only.
    """

    def __init__(
        self,
        start: Pose2,
        paths: tuple[JointPath, ...],
        held: TipCommands,
        began: float,
    ) -> None:
        """Prepare to follow ``paths``, one per arm, from time ``began`` [s] on.

        ``start`` is X_WG where the placement is planned to begin; ``held`` has the
        command of each arm that keeps its contact, None for the others. Without paths
        the approach takes no time.
        """
        self._paths = paths
        self._began = began
        self._log = ControlLog(
            "approach", 0.0, start, NO_ERROR, NO_ERROR, NO_ERROR, 0.0, "ok"
        )
        self.held = held
        self.arrival = began  # [s] when the touch begins
        if paths:
            longest = max(float(path.approach_time[-1]) for path in paths)
            self.arrival = began + (longest + SETTLE)

    def step(self, time: float) -> tuple[Commands, ControlLog]:
        """Return one command per arm at ``time`` [s], and the log of the tick."""
        elapsed = time - self._began
        commands = tuple(
            _command(path, elapsed, held)
            for path, held in zip(self._paths, self.held, strict=True)
        )
        return commands, self._log


def _command(
    path: JointPath, elapsed: float, held: TipCommand | None
) -> TipCommand | JointCommand:
    position, velocity = approach_reference(path, elapsed)
    if held is None:
        return JointCommand(position, velocity)
    return replace(held, posture=position)
