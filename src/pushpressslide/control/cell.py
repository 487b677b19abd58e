"""What a plan is run on: arms, a tracker of the object, and a clock.

A simulator gives all three, and a robot cell does. Each is a protocol of a few members,
and each can be another one. Poses, points and forces are about x, y and height of the
support's frame (core/support_frame.py), on a table the world's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Protocol

from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.control.tracker import ObjectTracker
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import ArmCommand, TipState, Vector3
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.selection.placement_planner import PlacementPlanner, PlansAlone

Interface = Literal["tip", "torque", "velocity", "position"]
"""What an arm's driver takes; ``tip``: a tip without an arm obeys the command itself."""


class ArmState(NamedTuple):
    """What an arm measures."""

    time: float  # [s] of the cell's clock
    tip: TipState
    joints: ArmReading | None = None  # None: a tip without an arm


class Applied(NamedTuple):
    """What became of a command; nothing is known of a tip without an arm."""

    torque: Array | None = None  # (n,) [N m]
    reference: Array | None = None  # (n,) [rad] that the joints were led to
    # largest torque and change of a torque that were asked for, as shares of their limits
    torque_share: float = 0.0
    rate_share: float = 0.0


class Arm(Protocol):
    """One robot arm with its tip, its limits, its executor and its own rate.

    It goes on obeying a command until the next one.
    """

    interface: Interface

    @property
    def limits(self) -> ArmLimits | None:
        """Limits of its joints; None for a tip without an arm."""

    @property
    def path(self) -> JointPath | None:
        """Its joint path in this placement, from where the arm was as the placement
        began; None for a tip without an arm.
        """

    def connect(self) -> None:
        """Begin to drive it; called before the first read."""

    def read(self) -> ArmState:
        """What is measured now."""

    def send(self, command: ArmCommand) -> Applied:
        """Obey ``command`` until the next one; what was really applied.

        None: rest where the joint path along the contact begins.
        """

    def disconnect(self) -> None:
        """Cease to drive it, at rest; called once, however the run ended."""


class Clock(Protocol):
    """Physics that advance, or a wall clock that waits."""

    # time stands still until ``advance``, and sensors have the faults that the task says
    simulated: bool

    @property
    def time(self) -> float:
        """Time [s] since the start."""

    def advance(self) -> None:
        """Let the time pass until the next control period begins."""

    def failure(self) -> str | None:
        """Why the run cannot go on; None while it can."""


class Truth(NamedTuple):
    """What a recorder is told of a tick: more than a robot sees."""

    X_WG: Pose2  # of the object as the tick began
    tips: tuple[TipState, ...]  # as it began
    # of G's origin along x and y [m/s], and the yaw rate [rad/s]; None: not known
    twist: Vector3 | None = None
    # [N] of each tip ON the object during the tick; None: as it began
    forces: tuple[Vector3, ...] | None = None
    # makes this tick's rows of the arrays of core.record.Record that not every cell has;
    # asked when the run is over
    extras: Callable[[], Mapping[str, Any]] = dict


class Witness(Protocol):
    """Tells a recorder the truth, as only a simulator can."""

    @property
    def facts(self) -> Mapping[str, Any]:
        """What is to be known of the whole run."""

    def observe(self) -> Truth:
        """The truth of the tick that was passed last."""


class Placements(Protocol):
    """Where the arms go from one placement to the next one."""

    def prepare(self) -> PlacementPlanner:
        """An empty preparation of placements from where the arms are now, in place of
        all that are ahead.
        """

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        """Go on with the next placement; arms in ``kept_arms`` keep their contacts."""


class TipsAlone:
    """Placements of tips without arms: they travel there by themselves."""

    def prepare(self) -> PlacementPlanner:
        """A preparation that takes any plan."""
        return PlansAlone()

    def hand_over(self, placement: Plan, kept_arms: frozenset[int]) -> None:
        """Nothing has to be done."""


@dataclass(frozen=True)
class Cell:
    """Everything that a plan is run on.

    It begins with the object at its true start and the arms where the approach to the
    first placement begins, or all as a run left it that this one goes on from.
    """

    name: str  # of the engine, as in a record
    clock: Clock
    arms: Sequence[Arm]  # one per robot of the task
    tracker: ObjectTracker
    placements: Placements = field(default_factory=TipsAlone)
    witness: Witness | None = None  # None: what was measured is recorded

    @property
    def arm_limits(self) -> tuple[ArmLimits, ...]:
        """Limits of each arm; none where tips move without arms."""
        limits = [arm.limits for arm in self.arms]
        return tuple(one for one in limits if one is not None)

    @property
    def joint_paths(self) -> tuple[JointPath, ...]:
        """Joint path of each arm; none where tips move without arms."""
        paths = [arm.path for arm in self.arms]
        return tuple(path for path in paths if path is not None)

    @contextmanager
    def connected(self) -> Iterator[None]:
        """Drive the arms; they are disconnected however it ends."""
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
        """Nothing has to be done."""

    def disconnect(self) -> None:
        """Nothing has to be done."""


class TipAlone(Driverless):
    """What all tips without arms have in common."""

    interface: Interface = "tip"
    limits: ArmLimits | None = None
    path: JointPath | None = None
