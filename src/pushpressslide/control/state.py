"""The controller's state between ticks, and its input at a tick."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from pushpressslide.control.adaptation import Adaptation
from pushpressslide.control.estimator import NO_TWIST, Estimate
from pushpressslide.control.following import Following
from pushpressslide.core.control import (
    Measurement,
    Phase,
    TipCommand,
    TipState,
    Vector3,
)
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.record import ReasonCode
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.normal_force import NormalForceState
from pushpressslide.identification.parameter_estimates import ParameterEstimates
from pushpressslide.identification.tip_friction import TipFriction

FREE_STIFFNESS = (1500.0, 1500.0, 3000.0)  # [N/m] of a tip that touches nothing
FREE_DAMPING = (150.0, 150.0, 250.0)  # [N s/m]
# [N] by which the servo may exceed the allocated force: it also accelerates the arm
SERVO_CAP = 25.0
ALIGN_SPEED = 0.10  # [m/s] of the free tip
# [s] in which a tip comes to rest at the start of a phase. One that stops at once is
# stopped by the force at the tip, which tilts a tool by 7 degrees
SLOWING_TIME = 0.15

Failure = tuple[ReasonCode, str]
"""Code of a failure, and its description in words."""


class TipContext(NamedTuple):
    """Input of the laws of one tip at a tick."""

    contact: Contact
    tip: TipState
    X_WB: Pose2
    time: float  # [s]
    dt: float  # [s] since the last tick
    joint_progress: float  # [m] on the planned path, for the joint reference
    tool_yaw: float  # [rad] wanted of the tool, less the joint path's offset


LEAST_TOP = 0.8
"""Largest depth of a tip that still presses on a top, as a share of the top's height."""


class TipMemory(NamedTuple):
    """State of one tip between ticks."""

    start: Vector3  # [m] where it was when the phase began
    advance_start: Pose2 | None = (
        None  # X_WB when the tip began to advance in this touch
    )
    felt: float | None = None  # [s] since when contact is felt in this touch
    absent: float | None = None  # [s] since when it is felt no more
    resumed: float | None = None  # [s] when the tip last started to advance
    touch_depth: float = 0.0  # [m] advance at which contact was felt
    regulator: NormalForceState = NormalForceState()
    velocity: Point | None = None  # [m/s] world, as last commanded in this phase
    turn: float = 0.0  # [rad/s] of the tool, the same
    mean_force: Vector3 | None = None  # [N] mean of the last measurements in this phase
    kept_force: Vector3 | None = None  # [N] the same over more, that tells a loss
    height: float | None = None  # [m] at which a pushing tip is held, in this phase
    lowered: float = (
        0.0  # [m] of a pressing tip below its planned height when it touched
    )
    # [N] along the support, world, as last commanded to a pressing tip in this phase
    drag: Point = (0.0, 0.0)
    # command of a tip that keeps its contact from the last placement
    held_command: TipCommand | None = None
    # [m/s] world, and [rad/s] of the tool, of the motion that ended as the phase began
    carried: Point = (0.0, 0.0)
    spin: float = 0.0

    def slowed(self, elapsed: float) -> Slowing:
        """The tip's way to rest, ``elapsed`` [s] after the phase began."""
        u = min(elapsed / SLOWING_TIME, 1.0)
        left = 1.0 - u
        rate = -1.0 / SLOWING_TIME if u < 1.0 else 0.0
        moved = SLOWING_TIME * u * (1.0 - 0.5 * u)
        vx, vy = self.carried
        x, y, z = self.start
        return Slowing(
            (x + moved * vx, y + moved * vy, z),
            (left * vx, left * vy, 0.0),
            (rate * vx, rate * vy, 0.0),
            left * self.spin,
            rate * self.spin,
        )


class Slowing(NamedTuple):
    """Motion of a tip that comes to rest: position [m], velocity [m/s] and acceleration
    [m/s^2], and the tool's yaw rate [rad/s] with its derivative [rad/s^2].
    """

    position: Vector3
    velocity: Vector3
    acceleration: Vector3
    spin: float
    spin_rate: float


@dataclass(frozen=True, slots=True)
class StallWatch:
    """Pose and time of the object's last motion.

    Both are kept while the object moves by less than the motion threshold.
    """

    pose: Pose2  # X_WB
    since: float  # [s]


class Touched(NamedTuple):
    """Object and tips, as estimated and measured, when a motion began."""

    X_WB: Pose2
    tips: tuple[TipState, ...]
    place: float  # [m] standard deviation of the object's place


@dataclass(frozen=True, slots=True)
class ContactLosses:
    """Number of contact losses near one place of the path."""

    pose: Pose2  # X_WB at the first of them
    count: int


class Watches(NamedTuple):
    """Monitored failures, and the number of corrections of each."""

    lost: float | None = None  # [s] since when contact is missing
    # those of several contacts that are not felt, even if they need not be
    unfelt: tuple[int, ...] = ()
    losses: ContactLosses | None = None
    still: StallWatch | None = None  # where the object was when it last moved
    replanned: float = 0.0  # [s] of the last replan
    resisted: float | None = None  # [s] since when another body pushes back
    # [s] since when no path leads on from an object that turns otherwise than planned
    mistaken: float | None = None
    # of a press of unsure friction, since its last touch
    touched: Touched | None = None
    retouches: int = 0
    resistances: int = 0  # times that another body pushed back
    tip_friction: TipFriction | None = None  # of presses that slid
    retries: int = 0
    looked: float | None = (
        None  # [s] since when an object that has arrived is looked at
    )


class PhaseState(NamedTuple):
    """A phase and its progress. Each new phase is a new instance."""

    name: Phase
    since: float  # [s]
    tips: tuple[TipMemory, ...]  # one per contact
    # whether the touch starts with aligning the tips, or from where they are
    align: bool = True
    aligned: float = 0.0  # [s] from ``since`` to the advance; 0 before that
    commanded_twist: Twist = NO_TWIST  # commanded to the object, in B
    failure: Failure | None = None
    retreat_fraction: float = (
        1.0  # share of the retreat at which the tips stop, in a release
    )

    def delayed(self, passed: float) -> PhaseState:
        """Copy whose tips go on ``passed`` [s] later."""
        tips = tuple(
            memory
            if memory.resumed is None
            else memory._replace(resumed=memory.resumed + passed)
            for memory in self.tips
        )
        return self._replace(since=self.since + passed, tips=tips)

    @property
    def slows(self) -> bool:
        """Whether a tip begins this phase in motion."""
        return any(memory.carried != (0.0, 0.0) for memory in self.tips)


class ControllerState(NamedTuple):
    """State of the controller between ticks.

    It consists of tuples: replacing a few fields takes a tenth of the time that a
    dataclass needs.
    """

    phase: PhaseState
    following: Following
    estimate: Estimate
    estimator: Any  # state of the estimator
    adaptation: Adaptation = Adaptation()
    watches: Watches = Watches()

    def delayed(self, passed: float) -> ControllerState:
        """The same state, started ``passed`` [s] later.

        The object was not moved in the meantime.
        """
        phase = self.phase
        watches = self.watches
        still = watches.still
        if still is not None:
            still = StallWatch(still.pose, still.since + passed)
        lost = None if watches.lost is None else watches.lost + passed
        rests = tuple(m._replace(carried=(0.0, 0.0), spin=0.0) for m in phase.tips)
        return self._replace(
            phase=phase._replace(
                since=phase.since + passed, tips=rests, commanded_twist=NO_TWIST
            ),
            following=self.following.delayed(passed),
            watches=watches._replace(
                lost=lost, still=still, replanned=watches.replanned + passed
            ),
        )


class Instant(NamedTuple):
    """Quantities known at a tick."""

    time: float  # [s]
    dt: float  # [s] since the last tick
    X_WG: Pose2  # of the object, as estimated
    X_WB: Pose2  # the same
    tips: tuple[TipState, ...]  # as measured
    # share of the planned speed; 0: the tips stand still, to look or for lack of pictures
    pace: float = 1.0

    @property
    def rests(self) -> bool:
        """Whether the tips stand still."""
        return self.pace == 0.0

    def context(self, contact: Contact, tool_yaw: float, progress: float) -> TipContext:
        """Input of the laws of the tip at a ``contact``.

        ``tool_yaw`` [rad] is the wanted yaw of the tool, ``progress`` [m] the arc
        length at which the joint reference is read.
        """
        tip = self.tips[contact.arm]
        return TipContext(
            contact, tip, self.X_WB, self.time, self.dt, progress, tool_yaw
        )


def tip_position(
    contact: Contact, X_WB: Pose2, radius: float, gap: float = 0.0
) -> Vector3:
    """Centre [m] of a tip of ``radius`` [m], at a distance ``gap`` [m] before its
    contact.
    """
    point, height = contact.tip_place(radius, gap)
    x, y = X_WB.apply(point)
    return (x, y, height)


def sunk(contact: Contact, tip: TipState, radius: float, max_depth: float) -> bool:
    """Whether a ``tip`` that should press on top has slid off: it is more than
    ``max_depth`` [m] below its planned height.

    ``radius`` [m] is the tip's. Nothing supports the tip then, and pressing harder
    would push it onto the support next to the object.
    """
    if contact.kind != "top":
        return False
    _, height = contact.tip_place(radius)
    return tip.position[2] < height - max_depth


def lowered(contact: Contact, tip: TipState, radius: float, max_depth: float) -> float:
    """Depth [m] of a ``tip`` that touches a top below its planned height, by errors of
    the arm or of the object's height: at most ``max_depth`` [m], and nowhere near the
    support.

    ``radius`` [m] is the tip's.
    """
    if contact.kind != "top":
        return 0.0
    _, height = contact.tip_place(radius)
    most = min(max_depth, max(0.0, LEAST_TOP * contact.height - max_depth))
    return min(max(height - tip.position[2], 0.0), most)


def contact_yaw(contact: Contact, X_WB: Pose2) -> float:
    """Yaw [rad] of the contact frame: the direction of the face's normal for a push,
    the object's yaw for a press.
    """
    if contact.kind == "top":
        return X_WB.yaw
    return X_WB.yaw + math.atan2(contact.normal[1], contact.normal[0])


def pressed(force: Vector3, direction: Vector3) -> float:
    """Normal force [N] of a tip whose force on the object is ``force``."""
    return force[0] * direction[0] + force[1] * direction[1] + force[2] * direction[2]


def averaged(mean: Vector3 | None, force: Vector3, samples: int) -> Vector3:
    """Mean of a force after another measurement of it, over about as many ``samples``."""
    if mean is None or samples == 1:
        return force
    x, y, z = (m + (f - m) / samples for m, f in zip(mean, force, strict=True))
    return (x, y, z)


def by_arm(
    commands: tuple[TipCommand, ...], contacts: tuple[Contact, ...], arms: int
) -> tuple[TipCommand | None, ...]:
    """One command per arm, None for an arm without a contact."""
    out: list[TipCommand | None] = [None] * arms
    for command, contact in zip(commands, contacts, strict=True):
        out[contact.arm] = command
    return tuple(out)


def smooth(u: float) -> float:
    """Minimum-jerk ramp from 0 to 1 at ``u``, clamped outside [0, 1]."""
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))


def smooth_rate(u: float) -> float:
    """First derivative of the minimum-jerk ramp at ``u``, zero outside [0, 1]."""
    u = min(max(u, 0.0), 1.0)
    return 30.0 * u * u * (1.0 - u) * (1.0 - u)


def smooth_change(u: float) -> float:
    """Second derivative of the minimum-jerk ramp at ``u``, zero outside [0, 1]."""
    u = min(max(u, 0.0), 1.0)
    return 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)


def ramp_time(distance: float, speed: float = ALIGN_SPEED) -> float:
    """Time [s] of a minimum-jerk move over ``distance`` [m] with peak speed ``speed``
    [m/s].
    """
    return 1.875 * math.fabs(distance) / speed


def between(a: Vector3, b: Vector3, share: float) -> Vector3:
    """Point [m] at the fraction ``share`` of the line from ``a`` to ``b``."""
    return (
        a[0] + share * (b[0] - a[0]),
        a[1] + share * (b[1] - a[1]),
        a[2] + share * (b[2] - a[2]),
    )


def enter_phase(
    state: ControllerState,
    name: Phase,
    now: Instant | Measurement,
    failure: Failure | None = None,
    *,
    at_once: bool = False,
) -> ControllerState:
    """State at the start of a phase, with the tips as measured ``now``.

    The regulator of the normal force is kept only by a press that continues into the
    phase. Tips that move before they line up anew or draw back after a failure slow down,
    if they need not stop ``at_once``.
    """
    contacts = state.following.binding.segment.contacts
    slows = (name == "touch" or failure is not None) and not at_once
    memories = tuple(
        TipMemory(
            now.tips[c.arm].position,
            regulator=m.regulator if name == "move" else NormalForceState(),
            mean_force=m.mean_force if name == "move" else None,
            lowered=m.lowered,
            carried=_carried(m, now.tips[c.arm]) if slows else (0.0, 0.0),
            spin=m.turn if slows else 0.0,
        )
        for m, c in zip(state.phase.tips, contacts, strict=True)
    )
    watches = state.watches._replace(looked=None, mistaken=None, unfelt=())
    if name != "touch":
        watches = watches._replace(lost=None)
    phase = PhaseState(name, now.time, memories, failure=failure)
    return state._replace(phase=phase, watches=watches)


def _carried(memory: TipMemory, tip: TipState) -> Point:
    """Velocity [m/s] along the support that a ``tip`` was commanded and has. What holds
    it back is not pushed on.
    """
    if memory.velocity is None:
        return (0.0, 0.0)
    x, y = memory.velocity
    vx, vy, _ = tip.velocity
    asked = x * x + y * y
    if asked == 0.0:
        return (0.0, 0.0)
    share = min(max((x * vx + y * vy) / asked, 0.0), 1.0)
    return (share * x, share * y)


def estimates(state: ControllerState) -> ParameterEstimates:
    """Identified parameters. If rho is not identified now, the last known rho is used."""
    found = state.estimate.parameters
    rho = state.following.rho
    if found.rho is not None or rho is None:
        return found
    return found._replace(rho=rho)
