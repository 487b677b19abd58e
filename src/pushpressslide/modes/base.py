"""What a contact mode is: its contacts, its reduced model, its tracking point, what it can do, and its
closed-form laws.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.wrench import Twist, Wrench


class Guidance(NamedTuple):
    """What a mode's tracking law asks of the object at one tick."""

    progress: float  # [m] arc length of the path's nearest point
    wrench: Wrench  # about the CoM, in B
    twist: Twist  # of the CoM, in B
    steering: float  # [rad] force angle from the heading axis
    error: tuple[float, float, float]  # along [m], left [m], heading [rad]; reference minus actual
    saturated: bool


class Tracker(Protocol):
    """A tracking law bound to a plan; its only state is the progress, which is handed in and out."""

    def step(self, path: ArcPath, X_WB: Pose2, progress: float, speed: float, grip: float) -> Guidance:
        """Return what the object should do at pose ``X_WB`` when the path is to be followed at ``speed``
        [m/s].

        ``grip`` in (0, 1] is the share of the mode's steering that may be used: the contacts are near
        slipping below 1.
        """
        ...


class Mode(Protocol):
    """One contact topology."""

    name: str
    arms: int
    reduced_model: str
    tracking_point: str
    cop_steering: bool

    def choices(self, task: Task) -> list[Choice]:
        """Return every placement of the contacts that was considered, best first, each judged feasible or
        not.
        """
        ...

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: the frame at the tracking point, x along the heading, in the body frame."""
        ...

    def tracker(self, plan: Plan) -> Tracker:
        """Return the tracking law for a plan."""
        ...

    def allocator(
        self, contacts: Sequence[Contact], friction: float, rho: float | None = None
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)``: a wrench about the CoM, in B, to contact forces."""
        ...

    def replan(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...], longest: float) -> Plan | None:
        """Return the plan from where object and contacts (points in B [m]) really are; None if that takes
        more than ``longest`` [m].
        """
        ...
