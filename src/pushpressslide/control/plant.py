"""What an engine or a robot cell is to the run loop: a plant that is measured, commanded
and advanced.

Poses, points and forces are about x, y and height of the support's frame
(core/support_frame.py), on a table the world's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.core.control import Commands, Measurement, Vector3
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.selection.preparation import Preparation


@dataclass(frozen=True, slots=True)
class PlantRow:
    """What a plant adds to the record of one tick."""

    # of G's origin along x and y [m/s], and the yaw rate [rad/s]
    object_twist: Vector3
    tip_forces: tuple[Vector3, ...]  # [N] of each tip ON the object during the tick
    execution_time: float = 0.0  # [s] of wall time, from commands to actuators
    # makes this tick's rows of the arrays of core.record.Record that not every plant
    # has; asked when the run is over
    extras: Callable[[], Mapping[str, Any]] = dict


class Plant(Protocol):
    """An object on its support with the arms at it.

    A plant starts at time 0 with the object at its true start and the arms where the
    approach to the first placement begins, or all as a state has it. Its period is ``motion.control_period``.
    """

    name: str  # of the engine, as in a record
    overhead: float  # [s] expected beside the planned motions; for the progress only

    @property
    def time(self) -> float:
        """Time [s] since the start."""

    @property
    def joint_paths(self) -> tuple[JointPath, ...]:
        """The joint path of each arm in this placement, from where the arm was when
        the placement began; empty where tips move without arms.
        """

    @property
    def meta(self) -> Mapping[str, Any]:
        """Facts about the whole run, for the record."""

    @property
    def arm_limits(self) -> tuple[ArmLimits, ...]:
        """The limits of each arm's joints; none where tips move without arms."""

    def readings(self) -> tuple[ArmReading, ...]:
        """Return each arm's joints at the last measurement, and what the last commands
        asked of them; none where tips move without arms.
        """

    def measure(self) -> Measurement:
        """Return the truth that sensors see at the present time."""

    def apply(self, commands: Commands) -> None:
        """Command every arm until the next call."""

    def advance(self) -> None:
        """Let one control period pass; what goes wrong is kept for ``diverged``."""

    def row(self) -> PlantRow:
        """Return what is recorded of the tick from the last measurement on."""

    def diverged(self) -> str | None:
        """Return why the run cannot go on, or None."""

    def prepare(self) -> Preparation:
        """Return an empty preparation of placements from where the arms are now, in
        place of all that are ahead.
        """

    def hand_over(self, placement: Plan, lasting: frozenset[int]) -> None:
        """Go on with the next placement; arms in ``lasting`` keep their contacts."""
