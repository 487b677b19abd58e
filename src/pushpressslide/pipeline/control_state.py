"""What the controller remembers between ticks, and the laws that a plan is bound to."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import Phase, Vector3
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point
from pushpressslide.core.record import ReasonCode
from pushpressslide.execution.normal_force import NormalForceState
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Tracker

FREE_STIFFNESS = (1500.0, 1500.0, 3000.0)  # [N/m] of a tip that touches nothing
FREE_DAMPING = (150.0, 150.0, 250.0)  # [N s/m]
SERVO_CAP = 25.0  # [N] by which the servo may exceed the allocated force: it also accelerates the arm
ALIGN_SPEED = 0.10  # [m/s] of the free tip


@dataclass(frozen=True, slots=True)
class Binding:
    """A plan with its closed-form laws; made anew when object or contacts turn out to be elsewhere."""

    plan: Plan
    tracker: Tracker
    allocate: Callable[[float, float, float], Allocation]
    tip_points: tuple[Point, ...]  # [m] in B, of the tips' centres


def bind(plan: Plan) -> Binding:
    """Return the laws of ``plan``'s mode for its contacts."""
    mode, choice = MODES[plan.choice.mode], plan.choice
    tip_points = tuple(
        (c.point[0] - r.tip_radius * c.normal[0], c.point[1] - r.tip_radius * c.normal[1])
        for c, r in zip(choice.contacts, plan.task.robots, strict=True)
    )
    friction, rho = plan.task.believed.contact_friction, choice.parameters.get("rho")
    return Binding(plan, mode.tracker(plan), mode.allocator(choice.contacts, friction, rho), tip_points)


@dataclass(frozen=True, slots=True)
class ControllerState:
    """Everything that the controller remembers between ticks."""

    phase: Phase
    since: float  # [s] start of the phase
    tip_start: tuple[Vector3, ...]  # [m] where the tips were when the phase began
    binding: Binding  # what is being followed now
    last_time: float  # [s]
    progress: float = 0.0  # [m] on the binding's path
    clock_start: float = 0.0  # [s] time zero of the binding's profile
    reference: Plan | None = None  # the plan that errors are judged by: the one made at the first touch
    reference_start: float = 0.0  # [s] its time zero
    align: bool = True  # whether the touch begins with lining up, or goes on from where the tips are
    felt: float | None = None  # [s] since when contact is felt in this touch
    touch_depth: float = 0.0  # [m] advance at which contact was felt
    lost: float | None = None  # [s] since when contact is missing
    corrected: float = 0.0  # [s] of the last re-plan on the way
    regrasps: int = 0
    tip_velocities: tuple[Point, ...] = ()  # [m/s] world, as last commanded in this phase
    grip: float = 1.0  # share of the steering that may be used, lowered while contacts are near slipping
    regulator: NormalForceState = NormalForceState()
    failure: tuple[ReasonCode, str] | None = None


def smooth(u: float) -> float:
    """Return the minimum-jerk ramp from 0 to 1 at ``u``, clamped outside [0, 1]."""
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))


def ramp_time(way: float) -> float:
    """Return how long a minimum-jerk move over ``way`` [m] takes at ALIGN_SPEED at its fastest [s]."""
    return 1.875 * math.fabs(way) / ALIGN_SPEED


def approached(value: Point, target: Point, step: float) -> Point:
    """Return ``target`` if it is within ``step`` of ``value``, else the point that far on the way to it."""
    dx, dy = target[0] - value[0], target[1] - value[1]
    size = math.hypot(dx, dy)
    if size <= step:
        return target
    return (value[0] + dx * step / size, value[1] + dy * step / size)
