"""What the controller remembers between ticks, and the laws that a plan is bound to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.control.adaptation import Adaptation
from pushpressslide.control.correction import sides_of, touched_points
from pushpressslide.control.timeline import Timeline
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import (
    ControlLog,
    Measurement,
    Phase,
    TipCommand,
    TipState,
    Vector3,
)
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact, Segment
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.record import ReasonCode
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.execution.normal_force import NormalForceState
from pushpressslide.geometry.sides import Side
from pushpressslide.identification.center import CenterIdentifier, CenterState
from pushpressslide.identification.findings import Findings
from pushpressslide.identification.online import AxleIdentifier, AxleState
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Allocator, Tracker

FREE_STIFFNESS = (1500.0, 1500.0, 3000.0)  # [N/m] of a tip that touches nothing
FREE_DAMPING = (150.0, 150.0, 250.0)  # [N s/m]
# [N] by which the servo may exceed the allocated force: it also accelerates the arm
SERVO_CAP = 25.0
ALIGN_SPEED = 0.10  # [m/s] of the free tip
# [m] that the joint reference may be ahead of the object or behind it: a spring
# stretched round a bend would pull the tip sideways off its face
JOINT_LEAD = 0.03
NOTHING_SEEN = CenterState()
NO_TWIST = Twist(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Binding:
    """A segment with its closed-form laws.

    Every replan makes a new one.
    """

    segment: Segment
    tracker: Tracker
    allocate: Allocator
    tip_points: tuple[Point, ...]  # [m] in B, of the tips' centres, one per contact
    sides: tuple[Side | None, ...]  # of the object, that the contacts are on

    def touched(self, X_WB: Pose2, tips: Sequence[TipState]) -> tuple[Point, ...]:
        """Return where the tips touch the object [m], in B."""
        return touched_points(self.segment.contacts, self.sides, X_WB, tips)


def bind(task: Task, segment: Segment, tracker: Tracker) -> Binding:
    """Return the laws of a segment's mode for its contacts, led by ``tracker``; ``task``
    is its leg's.
    """
    mode = MODES[segment.mode]
    contacts = segment.contacts
    tip_points = tuple(
        contact.tip_place(task.robots[contact.arm].tip_radius)[0]
        for contact in contacts
    )
    allocate = mode.allocator_of(segment, task.contact_friction)
    return Binding(
        segment,
        tracker,
        allocate,
        tip_points,
        sides_of(task.object, contacts),
    )


class TipContext(NamedTuple):
    """What the laws of one tip are given at a tick."""

    contact: Contact
    tip: TipState
    X_WB: Pose2
    time: float  # [s]
    dt: float  # [s] since the last tick
    joint_progress: float  # [m] on the planned path, for the joint reference
    tool_yaw: float  # [rad] wanted of the tool, less the joint path's offset


class TipMemory(NamedTuple):
    """What is remembered of one tip."""

    start: Vector3  # [m] where it was when the phase began
    found: Pose2 | None = None  # X_WB when the tip began to advance in this touch
    felt: float | None = None  # [s] since when contact is felt in this touch
    absent: float | None = None  # [s] since when it is felt no more
    resumed: float | None = None  # [s] when the tip advanced anew since it was
    touch_depth: float = 0.0  # [m] advance at which contact was felt
    regulator: NormalForceState = NormalForceState()
    velocity: Point | None = None  # [m/s] world, as last commanded in this phase
    turn: float = 0.0  # [rad/s] of the tool, the same
    mean_force: float | None = None  # [N] of the last measurements, in this phase
    height: float | None = None  # [m] at which a pushing tip is held, in this phase
    # [N] along the support, world, as last commanded to a pressing tip in this phase
    drag: Point = (0.0, 0.0)
    # of a tip that comes into this placement with the contact it has
    held: TipCommand | None = None


@dataclass(frozen=True, slots=True)
class Still:
    """Where an object has been since a time, but for less than counts as motion."""

    pose: Pose2  # X_WB
    since: float  # [s]


@dataclass(frozen=True, slots=True)
class Losses:
    """How often contact was lost about one place."""

    pose: Pose2  # X_WB at the first of them
    count: int


class ControllerState(NamedTuple):
    """Everything that the controller remembers between ticks: a tuple, of which another
    one with a few other fields is made in a tenth of a dataclass's time.
    """

    phase: Phase
    since: float  # [s] start of the phase
    tips: tuple[TipMemory, ...]  # one per contact
    binding: Binding  # what is being followed now
    last_time: float  # [s]
    segment: Segment  # as planned: what is being followed, before any replanning
    ahead: tuple[Segment, ...]  # the segments that come after it
    identifier: AxleIdentifier | None  # of the virtual axle in this segment
    center_identifier: CenterIdentifier | None  # of the CoM, the same
    joint_start: float = 0.0  # [m] of joint path before this segment
    progress: float = 0.0  # [m] on the binding's path
    clock_start: float = 0.0  # [s] time zero of the binding's profile
    began: float | None = None  # [s] of the placement's motion, after its first touch
    # what is being followed, as planned when it began
    reference: Segment | None = None
    reference_start: float = 0.0  # [s] its time zero
    # whether the touch begins with lining up, or goes on from where the tips are
    align: bool = True
    lost: float | None = None  # [s] since when contact is missing
    losses: Losses | None = None
    still: Still | None = None  # where the object was when it last moved
    replanned: float = 0.0  # [s] of the last replan on the way
    retouches: int = 0
    retries: int = 0
    # what is identified of the virtual axle in this segment
    axle: AxleState = AxleState()
    rho: float | None = None  # [m] as last identified in this placement
    center: CenterState = NOTHING_SEEN  # what is identified of the CoM
    # p_BCom [m] of the plan that is followed
    followed_center: Point = (0.0, 0.0)
    adaptation: Adaptation = Adaptation()
    # of the object, as measured or, where the camera missed it, as predicted
    X_WB: Pose2 | None = None
    twist: Twist = NO_TWIST  # that the object is led with, in B
    failure: tuple[ReasonCode, str] | None = None
    drawn: float = 1.0  # share of the way back at which the tips stop, in a release
    ticks: tuple[float, float] = (0.0, 0.0)  # [s] wall time of track and allocate


def tip_position(
    contact: Contact, X_WB: Pose2, radius: float, gap: float = 0.0
) -> Vector3:
    """Return where the centre of a tip of ``radius`` [m] is, ``gap`` [m] before its
    contact [m].
    """
    point, height = contact.tip_place(radius, gap)
    x, y = X_WB.apply(point)
    return (x, y, height)


def sunk(contact: Contact, tip: TipState, radius: float, most: float) -> bool:
    """Whether a ``tip`` of ``radius`` [m] that presses on top of an object is beside it:
    by more than ``most`` [m] lower than it rests there.

    Nothing holds it then: pressed on, it falls beside the object on the support.
    """
    if contact.kind != "top":
        return False
    _, height = contact.tip_place(radius)
    return tip.position[2] < height - most


def contact_yaw(contact: Contact, X_WB: Pose2) -> float:
    """Return the yaw [rad] of the contact frame.

    It is that of the face's normal, and under a press that of the object.
    """
    if contact.kind == "top":
        return X_WB.yaw
    return X_WB.yaw + math.atan2(contact.normal[1], contact.normal[0])


def pressed(force: Vector3, direction: Vector3) -> float:
    """Return the normal force [N] of a tip whose force on the object is ``force``."""
    return force[0] * direction[0] + force[1] * direction[1] + force[2] * direction[2]


def by_arm(
    commands: tuple[TipCommand, ...], contacts: tuple[Contact, ...], arms: int
) -> tuple[TipCommand | None, ...]:
    """Return one command per arm: None for an arm without a contact."""
    out: list[TipCommand | None] = [None] * arms
    for command, contact in zip(commands, contacts, strict=True):
        out[contact.arm] = command
    return tuple(out)


def smooth(u: float) -> float:
    """Return the minimum-jerk ramp from 0 to 1 at ``u``, clamped outside [0, 1]."""
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))


def smooth_rate(u: float) -> float:
    """Return the derivative of the minimum-jerk ramp at ``u``, zero outside [0, 1]."""
    u = min(max(u, 0.0), 1.0)
    return 30.0 * u * u * (1.0 - u) * (1.0 - u)


def smooth_change(u: float) -> float:
    """Return the second derivative of the minimum-jerk ramp at ``u``, zero outside [0,
    1].
    """
    u = min(max(u, 0.0), 1.0)
    return 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)


def ramp_time(way: float, speed: float = ALIGN_SPEED) -> float:
    """Return how long a minimum-jerk move over ``way`` [m] takes at ``speed`` [m/s] at
    its fastest [s].
    """
    return 1.875 * math.fabs(way) / speed


def between(a: Vector3, b: Vector3, share: float) -> Vector3:
    """Return the point [m] at ``share`` of the way from ``a`` to ``b``."""
    return (
        a[0] + share * (b[0] - a[0]),
        a[1] + share * (b[1] - a[1]),
        a[2] + share * (b[2] - a[2]),
    )


def begin(
    state: ControllerState, phase: Phase, measurement: Measurement
) -> ControllerState:
    """Return the state at the start of a phase.

    The regulator of the normal force is kept only by a press that goes on.
    """
    contacts = state.binding.segment.contacts
    tips = tuple(
        TipMemory(
            measurement.tips[c.arm].position,
            regulator=m.regulator if phase == "move" else NormalForceState(),
        )
        for m, c in zip(state.tips, contacts, strict=True)
    )
    return state._replace(
        phase=phase,
        since=measurement.time,
        tips=tips,
        last_time=measurement.time,
        align=True,
        lost=state.lost if phase == "touch" else None,
        twist=NO_TWIST,
    )


def joint_progress(state: ControllerState) -> float:
    """Return where on the PLANNED path the joint reference is taken: as far from the
    end as the object is on its own path; where a turn on the spot goes on as arcs, whose
    lengths are another point's, where the object is nearest to it.
    """
    planned = state.segment
    if remade(state, state.binding.segment):
        assert isinstance(planned.path, TwistPath)
        assert state.X_WB is not None
        here = planned.path.nearest(state.X_WB.compose(planned.X_BV), 0.0)
        return state.joint_start + min(here, planned.path.length)
    left = state.binding.segment.path.length - state.progress
    return state.joint_start + max(0.0, state.segment.path.length - left)


def remade(state: ControllerState, segment: Segment) -> bool:
    """Whether ``segment`` drives along arcs where its leg was planned along twists."""
    planned = state.segment
    twists = isinstance(planned.path, TwistPath)
    return twists and isinstance(segment.path, ArcPath) and segment.leg == planned.leg


def joint_reference(state: ControllerState, time: float, tracking: bool) -> float:
    """Return where on the planned path the joint reference is taken in the move [m].

    With joint ``tracking`` it is where the reference is at the same ``time`` [s], the
    paper's q(t), at most JOINT_LEAD from the object.
    """
    here = joint_progress(state)
    reference = state.reference
    if not tracking or reference is None:
        return here
    elapsed = time - state.reference_start
    timed = reference.profile.at(elapsed)[0] - reference.path.length
    timed += state.joint_start + state.segment.path.length
    return max(0.0, min(max(timed, here - JOINT_LEAD), here + JOINT_LEAD))


def seen(
    state: ControllerState, measurement: Measurement, X_WB: Pose2, touched: Point
) -> tuple[AxleState, CenterState]:
    """Return what is identified of the virtual axle and of the CoM, this tick included;
    ``touched`` [m] in B is the first contact.
    """
    arm = state.binding.segment.contacts[0].arm
    fx, fy, _ = measurement.tips[arm].force
    force = X_WB.unrotate((fx, fy))
    time = measurement.time
    axle = state.axle
    center = state.center
    if state.identifier is not None:
        axle = state.identifier.step(axle, time, X_WB, force)
    if state.center_identifier is not None:
        center = state.center_identifier.step(center, time, X_WB, force, touched)
    return axle, center


def findings(state: ControllerState) -> Findings:
    """Return what is identified: the virtual axle where it contradicts the plan; rho as
    it is identified in this segment, or was before; the CoM.
    """
    rho = state.rho
    axle = None
    if state.identifier is not None:
        axle = state.identifier.identified(state.axle)
    if axle is not None:
        rho = axle.rho
    center = state.center.center
    elsewhere = False
    if state.center_identifier is not None:
        identifier = state.center_identifier
        elsewhere = identifier.contradicts(state.center, state.followed_center)
        if not elsewhere:  # the plan is not contradicted
            center = state.followed_center
    return Findings(axle, rho, state.axle.drag, center, elsewhere)


def control_log(
    state: ControllerState,
    measurement: Measurement,
    X_BG: Pose2,
    planned: Timeline,
    guidance: Guidance | None = None,
    allocation: Allocation | None = None,
) -> ControlLog:
    """Return what was decided at a tick, for the record."""
    clock = 0.0
    if state.began is not None:
        clock = measurement.time - state.began
    reference = planned.body_pose(clock).compose(X_BG)
    pose = Pose2(reference.x, reference.y, wrap_angle(reference.yaw))
    if guidance is None or allocation is None:
        nothing = (0.0, 0.0, 0.0)
        return ControlLog(
            state.phase, state.progress, pose, nothing, nothing, nothing, 0.0, "ok"
        )
    wrench = guidance.wrench
    rx, ry, rt = allocation.residual
    given = Wrench(wrench.fx - rx, wrench.fy - ry, wrench.tau - rt, wrench.about)
    return ControlLog(
        state.phase,
        state.progress,
        pose,
        guidance.error,
        wrench.moved_to((0.0, 0.0))[:3],
        given.moved_to((0.0, 0.0))[:3],
        guidance.steering,
        allocation.status,
    )
