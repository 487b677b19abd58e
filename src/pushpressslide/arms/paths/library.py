"""Interface of a library of rigid bodies for the search for joint paths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from pushpressslide.arms.model import ArmModel
from pushpressslide.arms.paths.capsules import ArmCapsules
from pushpressslide.arms.paths.clearance import Clearance
from pushpressslide.arms.paths.postures import Posture, TipPath
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.task import Robot
from pushpressslide.robots.kinematics import ArmKinematics


class ArmLibrary(Protocol):
    """Dynamics, distances and, if available, an optimiser of joint paths."""

    def model(self, robot: Robot) -> ArmModel:
        """Arm's dynamics."""

    def clearance(self, plan: Plan, arm: int, others: Mapping[int, Array]) -> Clearance:
        """Clearance model of an arm of a plan. ``others`` are postures (n,) of arms
        that stand still, by index.
        """

    def capsules(self, robot: Robot, index: int) -> ArmCapsules:
        """Capsules that enclose the ``index``th arm of a task."""

    def refined(
        self,
        kinematics: ArmKinematics,
        clearance: Any,
        path: TipPath,
        guess: Posture,
        margin: float,
        min_distance: float,
    ) -> Posture | None:
        """Posture near ``guess`` that follows a path which ``guess`` itself just
        misses. None without such a posture or without an optimiser.

        The posture keeps ``margin`` [rad] from the joint limits and ``min_distance``
        [m] from everything.
        """
