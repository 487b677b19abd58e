"""An object that two contacts hold and lead along one constant twist: what the modes
that press share.
"""

from __future__ import annotations

from math import hypot

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.height_term import DraggedSurface

EDGE = 0.012  # [m] that a press stays away from the top's edges
# half widths that the centre of pressure stays inside the base's edge
TIPPING_MARGIN = 0.15
DECAY = 0.015  # [m] of path over which the tracker takes an error down to 1/e
LEAST_GIVEN = 1e-3  # share of the wanted wrench, below which it counts as this


def twist_at(path: TwistPath, point: Point) -> Twist:
    """Return the twist per metre with which a path of ``point`` [m] in B begins."""
    return Twist(*path.rate(0.0), point)


def path_onward(
    task: Task, X_WB: Pose2, X_BV: Pose2, goal: Pose2, radius: float, longest: float
) -> TwistPath | None:
    """Return the path of V by one twist from ``X_WB`` to the object's ``goal`` X_WG;
    None if it is longer than ``longest`` [m], or if there is nowhere to go.
    """
    start = X_WB.compose(X_BV)
    end = goal.compose(task.object.X_GB).compose(X_BV)
    path = TwistPath.between((start, end), radius)
    if not 0.0 < path.length <= longest:
        return None
    return path


def utilisation(used: float, given: Allocation, surface: DraggedSurface) -> float:
    """Return the friction utilisation ``used`` of an allocation, scaled up by the share
    of the wanted wrench that it could not give.
    """
    fx, fy, tau = given.residual
    lost = hypot(fx, fy, tau / surface.rho) / surface.max_force
    return used / max(1.0 - lost, LEAST_GIVEN)


def tipping_refusal(cause: str, margin: float) -> Refusal | None:
    """Return what stands against a tipping ``margin`` [half widths] of the centre of
    pressure; None if nothing. ``cause`` says what tips the object.
    """
    if margin >= TIPPING_MARGIN:
        return None
    text = (
        f"{cause}: the centre of pressure comes within {{figure:.2f}} half widths of "
        "the base's edge, allowed {allowed:g}"
    )
    return Refusal("tipping", text, margin, TIPPING_MARGIN)
