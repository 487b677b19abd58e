"""The cell that a plan runs on: arms, a tracker of the object, and a clock.

Simulators and real robot cells both provide these three. Each is a protocol of a few
members and can be replaced separately. Poses, points and forces are in the support's
frame (core/support_frame.py): x, y and height. On a table this is the world frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Protocol

from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.control.spacing import Spacing
from pushpressslide.control.tracker import ObjectTracker
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import ArmCommand, TipState, Vector3
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.selection.placement_planner import PlacementPlanner, PlansAlone

Interface = Literal["tip", "torque", "velocity", "position"]
"""Kind of command that an arm's driver accepts. With ``tip``, a tip without an arm
executes the tip command directly.
"""


class ArmState(NamedTuple):
    """Measurements of an arm."""

    time: float  # [s] of the cell's clock
    tip: TipState
    joints: ArmReading | None = None  # None: a tip without an arm


class Applied(NamedTuple):
    """The part of a command that was really applied. For a tip without an arm all
    fields are None.
    """

    torque: Array | None = None  # (n,) [N m]
    reference: Array | None = None  # (n,) [rad] to which the joints were commanded
    # largest commanded torque and change of torque, as shares of their limits
    torque_share: float = 0.0
    rate_share: float = 0.0


class Arm(Protocol):
    """One robot arm with its tip, joint limits, executor and control rate.

    The arm executes a command until the next one arrives.
    """

    interface: Interface

    @property
    def limits(self) -> ArmLimits | None:
        """Limits of the joints. None for a tip without an arm."""

    @property
    def path(self) -> JointPath | None:
        """Joint path in this placement, from the arm's configuration at its start. None
        for a tip without an arm.
        """

    def connect(self) -> None:
        """Start to drive the arm. Called before the first ``read``."""

    def read(self) -> ArmState:
        """Present measurements."""

    def send(self, command: ArmCommand) -> Applied:
        """Execute ``command`` until the next one. Returns what was really applied.

        With None the arm rests at the start of the joint path along the contact.
        """

    def disconnect(self) -> None:
        """Stop the arm, and stop driving it. Called once, however the run ended."""


class Clock(Protocol):
    """A clock: simulated physics that advance, or a wall clock that waits."""

    # time stands still until ``advance``; sensors have the task's imperfections
    simulated: bool

    @property
    def time(self) -> float:
        """Time [s] since the start."""

    def advance(self) -> None:
        """Let time pass until the next control period starts."""

    def failure(self) -> str | None:
        """Reason why the run cannot go on, or None."""


class TrueState(NamedTuple):
    """True state at a tick, for the record. It contains more than a robot can measure."""

    X_WG: Pose2  # of the object as the tick began
    tips: tuple[TipState, ...]  # as it began
    # of G's origin along x and y [m/s], and the yaw rate [rad/s]; None: not known
    twist: Vector3 | None = None
    # [N] of each tip ON the object during the tick; None: as it began
    forces: tuple[Vector3, ...] | None = None
    # makes this tick's rows of the arrays of core.record.Record that not every cell
    # has; called after the run
    extras: Callable[[], Mapping[str, Any]] = dict


class Witness(Protocol):
    """Reports the true state to a recorder, as only a simulator can."""

    @property
    def facts(self) -> Mapping[str, Any]:
        """Facts about the whole run."""

    def observe(self) -> TrueState:
        """True state of the last completed tick."""


class Placements(Protocol):
    """Arm motions from one placement to the next."""

    def prepare(self) -> PlacementPlanner:
        """Empty planner that starts from the present state of the arms. Its placements
        replace all remaining ones.
        """

    def restore(self) -> None:
        """Keep the remaining placements: no planner prepared since has a plan."""

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        """Continue with the next placement. Arms in ``kept_arms`` keep their contacts."""


class TipsAlone:
    """Placements of tips without arms, which need no joint paths."""

    def prepare(self) -> PlacementPlanner:
        """Planner that accepts any plan."""
        return PlansAlone()

    def restore(self) -> None:
        """Do nothing."""

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        """Do nothing."""


@dataclass(frozen=True)
class Cell:
    """Arms, tracker and clock on which a plan runs.

    A cell starts with the object at its true start and the arms at the start of the
    approach to the first placement, or in the final state of a run that this one
    continues.
    """

    name: str  # of the engine, as in a record
    clock: Clock
    arms: Sequence[Arm]  # one per robot of the task
    tracker: ObjectTracker
    placements: Placements = field(default_factory=TipsAlone)
    witness: Witness | None = None  # None: what was measured is recorded
    spacing: Spacing | None = None  # of the arms; None: not watched

    @property
    def arm_limits(self) -> tuple[ArmLimits, ...]:
        """Limits of each arm. Empty for tips without arms."""
        limits = [arm.limits for arm in self.arms]
        return tuple(one for one in limits if one is not None)

    @property
    def joint_paths(self) -> tuple[JointPath, ...]:
        """Joint path of each arm. Empty for tips without arms."""
        paths = [arm.path for arm in self.arms]
        return tuple(path for path in paths if path is not None)

    @contextmanager
    def connected(self) -> Iterator[None]:
        """Context in which the arms are driven. They are disconnected at its end, even
        after an error.
        """
        driven: list[Arm] = []
        try:
            for arm in self.arms:
                arm.connect()
                driven.append(arm)
            yield
        finally:
            for arm in driven:
                arm.disconnect()


class Driverless:
    """An arm that needs no connection, as in a simulator."""

    def connect(self) -> None:
        """Do nothing."""

    def disconnect(self) -> None:
        """Do nothing."""


class TipAlone(Driverless):
    """Base of all tips without arms."""

    interface: Interface = "tip"
    limits: ArmLimits | None = None
    path: JointPath | None = None
