"""The cell of arms in a simulator with bodies in space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.model import at_rest
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.placements import ArmPlacements
from pushpressslide.control.approach import SETTLE
from pushpressslide.control.cell import Cell, Clock, TrueState
from pushpressslide.control.tracker import ObjectTracker
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import WorldState

FALLEN = "the object has fallen over the edge of support.region"
TIPPED = math.radians(60.0)  # no object comes back from this angle
FAR = 2.0
"""Distance [m] from start and goal beyond which the simulation has diverged."""


class ArmPhysics(Clock, ObjectTracker, Protocol):
    """Simulated physics of bodies and arms, with the true state."""

    facts: dict[str, Any]

    def put(self, arms: Sequence[JointArm], start: WorldState | None) -> None:
        """Put ``arms`` at the start of their joint paths, or arms and bodies as in
        ``start``.
        """

    def observe(self) -> TrueState:
        """True state of the last completed tick."""


def arm_cell(
    name: str,
    physics: ArmPhysics,
    arms: Sequence[JointArm],
    placements: ArmPlacements,
    paths: Sequence[tuple[ArmPath, ...]],
    plan: Plan,
    start: WorldState | None,
) -> Cell:
    """Cell of an engine of the given name, with its arms at the start of the first of
    ``paths``, or with arms and bodies as in ``start``.
    """
    postures = None if start is None else [np.array(q) for q in start.joints]
    placements.begin_placement(plan.query, postures)
    physics.put(arms, start)
    physics.facts.update(_path_facts(paths))
    physics.facts["start_tips"] = [
        arm.model.state_at(at_rest(arm.path.approach[-1])).position for arm in arms
    ]
    spacing = placements.spacing(plan.task.robots)
    return Cell(name, physics, arms, physics, placements, physics, spacing)


def _path_facts(paths: Sequence[tuple[ArmPath, ...]]) -> dict[str, Any]:
    """Facts about the planned joint paths of all placements."""
    every = [path for placement in paths for path, _ in placement]
    first = max(float(path.approach_time[-1]) for path, _ in paths[0])
    return {
        "joint_margin_planned": min(path.joint_margin for path in every),
        "condition_planned": max(path.condition for path in every),
        "clearance_planned": min(path.clearance for path in every),
        "approach_time": first + SETTLE,
    }


def lost_object(
    total: float,
    X_WG: Pose2,
    ends: Sequence[Pose2],
    height: float | None,
    tilt: float = 0.0,
) -> str | None:
    """Reason why a simulation cannot continue with an object at X_WG, or None.

    ``total`` is the sum of the state, which is not finite if the simulation has
    diverged; ``ends`` are the object's start and goal. ``height`` [m] above the support
    is None if the support has no edge. ``tilt`` [rad] is the angle by which the object
    leans.
    """
    place = f"({X_WG.x:.2f}, {X_WG.y:.2f})"
    off = min(math.dist(X_WG.position, end.position) for end in ends)
    if not math.isfinite(total) or off > FAR:
        return f"the object is at {place}"
    if height is not None and height < 0.0:
        return f"{FALLEN} at {place}"
    if tilt > TIPPED:
        return f"the object has tipped and fallen over at {place}"
    return None
