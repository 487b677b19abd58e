"""Holonomic law limited to the wrenches that the contacts can provide.

If they cannot provide the wanted wrench, the pull towards the path is reduced, but not
the motion along the path.
"""

from __future__ import annotations

from collections.abc import Callable

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Pose2
from pushpressslide.tracking.carried import CarriedTracker
from pushpressslide.tracking.holonomic import HolonomicTracker

SHARES = (1.0, 0.5, 0.2, 0.0)  # fractions of the pull that are tried


class EasedTracker:
    """Tracking law with a reduced pull: the largest fraction in ``SHARES`` for which
    the contacts can provide the wrench.

    If no fraction is small enough, there is no pull.
    """

    def __init__(
        self,
        law: HolonomicTracker | CarriedTracker,
        allocate: Callable[[float, float, float], Allocation],
    ) -> None:
        """Bind to a law, and to the allocator of the contacts that hold the object."""
        self._law = law
        self._allocate = allocate

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench and twist that follow ``path`` at ``speed`` [m/s].

        ``steering_scale`` in (0, 1] also reduces the pull.
        """
        for share in SHARES:
            guidance = self._law.step(
                path, X_WB, progress, speed, share * steering_scale
            )
            allocation = self._allocate(guidance.fx, guidance.fy, guidance.tau)
            if allocation.status == "ok" and allocation.margin > 0.0:
                break
        return guidance
